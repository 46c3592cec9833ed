//! How XTC compresses positions: whole numbers, as a stream of bits.
//!
//! ```text
//! group   │ a particle in the box │ flag │ number of near ones │ their displacements …
//! bits    │ log₂ of the volume    │ 1    │ 5, where it changes │ `near` each
//! ```
//!
//! A group has up to eight particles beside the first, each near the one before it. In a group of two or more, the
//! second particle of the file stands first, and the first is relative to it.
//! The format lets the reach of 'near' change from group to group. Neighbors in a fluid are alike everywhere, so that one
//! reach serves the whole frame: the one with the fewest bits.
//! Source: GROMACS reference manual, "xtc file format"; the table of sizes belongs to the format.

/// Values that a near particle may take on each axis, by the bits of all three axes together: about 2^(bits/3).
const SIZES: [u32; 65] = [
    0, 0, 0, 0, 0, 0, 0, 0, 0, 8, 10, 12, 16, 20, 25, 32, 40, 50, 64, 80, 101, 128, 161, 203, 256,
    322, 406, 512, 645, 812, 1024, 1290, 1625, 2048, 2580, 3250, 4096, 5060, 6501, 8192, 10321,
    13003, 16384, 20642, 26007, 32768, 41285, 52015, 65536, 82570, 104_031, 131_072, 165_140,
    208_063, 262_144, 330_280, 416_127, 524_287, 660_561, 832_255, 1_048_576, 1_321_122, 1_664_510,
    2_097_152, 2_642_245,
];
/// The fewest bits of a near particle.
const FEWEST: usize = 9;
/// The most particles of a group beside its first.
const LONGEST: usize = 8;
/// Axes with more multiples than this are written one by one.
const LARGEST: u64 = 0xff_ffff;

/// A position in multiples of 1/precision.
pub type Multiples = [i32; 3];

/// Appends bounds, reach, length and bits of the positions, in the order of the format.
///
/// The length has 64 bits in files with the magic number of 2023, and 32 bits before.
pub fn push(to: &mut Vec<u8>, positions: &[Multiples], long: bool) {
    let mut low = [i32::MAX; 3];
    let mut high = [i32::MIN; 3];
    for position in positions {
        for axis in 0..3 {
            low[axis] = low[axis].min(position[axis]);
            high[axis] = high[axis].max(position[axis]);
        }
    }
    let range = Range::new(low, high);
    let near = fewest_bits(positions, range.bits());
    for number in low.iter().chain(&high) {
        to.extend(number.to_be_bytes());
    }
    to.extend((near as u32).to_be_bytes());
    let length_at = to.len();
    to.extend(&[0; 8][..if long { 8 } else { 4 }]);
    let begin = to.len();
    // Ten bytes at most for each, nearly always.
    to.reserve(10 * positions.len());
    groups(to, positions, &range, near);
    let length = to.len() - begin;
    if long {
        to[length_at..begin].copy_from_slice(&(length as u64).to_be_bytes());
    } else {
        to[length_at..begin].copy_from_slice(&(length as u32).to_be_bytes());
    }
    to.resize(begin + length.next_multiple_of(4), 0);
}

/// The bits of a near particle with which the frame is shortest, about.
fn fewest_bits(positions: &[Multiples], far: u32) -> usize {
    let mut pairs = [0_usize; SIZES.len() + 1];
    for pair in positions.windows(2) {
        pairs[bits_to_reach(pair[0], pair[1])] += 1;
    }
    // The flag of a group and, for most groups, its number.
    let first = f64::from(far) + 5.0;
    let mut reached: usize = pairs[..FEWEST].iter().sum();
    let mut best = (f64::INFINITY, FEWEST);
    for (bits, pairs) in pairs.iter().enumerate().take(SIZES.len()).skip(FEWEST) {
        reached += pairs;
        let share = reached as f64 / positions.len() as f64;
        let share = share.min(LONGEST as f64 / (LONGEST + 1) as f64);
        let cost = share * bits as f64 + (1.0 - share) * first;
        if cost < best.0 {
            best = (cost, bits);
        }
    }
    best.1
}

/// The fewest bits with which one position is near the other; one more than the table has where none is enough.
fn bits_to_reach(a: Multiples, b: Multiples) -> usize {
    let largest = (0..3).map(|k| a[k].abs_diff(b[k])).max().unwrap_or(0);
    // Half a size must be larger; sizes double every three bits.
    let size = 2 * (u64::from(largest) + 1);
    let octave = (3 * (63 - size.leading_zeros()) as usize).clamp(FEWEST, SIZES.len() - 4);
    // Counted without a branch: it is guessed wrong for most pairs.
    let too_small = |k: &usize| u64::from(SIZES[octave + k]) < size;
    octave + (0..4).filter(too_small).count()
}

