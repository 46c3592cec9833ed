//! The figures of a run's page.

use lennard_core::Table;
use lennard_report::{
    Axis, Dash, Figure, Guide, Look, PageFigure, Point, ReportError, Series, Symbol,
};

use crate::compare::RunFolder;

pub(super) const TIME_SERIES: &str = "Measured stages only. What lies left of the dashed line is the start that all averages leave out.";
pub(super) const ERROR_BARS: &str = "Apparent standard error of the mean when successive samples are averaged in blocks: it rises until the blocks are longer than \
     the correlation, and the plateau is the error.";
pub(super) const STRUCTURE: &str = "Pair distribution and static structure factor. A liquid freezes where the first peak of S(k) reaches 2.85 (Hansen and Verlet 1969).";
pub(super) const MOTION: &str = "Mean-square displacement, velocity autocorrelation, and the correlations of stress and heat flux whose integrals are the viscosity and the \
     conductivity.";

/// Points of a curve that can be told apart on a page.
const MOST_POINTS: usize = 600;

/// Height of the first peak of S(k) at freezing.
const HANSEN_VERLET: f64 = 2.85;

/// A figure with what is said below it.
pub(super) struct Captioned {
    figure: Figure,
    caption: String,
    data: String,
}

impl Captioned {
    pub(super) fn on_page(self) -> Result<PageFigure, ReportError> {
        Ok(PageFigure {
            svg: self.figure.to_svg()?,
            caption: self.caption,
            command: None,
            data: Some(self.data),
        })
    }
}

fn column<'a>(table: &'a Table, name: &str) -> Option<&'a [f64]> {
    table
        .columns
        .iter()
        .find(|c| c.name == name)
        .map(|c| c.values.as_slice())
}

/// Pairs of two columns, finite ones, neighbors averaged where there are more than can be seen.
fn curve(table: &Table, x: &str, y: &str) -> Option<Vec<(f64, f64)>> {
    let pairs: Vec<(f64, f64)> = column(table, x)?
        .iter()
        .copied()
        .zip(column(table, y)?.iter().copied())
        .filter(|(a, b)| a.is_finite() && b.is_finite())
        .collect();
    let group = pairs.len().div_ceil(MOST_POINTS).max(1);
    let thinned: Vec<(f64, f64)> = pairs
        .chunks(group)
        .map(|c| {
            let n = c.len() as f64;
            (
                c.iter().map(|p| p.0).sum::<f64>() / n,
                c.iter().map(|p| p.1).sum::<f64>() / n,
            )
        })
        .collect();
    (!thinned.is_empty()).then_some(thinned)
}

/// Points with error bars.
fn with_errors(table: &Table, x: &str, y: &str, error: &str, scale: f64) -> Option<Vec<Point>> {
    let (x, y, e) = (column(table, x)?, column(table, y)?, column(table, error)?);
    let points: Vec<Point> = (0..x.len().min(y.len()).min(e.len()))
        .filter(|&i| x[i].is_finite() && y[i].is_finite())
        .map(|i| Point {
            x: x[i],
            y: scale * y[i],
            error: Some(scale * e[i]).filter(|e| e.is_finite()),
            ..Point::default()
        })
        .collect();
    (!points.is_empty()).then_some(points)
}

