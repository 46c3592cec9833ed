//! Where a condition ends.

use std::convert::Infallible;

/// Halves the interval from where a condition holds to where it does not. Returns its last place inside, and its first outside.
#[must_use]
pub fn bisect(inside: f64, outside: f64, halvings: usize, holds: impl Fn(f64) -> bool) -> [f64; 2] {
    let Ok(found) = try_bisect(inside, outside, halvings, |x| Ok::<_, Infallible>(holds(x)));
    found
}

/// As [`bisect`], for a condition that cannot always be told. An interval of no length stays.
///
/// # Errors
/// The first error of the condition.
pub fn try_bisect<E>(
    mut inside: f64,
    mut outside: f64,
    halvings: usize,
    holds: impl Fn(f64) -> Result<bool, E>,
) -> Result<[f64; 2], E> {
    for _ in 0..halvings {
        let middle = 0.5 * (inside + outside);
        *(if inside == outside || holds(middle)? { &mut inside } else { &mut outside }) = middle;
    }
    Ok([inside, outside])
}