fn groups(to: &mut Vec<u8>, positions: &[Multiples], range: &Range, near: usize) {
    let size = u64::from(SIZES[near]);
    let reach = (SIZES[near] / 2) as i32;
    let is_near = |a: Multiples, b: Multiples| {
        (a[0].abs_diff(b[0]) < reach as u32)
            & (a[1].abs_diff(b[1]) < reach as u32)
            & (a[2].abs_diff(b[2]) < reach as u32)
    };
    let displacement = |from: Multiples, by: Multiples| {
        let [x, y, z] = [0, 1, 2].map(|k| (by[k] - from[k] + reach) as u64);
        (x * size + y) * size + z
    };
    let mut bits = Bits::new(to);
    let mut number_before = None;
    let mut at = 0;
    while at < positions.len() {
        let mut displacements = [0_u64; LONGEST];
        let mut number = 0;
        let mut before = positions[at];
        at += 1;
        match positions.get(at) {
            Some(&second) if is_near(before, second) => {
                range.push(&mut bits, second);
                displacements[0] = displacement(second, before);
                number = 1;
                at += 1;
                while let Some(&next) = positions.get(at)
                    && number < LONGEST
                    && is_near(before, next)
                {
                    displacements[number] = displacement(before, next);
                    number += 1;
                    before = next;
                    at += 1;
                }
            }
            _ => range.push(&mut bits, before),
        }
        if number_before == Some(number) {
            bits.push(0, 1);
        } else {
            number_before = Some(number);
            // Three numbers for each particle; the 1 leaves the reach as it is.
            bits.push(1 << 5 | (3 * number as u64 + 1), 6);
        }
        for &displacement in &displacements[..number] {
            bits.push_by_bytes(displacement, near as u32);
        }
    }
    bits.finish();
}

/// The box that holds every position, in multiples.
struct Range {
    low: Multiples,
    sizes: [u64; 3],
    /// Bits of the three axes together, or none where they are written one by one.
    together: Option<u32>,
}

impl Range {
    fn new(low: Multiples, high: Multiples) -> Self {
        let sizes = [0, 1, 2].map(|k| (i64::from(high[k]) - i64::from(low[k])) as u64 + 1);
        let together = sizes.iter().all(|&size| size <= LARGEST).then(|| {
            let product: u128 = sizes.iter().map(|&size| u128::from(size)).product();
            u128::BITS - product.leading_zeros()
        });
        Self { low, sizes, together }
    }

    fn axis_bits(&self) -> [u32; 3] {
        self.sizes.map(|size| u64::BITS - size.leading_zeros())
    }

    fn bits(&self) -> u32 {
        self.together.unwrap_or_else(|| self.axis_bits().iter().sum())
    }

    #[inline]
    fn read(&self, from: &mut BitsRead<'_>) -> Multiples {
        let numbers = match self.together {
            None => self.axis_bits().map(|bits| from.take(bits)),
            Some(bits) => {
                let number = from.take_by_bytes(bits);
                let [_, y, z] = self.sizes;
                match u64::try_from(number) {
                    Ok(number) => [number / z / y, number / z % y, number % z],
                    Err(_) => {
                        let (y, z) = (u128::from(y), u128::from(z));
                        [number / z / y, number / z % y, number % z].map(|x| x as u64)
                    }
                }
            }
        };
        [0, 1, 2].map(|k| self.low[k].wrapping_add(numbers[k] as i32))
    }

    #[inline]
    fn push(&self, to: &mut Bits<'_>, position: Multiples) {
        let [x, y, z] = [0, 1, 2].map(|k| (position[k] - self.low[k]) as u64);
        let Some(together) = self.together else {
            for (number, bits) in [x, y, z].into_iter().zip(self.axis_bits()) {
                to.push(number, bits);
            }
            return;
        };
        let layer = self.sizes[1] * self.sizes[2];
        let number = u128::from(x) * u128::from(layer) + u128::from(y * self.sizes[2] + z);
        if together <= u64::BITS {
            to.push_by_bytes(number as u64, together);
        } else {
            to.push_by_bytes(number as u64, u64::BITS);
            to.push((number >> u64::BITS) as u64, together - u64::BITS);
        }
    }
}

/// A stream of bits, the highest first.
struct Bits<'a> {
    to: &'a mut Vec<u8>,
    /// Bits that are not yet a whole word stand at its upper end.
    word: u64,
    filled: u32,
}

