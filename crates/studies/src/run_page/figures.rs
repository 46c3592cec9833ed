//! The figures of a run's page: what `figures.toml` says, with the words, levels and ranges that the run has.

use lennard_observables::Table;
use lennard_observables::quantities::{QUANTITIES, axis};

use crate::compare::{HANSEN_VERLET, RunFolder, capital};
use crate::report::{
    Drawing, Guide, Picture, ReportError, filled, pictures, significant, with_error,
};

const TEXT: &str = include_str!("figures.toml");

/// Energy, pressure and temperature against time through all stages.
pub(super) const TIME_SERIES: [&str; 3] = ["potential_energy", "pressure", "temperature"];
/// Density and volume where the box changes, and the conserved energy, in the measured stages.
pub(super) const MORE_IN_TIME: [&str; 3] = ["density", "volume", "conserved_energy"];
/// Errors of means against the length of blocks.
pub(super) const BLOCKING: [&str; 3] =
    ["blocking_potential_energy", "blocking_pressure", "blocking_temperature"];
/// Displacement, velocity autocorrelation, Green–Kubo integrals.
pub(super) const MOTION: [&str; 5] =
    ["msd", "vacf", "vacf_integral", "shear_viscosity", "thermal_conductivity"];

/// Shells that are marked in g(r).
const SHELLS: usize = 3;

/// The diffusion coefficient by the integral of the velocity autocorrelation.
const GREEN_KUBO: &str = "diffusion_coefficient_green_kubo";

/// The figures of a run. Means over time belong to a fluid, not to a few bodies.
pub(super) struct Figures(Vec<Picture>);

impl Figures {
    /// # Errors
    /// [`ReportError::Text`] where the text of the figures is none.
    pub(super) fn of(run: &RunFolder, is_fluid: bool) -> Result<Self, ReportError> {
        let fit = fitted(run);
        let table = |name: &str| {
            let table = run.table(name)?;
            match name {
                "msd" if fit.is_none() => Some(table.without(&["fit"])),
                name if BLOCKING.contains(&name) => Some(table).filter(has_errors),
                _ => Some(table),
            }
        };
        let mut found = pictures(TEXT, &table, &words(run, is_fluid))?;
        for picture in &mut found {
            if let Drawing::Plot(figure) = &mut picture.drawing {
                figure.guides.extend(guides(run, &figure.name, is_fluid));
                if TIME_SERIES.contains(&&*figure.name) && is_fluid {
                    figure.y.range = measured_range(run, &figure.name);
                }
            }
        }
        Ok(Self(found))
    }

    /// The figures of these names that are there.
    pub(super) fn named(&self, names: &[&str]) -> Vec<Picture> {
        self.0.iter().filter(|picture| names.contains(&picture.name())).cloned().collect()
    }
}

/// What stands in the place of words in braces.
fn words(run: &RunFolder, is_fluid: bool) -> Vec<(String, String)> {
    let mut words = vec![("freezing height".to_owned(), HANSEN_VERLET.to_string())];
    for quantity in QUANTITIES {
        let of = quantity.key;
        words.extend([
            (format!("title of {of}"), capital(quantity.words)),
            (format!("words of {of}"), quantity.words.to_owned()),
            (format!("axis of {of}"), quantity.axis()),
            (format!("axis of the error of {of}"), axis("standard error", quantity.unit)),
        ]);
    }
    for (name, average) in &run.record.averages {
        let (mean, error) = (average.estimate.mean, average.estimate.standard_error);
        let value = match error.is_finite() {
            true => with_error(mean, error),
            false => format!("{} (no result: {})", significant(mean, 4), average.standing.words()),
        };
        words.extend(is_fluid.then(|| (format!("level of {name}"), value.clone())));
        words.push((format!("mean of {name}"), value));
    }
    for name in ["shear_viscosity", "thermal_conductivity"] {
        let unit = run.average(name).map(|average| average.unit.as_str());
        let said = unit.map(|unit| format!("Plateau {{mean of {name}}} {unit}."));
        let said = said.unwrap_or_else(|| "No plateau was found.".to_owned());
        words.push((format!("plateau of {name}"), filled(&said, &words)));
    }
    for blocking in BLOCKING {
        let line = match printed_error(run, blocking) {
            Some(_) => "the line is the error printed beside the mean, from the correlation time",
            None => "the mean has no error",
        };
        words.push((format!("line of {blocking}"), line.to_owned()));
    }
    let across = run.table("interface_profile");
    let across = across.and_then(|table| Some(table.columns.first()?.name.clone()));
    words.extend(across.map(|across| ("axis across".to_owned(), across)));
    let ends: Vec<String> = shells(run).iter().map(|r| format!("{r:.3}")).collect();
    words.extend((!ends.is_empty()).then(|| ("ends of shells".to_owned(), ends.join(", "))));
    let fit = match fitted(run) {
        Some(ends) => {
            let [from, to] = ends.map(|end| significant(end, 3));
            format!("The dashed line is fitted from {from} to {to} τ.")
        }
        None => "No straight part was found: the run is too short.".to_owned(),
    };
    words.push(("fit of msd".to_owned(), fit));
    words
}

