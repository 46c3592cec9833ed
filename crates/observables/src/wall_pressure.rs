//! The pressure on each wall.

use crate::{Findings, Observable, ObservableSpec, Surroundings, recipe};
use lennard_core::{Axis, View, WallReading, persist};

use crate::series::{Series, columns};

const SPEC: ObservableSpec = ObservableSpec {
    name: "wall-pressure",
    summary: "normal force per area on each wall: from forces, and from the momentum of hits",
    equation: "P = sum F_z/A, or P = sum 2 m |v_z|/(A t) over the hits of a time t",
    source: "Newton's second law for the wall, averaged over the time between samples (docs/walls.md)",
    surroundings: Surroundings::Walls,
    alone: None,
    ..ObservableSpec::PLAIN
};

/// Rows kept before neighbors are averaged in pairs.
const MOST_ROWS: usize = 1 << 16;

lennard_core::options! {
    /// Options of [`WallPressure`]: there are none.
    pub struct WallPressureOptions {}
}

recipe!(WallPressureOptions, |_, _| WallPressure::default());

columns! {
    /// Pressure on the lower and upper wall of each axis, ε/σ³; zero where there is no wall.
    struct Rows { time, x_lower, x_upper, y_lower, y_upper, z_lower, z_upper }
}

/// The normal force per area on each wall, in ε/σ³, positive where particles push the wall outward.
///
/// A wall that exerts forces feels Σ F_z/A at the sampled step. A wall that is hit feels the momentum of all hits since
/// the sample before, over area and time. The two walls of an axis feel the same pressure on average, unless a field acts.
#[derive(Debug, Clone, PartialEq)]
pub struct WallPressure {
    series: Series<Rows>,
    /// 1 for each wall that there is, in the order of the columns.
    has_wall: [u64; 6],
    /// Time of the sample before, τ; NaN before the first.
    last_time: f64,
    /// Impulse of each wall at the sample before.
    last_impulse: [f64; 6],
}

impl Default for WallPressure {
    fn default() -> Self {
        Self {
            series: Series::new(Rows::default(), MOST_ROWS),
            has_wall: [0; 6],
            last_time: f64::NAN,
            last_impulse: [0.0; 6],
        }
    }
}

/// The column of a wall, counted from the lower wall of x.
fn column(wall: &WallReading) -> usize {
    2 * wall.axis + usize::from(wall.is_upper)
}

impl Observable for WallPressure {
    fn spec(&self) -> &'static ObservableSpec {
        &SPEC
    }

    fn sample(&mut self, view: &View<'_>) {
        let time = view.state.time;
        let elapsed = time - self.last_time;
        let mut row = [0.0; 7];
        row[0] = time;
        for wall in view.walls {
            let k = column(wall);
            self.has_wall[k] = 1;
            let lengths = view.cell().lengths();
            let area = view.cell().volume() / lengths[wall.axis];
            let from_hits = (wall.impulse - self.last_impulse[k]) / elapsed;
            self.last_impulse[k] = wall.impulse;
            row[k + 1] = (wall.force + from_hits) / area;
        }
        // The first sample has no time before it over which hits could be counted.
        if self.last_time.is_finite() {
            self.series.push(&row);
        }
        self.last_time = time;
    }

    fn finish(&self, discarded: f64) -> Findings {
        let rows = self.series.rows();
        let cut = (discarded * rows.time.len() as f64).ceil() as usize;
        let columns = [
            &rows.x_lower,
            &rows.x_upper,
            &rows.y_lower,
            &rows.y_upper,
            &rows.z_lower,
            &rows.z_upper,
        ];
        let pressure = "ε/σ³";
        let there = columns.into_iter().enumerate().filter(|(k, _)| self.has_wall[*k] > 0);
        let named: Vec<(String, &Vec<f64>)> = there
            .map(|(k, column)| {
                (format!("{}_{}", Axis::ALL[k / 2].name(), ["lower", "upper"][k % 2]), column)
            })
            .collect();
        let average = |(name, column): &(String, &Vec<f64>)| {
            self.series.average(&format!("wall_pressure_{name}"), pressure, column, cut)
        };
        let columns = named.iter().map(|(name, column)| (name.as_str(), pressure, *column));
        let what = "normal force per area on each wall";
        let table = self.series.table("wall_pressure", what, columns);
        let averages = named.iter().map(average).collect();
        Findings { averages, tables: vec![table], ..Findings::default() }
    }
}

persist!(WallPressure { series, last_time, last_impulse, has_wall });