/// Temperature, energy, pressure and conserved energy against time.
pub(super) fn time_series(run: &RunFolder) -> Vec<Captioned> {
    let Some(table) = run.table("measured") else {
        return Vec::new();
    };
    let cut = run
        .average("potential_energy")
        .map_or(0, |a| a.equilibration_cut);
    let time = column(&table, "time").unwrap_or_default();
    // The cut counts samples, and a row may be the mean of several.
    let interval = run.scene.output.thermo_every as f64 * run.scene.integrator.dt;
    let cut_time = time
        .first()
        .filter(|_| cut > 0)
        .map(|start| start + cut as f64 * interval);
    [
        ("temperature", "Temperature, whole steps", "T / (ε/k_B)"),
        ("potential_energy", "Potential energy", "U/N / ε"),
        ("pressure", "Pressure", "P / (ε/σ³)"),
        ("conserved_energy", "Conserved energy", "(E − heat)/N / ε"),
    ]
    .into_iter()
    .filter_map(|(name, title, label)| {
        let mut figure =
            Figure::new(name, title, Axis::linear("time / τ"), Axis::linear(label)).with(
                Series::new("", Look::Line(Dash::Solid), 0, curve(&table, "time", name)?),
            );
        if let Some(at) = cut_time {
            figure = figure.guided(Guide::Vertical(at, "averages begin".into()));
        }
        let caption = run.average(name).map_or(String::new(), |a| {
            format!(
                "Mean {}.",
                lennard_report::with_error(a.mean, a.standard_error)
            )
        });
        Some(Captioned {
            figure,
            caption,
            data: "measured.csv".into(),
        })
    })
    .collect()
}

/// Blocking curves.
pub(super) fn blocking(run: &RunFolder) -> Vec<Captioned> {
    [("potential_energy", "Potential energy", "ε"), ("pressure", "Pressure", "ε/σ³"), ("temperature", "Temperature, whole steps", "ε/k_B")]
        .into_iter()
        .filter_map(|(name, title, unit)| {
            let table = run.table(&format!("blocking_{name}"))?;
            let points = with_errors(&table, "block", "standard_error", "uncertainty", 1.0)?;
            if points.iter().all(|p| p.y <= 0.0) {
                return None;
            }
            let mut figure = Figure::new(
                format!("blocking_{name}"),
                format!("{title}: error against block length"),
                Axis::logarithmic("samples a block"),
                Axis::linear(format!("standard error / {unit}")),
            )
            .with(Series::from_points("", Look::LineAndPoints(Dash::Dotted, Symbol::Disc), 0, points));
            if let Some(average) = run.average(name) {
                figure = figure.guided(Guide::Horizontal(average.standard_error, "printed error".into()));
            }
            Some(Captioned {
                figure,
                caption: "Marks with their own uncertainty; the line is the error printed beside the mean, from the correlation time.".into(),
                data: format!("blocking_{name}.csv"),
            })
        })
        .collect()
}

/// g(r) with its shells and S(k).
pub(super) fn structure(run: &RunFolder) -> Vec<Captioned> {
    let mut found = Vec::new();
    if let Some(g) = run.table("rdf").and_then(|t| curve(&t, "r", "g")) {
        let mut figure = Figure::new(
            "rdf",
            "Radial distribution function",
            Axis::linear("r / σ"),
            Axis::linear("g(r)"),
        )
        .with(Series::new("", Look::Line(Dash::Solid), 0, g))
        .guided(Guide::Horizontal(1.0, String::new()));
        let mut shells = Vec::new();
        if let Some(peaks) = run.table("rdf_peaks") {
            let kinds = column(&peaks, "kind").unwrap_or_default();
            let places = column(&peaks, "r").unwrap_or_default();
            let minima = kinds
                .iter()
                .zip(places)
                .filter(|(kind, _)| **kind < 0.0)
                .map(|(_, r)| *r);
            for (shell, r) in minima.take(3).enumerate() {
                figure = figure.guided(Guide::Vertical(r, (shell + 1).to_string()));
                shells.push(format!("{r:.3}"));
            }
        }
        let coordination = run
            .average("coordination_number")
            .map_or(String::new(), |a| {
                format!(
                    " {} neighbors up to the first of them.",
                    lennard_report::with_error(a.mean, a.standard_error)
                )
            });
        let caption = if shells.is_empty() {
            "No shell ends within the range.".to_owned()
        } else {
            format!(
                "Shells 1, 2, … end at the dashed minima, {} σ.{coordination}",
                shells.join(", ")
            )
        };
        found.push(Captioned {
            figure,
            caption,
            data: "rdf.csv".into(),
        });
    }
    if let Some(s) = run
        .table("structure_factor")
        .and_then(|t| with_errors(&t, "k", "structure_factor", "standard_error", 1.0))
    {
        let figure = Figure::new(
            "structure_factor",
            "Static structure factor",
            Axis::linear("k / σ⁻¹"),
            Axis::linear("S(k)"),
        )
        .with(Series::from_points(
            "",
            Look::LineAndPoints(Dash::Solid, Symbol::Disc),
            0,
            s,
        ))
        .guided(Guide::Horizontal(HANSEN_VERLET, "freezing, 2.85".into()))
        .guided(Guide::Horizontal(1.0, String::new()));
        let caption = run
            .average("structure_factor_first_peak")
            .map_or(String::new(), |a| {
                format!(
                    "First peak {}.",
                    lennard_report::with_error(a.mean, a.standard_error)
                )
            });
        found.push(Captioned {
            figure,
            caption,
            data: "structure_factor.csv".into(),
        });
    }
    found
}

