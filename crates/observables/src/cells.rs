//! Particles sorted into cells, for observables that look at near particles.

use lennard_core::{DVec3, PeriodicBox};

/// Cells along a side from which a grid of cells pays: with three, each cell would see all others.
const FEWEST_CELLS: usize = 4;

/// Distances worked out at a time: the arithmetic runs in vector registers.
pub(crate) const BATCH: usize = 128;

/// Coordinates by axis, with the number of each particle.
#[derive(Debug, Default, Clone)]
pub(crate) struct Points {
    x: Vec<f64>,
    y: Vec<f64>,
    z: Vec<f64>,
    id: Vec<u32>,
}

impl Points {
    fn push(&mut self, r: DVec3, id: u32) {
        self.x.push(r.x);
        self.y.push(r.y);
        self.z.push(r.z);
        self.id.push(id);
    }

    pub(crate) fn len(&self) -> usize {
        self.x.len()
    }

    pub(crate) fn get(&self, i: usize) -> DVec3 {
        DVec3::new(self.x[i], self.y[i], self.z[i])
    }

    /// The numbers of the particles.
    pub(crate) fn ids(&self) -> &[u32] {
        &self.id
    }

    /// Squared distances from a point to the particles from `first` on, by the nearest image in a box with these sides.
    /// Point and particles lie in the box. `look` gets them in batches, each with the place of its first particle.
    pub(crate) fn squared_distances(
        &self,
        from: DVec3,
        sides: DVec3,
        first: usize,
        mut look: impl FnMut(usize, &[f64]),
    ) {
        let mut squared = [0.0; BATCH];
        let batches = self.x[first..]
            .chunks(BATCH)
            .zip(self.y[first..].chunks(BATCH))
            .zip(self.z[first..].chunks(BATCH));
        for (batch, ((x, y), z)) in batches.enumerate() {
            for (((squared, x), y), z) in squared.iter_mut().zip(x).zip(y).zip(z) {
                *squared = nearest(from, DVec3::new(*x, *y, *z), sides).length_squared();
            }
            look(first + batch * BATCH, &squared[..x.len()]);
        }
    }

    /// The coordinates along each axis from one particle on, σ.
    pub(crate) fn coordinates(&self, first: usize) -> [&[f64]; 3] {
        [&self.x, &self.y, &self.z].map(|along| &along[first..])
    }
}

/// The distance of two points of a box with these sides along each axis, by the nearest image: the shorter way around.
#[inline]
pub(crate) fn nearest(a: DVec3, b: DVec3, sides: DVec3) -> DVec3 {
    let d = (a - b).abs();
    d.min(sides - d)
}

impl FromIterator<DVec3> for Points {
    fn from_iter<I: IntoIterator<Item = DVec3>>(positions: I) -> Self {
        let mut points = Self::default();
        let numbered = (0_u32..).zip(positions);
        numbered.for_each(|(id, r)| points.push(r, id));
        points
    }
}

/// Particles in cells whose edges are at least the radius of a search: near particles are in the 27 cells around a point.
#[derive(Debug, Clone)]
pub(crate) struct Cells {
    sides: DVec3,
    count: [usize; 3],
    members: Vec<Points>,
}

impl Cells {
    /// Sorts particles, each with its number, for searches within `radius` σ, at most half the shortest side. Positions may be
    /// unwrapped. A box of few cells becomes one cell.
    pub(crate) fn new(positions: &[(u32, DVec3)], cell: &PeriodicBox, radius: f64) -> Self {
        let sides = cell.lengths();
        let fits = (sides / radius).floor().as_usizevec3();
        // More cells than particles would only be walked in vain.
        let most = (positions.len() as f64).cbrt().ceil() as usize;
        let most = most.max(FEWEST_CELLS);
        let count = if fits.min_element() < FEWEST_CELLS {
            [1; 3]
        } else {
            [fits.x.min(most), fits.y.min(most), fits.z.min(most)]
        };
        let mut members = Vec::new();
        members.resize_with(count.iter().product(), Points::default);
        let mut cells = Self { sides, count, members };
        for (id, r) in positions {
            let r = cell.wrap(*r);
            let home = cells.home(r);
            cells.members[home].push(r, *id);
        }
        cells
    }