impl<'a> Bits<'a> {
    fn new(to: &'a mut Vec<u8>) -> Self {
        Self { to, word: 0, filled: 0 }
    }

    /// Appends the lowest `bits` of a number that has no others; one bit at least, 64 at most.
    #[inline]
    fn push(&mut self, number: u64, bits: u32) {
        let free = u64::BITS - self.filled;
        if bits < free {
            self.word |= number << (free - bits);
            self.filled += bits;
        } else {
            let rest = bits - free;
            self.word |= number >> rest;
            self.to.extend_from_slice(&self.word.to_be_bytes());
            self.word = if rest == 0 { 0 } else { number << (u64::BITS - rest) };
            self.filled = rest;
        }
    }

    /// Appends a number of so many bits with its lowest byte first; what is no whole byte comes last.
    #[inline]
    fn push_by_bytes(&mut self, number: u64, bits: u32) {
        let rest = bits % 8;
        let whole = bits - rest;
        if whole == u64::BITS {
            self.push(number.swap_bytes(), u64::BITS);
        } else {
            // The lower bytes, turned round; in two steps, since a shift by 64 bits is none.
            let turned = number.swap_bytes() >> 8 >> (u64::BITS - 8 - whole);
            self.push(turned << rest | number >> whole, bits);
        }
    }

    fn finish(self) {
        let bytes = self.filled.div_ceil(8) as usize;
        self.to.extend_from_slice(&self.word.to_be_bytes()[..bytes]);
    }
}

/// Reads the `n` positions that `bytes` hold, and calls `put` with each; `near` is the reach at the beginning.
///
/// # Errors
/// What is wrong with the bits.
pub fn read(
    bytes: &[u8],
    n: usize,
    [low, high]: [Multiples; 2],
    mut near: usize,
    mut put: impl FnMut(Multiples),
) -> Result<(), &'static str> {
    if (0..3).any(|axis| low[axis] > high[axis]) {
        return Err("bounds in the wrong order");
    }
    let range = Range::new(low, high);
    let mut bits = BitsRead { bytes, at: 0 };
    let (mut done, mut number) = (0, 0);
    while done < n {
        if !(FEWEST..SIZES.len()).contains(&near) {
            return Err("a reach that the format does not have");
        }
        let (size, reach) = (u64::from(SIZES[near]), (SIZES[near] / 2) as i32);
        let first = range.read(&mut bits);
        let mut change = 1;
        if bits.take(1) == 1 {
            let written = bits.take(5) as usize;
            (number, change) = (written / 3, written % 3);
        }
        if number >= n - done {
            return Err("more positions than particles");
        }
        let mut before = first;
        for member in 0..number {
            let packed = bits.take_by_bytes(near as u32) as u64;
            let by = [packed / (size * size), packed / size % size, packed % size];
            before = [0, 1, 2].map(|k| before[k].wrapping_add(by[k] as i32).wrapping_sub(reach));
            put(before);
            // The second particle of the file stands first, and the first is relative to it.
            if member == 0 {
                put(first);
            }
        }
        if number == 0 {
            put(first);
        }
        if bits.at > 8 * bytes.len() {
            return Err("fewer positions than particles");
        }
        done += number + 1;
        // 0 makes the reach smaller, and 2 larger.
        near = near + change - 1;
    }
    Ok(())
}

/// Bits as [`Bits`] writes them; behind the end there are zeros.
struct BitsRead<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl BitsRead<'_> {
    /// The next `bits`, from 1 to 56.
    #[inline]
    fn take(&mut self, bits: u32) -> u64 {
        let rest = self.bytes.get(self.at / 8..).unwrap_or_default();
        let word = match rest.first_chunk() {
            Some(word) => u64::from_be_bytes(*word),
            None => rest.iter().rev().fold(0, |word, byte| word >> 8 | u64::from(*byte) << 56),
        };
        let found = word << (self.at % 8) >> (64 - bits);
        self.at += bits as usize;
        found
    }

    /// The next number of so many bits, whose lowest byte stands first.
    #[inline]
    fn take_by_bytes(&mut self, bits: u32) -> u128 {
        let (mut number, mut shift) = (0, 0);
        while shift < bits {
            let now = (bits - shift).min(48);
            let rest = now % 8;
            let found = self.take(now);
            let whole = (found >> rest << ((64 - (now - rest)) % 64)).swap_bytes();
            let top = (found & ((1 << rest) - 1)) << (now - rest);
            number |= u128::from(whole | top) << shift;
            shift += now;
        }
        number
    }
}
