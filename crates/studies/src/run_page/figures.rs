//! The figures of a run's page.

use crate::report::{
    Axis, Dash, Figure, Guide, Look, Picture, Point, Series, Symbol, significant, with_error,
};
use lennard_core::Table;

use crate::compare::{HANSEN_VERLET, RunFolder};

pub(super) const TIME_SERIES: &str = "Measured stages only. What lies left of the dashed line is the start that all averages leave out.";
/// The same of few bodies, which have no averages.
pub(super) const MOTION_OF_BODIES: &str = "Measured stages only.";
pub(super) const ALL_STAGES: &str =
    "The whole run from its start. Dashed lines are the beginnings of stages.";
pub(super) const ERROR_BARS: &str = "Apparent standard error of the mean when successive samples are averaged in blocks: it rises until the blocks are longer than \
     the correlation, and the plateau is the error.";
pub(super) const STRUCTURE: &str = "Pair distribution and static structure factor. A liquid freezes where the first peak of S(k) reaches 2.85 (Hansen and Verlet 1969).";
pub(super) const INTERFACE: &str = "Density across the slab about its own middle, with the fit of two hyperbolic tangents that both densities and the thickness come from.";

/// Points of a curve that can be told apart on a page.
const MOST_POINTS: usize = 600;
/// Shells that are marked in g(r).
const SHELLS: usize = 3;

pub(super) const LINE: Look = Look::Line(Dash::Solid);
pub(super) const MARKS: Look = Look::LineAndPoints(Dash::Dotted, Symbol::Disc);
const JOINED_MARKS: Look = Look::LineAndPoints(Dash::Solid, Symbol::Disc);

/// The only series of a figure.
pub(super) fn series<P: Into<Point>>(look: Look, points: Vec<P>) -> Series {
    Series::new("", look, 0, points)
}

/// Pairs of two columns, finite ones, neighbors averaged where there are more than can be seen.
pub(super) fn curve(table: &Table, x: &str, y: &str) -> Option<Vec<(f64, f64)>> {
    let pairs = table.numbers(x)?.into_iter().zip(table.numbers(y)?);
    let pairs: Vec<(f64, f64)> = pairs.filter(|(a, b)| a.is_finite() && b.is_finite()).collect();
    let group = pairs.len().div_ceil(MOST_POINTS).max(1);
    let mean = |c: &[(f64, f64)]| {
        let n = c.len() as f64;
        let (x, y) = c.iter().fold((0.0, 0.0), |(x, y), p| (x + p.0, y + p.1));
        (x / n, y / n)
    };
    let thinned: Vec<(f64, f64)> = pairs.chunks(group).map(mean).collect();
    (!thinned.is_empty()).then_some(thinned)
}

/// Points with error bars.
pub(super) fn with_errors(table: &Table, [x, y, error]: [&str; 3]) -> Option<Vec<Point>> {
    let pairs = table.numbers(x)?.into_iter().zip(table.numbers(y)?);
    let points: Vec<Point> = pairs
        .zip(table.numbers(error)?)
        .filter(|((x, y), _)| x.is_finite() && y.is_finite())
        .map(|((x, y), error)| Point { error: Some(error), ..Point::from((x, y)) })
        .collect();
    (!points.is_empty()).then_some(points)
}

/// A sentence with a mean of the run and its error in the place of `{}`; nothing where the run has no such mean. A mean that is
/// no result says why.
pub(super) fn said_of(run: &RunFolder, average: &str, sentence: &str) -> String {
    run.average(average).map_or(String::new(), |a| {
        let value = match a.standard_error.is_finite() {
            true => with_error(a.mean, a.standard_error),
            false => {
                format!("{} (no result: {})", significant(a.mean, 4), a.standing.replace('-', " "))
            }
        };
        sentence.replace("{}", &value)
    })
}

