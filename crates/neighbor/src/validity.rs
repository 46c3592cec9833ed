//! The displacement criterion: how long a list may be used.

use crate::clusters::Reach;

/// When a list expires, whatever the pairs.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Limits {
    /// A list expires once more than one particle in this many has moved far.
    ///
    /// To look ahead of more particles would cost more than a longer life of the list saves.
    pub far_among: usize,
    /// The largest sum of two displacements, in skins.
    pub farthest_together: f64,
}

impl Limits {
    /// The limits below [`LARGE_SYSTEM`] particles.
    pub const SMALL: Self = Self { far_among: 32, farthest_together: 2.0 };

    /// The limits from [`LARGE_SYSTEM`] particles on: their lists take longer to build, and their fastest particles
    /// are faster.
    const LARGE: Self = Self { far_among: 16, farthest_together: 3.0 };

    /// The limits for a number of particles.
    pub fn of(n: usize) -> Self {
        if n < LARGE_SYSTEM { Self::SMALL } else { Self::LARGE }
    }
}

/// The smallest number of particles whose arrays no cache holds.
///
/// From this size on, loops prefetch what comes into reach. Below it, prefetching costs time.
pub const LARGE_SYSTEM: usize = 131_072;

/// The largest distance at the build of two particles that come within the cutoff while a list is in use, σ.
#[must_use]
pub fn farthest_apart(reach: Reach, n: usize) -> f64 {
    reach.r_cut + Limits::of(n).farthest_together * (reach.r_list - reach.r_cut)
}

/// Whether a list may be used.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Validity {
    /// No pair inside the cutoff can be missing.
    Valid,
    /// A pair inside the cutoff may be missing, ahead of a particle that moved far.
    /// [`unlisted_pairs`](crate::unlisted_pairs) finds all such pairs.
    Uncertain,
    /// A pair inside the cutoff may be missing: the list must be built again before its use.
    Expired,
}

/// Decides by displacements whether a list may be used.
///
/// A list built at positions x⁰ in a box L⁰ contains all pairs with r ≤ r_list = r_cut + skin. At positions x in a box
/// L, let a = min_k L_k/L⁰_k and d_i = x_i − (L/L⁰)·x⁰_i, with unwrapped positions. A pair that is not listed has
/// r ≥ a·r_list − |d_i| − |d_j|. No pair inside the cutoff is missing while
///
/// 2·max|d_i| ≤ a·r_list − r_cut.
///
/// The right side is the *effective skin*. In the box of the build it is the skin.
///
/// Beyond that, a pair can be missing only where one of its particles moved by more than half the skin toward the
/// other. The criterion answers [`Validity::Uncertain`] while such particles are few and moved by at most one skin (one
/// and a half skins in large systems). It does so in the box of the build only.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Criterion {
    /// Largest 4·|d|² that is allowed, rounded down, σ²; negative where no displacement is allowed.
    limit: f64,
    in_build_box: bool,
}

impl Criterion {
    /// The criterion in the box of the build, for a list with this skin, σ.
    #[must_use]
    pub fn new(skin: f64) -> Self {
        Self { limit: Self::limit(skin), in_build_box: true }
    }

    /// The criterion in a box that changed since the build: `effective_skin` is a·r_list − r_cut, σ.
    #[must_use]
    pub fn in_changed_box(effective_skin: f64) -> Self {
        Self { limit: Self::limit(effective_skin), in_build_box: false }
    }

    fn limit(skin: f64) -> f64 {
        if skin < 0.0 {
            return -1.0;
        }
        // Rounding of |d|² and of skin² may err by a few units in the last place each.
        skin * skin * (1.0 - 8.0 * f64::EPSILON)
    }

    /// The |d|² beyond which a particle moved far, that is by more than half the effective skin, σ².
    #[must_use]
    pub fn far2(&self) -> f64 {
        0.25 * self.limit
    }

    /// Whether a list may be used where the largest |d|² is `largest_displacement2` σ², and `far` of `n` particles moved
    /// far.
    #[must_use]
    pub fn check(&self, largest_displacement2: f64, far: usize, n: usize) -> Validity {
        let limits = Limits::of(n);
        // The factor is four times the square of half of the distance that two particles may move together.
        let uncertain = limits.farthest_together.powi(2) * self.limit;
        // With a skin of zero the list is valid at the positions of its build alone. NaN is never valid.
        if 4.0 * largest_displacement2 <= self.limit {
            Validity::Valid
        } else if self.in_build_box
            && 4.0 * largest_displacement2 <= uncertain
            && far * limits.far_among <= n
        {
            Validity::Uncertain
        } else {
            Validity::Expired
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_list_is_valid_up_to_half_the_skin_and_no_further() {
        let criterion = Criterion::new(0.3);
        let check = |moved: f64, far| criterion.check(moved.powi(2), far, 128);
        assert_eq!(check(0.1499, 0), Validity::Valid);
        assert_eq!(check(0.1501, 1), Validity::Uncertain);
        assert_eq!(check(0.2999, 4), Validity::Uncertain);
        assert_eq!(check(0.2999, 5), Validity::Expired);
        assert_eq!(check(0.3001, 1), Validity::Expired);
        let in_large = |moved: f64, far| criterion.check(moved.powi(2), far, LARGE_SYSTEM);
        assert_eq!(in_large(0.4499, 8192), Validity::Uncertain);
        assert_eq!(in_large(0.4499, 8193), Validity::Expired);
        assert_eq!(in_large(0.4501, 1), Validity::Expired);
        assert!((criterion.far2().sqrt() - 0.15).abs() < 1e-12);
        assert_eq!(check(f64::NAN, 1), Validity::Expired);
        assert_eq!(Criterion::new(0.0).check(0.0, 0, 128), Validity::Valid);
        assert_eq!(Criterion::new(0.0).check(1e-300, 1, 128), Validity::Expired);
    }

    #[test]
    fn in_a_changed_box_a_list_is_valid_or_expired_and_never_uncertain() {
        let check = |skin, moved: f64| Criterion::in_changed_box(skin).check(moved.powi(2), 1, 128);
        assert_eq!(check(0.3, 0.1499), Validity::Valid);
        assert_eq!(check(0.3, 0.1501), Validity::Expired);
        // The box shrank by more than the skin allows.
        assert_eq!(check(-0.01, 0.0), Validity::Expired);
        assert_eq!(check(f64::NAN, 0.0), Validity::Expired);
    }
}
