//! The particles of a file, row by row: one bound and one rule for every format.

use std::collections::BTreeMap;

use lennard_core::{DVec3, PeriodicBox};

use crate::FormatError;
use crate::columns::{Columns, Row, Vector};
use crate::error::{Refusal, refused};
use crate::lines::{At, Lines};
use crate::species_reader::{FoundSpecies, SpeciesReader};
use crate::units::Scales;

/// The largest coordinate in σ and component of a velocity in σ/τ of a start: beyond, positions have fewer than seven decimals.
pub const LARGEST: f64 = 1e9;

/// The smallest mass in m; the largest is its inverse. Scenes have the same bounds.
const SMALLEST_MASS: f64 = 1e-6;

/// A momentum and a velocity may differ by this share: files are rounded.
const SAME_MOTION: f64 = 1e-4;
/// Below this, in σ/τ, they do not differ.
const AT_REST: f64 = 1e-6;

/// Where the coordinates of a file begin, and its units.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Place {
    /// The lower corner of the box, in units of the file.
    pub(crate) low: DVec3,
    /// The box, σ.
    pub(crate) cell: Option<PeriodicBox>,
    /// Whether positions are shares of the box.
    pub(crate) scaled: bool,
    pub(crate) scales: Scales,
}

impl Place {
    /// From the lower corner and the box, both in units of the file.
    pub(crate) fn new(
        low: DVec3,
        cell: Option<PeriodicBox>,
        scales: Scales,
    ) -> Result<Self, Refusal> {
        let cell = cell.map(|cell| PeriodicBox::new(cell.lengths() / scales.length)).transpose();
        let cell =
            cell.map_err(|e| (e.to_string(), "a box that its length scale allows".to_string()))?;
        Ok(Self { low, cell, scaled: false, scales })
    }

    fn position(&self, row: &Row<'_>) -> Result<DVec3, Refusal> {
        let sides = self.cell.map(|cell| cell.lengths());
        let mut position = match sides.filter(|_| self.scaled) {
            Some(sides) => row.position * sides,
            None => (row.position - self.low) / self.scales.length,
        };
        if let (Some(image), Some(sides)) = (row.image, sides) {
            position += image.as_dvec3() * sides;
        }
        within(position, "the position", "coordinates", "σ")
    }
}

fn within(found: DVec3, what: &str, parts: &str, unit: &str) -> Result<DVec3, Refusal> {
    if found.abs().cmple(DVec3::splat(LARGEST)).all() {
        return Ok(found);
    }
    let [x, y, z] = found.to_array();
    refused(
        format!("{what} ({x:e}, {y:e}, {z:e}) {unit}"),
        format!("{parts} from -{LARGEST:e} to {LARGEST:e} {unit}"),
    )
}

/// A velocity that a run can start with.
pub(crate) fn velocity(found: DVec3) -> Result<DVec3, Refusal> {
    within(found, "the velocity", "components", "σ/τ")
}

/// A mass that a run can start with.
pub(crate) fn mass(found: f64) -> Result<f64, Refusal> {
    match (SMALLEST_MASS..=1.0 / SMALLEST_MASS).contains(&found) {
        true => Ok(found),
        false => refused(
            format!("the mass {found:e}"),
            format!("a mass from {SMALLEST_MASS:e} to {:e}", 1.0 / SMALLEST_MASS),
        ),
    }
}

/// The velocity v = p/m, which must agree with a velocity that stands beside the momentum.
pub(crate) fn velocity_of(
    momentum: DVec3,
    mass: f64,
    beside: Option<DVec3>,
) -> Result<DVec3, Refusal> {
    let of_momentum = velocity(momentum / mass)?;
    let Some(beside) = beside else {
        return Ok(of_momentum);
    };
    let size = |v: DVec3| v.abs().max_element();
    let allowed = SAME_MOTION * size(of_momentum).max(size(beside)) + AT_REST;
    if size(of_momentum - beside) <= allowed {
        return Ok(beside);
    }
    refused(
        format!("the velocity {beside} beside the momentum {momentum} of a mass {mass}"),
        "a momentum that is mass times velocity, or one of the two",
    )
}

/// So many coordinates of a frame tell the number of its digits.
const ROWS_LOOKED_AT: usize = 64;

/// How coordinates are written, as some rows tell.
#[derive(Debug, Clone, Copy, Default)]
struct Written {
    /// The most significant digits of a coordinate.
    digits: i32,
    /// The largest coordinate, in units of the file.
    largest: f64,
    /// σ per unit of the file.
    unit: f64,
}