/// Temperature, energy, pressure and conserved energy against time; density and volume where the box changes. Of a fluid, the
/// means and where they begin.
pub(super) fn time_series(run: &RunFolder, is_fluid: bool) -> Vec<Picture> {
    let Some(table) = run.table("measured") else {
        return Vec::new();
    };
    let changing_box = run.table("box");
    let cut = run.average("potential_energy").map_or(0, |a| a.equilibration_cut);
    let time = table.numbers("time").unwrap_or_default();
    // The cut counts samples, and a row may be the mean of several.
    let interval = run.scene.output.thermo_every as f64 * run.scene.integrator.dt;
    let cut_time =
        time.first().filter(|_| is_fluid && cut > 0).map(|start| start + cut as f64 * interval);
    let draw = |(file, name, title, label)| {
        let table = if file == "box" { changing_box.as_ref()? } else { &table };
        let curve = curve(table, "time", name)?;
        let mut figure = Figure::new(name, title, Axis::linear("time / τ"), Axis::linear(label))
            .with(series(LINE, curve));
        if let Some(at) = cut_time {
            figure = figure.guided(Guide::Vertical(at, "averages begin".into()));
        }
        let mean = match is_fluid {
            true => said_of(run, name, "Mean {}."),
            false => String::new(),
        };
        Some(Picture::new(figure, mean, format!("{file}.csv")))
    };
    [
        ("measured", "temperature", "Temperature, whole steps", "T / (ε/k_B)"),
        ("measured", "potential_energy", "Potential energy", "U/N / ε"),
        ("measured", "pressure", "Pressure", "P / (ε/σ³)"),
        ("box", "density", "Density", "ρ / σ⁻³"),
        ("box", "volume", "Volume", "V / σ³"),
        ("measured", "conserved_energy", "Conserved energy", "(E − heat)/N / ε"),
    ]
    .into_iter()
    .filter_map(draw)
    .collect()
}

/// Temperature, energy and pressure against time through all stages; nothing where there is one stage.
pub(super) fn all_stages(run: &RunFolder) -> Vec<Picture> {
    let stages = &run.scene.stages;
    let Some(table) = run.table("thermo").filter(|_| stages.len() > 1) else {
        return Vec::new();
    };
    let times = table.numbers("time").unwrap_or_default();
    let numbers = table.numbers("stage").unwrap_or_default();
    let begins = |stage: usize| {
        let mut rows = times.iter().zip(&numbers);
        let first = rows.find(|(_, number)| **number == stage as f64)?;
        // Names of short stages would lie on each other.
        let name =
            if stages[stage].measure { stages[stage].name.to_string() } else { String::new() };
        Some(Guide::Vertical(*first.0, name))
    };
    let guides: Vec<Guide> = (1..stages.len()).filter_map(begins).collect();
    let draw = |(name, title, label): (&str, &str, &str)| {
        let curve = curve(&table, "time", name)?;
        let figure = Figure::new(
            format!("all_stages_{name}"),
            title,
            Axis::linear("time / τ"),
            Axis::linear(label),
        );
        let figure = guides.iter().cloned().fold(figure.with(series(LINE, curve)), Figure::guided);
        Some(Picture::new(figure, "", "thermo.csv"))
    };
    [
        ("temperature", "Temperature, all stages", "T / (ε/k_B)"),
        ("potential_energy", "Potential energy, all stages", "U/N / ε"),
        ("pressure", "Pressure, all stages", "P / (ε/σ³)"),
    ]
    .into_iter()
    .filter_map(draw)
    .collect()
}

/// Blocking curves.
pub(super) fn blocking(run: &RunFolder) -> Vec<Picture> {
    let draw = |(name, title, unit)| {
        let file = format!("blocking_{name}");
        let points = with_errors(&run.table(&file)?, ["block", "standard_error", "uncertainty"])?;
        if points.iter().all(|p| p.y <= 0.0) {
            return None;
        }
        let mut figure = Figure::new(
            file.as_str(),
            format!("{title}: error against block length"),
            Axis::logarithmic("samples per block"),
            Axis::linear(format!("standard error / {unit}")),
        )
        .with(series(MARKS, points));
        let printed = run.average(name).map(|average| average.standard_error);
        let line = match printed.filter(|error| error.is_finite()) {
            Some(error) => {
                figure = figure.level(error, "printed error");
                "the line is the error printed beside the mean, from the correlation time"
            }
            None => "the mean has no error",
        };
        let caption = format!("Marks with their own uncertainty; {line}.");
        Some(Picture::new(figure, caption, format!("{file}.csv")))
    };
    [
        ("potential_energy", "Potential energy", "ε"),
        ("pressure", "Pressure", "ε/σ³"),
        ("temperature", "Temperature, whole steps", "ε/k_B"),
    ]
    .into_iter()
    .filter_map(draw)
    .collect()
}

