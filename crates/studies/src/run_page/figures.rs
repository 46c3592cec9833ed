//! The figures of a run's page: a row for each, with the table that has its numbers.

use crate::report::{
    Axis, Columns, Dash, FigureRow, Guide, Look, Picture, Symbol, significant, with_error,
};

use lennard_observables::quantities::{Quantity, axis, quantity_of, quantity_words};
use lennard_observables::{CORRECTED, UNCORRECTED};

use crate::compare::{HANSEN_VERLET, RunFolder, capital};

/// The coefficients with Green–Kubo integrals.
const VISCOSITY: &str = "shear_viscosity";
const CONDUCTIVITY: &str = "thermal_conductivity";

pub(super) const TIME_SERIES: &str = "Measured stages only. What lies left of the dashed line is the start that all averages leave out.";
/// The same of few bodies, which have no averages.
pub(super) const MOTION_OF_BODIES: &str = "Measured stages only.";
pub(super) const ALL_STAGES: &str =
    "The whole run from its start. Dashed lines are the beginnings of stages.";
pub(super) const ERROR_BARS: &str = "Apparent standard error of the mean when successive samples are averaged in blocks: it rises until the blocks are longer than \
     the correlation, and the plateau is the error.";
pub(super) const STRUCTURE: &str = "Pair distribution and static structure factor. A liquid freezes where the first peak of S(k) reaches 2.85 (Hansen and Verlet 1969).";
pub(super) const INTERFACE: &str = "Density across the slab about its own middle, with the fit of two hyperbolic tangents that both densities and the thickness come from.";
pub(super) const MOTION: &str = "Mean-square displacement, velocity autocorrelation, and the correlations of stress and heat flux whose integrals are the viscosity and the \
     conductivity.";

/// Shells that are marked in g(r).
const SHELLS: usize = 3;

/// The diffusion coefficient by the integral of the velocity autocorrelation.
const GREEN_KUBO: &str = "diffusion_coefficient_green_kubo";

/// Marks joined by a dotted line.
fn dotted_marks(_: usize) -> Look {
    Look::LineAndPoints(Dash::Dotted, Symbol::Disc)
}

/// The rows that the run has tables for, drawn.
fn drawn<'a>(run: &RunFolder, rows: impl IntoIterator<Item = FigureRow<'a>>) -> Vec<Picture> {
    rows.into_iter().filter_map(|row| row.draw(|name| run.table(name))).collect()
}

/// A horizontal guide.
fn level(at: f64, word: impl Into<String>) -> Guide {
    Guide::Horizontal(at, word.into())
}

/// A level at a mean of the run, with a word beside it that says whether the mean is a result.
fn level_at(run: &RunFolder, average: &str, word: &str) -> Vec<Guide> {
    let mean = run.average(average).map(|a| match a.estimate.standard_error.is_finite() {
        true => level(a.estimate.mean, word),
        false => level(a.estimate.mean, format!("{word}: no result")),
    });
    mean.into_iter().collect()
}

/// A sentence with a mean of the run and its error in the place of `{}`; nothing where the run has no such mean. A mean that is
/// no result says why.
fn said_of(run: &RunFolder, average: &str, sentence: &str) -> String {
    run.average(average).map_or(String::new(), |a| {
        let value = match a.estimate.standard_error.is_finite() {
            true => with_error(a.estimate.mean, a.estimate.standard_error),
            false => {
                format!("{} (no result: {})", significant(a.estimate.mean, 4), a.standing.words())
            }
        };
        sentence.replace("{}", &value)
    })
}

/// Temperature, energy, pressure and conserved energy against time; density and volume where the box changes. Of a fluid, the
/// means and where they begin.
pub(super) fn time_series(run: &RunFolder, is_fluid: bool) -> Vec<Picture> {
    let cut = run.average("potential_energy").map_or(0, |a| a.estimate.equilibration_cut);
    let time = run.table("measured").and_then(|table| table.numbers("time")).unwrap_or_default();
    // The cut counts samples, and a row may be the mean of several.
    let interval = run.scene.output.thermo_every as f64 * run.scene.integrator.dt;
    let start = time.first().filter(|_| is_fluid && cut > 0);
    let begin =
        start.map(|start| Guide::Vertical(start + cut as f64 * interval, "averages begin".into()));
    let draw = |(table, name)| {
        let quantity = quantity_of(name)?;
        let row = FigureRow {
            name,
            title: &capital(quantity.words),
            x: Axis::linear("time / τ"),
            y: Axis::linear(quantity.axis()),
            table,
            columns: vec![Columns::new("", ["time", name], Look::line)],
            guides: begin.iter().cloned().collect(),
            caption: if is_fluid { said_of(run, name, "Mean {}.") } else { String::new() },
            ..FigureRow::default()
        };
        row.draw(|name| run.table(name))
    };
    [
        ("measured", "temperature"),
        ("measured", "potential_energy"),
        ("measured", "pressure"),
        ("box", "density"),
        ("box", "volume"),
        ("measured", "conserved_energy"),
    ]
    .into_iter()
    .filter_map(draw)
    .collect()
}

