//! Registers of AVX2 and AVX-512: everything that does not depend on their width, written once.

/// Makes a register type of a vector, with [`Real`](crate::real::Real) and [`Lanes`](super::lanes::Lanes).
///
/// The module that calls it names the operations of its vector as they are named here. Most are instructions with another name
/// (`use _mm256_add_pd as add`). A few are functions of the module. Rows are addressed in `unit`s. A value of the type proves
/// that this processor has the instruction set.
macro_rules! registers {
    ($(#[$doc:meta])* $lanes:ident: $number:ty, $bits:ty, $width:literal, $isa:ty, $row:ty, $unit:ty) => {
        $(#[$doc])*
        #[derive(Clone, Copy)]
        pub struct $lanes(pub(super) Vector);

        impl std::ops::Add for $lanes {
            type Output = Self;
            #[inline(always)]
            fn add(self, o: Self) -> Self {
                // SAFETY: a value of this type or a token proves the instruction set, here and below.
                Self(unsafe { add(self.0, o.0) })
            }
        }
        impl std::ops::Sub for $lanes {
            type Output = Self;
            #[inline(always)]
            fn sub(self, o: Self) -> Self {
                // SAFETY: as above.
                Self(unsafe { sub(self.0, o.0) })
            }
        }
        impl std::ops::Mul for $lanes {
            type Output = Self;
            #[inline(always)]
            fn mul(self, o: Self) -> Self {
                // SAFETY: as above.
                Self(unsafe { mul(self.0, o.0) })
            }
        }
        impl std::ops::Div for $lanes {
            type Output = Self;
            #[inline(always)]
            fn div(self, o: Self) -> Self {
                // SAFETY: as above.
                Self(unsafe { div(self.0, o.0) })
            }
        }
        impl std::ops::Neg for $lanes {
            type Output = Self;
            #[inline(always)]
            fn neg(self) -> Self {
                // SAFETY: as above.
                Self(unsafe { sub(splat(0.0), self.0) })
            }
        }

        impl crate::real::Real for $lanes {
            #[inline(always)]
            fn splat(self, value: f64) -> Self {
                // SAFETY: as above.
                Self(unsafe { splat(value as $number) })
            }
            #[inline(always)]
            fn mul_add(self, a: Self, b: Self) -> Self {
                // SAFETY: as above.
                Self(unsafe { fmadd(self.0, a.0, b.0) })
            }
            #[inline(always)]
            fn sqrt(self) -> Self {
                // SAFETY: as above.
                Self(unsafe { sqrt(self.0) })
            }
            #[inline(always)]
            fn min(self, o: Self) -> Self {
                // SAFETY: as above.
                Self(unsafe { min(self.0, o.0) })
            }
            #[inline(always)]
            fn max(self, o: Self) -> Self {
                // SAFETY: as above.
                Self(unsafe { max(self.0, o.0) })
            }
        }

        impl Lanes for $lanes {
            const WIDTH: usize = $width;
            type Isa = $isa;
            type Row = $row;
            type Mask = Mask;
            type Number = $number;
            type Species = Species;
            type Table = Table;

            #[inline(always)]
            fn constant(_isa: $isa, value: f64) -> Self {
                // SAFETY: as above.
                Self(unsafe { splat(value as $number) })
            }

            #[inline(always)]
            fn spread(_isa: $isa, row: &$row) -> [Self; 3] {
                let [x, y, z, _] = (*row).into();
                // SAFETY: as above.
                unsafe { [Self(coordinate(x)), Self(coordinate(y)), Self(coordinate(z))] }
            }
            #[inline(always)]
            unsafe fn gather<E: Copy + Into<u32>>(
                _isa: $isa,
                rows: *const $row,
                entries: *const E,
            ) -> ([Self; 3], Species) {
                // SAFETY: entries are readable, and each numbers a readable row.
                unsafe {
                    let [x, y, z, padding] = transposed(|k| {
                        let entry: u32 = (*entries.add(k)).into();
                        rows.cast::<$unit>().add(entry as usize).cast()
                    });
                    ([Self(x), Self(y), Self(z)], species(padding))
                }
            }

            #[inline(always)]
            fn species_of(row: &$row) -> usize {
                species_of(row)
            }
            #[inline(always)]
            fn table(_isa: $isa, numbers: &BySpecies<$number>) -> Table {
                // SAFETY: as above.
                unsafe { table(numbers) }
            }
            #[inline(always)]
            fn pick(table: Table, species: Species) -> Self {
                // SAFETY: as above.
                Self(unsafe { pick(table, species) })
            }

            /// Whole rows are loaded and transposed, as rows of coordinates are: four gathers would load each row four times.
            #[inline(always)]
            fn look_up(self, rows: &RowsOf<$number>, first: Self) -> (Self, [Self; 5]) {
                // Rows are numbered in units of 8 bytes, which an address takes without a shift.
                const UNITS: usize = size_of::<<$number as Number>::Row>() / 8;
                const FOLDED: u32 = <$number as Number>::BITS - <$number as Number>::FOLDED;
                let counts_from = (<$number>::COUNTS_FROM as $number).to_bits() + rows.first as $bits;
                // SAFETY: as above. A clamped number has a row, and a number that is not one becomes the lowest.
                unsafe {
                    let held = max(self.0, splat(rows.lowest as $number));
                    let held = to_bits(min(held, splat(rows.highest as $number)));
                    let begin = from_bits(and_bits(held, each_bits(-1 << rows.shift)));
                    let number = shift_right(held, each_bits(rows.shift as _));
                    let first = sub_bits(to_bits(first.0), each_bits(counts_from as _));
                    let units = shift_left::<{ UNITS.ilog2() as _ }>(add_bits(number, first));
                    let mut at: [$bits; $width] = [0; $width];
                    store_bits(at.as_mut_ptr().cast(), units);
                    let rows = &rows.rows[..];
                    let [u, g0, g1, g2] = transposed(|k| {
                        debug_assert!(at[k] as usize / UNITS < rows.len());
                        rows.as_ptr().cast::<u64>().add(at[k] as usize).cast()
                    });
                    let g3 = from_bits(shift_left::<{ FOLDED as _ }>(to_bits(g2)));
                    let row = [Self(u), Self(g0), Self(g1), Self(g2), Self(g3)];
                    (Self(sub(self.0, begin)), row)
                }
            }

            #[inline(always)]
            fn at_most(self, limit: Self) -> Mask {
                // SAFETY: as above.
                unsafe { cmp::<_CMP_LE_OQ>(self.0, limit.0) }
            }
            #[inline(always)]
            fn at_most_among(self, limit: Self, bits: u32) -> Mask {
                // SAFETY: as above.
                unsafe { both(cmp::<_CMP_LE_OQ>(self.0, limit.0), among(bits)) }
            }
            #[inline(always)]
            fn bits(mask: Mask) -> u32 {
                // SAFETY: as above.
                unsafe { bits(mask) }
            }
            #[inline(always)]
            fn keep(self, mask: Mask) -> Self {
                // SAFETY: as above.
                Self(unsafe { keep(mask, self.0) })
            }
            #[inline(always)]
            fn sum(self) -> f64 {
                // SAFETY: as above.
                unsafe { sum(self.0) }
            }
            #[inline(always)]
            fn sum3(x: Self, y: Self, z: Self, unit: f64) -> DVec3 {
                // SAFETY: as above.
                unsafe { sum3([x.0, y.0, z.0], unit) }
            }
        }
    };
}
pub(super) use registers;
