//! How the loop over shared lists sees coordinates in fixed point.

use lennard_neighbor::SHARERS;

use super::FixedRow;
use super::lanes::FixedLanes;

/// A way to see them.
pub trait View<L: FixedLanes> {
    /// Whether distances are in σ, or else in units of the rows, as long along all axes.
    const IN_SIGMA: bool;
    /// Of one particle, in every lane.
    type Own: Copy;
    /// Of a register of others.
    type Others: Copy;

    /// Those of the sharers.
    fn own(&self) -> [Self::Own; SHARERS];

    /// Those of others.
    ///
    /// # Safety
    /// The processor has the instruction set of `L`, here and below.
    unsafe fn others(&self, gathered: L::Own) -> Self::Others;

    /// own − others along each axis.
    ///
    /// # Safety
    /// As [`View::others`].
    unsafe fn apart(&self, own: Self::Own, others: Self::Others) -> [L; 3];
}

#[inline(always)]
fn spread<L: FixedLanes>([x, y, z]: [f64; 3]) -> [L; 3] {
    [L::splat(x), L::splat(y), L::splat(z)]
}

#[inline(always)]
fn stretch<L: FixedLanes>([x, y, z]: [L; 3], [sx, sy, sz]: [L; 3]) -> [L; 3] {
    [x * sx, y * sy, z * sz]
}

/// As they are: each difference is exact, wraps as the box does, and is rounded by itself.
pub struct AsTheyAre<L: FixedLanes> {
    own: [L::Own; SHARERS],
    scale: [L; 3],
}

impl<L: FixedLanes> AsTheyAre<L> {
    /// Of sharers at `rows`, in units of these lengths along each axis, σ.
    ///
    /// # Safety
    /// As [`View::others`].
    #[inline(always)]
    pub unsafe fn new([a, b, c, d]: [&FixedRow; SHARERS], scale: [f64; 3]) -> Self {
        // SAFETY: the contract is passed on, here and below.
        let own = unsafe { [L::spread(a), L::spread(b), L::spread(c), L::spread(d)] };
        let scale = spread(scale);
        Self { own, scale }
    }
}

impl<L: FixedLanes> View<L> for AsTheyAre<L> {
    const IN_SIGMA: bool = true;
    type Own = L::Own;
    type Others = L::Own;

    #[inline(always)]
    fn own(&self) -> [L::Own; SHARERS] {
        self.own
    }

    #[inline(always)]
    unsafe fn others(&self, gathered: L::Own) -> L::Own {
        gathered
    }

    #[inline(always)]
    unsafe fn apart(&self, own: L::Own, others: L::Own) -> [L; 3] {
        // SAFETY: as above.
        stretch(unsafe { L::apart(own, others) }, self.scale)
    }
}

/// From the point amid sharers that are together: what is gathered is rounded once for all four, and differences are
/// those of small numbers. In a `CUBIC` box, whose units are as long along all axes, nothing is stretched to σ.
pub struct FromAmid<L: FixedLanes, const CUBIC: bool> {
    amid: L::Own,
    own: [[L; 3]; SHARERS],
    scale: [L; 3],
}

impl<L: FixedLanes, const CUBIC: bool> FromAmid<L, CUBIC> {
    /// Of sharers at `rows`, in units of these lengths along each axis, σ.
    ///
    /// # Safety
    /// As [`View::others`].
    #[inline(always)]
    pub unsafe fn new(rows: [&FixedRow; SHARERS], scale: [f64; 3]) -> Self {
        let scale = if CUBIC { [1.0; 3] } else { scale };
        // SAFETY: the contract is passed on, here and below.
        let (amid, own) = unsafe { L::from_amid(rows, scale) };
        let scale = spread(scale);
        Self { amid, own, scale }
    }
}

impl<L: FixedLanes, const CUBIC: bool> View<L> for FromAmid<L, CUBIC> {
    const IN_SIGMA: bool = !CUBIC;
    type Own = [L; 3];
    type Others = [L; 3];

    #[inline(always)]
    fn own(&self) -> [[L; 3]; SHARERS] {
        self.own
    }

    #[inline(always)]
    unsafe fn others(&self, gathered: L::Own) -> [L; 3] {
        // SAFETY: as above.
        let apart = unsafe { L::apart(gathered, self.amid) };
        if CUBIC {
            apart
        } else {
            stretch(apart, self.scale)
        }
    }

    #[inline(always)]
    unsafe fn apart(&self, own: [L; 3], others: [L; 3]) -> [L; 3] {
        [own[0] - others[0], own[1] - others[1], own[2] - others[2]]
    }
}