/// The levels and the places that the run marks in a figure.
fn guides(run: &RunFolder, figure: &str, is_fluid: bool) -> Vec<Guide> {
    let level = |at: f64, word: &str| Guide::Horizontal(at, word.to_owned());
    // The word says whether the mean is a result.
    let mean = |average: &str, word: &str| {
        let of = run.average(average)?.estimate;
        let word = match of.standard_error.is_finite() {
            true => word.to_owned(),
            false => format!("{word}: no result"),
        };
        Some(level(of.mean, &word))
    };
    match figure {
        name if TIME_SERIES.contains(&name) => {
            let left_out = left_out(run).filter(|_| is_fluid);
            begins(run).into_iter().chain(left_out).collect()
        }
        name if BLOCKING.contains(&name) => printed_error(run, name)
            .map(|error| level(error, "printed error"))
            .into_iter()
            .collect(),
        "rdf" => {
            let shells = shells(run).into_iter().enumerate();
            shells.map(|(i, r)| Guide::Vertical(r, (i + 1).to_string())).collect()
        }
        "msd" => fitted(run).map_or(Vec::new(), |[from, to]| {
            vec![Guide::Vertical(from, "fit".into()), Guide::Vertical(to, String::new())]
        }),
        "vacf_integral" => mean(GREEN_KUBO, "D in this box").into_iter().collect(),
        "shear_viscosity" | "thermal_conductivity" => mean(figure, "plateau").into_iter().collect(),
        "structure_factor" => {
            vec![level(HANSEN_VERLET, &format!("freezing, {HANSEN_VERLET}")), level(1.0, "")]
        }
        _ => Vec::new(),
    }
}

/// Twice the height of the measured stages: a start from far away comes in at the edge.
fn measured_range(run: &RunFolder, name: &str) -> Option<(f64, f64)> {
    let values = run.table("measured")?.numbers(name)?;
    let bounds = (f64::INFINITY, f64::NEG_INFINITY);
    let (low, high) = values.iter().fold(bounds, |(a, b), v| (a.min(*v), b.max(*v)));
    let beyond = 0.5 * (high - low);
    (beyond.is_finite() && beyond > 0.0).then_some((low - beyond, high + beyond))
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
fn left_out(run: &RunFolder) -> Option<Guide> {
    let first = |table| run.table(table).and_then(|t| t.numbers("time")?.first().copied());
    let cut = run.average("potential_energy").map_or(0, |a| a.estimate.equilibration_cut);
    // The cut counts samples, and a row may be the mean of several.
    let interval = run.scene.output.thermo_every as f64 * run.scene.integrator.dt;
    let begin = first("measured").map(|start| start + cut as f64 * interval);
    let begin = begin.filter(|begin| first("thermo").is_some_and(|start| start < *begin));
    begin.map(|begin| Guide::Before(begin, "averages begin".into()))
}

/// Whether a blocking curve has an error to show.
fn has_errors(blocking: &Table) -> bool {
    let errors = blocking.numbers("standard_error").unwrap_or_default();
    errors.iter().any(|error| *error > 0.0)
}

/// The error beside the mean whose blocking curve this is.
fn printed_error(run: &RunFolder, blocking: &str) -> Option<f64> {
    let average = run.average(blocking.strip_prefix("blocking_")?)?;
    Some(average.estimate.standard_error).filter(|error| error.is_finite())
}

/// The distances of the minima of g(r) that are marked, σ.
fn shells(run: &RunFolder) -> Vec<f64> {
    let Some(peaks) = run.table("rdf_peaks") else {
        return Vec::new();
    };
    let kinds = peaks.numbers("kind").unwrap_or_default();
    let places = peaks.numbers("r").unwrap_or_default();
    let minima = kinds.into_iter().zip(places).filter(|(kind, _)| *kind < 0.0);
    minima.map(|(_, r)| r).take(SHELLS).collect()
}

/// The lags between which the displacement is fitted, τ.
fn fitted(run: &RunFolder) -> Option<[f64; 2]> {
    let table = run.table("msd")?;
    let lags = table.numbers("time")?.into_iter().zip(table.numbers("fit")?);
    let mut fitted = lags.filter(|(lag, fit)| *lag > 0.0 && *fit > 0.0).map(|(lag, _)| lag);
    let first = fitted.next()?;
    Some([first, fitted.next_back()?])
}