/// Mean-square displacement, velocity autocorrelation, Green–Kubo integrals.
pub(super) fn motion(run: &RunFolder) -> Vec<Captioned> {
    let mut found = Vec::new();
    if let Some(table) = run.table("msd")
        && let Some(msd) = curve(&table, "time", "msd")
    {
        let msd = msd.into_iter().filter(|(t, x)| *t > 0.0 && *x > 0.0);
        let figure = Figure::new(
            "msd",
            "Mean-square displacement",
            Axis::logarithmic("lag / τ"),
            Axis::logarithmic("⟨|r(t) − r(0)|²⟩ / σ²"),
        )
        .with(Series::new("", Look::Line(Dash::Solid), 0, msd));
        let caption = run
            .average("diffusion_coefficient")
            .map_or(String::new(), |a| {
                format!(
                    "D = {} σ²/τ from the slope.",
                    lennard_report::with_error(a.mean, a.standard_error)
                )
            });
        found.push(Captioned {
            figure,
            caption,
            data: "msd.csv".into(),
        });
    }
    if let Some(c) = run
        .table("vacf")
        .and_then(|t| curve(&t, "time", "normalised"))
    {
        let figure = Figure::new(
            "vacf",
            "Velocity autocorrelation",
            Axis::linear("lag / τ"),
            Axis::linear("C(t)/C(0)"),
        )
        .with(Series::new("", Look::Line(Dash::Solid), 0, c))
        .guided(Guide::Horizontal(0.0, String::new()));
        let caption = run
            .average("diffusion_coefficient_green_kubo")
            .map_or(String::new(), |a| {
                format!(
                    "D = {} σ²/τ from its integral.",
                    lennard_report::with_error(a.mean, a.standard_error)
                )
            });
        found.push(Captioned {
            figure,
            caption,
            data: "vacf.csv".into(),
        });
    }
    for (name, title, label) in [
        (
            "shear_viscosity",
            "Green–Kubo integral of the shear viscosity",
            "η / (ετ/σ³)",
        ),
        (
            "thermal_conductivity",
            "Green–Kubo integral of the thermal conductivity",
            "λ / (k_B/(στ))",
        ),
    ] {
        let Some(table) = run.table(name) else {
            continue;
        };
        let Some(points) = with_errors(&table, "time", "integral", "integral_standard_error", 1.0)
        else {
            continue;
        };
        let mut figure = Figure::new(
            name,
            title,
            Axis::linear("upper limit / τ"),
            Axis::linear(label),
        )
        .with(Series::from_points(
            "",
            Look::LineAndPoints(Dash::Dotted, Symbol::Disc),
            0,
            points,
        ));
        let mut caption = "No plateau was found.".to_owned();
        if let Some(a) = run.average(name) {
            figure = figure.guided(Guide::Horizontal(a.mean, "plateau".into()));
            caption = format!(
                "Plateau {} {}.",
                lennard_report::with_error(a.mean, a.standard_error),
                a.unit
            );
        }
        found.push(Captioned {
            figure,
            caption,
            data: format!("{name}.csv"),
        });
    }
    found
}
