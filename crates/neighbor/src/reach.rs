//! Cells along a periodic axis, counted on beyond the faces of the box.

/// The cell of the box, of `count`, that a cell counted on beyond its faces stands for.
#[inline(always)]
pub(crate) fn home(mut cell: i64, count: u32) -> u32 {
    let count = i64::from(count);
    // Nothing reaches far beyond, and divisions are slow.
    while cell < 0 {
        cell += count;
    }
    while cell >= count {
        cell -= count;
    }
    cell as u32
}

/// Cells that follow each other, both ends included.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Reach {
    pub first: i64,
    pub last: i64,
}

impl Reach {
    /// Where there are more than all, all, and each once.
    #[inline(always)]
    fn among(self, count: u32) -> Self {
        let all = i64::from(count);
        if self.last - self.first + 1 < all {
            return self;
        }
        Self {
            first: 0,
            last: all - 1,
        }
    }

    /// The cells of the box, of `count`, each once.
    #[inline(always)]
    pub fn around(self, count: u32) -> impl Iterator<Item = u32> {
        let Self { first, last } = self.among(count);
        (first..=last).map(move |cell| home(cell, count))
    }

    /// The same in one run or two, both ends included.
    #[inline(always)]
    pub fn runs(self, count: u32) -> impl Iterator<Item = [u32; 2]> {
        let Self { first, last } = self.among(count);
        let (a, b) = (home(first, count), home(last, count));
        let (run, around_the_end) = if a <= b {
            ([a, b], None)
        } else {
            ([a, count - 1], Some([0, b]))
        };
        [Some(run), around_the_end].into_iter().flatten()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_reach_beyond_the_faces_is_taken_around_and_no_cell_comes_twice() {
        let around = |first, last| Reach { first, last }.around(5).collect::<Vec<_>>();
        assert_eq!(around(-2, 1), [3, 4, 0, 1]);
        assert_eq!(around(4, 8), [0, 1, 2, 3, 4]);
        assert_eq!(around(-7, 9), [0, 1, 2, 3, 4]);
        let runs = |first, last| Reach { first, last }.runs(5).collect::<Vec<_>>();
        assert_eq!(runs(-2, 1), [[3, 4], [0, 1]]);
        assert_eq!(runs(6, 8), [[1, 3]]);
        assert_eq!(runs(-1, 6), [[0, 4]]);
        assert_eq!(
            [-11, -1, 0, 4, 5, 13].map(|k| home(k, 5)),
            [4, 4, 0, 4, 0, 3]
        );
    }
}
