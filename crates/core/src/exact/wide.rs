//! Sums of doubles as one wide integer, in units of the smallest double.

use std::ops::Range;

/// Bits of a digit.
const DIGIT_BITS: u32 = 32;
/// Digits of an accumulator: 2046 exponents, 53 bits of the largest numbers, and room for 2⁶³ of them.
const DIGITS: usize = 68;
/// Terms before digits have to be carried: each adds less than 2³² to a digit.
const MOST_TERMS: u64 = 1 << 30;

/// A wide integer.
#[derive(Debug, Clone)]
pub struct WideSum {
    /// Digits of 32 bits, the lowest first, which may be negative and hold more than 32 bits.
    digits: [i64; DIGITS],
    /// The digits that are not zero lie here.
    used: Range<usize>,
    /// The number of terms that the digits were filled by.
    terms: u64,
    /// Terms of +∞, of −∞, and terms that are no number.
    not_finite: [i64; 3],
}

impl Default for WideSum {
    fn default() -> Self {
        Self {
            digits: [0; DIGITS],
            used: Range { start: DIGITS, end: 0 },
            terms: 0,
            not_finite: [0; 3],
        }
    }
}

impl WideSum {
    /// Words that a sum takes: sums of words of several sums are the words of their total.
    pub const WORDS: usize = DIGITS + 3;

    /// Its words, none of which is large.
    pub fn words(mut self) -> [i64; Self::WORDS] {
        self.carry();
        let mut words = [0; Self::WORDS];
        words[..DIGITS].copy_from_slice(&self.digits);
        words[DIGITS..].copy_from_slice(&self.not_finite);
        words
    }

    /// The sum with words that are sums of words.
    pub fn of_words(words: &[i64; Self::WORDS]) -> Self {
        let mut sum = Self::default();
        sum.digits.copy_from_slice(&words[..DIGITS]);
        sum.not_finite.copy_from_slice(&words[DIGITS..]);
        sum.carry();
        sum
    }

    /// Adds a term.
    pub fn add(&mut self, term: f64) {
        let bits = term.to_bits();
        let exponent = (bits >> 52) as usize & 0x7ff;
        let fraction = bits & ((1 << 52) - 1);
        if exponent == 0x7ff {
            let kind = match fraction {
                0 => usize::from(term < 0.0),
                _ => 2,
            };
            self.not_finite[kind] += 1;
            return;
        }
        // A number below 2⁻¹⁰²² has no leading one.
        let (digits, shift) = match exponent {
            0 => (fraction, 0),
            _ => (fraction | 1 << 52, exponent - 1),
        };
        if digits == 0 {
            return;
        }
        if self.terms == MOST_TERMS {
            self.carry();
        }
        self.terms += 1;
        let first = shift / DIGIT_BITS as usize;
        let mut wide = u128::from(digits) << (shift % DIGIT_BITS as usize);
        for digit in &mut self.digits[first..first + 3] {
            let part = i64::from(wide as u32);
            *digit += if term < 0.0 { -part } else { part };
            wide >>= DIGIT_BITS;
        }
        self.used = self.used.start.min(first)..self.used.end.max(first + 3);
    }

    /// Adds the terms of another sum.
    pub fn merge(&mut self, other: &Self) {
        let mut carried;
        let mut other = other;
        if self.terms + other.terms > MOST_TERMS {
            self.carry();
            carried = other.clone();
            carried.carry();
            other = &carried;
        }
        for k in other.used.clone() {
            self.digits[k] += other.digits[k];
        }
        self.used = self.used.start.min(other.used.start)..self.used.end.max(other.used.end);
        self.terms += other.terms;
        for (mine, theirs) in self.not_finite.iter_mut().zip(other.not_finite) {
            *mine += theirs;
        }
    }

    /// Brings all digits but the last into 0..2³².
    fn carry(&mut self) {
        let mut carried = 0;
        for digit in &mut self.digits[..DIGITS - 1] {
            let all = *digit + carried;
            *digit = all & i64::from(u32::MAX);
            carried = all >> DIGIT_BITS;
        }
        self.digits[DIGITS - 1] += carried;
        self.used = 0..DIGITS;
        self.terms = 1;
    }

    /// The sum, rounded once to the nearest double, ties to even; beyond the largest double it is infinite.
    #[must_use]
    pub fn value(&self) -> f64 {
        match self.not_finite {
            [0, 0, 0] => {}
            [_, 0, 0] => return f64::INFINITY,
            [0, _, 0] => return f64::NEG_INFINITY,
            _ => return f64::NAN,
        }
        if self.used.is_empty() {
            return 0.0;
        }
        let digits = &self.digits[self.used.clone()];
        // The magnitude in whole digits; two more digits take what is carried beyond the last.
        let mut magnitude = [0_u32; DIGITS + 2];
        let written = |sign: i64, magnitude: &mut [u32; DIGITS + 2]| {
            let mut carried = 0;
            let both = magnitude[self.used.start..].iter_mut().zip(digits);
            for (to, digit) in both {
                let all = sign * digit + carried;
                *to = all as u32;
                carried = all >> DIGIT_BITS;
            }
            magnitude[self.used.end] = carried as u32;
            magnitude[self.used.end + 1] = (carried >> DIGIT_BITS) as u32;
            carried >= 0
        };
        let sign = if written(1, &mut magnitude) {
            1.0
        } else {
            written(-1, &mut magnitude);
            -1.0
        };
        let Some(top) = magnitude.iter().rposition(|digit| *digit != 0) else {
            return 0.0;
        };
        // Three digits have more bits than a double. What lies below them decides ties alone.
        let base = top.saturating_sub(2);
        let leading = magnitude[base..=top].iter().rev();
        let mut leading = leading.fold(0_u128, |all, digit| all << DIGIT_BITS | u128::from(*digit));
        leading |= u128::from(magnitude[..base].iter().any(|digit| *digit != 0));
        sign * scaled(leading as f64, (DIGIT_BITS as usize * base) as i32 - 1074)
    }
}

/// x·2ᵏ for −1074 ≤ k ≤ 1023, where the result is exact or infinite.
fn scaled(x: f64, k: i32) -> f64 {
    if k < -500 { x * power_of_two(k + 537) * power_of_two(-537) } else { x * power_of_two(k) }
}

/// 2ᵏ for −1022 ≤ k ≤ 1023.
pub fn power_of_two(k: i32) -> f64 {
    f64::from_bits(((k + 1023) as u64) << 52)
}