    /// The sides of the box, σ.
    pub(crate) fn sides(&self) -> DVec3 {
        self.sides
    }

    /// Number of cells.
    pub(crate) fn len(&self) -> usize {
        self.members.len()
    }

    /// The particles of a cell.
    pub(crate) fn members(&self, cell: usize) -> &Points {
        &self.members[cell]
    }

    /// The cell of a point in the box.
    pub(crate) fn home(&self, r: DVec3) -> usize {
        let [nx, ny, nz] = self.count;
        let scale = DVec3::new(nx as f64, ny as f64, nz as f64) / self.sides;
        let s = (r * scale).as_usizevec3();
        self.index([s.x.min(nx - 1), s.y.min(ny - 1), s.z.min(nz - 1)])
    }

    fn index(&self, [x, y, z]: [usize; 3]) -> usize {
        (x * self.count[1] + y) * self.count[2] + z
    }

    /// The 13 cells on one side of a cell: each pair of neighboring cells comes once. None where there is one cell.
    pub(crate) fn forward(&self, cell: usize) -> impl Iterator<Item = &Points> {
        self.offset(cell, 14..27)
    }

    /// A cell and all cells around it, each once, the cell itself first.
    pub(crate) fn around(&self, cell: usize) -> impl Iterator<Item = &Points> {
        let others = self.offset(cell, 0..13).chain(self.offset(cell, 14..27));
        std::iter::once(&self.members[cell]).chain(others)
    }

    /// The cells at some of the 27 offsets; the offset 13 is the cell itself.
    fn offset(
        &self,
        cell: usize,
        offsets: std::ops::Range<usize>,
    ) -> impl Iterator<Item = &Points> {
        let [nx, ny, nz] = self.count;
        let (x, y, z) = (cell / (ny * nz), cell / nz % ny, cell % nz);
        let offsets = if self.len() == 1 { 0..0 } else { offsets };
        offsets.map(move |k| {
            // An offset of 0, 1, 2 stands for −1, 0, 1.
            let [dx, dy, dz] = [k / 9, k / 3 % 3, k % 3];
            let other = [(x + dx + nx - 1) % nx, (y + dy + ny - 1) % ny, (z + dz + nz - 1) % nz];
            &self.members[self.index(other)]
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::random_positions;

    #[test]
    fn a_point_sees_every_near_particle_once() {
        let cell = PeriodicBox::new(DVec3::new(9.0, 11.0, 10.0)).unwrap();
        let positions = random_positions(500, 10.0, 7);
        // 4.5 makes one cell, 2.2 and 0.9 many.
        for radius in [4.5, 2.2, 0.9] {
            let numbered = (0_u32..).zip(positions.iter().copied());
            let numbered: Vec<(u32, DVec3)> = numbered.collect();
            let cells = Cells::new(&numbered, &cell, radius);
            for point in random_positions(20, 9.0, 8) {
                let mut found = Vec::new();
                for points in cells.around(cells.home(point)) {
                    points.squared_distances(point, cells.sides(), 0, |first, squared| {
                        for (k, r2) in squared.iter().enumerate() {
                            if *r2 <= radius * radius {
                                found.push(points.ids()[first + k]);
                            }
                        }
                    });
                }
                found.sort_unstable();
                let near = |i: &u32| {
                    let r = cell.minimum_image(point - positions[*i as usize]);
                    r.length() <= radius
                };
                let expected: Vec<u32> = (0..500).filter(near).collect();
                assert_eq!(found, expected, "radius {radius}");
            }
        }
    }
}
