//! Memory that lists give back after a build.

/// Gives back most of the unused capacity of a list, and keeps some room for the next build.
pub fn give_back<T>(list: &mut Vec<T>) {
    let len = list.len();
    if list.capacity() > len + len / 4 {
        list.shrink_to(len + len / 16);
    }
}
