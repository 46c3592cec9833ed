//! Where a condition ends.

/// Halves the interval from where a condition holds to where it does not. Returns its last place inside, and its first outside.
#[must_use]
pub fn bisect(
    mut inside: f64,
    mut outside: f64,
    halvings: usize,
    holds: impl Fn(f64) -> bool,
) -> [f64; 2] {
    for _ in 0..halvings {
        let middle = 0.5 * (inside + outside);
        *(if holds(middle) { &mut inside } else { &mut outside }) = middle;
    }
    [inside, outside]
}
