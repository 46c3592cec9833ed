//! Lines of particles as text, on all threads.

use std::ops::Range;
use std::path::Path;

use glam::DVec3;
use rayon::prelude::*;

use crate::WriteError;
use crate::frame::NotFinite;

/// Particles formatted by one task: enough to be worth a task, little enough to balance.
const PARTICLES_A_TASK: usize = 512;

/// Tasks formatted before their text is joined: bounds the memory besides the frame itself to a few MiB.
const TASKS_A_ROUND: usize = 32;

/// Typical length of a vector as text, three numbers of up to 20 characters: a first guess only.
const BYTES_A_VECTOR: usize = 60;

/// Appends the lines of some particles, which `push` writes one by one; so many vectors stand in a line.
pub(super) fn push_lines(
    to: &mut Vec<u8>,
    path: &Path,
    particles: Range<usize>,
    vectors: usize,
    push: impl Fn(&mut Vec<u8>, usize) -> Result<(), NotFinite> + Sync,
) -> Result<(), WriteError> {
    to.reserve(particles.len() * (10 + vectors * BYTES_A_VECTOR));
    let end = particles.end;
    let starts: Vec<usize> = particles.step_by(PARTICLES_A_TASK).collect();
    let one_task = |&first: &usize, text: &mut Vec<u8>| {
        text.clear();
        (first..(first + PARTICLES_A_TASK).min(end)).try_for_each(|i| push(text, i))
    };
    let mut texts: Vec<Vec<u8>> = vec![Vec::new(); starts.len().min(TASKS_A_ROUND)];
    for round in starts.chunks(TASKS_A_ROUND) {
        let texts = &mut texts[..round.len()];
        if let ([first], [text]) = (round, &mut *texts) {
            one_task(first, text).map_err(|bad| bad.in_file(path))?;
        } else {
            // All results are looked at in order, so that the particle named is always the first.
            let results: Vec<Result<(), NotFinite>> = round
                .par_iter()
                .zip(texts.par_iter_mut())
                .map(|(first, text)| one_task(first, text))
                .collect();
            results.into_iter().collect::<Result<(), _>>().map_err(|bad| bad.in_file(path))?;
        }
        for text in texts.iter() {
            to.extend_from_slice(text);
        }
    }
    Ok(())
}

/// Appends three numbers with blanks between them.
pub(super) fn push_vector(to: &mut Vec<u8>, vector: DVec3) {
    push_float(to, vector.x);
    for component in [vector.y, vector.z] {
        to.push(b' ');
        push_float(to, component);
    }
}

/// Appends an integer with a blank before it.
pub(super) fn push_field(to: &mut Vec<u8>, value: impl itoa::Integer) {
    to.push(b' ');
    push_integer(to, value);
}

/// Appends the shortest text that reads back to the same bits. It always holds a point or an
/// exponent, so that readers which try integers first still see a floating-point number.
///
/// `value` must be finite: callers check, since they can say whose number it is.
#[inline]
pub(crate) fn push_float(to: &mut Vec<u8>, value: f64) {
    to.extend_from_slice(zmij::Buffer::new().format_finite(value).as_bytes());
}

/// Appends the shortest text, and `nan`, `inf` or `-inf` where the number is not finite.
pub(crate) fn push_any_float(to: &mut Vec<u8>, value: f64) {
    if value.is_finite() {
        push_float(to, value);
    } else if value.is_nan() {
        to.extend_from_slice(b"nan");
    } else {
        to.extend_from_slice(if value > 0.0 { b"inf" } else { b"-inf" });
    }
}

/// Appends an integer without point or exponent.
#[inline]
pub(crate) fn push_integer(to: &mut Vec<u8>, value: impl itoa::Integer) {
    to.extend_from_slice(itoa::Buffer::new().format(value).as_bytes());
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn float(value: f64) -> String {
        let mut to = Vec::new();
        push_float(&mut to, value);
        String::from_utf8(to).unwrap()
    }

    #[test]
    fn whole_numbers_keep_a_point() {
        assert_eq!(float(1.0), "1.0");
        assert_eq!(float(-0.0), "-0.0");
        assert_eq!(float(864.0), "864.0");
    }

    proptest! {
        #[test]
        fn every_finite_number_reads_back_to_the_same_bits(bits in any::<u64>()) {
            let value = f64::from_bits(bits);
            prop_assume!(value.is_finite());
            let text = float(value);
            prop_assert_eq!(text.parse::<f64>().unwrap().to_bits(), bits);
            prop_assert!(text.contains(['.', 'e']), "{} would be read as an integer", text);
        }
    }
}