/// g(r) with its shells and S(k).
pub(super) fn structure(run: &RunFolder) -> Vec<Picture> {
    [pair_distribution(run), structure_factor(run)].into_iter().flatten().collect()
}

/// The density across a slab with its fit.
pub(super) fn interface(run: &RunFolder) -> Vec<Picture> {
    let draw = || {
        let table = run.table("interface_profile")?;
        let place = table.columns.first()?.name.clone();
        let columns = [place.as_str(), "density", "standard error"];
        let density = with_errors(&table, columns)?;
        let mut figure = Figure::new(
            "interface_profile",
            "Density across the slab",
            Axis::linear(format!("{place} from the middle / σ")),
            Axis::linear("ρ / σ⁻³"),
        )
        .with(Series::new("measured", Look::Points(Symbol::Disc), 0, density));
        if let Some(fit) = curve(&table, &place, "fit") {
            figure = figure.with(Series::new("fit", LINE, 1, fit));
        }
        let caption = said_of(run, "liquid_density", "ρ of the liquid {} σ⁻³, ")
            + &said_of(run, "vapor_density", "of the vapor {} σ⁻³; ")
            + &said_of(run, "interface_thickness", "thickness from 10 % to 90 % {} σ.");
        Some(Picture::new(figure, caption, "interface_profile.csv"))
    };
    draw().into_iter().collect()
}

fn pair_distribution(run: &RunFolder) -> Option<Picture> {
    let g = curve(&run.table("rdf")?, "r", "g")?;
    let mut figure = Figure::new(
        "rdf",
        "Radial distribution function",
        Axis::linear("r / σ"),
        Axis::linear("g(r)"),
    )
    .with(series(LINE, g))
    .level(1.0, "");
    let mut shells = Vec::new();
    for (shell, r) in minima(run).into_iter().take(SHELLS).enumerate() {
        figure = figure.guided(Guide::Vertical(r, (shell + 1).to_string()));
        shells.push(format!("{r:.3}"));
    }
    let caption = if shells.is_empty() {
        "No shell ends within the range.".to_owned()
    } else {
        let neighbors = " {} neighbors up to the first of them.";
        format!(
            "Shells 1, 2, … end at the dashed minima, {} σ.{}",
            shells.join(", "),
            said_of(run, "coordination_number", neighbors)
        )
    };
    Some(Picture::new(figure, caption, "rdf.csv"))
}

/// The distances of the minima of g(r), σ.
fn minima(run: &RunFolder) -> Vec<f64> {
    let Some(peaks) = run.table("rdf_peaks") else {
        return Vec::new();
    };
    let kinds = peaks.numbers("kind").unwrap_or_default();
    let places = peaks.numbers("r").unwrap_or_default();
    let both = kinds.into_iter().zip(places);
    both.filter(|(kind, _)| *kind < 0.0).map(|(_, r)| r).collect()
}

fn structure_factor(run: &RunFolder) -> Option<Picture> {
    let table = run.table("structure_factor")?;
    let s = with_errors(&table, ["k", "structure_factor", "standard_error"])?;
    let figure = Figure::new(
        "structure_factor",
        "Static structure factor",
        Axis::linear("k / σ⁻¹"),
        Axis::linear("S(k)"),
    )
    .with(series(JOINED_MARKS, s))
    .level(HANSEN_VERLET, format!("freezing, {HANSEN_VERLET}"))
    .level(1.0, "");
    let caption = said_of(run, "structure_factor_first_peak", "First peak {}.");
    Some(Picture::new(figure, caption, "structure_factor.csv"))
}
