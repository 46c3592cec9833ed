//! Coordinate rows, as the pair loops read them.

/// A coordinate row in double precision: x, y, z in σ, and padding.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[repr(C, align(32))]
pub struct DoubleRow(pub [f64; 4]);

/// A coordinate row in fixed point: x, y, z in units of L/2³² along each axis, and padding.
///
/// The difference of two such integers is exact, and it wraps around as the periodic box does.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
#[repr(C, align(16))]
pub struct FixedRow(pub [i32; 4]);