impl Written {
    fn look_at(&mut self, position: DVec3, unit: f64) {
        for x in position.abs().to_array() {
            let shortest = format!("{x:e}");
            let digits = shortest.split('e').next().unwrap_or_default().replace('.', "").len();
            self.digits = self.digits.max(digits as i32);
            self.largest = self.largest.max(x);
        }
        self.unit = unit;
    }

    /// The step of the last digit of the largest coordinate, σ.
    fn rounding(self) -> f64 {
        let first = self.largest.max(f64::MIN_POSITIVE).log10().floor() as i32;
        self.unit * 10_f64.powi(first + 1 - self.digits)
    }
}

/// Gathers the particles of a frame.
pub(crate) struct ParticleReader {
    found: TrajectoryFrame,
    written: Written,
    species: SpeciesReader,
    /// Particles between two that are looked at.
    apart: usize,
}

impl ParticleReader {
    /// For `n` particles whose lines have these columns.
    pub(crate) fn new(n: usize, columns: &Columns) -> Self {
        let array = |wanted: bool| wanted.then(|| Vec::with_capacity(n));
        let has_masses = columns.has_masses();
        let momenta = columns.has(Vector::Momentum);
        Self {
            found: TrajectoryFrame {
                positions: Vec::with_capacity(n),
                velocities: array(columns.has(Vector::Velocity) || momenta && has_masses),
                momenta: array(momenta && !has_masses),
                forces: array(columns.has(Vector::Force)),
                ..TrajectoryFrame::default()
            },
            written: Written::default(),
            species: SpeciesReader::new(n),
            apart: n.div_ceil(ROWS_LOOKED_AT),
        }
    }

    /// Takes the next particle.
    pub(crate) fn take(&mut self, row: Row<'_>, place: &Place) -> Result<(), Refusal> {
        let found = &mut self.found;
        let scales = &place.scales;
        found.ids.extend(row.id);
        if found.positions.len().is_multiple_of(self.apart) {
            let sides = place.cell.filter(|_| place.scaled).map(|cell| cell.lengths());
            let unit = sides.map_or(1.0 / scales.length, DVec3::max_element);
            self.written.look_at(row.position, unit);
        }
        found.positions.push(place.position(&row)?);
        let mass = row.mass.map(|found| mass(scales.mass(found))).transpose()?;
        let own = row.velocity.map(|v| velocity(scales.velocity(v)?)).transpose()?;
        let momentum = row.momentum.map(|p| scales.momentum(p, mass)).transpose()?;
        let own = match (momentum, mass) {
            (Some(momentum), Some(mass)) => Some(velocity_of(momentum, mass, own)?),
            _ => own,
        };
        if let (Some(all), Some(velocity)) = (&mut found.velocities, own) {
            all.push(velocity);
        }
        if let (Some(all), Some(momentum)) = (&mut found.momenta, momentum) {
            all.push(momentum);
        }
        if let (Some(all), Some(force)) = (&mut found.forces, row.force) {
            let force = force * scales.length;
            if !force.is_finite() {
                let allowed = "numbers that stay finite when the length scale is taken out";
                return refused(format!("the force {force}"), allowed);
            }
            all.push(force);
        }
        self.species.take(row.name, row.kind, mass)
    }

    /// Reads the lines of `n` particles after the current line; `as_said` tells where their columns are said.
    pub(crate) fn read(
        lines: &mut Lines<'_>,
        n: usize,
        columns: &Columns,
        place: &Place,
        as_said: &str,
    ) -> Result<TrajectoryFrame, FormatError> {
        // A character and a separator for each column: before memory for all arrays is taken.
        let least = 2 * columns.width() as u64;
        if !lines.check_room(n, 0, least) {
            let allowed = format!(
                "at most what the {} bytes left in the file can hold, {least} bytes per particle: the count is wrong or the frame is truncated",
                lines.left()
            );
            return Err(lines.refuse(format!("{n} particles"), allowed));
        }
        let mut all = Self::new(n, columns);
        for row in 1..=n {
            next_row(lines, row, n)?;
            let read = columns.row(lines.line(), as_said);
            read.and_then(|row| all.take(row, place)).at(lines)?;
        }
        Ok(TrajectoryFrame { cell: place.cell, ..all.finish().at(lines)? })
    }

    /// The particles in the order of their numbers, where they have some.
    pub(crate) fn finish(self) -> Result<TrajectoryFrame, Refusal> {
        let (species, rounding) = (self.species.found, self.written.rounding());
        let mut found = TrajectoryFrame { species, rounding, ..self.found };
        let ids = &found.ids;
        if ids.windows(2).all(|pair| pair[0] < pair[1]) {
            return Ok(found);
        }
        let mut order: Vec<usize> = (0..ids.len()).collect();
        order.sort_by_key(|i| ids[*i]);
        if let Some(pair) = order.windows(2).find(|pair| ids[pair[0]] == ids[pair[1]]) {
            return refused(
                format!("two particles with the number {}", ids[pair[0]]),
                "a number of its own for each particle",
            );
        }
        sort(&order, &mut found.positions);
        for all in [&mut found.velocities, &mut found.momenta, &mut found.forces] {
            all.iter_mut().for_each(|all| sort(&order, all));
        }
        sort(&order, &mut found.species.of_particle);
        sort(&order, &mut found.ids);
        Ok(found)
    }
}

