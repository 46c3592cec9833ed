//! Rows of the next step, packed chunk by chunk while those of this step are read.

use lennard_neighbor::{ATOMS_PER_CHUNK, Way};

use super::packing::{Motion, Moved};
use super::pair_list::{PackPart, PairList};
use super::{Level, Scatter, write_ways};

const _: () = assert!(ATOMS_PER_CHUNK <= u64::BITS as usize, "a bit for each");

/// How far the particles of a chunk have moved since the list was built.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Strayed {
    /// What no |x − x⁰| is above, σ.
    bound: f64,
    /// The largest |x − x⁰|², σ²; 0 where displacements were not looked at, since nobody can have moved far.
    largest2: f64,
    /// Who moved far, a bit each.
    far: u64,
}

impl Strayed {
    /// Nothing is known.
    pub const UNKNOWN: Self = Self {
        bound: f64::INFINITY,
        largest2: 0.0,
        far: 0,
    };

    /// The same after a step that was no longer than this, σ.
    fn after(self, step: f64) -> Self {
        Self {
            bound: self.bound + step,
            largest2: 0.0,
            far: 0,
        }
    }

    /// What displacements say whose squares are these, where those above `far2` are far.
    fn by(squares: &[f64], far2: f64) -> Self {
        let (mut largest2, mut far, mut finite) = (0.0, 0, true);
        for (k, d2) in squares.iter().enumerate() {
            largest2 = if *d2 > largest2 { *d2 } else { largest2 };
            far |= u64::from(*d2 > far2) << k;
            // False for NaN.
            finite &= *d2 < f64::INFINITY;
        }
        let largest2 = if finite { largest2 } else { f64::INFINITY };
        Self {
            bound: f64::sqrt(largest2),
            largest2,
            far,
        }
    }

    /// Whether somebody may have moved far. With some care: squares are rounded.
    fn may_be_far(&self, far2: f64) -> bool {
        // False for what is no number.
        let all_are_near = self.bound * self.bound * (1.0 + 1e-9) <= far2;
        !all_are_near
    }

    /// How the particles of all chunks moved.
    pub fn all(chunks: &[Self]) -> Moved {
        let mut moved = Moved::NOTHING;
        for (c, chunk) in chunks.iter().enumerate() {
            moved.largest2 = moved.largest2.max(chunk.largest2);
            moved.finite &= chunk.largest2.is_finite();
            let mut far = chunk.far;
            while far != 0 {
                let place = c * ATOMS_PER_CHUNK + far.trailing_zeros() as usize;
                moved.far.push(place as u32);
                far &= far - 1;
            }
        }
        moved
    }
}

/// What chunks write for the next step.
pub struct Next<'a, Row> {
    /// The rows.
    pub rows: Scatter<'a, Row>,
    /// How far each chunk has strayed.
    pub strayed: Scatter<'a, Strayed>,
    /// Ways, where they are wanted.
    pub ways: Option<Scatter<'a, Way>>,
}

impl<Row: Copy> Next<'_, Row> {
    /// Packs a chunk whose particles just moved, none of them by more than `step` σ.
    ///
    /// # Safety
    /// No other thread packs the same chunk.
    pub unsafe fn pack<P: PairList<Row = Row>>(
        &self,
        (list, pack): (&P, PackPart<P>),
        level: Level,
        motion: Motion<'_>,
        chunk: usize,
        step: f64,
    ) {
        let first = chunk * ATOMS_PER_CHUNK;
        let places = first..first + motion.order.len();
        // SAFETY: what belongs to a chunk is this thread's by contract.
        let mut strayed = unsafe { self.strayed.read(chunk) }.after(step);
        let mut squares = [0.0; ATOMS_PER_CHUNK];
        let squares = &mut squares[..places.len()];
        let looks = self.ways.is_some() || strayed.may_be_far(motion.far2);
        let wanted = looks.then_some(&mut *squares);
        // SAFETY: as above.
        unsafe { pack(list, level, motion, first, wanted, &self.rows) };
        if looks {
            strayed = Strayed::by(squares, motion.far2);
        }
        if let Some(ways) = &self.ways {
            // SAFETY: as above.
            write_ways(level, motion, squares, unsafe { ways.part(places) });
        }
        // SAFETY: as above.
        unsafe { self.strayed.write(chunk, strayed) };
    }

    /// Whether displacements in the chunk after this one are likely to be looked at.
    ///
    /// # Safety
    /// As [`Next::pack`].
    pub unsafe fn will_look(&self, chunk: usize, far2: f64) -> bool {
        // Neighbors stray alike, and what is another thread's cannot be read.
        // SAFETY: as above.
        let bound = unsafe { self.strayed.read(chunk) }.bound;
        // A step is some tenth of the way.
        self.ways.is_some() || bound * bound > 0.8 * far2
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_chunk_is_looked_at_once_its_steps_add_up_to_far() {
        let far2 = 0.25;
        assert!(Strayed::UNKNOWN.may_be_far(far2));
        assert!(Strayed::UNKNOWN.after(0.1).may_be_far(far2));
        let mut strayed = Strayed::by(&[0.01, 0.04], far2);
        for _ in 0..2 {
            assert!(!strayed.may_be_far(far2));
            strayed = strayed.after(0.16);
        }
        assert!(
            strayed.may_be_far(far2),
            "0.2 and twice 0.16 are beyond a half"
        );
        assert!(strayed.after(f64::NAN).may_be_far(far2));
        assert!(strayed.after(f64::INFINITY).may_be_far(far2));
    }

    #[test]
    fn chunks_together_tell_what_a_look_at_all_would() {
        let squares: Vec<f64> = (0..3 * ATOMS_PER_CHUNK + 5)
            .map(|i| f64::from(i as u32 % 7))
            .collect();
        let together = |squares: &[f64]| {
            let chunks = squares.chunks(ATOMS_PER_CHUNK);
            let chunks: Vec<Strayed> = chunks.map(|squares| Strayed::by(squares, 4.5)).collect();
            let mut at_once = Moved::NOTHING;
            at_once.include(0, squares, 4.5);
            (Strayed::all(&chunks), at_once)
        };
        let (found, at_once) = together(&squares);
        assert_eq!(found, at_once);
        assert!(found.finite && found.far.len() > ATOMS_PER_CHUNK / 2);
        for broken in [f64::NAN, f64::INFINITY] {
            let mut squares = squares.clone();
            squares[60] = broken;
            assert!(!together(&squares).0.finite);
        }
    }
}
