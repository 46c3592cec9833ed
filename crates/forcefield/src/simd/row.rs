//! Coordinate rows, as the pair loops read them.

use super::level::Level;
use super::motion::Motion;
use glam::DVec3;
use lennard_core::MOST_SPECIES;
pub use lennard_neighbor::FixedRow;

/// A row as ranks send it to each other: its coordinates in words of 32 bits. Each rank knows the padding.
pub trait Row: Copy + Default + Send + Sync {
    /// Number of words.
    const WORDS: usize;
    /// Writes the words.
    fn send(&self, to: &mut [u32]);
    /// The row of a slot from its words.
    fn receive(from: &[u32], motion: &Motion<'_>, slot: usize) -> Self;
}

impl Row for FixedRow {
    const WORDS: usize = 3;

    #[inline(always)]
    fn send(&self, to: &mut [u32]) {
        to.iter_mut().zip(self).for_each(|(to, x)| *to = x.cast_unsigned());
    }

    #[inline(always)]
    fn receive(from: &[u32], motion: &Motion<'_>, slot: usize) -> Self {
        let [x, y, z] = [0, 1, 2].map(|axis| from[axis].cast_signed());
        [x, y, z, motion.fixed_padding(slot)]
    }
}

impl Row for DoubleRow {
    const WORDS: usize = 6;

    #[inline(always)]
    fn send(&self, to: &mut [u32]) {
        let [x, y, z, _] = self.0;
        to.copy_from_slice(&words_of([x, y, z].into()));
    }

    #[inline(always)]
    fn receive(from: &[u32], motion: &Motion<'_>, slot: usize) -> Self {
        let r = vector_of(from);
        Self([r.x, r.y, r.z, motion.padding(slot)])
    }
}

/// The words of a vector.
#[inline(always)]
pub fn words_of(vector: DVec3) -> [u32; 6] {
    let [x, y, z] = vector.to_array().map(f64::to_bits);
    [x as u32, (x >> 32) as u32, y as u32, (y >> 32) as u32, z as u32, (z >> 32) as u32]
}

/// The vector in six words.
#[inline(always)]
pub fn vector_of(words: &[u32]) -> DVec3 {
    let component =
        |k: usize| f64::from_bits(u64::from(words[2 * k + 1]) << 32 | u64::from(words[2 * k]));
    DVec3::new(component(0), component(1), component(2))
}

/// A coordinate row in double precision: x, y, z in σ, and padding.
///
/// In a mixture the padding names the species, in the bits that a register picks numbers by ([`DoubleRow::paddings`]).
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[repr(C, align(32))]
pub struct DoubleRow(pub [f64; 4]);

impl From<DoubleRow> for [f64; 4] {
    #[inline(always)]
    fn from(row: DoubleRow) -> Self {
        row.0
    }
}

/// The bits of 2⁵².
///
/// The padding of a row begins with them: a number that is neither tiny nor NaN stays as it is where zero is added.
const NORMAL: u64 = 0x4330_0000_0000_0000;

/// The padding of each species for registers of eight doubles, which pick by the lowest three bits.
static BY_LOWEST_BITS: [f64; MOST_SPECIES] = {
    let mut padding = [0.0; MOST_SPECIES];
    let mut species = 0;
    while species < MOST_SPECIES {
        padding[species] = f64::from_bits(NORMAL | species as u64);
        species += 1;
    }
    padding
};

/// The padding of each species for registers of eight singles, which hold four doubles.
///
/// The halves of a double pick the halves of another one: they hold 2k and 2k + 1 for the species k and k + 4. The sign is set
/// from species 4 on.
static BY_HALVES: [f64; MOST_SPECIES] = {
    let mut padding = [0.0; MOST_SPECIES];
    let mut species = 0;
    while species < MOST_SPECIES {
        let k = species as u64 % 4;
        let sign = (species as u64 / 4) << 63;
        padding[species] = f64::from_bits(sign | NORMAL | ((2 * k + 1) << 32) | (2 * k));
        species += 1;
    }
    padding
};

impl DoubleRow {
    /// The padding of each species in the rows of a level.
    pub fn paddings(level: Level) -> &'static [f64; MOST_SPECIES] {
        match level {
            Level::Avx2(_) => &BY_HALVES,
            Level::Avx512(_) | Level::Portable => &BY_LOWEST_BITS,
        }
    }

    /// The species by the lowest bits of the padding.
    #[inline(always)]
    pub fn species_by_lowest_bits(&self) -> usize {
        self.0[3].to_bits() as usize % MOST_SPECIES
    }

    /// The species by the halves of the padding.
    #[inline(always)]
    pub fn species_by_halves(&self) -> usize {
        let bits = self.0[3].to_bits();
        (bits as usize / 2 % 4) | ((bits >> 63) as usize * 4)
    }
}

/// The species of a row in fixed point: the word behind its coordinates.
#[inline(always)]
pub fn species_of_fixed(row: &FixedRow) -> usize {
    row[3] as usize % MOST_SPECIES
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paddings_name_their_species_and_stay_as_they_are_where_zero_is_added() {
        for species in 0..MOST_SPECIES {
            let [lowest, halves] = [BY_LOWEST_BITS, BY_HALVES].map(|paddings| {
                let padding = paddings[species];
                assert!(padding.is_normal() && (padding + 0.0).to_bits() == padding.to_bits());
                DoubleRow([0.0, 0.0, 0.0, padding])
            });
            assert_eq!(lowest.species_by_lowest_bits(), species);
            assert_eq!(halves.species_by_halves(), species);
        }
        // The rows of one species have no padding.
        assert_eq!(DoubleRow::default().species_by_lowest_bits(), 0);
    }
}
