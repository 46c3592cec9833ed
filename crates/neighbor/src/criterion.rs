//! The displacement criterion: when a list may still be used.

/// When a list is built anew, whatever the pairs.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Limits {
    /// One of how many particles may have moved far: to look ahead of more of them would cost more than lists that last
    /// longer save.
    pub far_among: usize,
    /// By how many skins two particles may have moved together.
    pub farthest_together: f64,
}

impl Limits {
    pub const FEW: Self = Self {
        far_among: 32,
        farthest_together: 2.0,
    };

    /// Those of [`MANY`] particles: their lists take more time to build, and the fastest of them are faster.
    const OF_MANY: Self = Self {
        far_among: 16,
        farthest_together: 3.0,
    };

    /// Those of so many particles.
    pub fn of(n: usize) -> Self {
        if n < MANY { Self::FEW } else { Self::OF_MANY }
    }
}

/// Fewest particles that no cache holds: what comes in reach is asked for ahead, and what is looked at is kept small. That of
/// fewer lies in a cache, or streams from one that is near enough.
pub const MANY: usize = 131_072;

/// What the criterion says about a list.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// No pair inside the cutoff can be missing.
    Valid,
    /// Pairs inside the cutoff might be missing, ahead of particles that moved far:
    /// [`missed_pairs`](crate::missed_pairs) finds them all.
    Doubtful,
    /// A pair inside the cutoff might be missing: build before use.
    Build,
}

/// Keeps a list honest.
///
/// A list built at positions x⁰ holds all pairs with r ≤ r_cut + skin. It may be used at positions x
/// while 2·max|x_i − x⁰_i| ≤ skin, with unwrapped positions: two particles that each moved by at most
/// half the skin have come closer by at most the skin. Beyond, a pair can be missing only of two of which one moved by
/// more than half the skin toward the other; while such particles are few and none moved by more than a whole skin
/// (of very many, one and a half), it is looked for ahead of them, and named where the list can take it in.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Criterion {
    skin: f64,
    /// Largest 4·|x − x⁰|² that is allowed, rounded down.
    limit: f64,
    builds: u64,
}

impl Criterion {
    /// The criterion of a list with this skin, σ.
    #[must_use]
    pub fn new(skin: f64) -> Self {
        Self {
            skin,
            // Rounding of |x − x⁰|² and skin² may each err by a few last bits: keep clear of them.
            limit: skin * skin * (1.0 - 8.0 * f64::EPSILON),
            builds: 0,
        }
    }

    /// The skin, σ.
    #[must_use]
    pub fn skin(&self) -> f64 {
        self.skin
    }

    /// The |x − x⁰|² beyond which a particle moved far, that is by more than half the skin, σ².
    #[must_use]
    pub fn far2(&self) -> f64 {
        0.25 * self.limit
    }

    /// Whether a list may be used where the largest |x − x⁰|² is `largest_displacement2` σ², and `far` of `n` particles
    /// moved far.
    #[must_use]
    pub fn check(&self, largest_displacement2: f64, far: usize, n: usize) -> Verdict {
        let limits = Limits::of(n);
        // Four times the square of half of what two may move.
        let doubtful = limits.farthest_together.powi(2) * self.limit;
        // With a skin of zero the list is good for the very positions of its build; NaN is never good.
        if 4.0 * largest_displacement2 <= self.limit {
            Verdict::Valid
        } else if 4.0 * largest_displacement2 <= doubtful && far * limits.far_among <= n {
            Verdict::Doubtful
        } else {
            Verdict::Build
        }
    }

    /// Records that a list was built.
    pub fn built(&mut self) {
        self.builds += 1;
    }

    /// Builds so far.
    #[must_use]
    pub fn builds(&self) -> u64 {
        self.builds
    }

    /// Sets the number of builds, as a restart does.
    pub fn set_builds(&mut self, builds: u64) {
        self.builds = builds;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_list_is_valid_up_to_half_the_skin_and_no_further() {
        let criterion = Criterion::new(0.3);
        let check = |moved: f64, far| criterion.check(moved.powi(2), far, 128);
        assert_eq!(check(0.1499, 0), Verdict::Valid);
        assert_eq!(check(0.1501, 1), Verdict::Doubtful);
        assert_eq!(check(0.2999, 4), Verdict::Doubtful);
        assert_eq!(check(0.2999, 5), Verdict::Build);
        assert_eq!(check(0.3001, 1), Verdict::Build);
        let among_many = |moved: f64, far| criterion.check(moved.powi(2), far, MANY);
        assert_eq!(among_many(0.4499, 8192), Verdict::Doubtful);
        assert_eq!(among_many(0.4499, 8193), Verdict::Build);
        assert_eq!(among_many(0.4501, 1), Verdict::Build);
        assert!((criterion.far2().sqrt() - 0.15).abs() < 1e-12);
        assert_eq!(check(f64::NAN, 1), Verdict::Build);
        assert_eq!(Criterion::new(0.0).check(0.0, 0, 128), Verdict::Valid);
        assert_eq!(Criterion::new(0.0).check(1e-300, 1, 128), Verdict::Build);
    }
}