/// Goes to the line of a particle.
pub(crate) fn next_row(lines: &mut Lines<'_>, row: usize, n: usize) -> Result<(), FormatError> {
    match lines.advance()? {
        true => Ok(()),
        false => Err(lines.refuse_end(format!("particle {row} of {n}: the frame is truncated"))),
    }
}

/// Passes over the lines of `n` particles: no frame comes of them.
pub(crate) fn skip_rows(
    lines: &mut Lines<'_>,
    n: usize,
) -> Result<Option<TrajectoryFrame>, FormatError> {
    (1..=n).try_for_each(|row| next_row(lines, row, n))?;
    Ok(None)
}

/// Brings an array into an order; an empty one stays so.
fn sort<T: Copy>(order: &[usize], all: &mut Vec<T>) {
    if !all.is_empty() {
        *all = order.iter().map(|i| all[*i]).collect();
    }
}

impl TrajectoryFrame {
    /// The frame as a start in a box, the last of so many frames.
    #[must_use]
    pub fn into_start(self, cell: PeriodicBox, frames: u64) -> StartConfiguration {
        let Self { positions, velocities, momenta, step, time, species, .. } = self;
        StartConfiguration { cell, positions, velocities, momenta, step, time, species, frames }
    }
}

impl StartConfiguration {
    /// Makes velocities of momenta, by the mass in m of each particle.
    ///
    /// # Errors
    /// What was found and what is allowed, where velocities beside the momenta are others.
    pub fn take_momenta(&mut self, mass: impl Fn(usize) -> f64) -> Result<(), (String, String)> {
        let Some(momenta) = self.momenta.take() else {
            return Ok(());
        };
        let beside = |i: usize| self.velocities.as_ref().map(|all| all[i]);
        let velocity = |(i, p): (usize, &DVec3)| {
            let velocity = velocity_of(*p, mass(i), beside(i));
            velocity.map_err(|(found, allowed)| (format!("{found}, particle {}", i + 1), allowed))
        };
        self.velocities = Some(momenta.iter().enumerate().map(velocity).collect::<Result<_, _>>()?);
        Ok(())
    }
}

/// A frame as read, in reduced units: a `length_scale` of the header is taken out.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct TrajectoryFrame {
    /// The numbers of the particles, which are in their order; empty where the file has none.
    pub ids: Vec<u64>,
    /// The periodic box; `None` where the header names none.
    pub cell: Option<PeriodicBox>,
    /// Positions, `[N]`, σ, unwrapped by the image flags where the file has them.
    pub positions: Vec<DVec3>,
    /// Velocities, `[N]`, σ/τ.
    pub velocities: Option<Vec<DVec3>>,
    /// Momenta, `[N]`, m σ/τ, where the file has no masses that make velocities of them.
    pub momenta: Option<Vec<DVec3>>,
    /// Forces, `[N]`, ε/σ.
    pub forces: Option<Vec<DVec3>>,
    /// The species of the particles.
    pub species: FoundSpecies,
    /// Number of the step.
    pub step: Option<u64>,
    /// Time in τ.
    pub time: Option<f64>,
    /// The other entries of the header, as text.
    pub info: BTreeMap<String, String>,
    /// Whether the file says in which image of the box each particle is.
    pub unwrapped: bool,
    /// The step between two positions that the file can tell apart, σ: its last digit, or its precision.
    pub rounding: f64,
}

/// Where a run starts, as read from a file; reduced units.
#[derive(Debug, Clone, PartialEq)]
pub struct StartConfiguration {
    /// The periodic box.
    pub cell: PeriodicBox,
    /// Positions, `[N]`, σ, unwrapped by the image flags where the file has them.
    pub positions: Vec<DVec3>,
    /// Velocities, `[N]`, σ/τ, where the file has them.
    pub velocities: Option<Vec<DVec3>>,
    /// Momenta, `[N]`, m σ/τ, where the file has no masses that make velocities of them.
    pub momenta: Option<Vec<DVec3>>,
    /// Number of the step, where the file has one.
    pub step: Option<u64>,
    /// Time in τ, where the file has one.
    pub time: Option<f64>,
    /// The species of the particles.
    pub species: FoundSpecies,
    /// Number of frames in the file, of which this is the last.
    pub frames: u64,
}
