//! The room of lists: many lists are held for long, and none may hold much more than its elements.

/// Makes room for `more` elements. A list without it grows by a sixteenth, and is not doubled.
#[inline]
pub fn make_room<T>(list: &mut Vec<T>, more: usize) {
    if list.capacity() - list.len() < more {
        list.reserve_exact(more.max(list.len() / 16));
    }
}

/// Fills a list with some elements. Where its room does not fit, it is given back before other room is taken.
///
/// One list after another then moves into what the lists before it gave back: no room is left between them.
pub fn refill<T: Copy>(list: &mut Vec<T>, elements: &[T]) {
    let len = elements.len();
    if !(len..=len + len / 8).contains(&list.capacity()) {
        *list = Vec::new();
        list.reserve_exact(len + len / 32);
    }
    list.clear();
    list.extend_from_slice(elements);
}

/// Gives back most of the unused capacity of a list, and keeps some room for the next build.
pub fn give_back<T>(list: &mut Vec<T>) {
    let len = list.len();
    if list.capacity() > len + len / 8 {
        list.shrink_to(len + len / 16);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_that_are_filled_again_keep_room_that_fits() {
        let elements = [3_u16; 1000];
        let mut list = Vec::new();
        for (len, room) in [(800, 825), (820, 825), (740, 825), (700, 721), (722, 744), (0, 0)] {
            refill(&mut list, &elements[..len]);
            assert_eq!((list.len(), list.capacity()), (len, room));
        }
    }

    #[test]
    fn lists_hold_little_more_than_their_elements() {
        let mut list: Vec<u16> = Vec::new();
        for _ in 0..1000 {
            make_room(&mut list, 1);
            list.push(7);
            assert!(list.capacity() <= list.len() + list.len() / 16 + 1);
        }
        list.truncate(950);
        let before = list.capacity();
        give_back(&mut list);
        assert_eq!(list.capacity(), before, "the next build may need it");
        list.truncate(500);
        give_back(&mut list);
        assert!((531..=562).contains(&list.capacity()), "{}", list.capacity());
    }
}
