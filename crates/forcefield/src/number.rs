//! The number types of registers, and the rows of pair laws that registers look up.

/// A number type of registers.
pub trait Number: Copy + std::fmt::Debug + Send + Sync + 'static {
    /// A row of a pair law.
    type Row: Copy + std::fmt::Debug + Send + Sync;
    /// Bits of the mantissa.
    const MANTISSA: u32;
    /// The number whose last bit counts 1, and whose other bits do not change by counting.
    const COUNTS_FROM: f64;
    /// The number nearest to a double.
    fn of(value: f64) -> Self;
    /// Number of bits.
    const BITS: u32;
    /// The last bits of a number that hold the leading bits of another one in a row.
    const FOLDED: u32;
    /// The number with these bits.
    fn from_bits(bits: u64) -> Self;
    /// The bits of the number.
    fn bits(self) -> u64;
    /// The number as a double.
    fn value(self) -> f64;
    /// A row of four numbers.
    fn row(numbers: [Self; 4]) -> Self::Row;
    /// The rows for registers of this type.
    fn rows(rows: &PairRows) -> &RowsOf<Self>;
}

impl Number for f64 {
    type Row = WideRow;
    const BITS: u32 = 64;
    const FOLDED: u32 = 32;
    const MANTISSA: u32 = 52;
    const COUNTS_FROM: f64 = 4_503_599_627_370_496.0;

    fn of(value: f64) -> Self {
        value
    }
    fn from_bits(bits: u64) -> Self {
        Self::from_bits(bits)
    }
    fn bits(self) -> u64 {
        self.to_bits()
    }
    fn value(self) -> f64 {
        self
    }
    fn row(numbers: [Self; 4]) -> WideRow {
        WideRow(numbers)
    }
    fn rows(rows: &PairRows) -> &RowsOf<Self> {
        &rows.wide
    }
}

impl Number for f32 {
    type Row = NarrowRow;
    const BITS: u32 = 32;
    const FOLDED: u32 = 12;
    const MANTISSA: u32 = 23;
    const COUNTS_FROM: f64 = 8_388_608.0;

    fn of(value: f64) -> Self {
        value as Self
    }
    fn from_bits(bits: u64) -> Self {
        Self::from_bits(bits as u32)
    }
    fn bits(self) -> u64 {
        u64::from(self.to_bits())
    }
    fn value(self) -> f64 {
        f64::from(self)
    }
    fn row(numbers: [Self; 4]) -> NarrowRow {
        NarrowRow(numbers)
    }
    fn rows(rows: &PairRows) -> &RowsOf<Self> {
        &rows.narrow
    }
}

/// A row in double precision.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(32))]
pub struct WideRow(pub [f64; 4]);

/// The same in single precision.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(16))]
pub struct NarrowRow(pub [f32; 4]);

/// The rows of several laws one after another, for registers of `T`. All laws have as many.
#[derive(Debug)]
pub struct RowsOf<T: Number> {
    /// The rows.
    pub rows: Vec<T::Row>,
    /// The smallest scaled s that has a row.
    pub lowest: f64,
    /// The largest scaled s that has a row.
    pub highest: f64,
    /// Bits of s to shift away for the number of a row.
    pub shift: u32,
    /// The number of the first row.
    pub first: u64,
    /// Number of rows of one law.
    pub per_law: usize,
}

impl<T: Number> RowsOf<T> {
    /// The number of rows before the first one of a law, as a register takes it: in the last bits of a number.
    pub fn first_of(&self, law: f64) -> f64 {
        T::COUNTS_FROM + law * self.per_law as f64
    }
}

/// The rows of the laws of all pairs of species, in both precisions.
#[derive(Debug)]
pub struct PairRows {
    /// In double precision.
    pub wide: RowsOf<f64>,
    /// In single precision.
    pub narrow: RowsOf<f32>,
    /// The scale of each law.
    pub scales: Vec<f64>,
}

impl PairRows {
    /// The constants of a law: scale of s, number of the law, and half the inverse of the scale.
    pub fn constants(&self, law: usize) -> [f64; 3] {
        let scale = self.scales[law];
        [scale, law as f64, 0.5 / scale]
    }
}