/// Temperature, energy and pressure against time through all stages; nothing of a finished run that has one stage.
pub(super) fn all_stages(run: &RunFolder) -> Vec<Picture> {
    let stages = &run.scene.stages;
    let Some(table) = run.table("thermo").filter(|_| stages.len() > 1 || !run.record.finished)
    else {
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
    let draw = |column| {
        let quantity = quantity_of(column)?;
        let row = FigureRow {
            name: &format!("all_stages_{column}"),
            title: &format!("{}, all stages", capital(quantity.words)),
            x: Axis::linear("time / τ"),
            y: Axis::linear(quantity.axis()),
            table: "thermo",
            columns: vec![Columns::new("", ["time", column], Look::line)],
            guides: guides.clone(),
            ..FigureRow::default()
        };
        row.draw(|name| run.table(name))
    };
    ["temperature", "potential_energy", "pressure"].into_iter().filter_map(draw).collect()
}

/// Blocking curves.
pub(super) fn blocking(run: &RunFolder) -> Vec<Picture> {
    let draw = |name| {
        let quantity = quantity_of(name)?;
        let file = &format!("blocking_{name}");
        let errors = run.table(file)?.numbers("standard_error")?;
        if !errors.iter().any(|error| *error > 0.0) {
            return None;
        }
        let printed = run.average(name).map(|average| average.estimate.standard_error);
        let printed = printed.filter(|error| error.is_finite());
        let line = match printed {
            Some(_) => "the line is the error printed beside the mean, from the correlation time",
            None => "the mean has no error",
        };
        let curve = Columns::new("", ["block", "standard_error"], dotted_marks);
        let row = FigureRow {
            name: file,
            title: &format!("{}: error against block length", capital(quantity.words)),
            x: Axis::logarithmic("samples per block"),
            y: Axis::linear(axis("standard error", quantity.unit)),
            table: file,
            columns: vec![curve.error("uncertainty")],
            guides: printed.map(|error| level(error, "printed error")).into_iter().collect(),
            caption: format!("Marks with their own uncertainty; {line}."),
            ..FigureRow::default()
        };
        row.draw(|name| run.table(name))
    };
    ["potential_energy", "pressure", "temperature"].into_iter().filter_map(draw).collect()
}

/// The density across a slab with its fit.
pub(super) fn interface(run: &RunFolder) -> Vec<Picture> {
    let place = run.table("interface_profile").and_then(|t| Some(t.columns.first()?.name.clone()));
    let place = place.unwrap_or_default();
    let density = Columns::new("measured", [&place, "density"], Look::marks);
    let row = FigureRow {
        name: "interface_profile",
        title: "Density across the slab",
        x: Axis::linear(format!("{place} from the middle / σ")),
        y: Axis::linear("ρ / σ⁻³"),
        table: "interface_profile",
        columns: vec![
            density.error("standard_error"),
            Columns::new("fit", [&place, "fit"], Look::line).at(1),
        ],
        caption: said_of(run, "liquid_density", "ρ of the liquid {} σ⁻³, ")
            + &said_of(run, "vapor_density", "of the vapor {} σ⁻³; ")
            + &said_of(run, "interface_thickness", "thickness from 10 % to 90 % {} σ."),
        ..FigureRow::default()
    };
    drawn(run, [row])
}

/// g(r) with its shells and S(k).
pub(super) fn structure(run: &RunFolder) -> Vec<Picture> {
    let shells: Vec<f64> = minima(run).into_iter().take(SHELLS).collect();
    let ends: Vec<String> = shells.iter().map(|r| format!("{r:.3}")).collect();
    let ends = ends.join(", ");
    let of_shells = match shells.is_empty() {
        true => "No shell ends within the range.".to_owned(),
        false => {
            format!("Shells 1, 2, … end at the dashed minima, {ends} σ.")
                + &said_of(run, "coordination_number", " {} neighbors up to the first of them.")
        }
    };
    let at_shells =
        shells.iter().enumerate().map(|(i, r)| Guide::Vertical(*r, (i + 1).to_string()));
    let factor = Columns::new("", ["k", "structure_factor"], Look::joined);
    let rows = [
        FigureRow {
            name: "rdf",
            title: "Radial distribution function",
            x: Axis::linear("r / σ"),
            y: Axis::linear("g(r)"),
            table: "rdf",
            columns: vec![Columns::new("", ["r", "g"], Look::line)],
            guides: [level(1.0, "")].into_iter().chain(at_shells).collect(),
            caption: of_shells,
            ..FigureRow::default()
        },
        FigureRow {
            name: "structure_factor",
            title: "Static structure factor",
            x: Axis::linear("k / σ⁻¹"),
            y: Axis::linear("S(k)"),
            table: "structure_factor",
            columns: vec![factor.error("standard_error")],
            guides: vec![
                level(HANSEN_VERLET, format!("freezing, {HANSEN_VERLET}")),
                level(1.0, ""),
            ],
            caption: said_of(run, "structure_factor_first_peak", "First peak {}."),
            ..FigureRow::default()
        },
    ];
    drawn(run, rows)
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

/// Mean-square displacement, velocity autocorrelation, Green–Kubo integrals.
pub(super) fn motion(run: &RunFolder) -> Vec<Picture> {
    let title = |name| format!("Green–Kubo integral of the {}", quantity_words(name));
    let [of_viscosity, of_conductivity] = [VISCOSITY, CONDUCTIVITY].map(title);
    let green_kubo = |name, title| FigureRow {
        name,
        title,
        x: Axis::linear("upper limit / τ"),
        y: Axis::linear(quantity_of(name).map(Quantity::axis).unwrap_or_default()),
        table: name,
        columns: vec![
            Columns::new("", ["time", "integral"], dotted_marks).error("integral_standard_error"),
        ],
        guides: level_at(run, name, "plateau"),
        caption: match run.average(name) {
            Some(a) => said_of(run, name, &format!("Plateau {{}} {}.", a.unit)),
            None => "No plateau was found.".to_owned(),
        },
        ..FigureRow::default()
    };
    let integral = "A third of its integral: D = {} σ²/τ in this box";
    let mut caption = said_of(run, GREEN_KUBO, integral)
        + &said_of(run, UNCORRECTED, "; the slope of the displacement gives {}");
    if !caption.is_empty() {
        caption += ". Neither is corrected for finite size.";
    }
    let rows = [
        displacement(run),
        FigureRow {
            name: "vacf",
            title: "Velocity autocorrelation",
            x: Axis::linear("lag / τ"),
            y: Axis::linear("C(t)/C(0)"),
            table: "vacf",
            columns: vec![Columns::new("", ["time", "normalised"], Look::line)],
            guides: vec![level(0.0, "")],
            caption,
            ..FigureRow::default()
        },
        FigureRow {
            name: "vacf_integral",
            title: "Running integral of the velocity autocorrelation",
            x: Axis::linear("upper limit / τ"),
            y: Axis::linear("D(t) / (σ²/τ)"),
            table: "vacf",
            columns: vec![Columns::new("", ["time", "diffusion"], Look::line)],
            guides: level_at(run, GREEN_KUBO, "D in this box"),
            ..FigureRow::default()
        },
        green_kubo(VISCOSITY, &of_viscosity),
        green_kubo(CONDUCTIVITY, &of_conductivity),
    ];
    drawn(run, rows)
}

fn displacement(run: &RunFolder) -> FigureRow<'static> {
    let (mut guides, mut columns) =
        (Vec::new(), vec![Columns::new("measured", ["time", "msd"], Look::line)]);
    let mut caption = "No straight part was found: the run is too short.".to_owned();
    if let Some([from, to]) = fitted(run) {
        caption = format!(
            "The dashed line is fitted from {} to {} τ.{}{}",
            significant(from, 3),
            significant(to, 3),
            said_of(run, UNCORRECTED, " A sixth of its slope: D = {} σ²/τ in this box."),
            said_of(run, CORRECTED, " Corrected for finite size (Yeh and Hummer): D = {} σ²/τ."),
        );
        columns.push(Columns::new("fit", ["time", "fit"], |_| Look::Line(Dash::Dashed)).at(1));
        guides = vec![Guide::Vertical(from, "fit".into()), Guide::Vertical(to, String::new())];
    }
    FigureRow {
        name: "msd",
        title: "Mean-square displacement",
        x: Axis::logarithmic("lag / τ"),
        y: Axis::logarithmic("⟨|r(t) − r(0)|²⟩ / σ²"),
        table: "msd",
        columns,
        guides,
        caption,
        ..FigureRow::default()
    }
}

/// The lags between which the displacement is fitted, τ.
fn fitted(run: &RunFolder) -> Option<[f64; 2]> {
    let table = run.table("msd")?;
    let lags = table.numbers("time")?.into_iter().zip(table.numbers("fit")?);
    let mut fitted = lags.filter(|(lag, fit)| *lag > 0.0 && *fit > 0.0).map(|(lag, _)| lag);
    let first = fitted.next()?;
    Some([first, fitted.next_back()?])
}
