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

/// Energy, pressure and temperature against time through all stages, what means leave out in grey. Of a fluid the measured stages
/// set the height: a start from far away comes in at the edge.
pub(super) fn time_series(run: &RunFolder, is_fluid: bool) -> Vec<Picture> {
    let mut guides = begins(run);
    guides.extend(left_out(run).filter(|_| is_fluid));
    let measured = run.table("measured").filter(|_| is_fluid);
    let shown = ["potential_energy", "pressure", "temperature"].into_iter();
    let draw = |name| {
        let values = measured.as_ref().and_then(|table| table.numbers(name)).unwrap_or_default();
        let (low, high) = (values.iter())
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(*v), b.max(*v)));
        let beyond = 0.5 * (high - low);
        let range = (beyond.is_finite() && beyond > 0.0).then_some((low - beyond, high + beyond));
        in_time(run, "thermo", name, range, &guides, is_fluid)
    };
    shown.filter_map(draw).collect()
}

/// Density and volume where the box changes, and the conserved energy, in the measured stages.
pub(super) fn more_in_time(run: &RunFolder, is_fluid: bool) -> Vec<Picture> {
    let shown = [("box", "density"), ("box", "volume"), ("measured", "conserved_energy")];
    shown
        .into_iter()
        .filter_map(|(table, name)| in_time(run, table, name, None, &[], is_fluid))
        .collect()
}

fn in_time(
    run: &RunFolder,
    table: &str,
    name: &str,
    range: Option<(f64, f64)>,
    guides: &[Guide],
    is_fluid: bool,
) -> Option<Picture> {
    let quantity = quantity_of(name)?;
    let row = FigureRow {
        name,
        title: &capital(quantity.words),
        x: Axis::linear("time / τ"),
        y: Axis { range, ..Axis::linear(quantity.axis()) },
        table,
        columns: vec![Columns::new("", ["time", name], Look::line)],
        guides: guides.to_vec(),
        caption: if is_fluid { said_of(run, name, "Mean {}.") } else { String::new() },
        ..FigureRow::default()
    };
    row.draw(|name| run.table(name))
}

/// Where stages begin, but the first.
fn begins(run: &RunFolder) -> Vec<Guide> {
    let column = |name| run.table("thermo").and_then(|table| table.numbers(name));
    let (times, stages) = (column("time").unwrap_or_default(), column("stage").unwrap_or_default());
    let changes =
        stages.windows(2).zip(times.iter().skip(1)).filter(|(pair, _)| pair[0] != pair[1]);
    changes.map(|(_, time)| Guide::Vertical(*time, String::new())).collect()
}

/// The time before the first sample that means count; none where they count all.
fn left_out(run: &RunFolder) -> impl Iterator<Item = Guide> {
    let first = |table| run.table(table).and_then(|t| t.numbers("time")?.first().copied());
    let cut = run.average("potential_energy").map_or(0, |a| a.estimate.equilibration_cut);
    // The cut counts samples, and a row may be the mean of several.
    let interval = run.scene.output.thermo_every as f64 * run.scene.integrator.dt;
    let begin = first("measured").map(|start| start + cut as f64 * interval);
    let begin = begin.filter(|begin| first("thermo").is_some_and(|start| start < *begin));
    begin.map(|begin| Guide::Before(begin, "averages begin".into())).into_iter()
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
            caption: format!(
                "Standard error of the mean over blocks: it rises until blocks are longer than the correlation. Marks have their own \
                 uncertainty; {line}."
            ),
            ..FigureRow::default()
        };
        row.draw(|name| run.table(name))
    };
    ["potential_energy", "pressure", "temperature"].into_iter().filter_map(draw).collect()
}

/// The density across a slab with its fit.
pub(super) fn interface(run: &RunFolder) -> Option<Picture> {
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
            + &said_of(run, "interface_thickness", "thickness from 10 % to 90 % {} σ. ")
            + "The fit is two hyperbolic tangents about the middle of the slab.",
        ..FigureRow::default()
    };
    row.draw(|name| run.table(name))
}

/// g(r) with its shells.
pub(super) fn pair_distribution(run: &RunFolder) -> Option<Picture> {
    let shells: Vec<f64> = minima(run).into_iter().take(SHELLS).collect();
    let ends: Vec<String> = shells.iter().map(|r| format!("{r:.3}")).collect();
    let ends = ends.join(", ");
    let of_shells = match shells.is_empty() {
        true => String::new(),
        false => {
            format!("Shells 1, 2, … end at the dashed minima, {ends} σ.")
                + &said_of(run, "coordination_number", " {} neighbors up to the first of them.")
        }
    };
    let at_shells =
        shells.iter().enumerate().map(|(i, r)| Guide::Vertical(*r, (i + 1).to_string()));
    let row = FigureRow {
        name: "rdf",
        title: "Radial distribution function",
        x: Axis::linear("r / σ"),
        y: Axis::linear("g(r)"),
        table: "rdf",
        columns: vec![Columns::new("", ["r", "g"], Look::line)],
        guides: [level(1.0, "")].into_iter().chain(at_shells).collect(),
        caption: of_shells,
        ..FigureRow::default()
    };
    row.draw(|name| run.table(name))
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

/// S(k) with the height at which a liquid freezes.
pub(super) fn structure_factor(run: &RunFolder) -> Option<Picture> {
    let freezing = format!(
        "First peak {{}}; a liquid freezes where it reaches {HANSEN_VERLET} (Hansen and Verlet 1969)."
    );
    let factor = Columns::new("", ["k", "structure_factor"], Look::joined);
    let row = FigureRow {
        name: "structure_factor",
        title: "Static structure factor",
        x: Axis::linear("k / σ⁻¹"),
        y: Axis::linear("S(k)"),
        table: "structure_factor",
        columns: vec![factor.error("standard_error")],
        guides: vec![level(HANSEN_VERLET, format!("freezing, {HANSEN_VERLET}")), level(1.0, "")],
        caption: said_of(run, "structure_factor_first_peak", &freezing),
        ..FigureRow::default()
    };
    row.draw(|name| run.table(name))
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
