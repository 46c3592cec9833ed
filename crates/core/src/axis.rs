//! The axes of the box.

crate::choices! {
    /// An axis of the box.
    pub enum Axis {
        /// The first.
        X = "x",
        /// The second.
        Y = "y",
        /// The third.
        #[default]
        Z = "z",
    }
}

impl Axis {
    /// All axes, in the order of the components of a vector.
    pub const ALL: [Self; 3] = [Self::X, Self::Y, Self::Z];

    /// The component of a vector along the axis: 0, 1 or 2.
    #[must_use]
    pub fn index(self) -> usize {
        self as usize
    }
}
