//! Tables, diagrams and the page.

use crate::report::{
    Axis, Block, Figure, Guide, Look, Page, Picture, Point, Section, Series, Symbol, counted,
    significant,
};
use lennard_core::{Cell, Table, Tone};

use super::found::EnsembleChart;
use super::point::{EnsemblePoint, Sampled, tau_of};
use crate::chart::{ChartError, ChartOptions, Outcome};
use crate::files;
use crate::lab::Value;

/// Standard errors beyond which a mean is called off.
const OFF: f64 = 3.0;

/// Writes table, figures, JSON and the page.
pub(super) fn write(chart: &EnsembleChart, options: &ChartOptions<'_>) -> Result<(), ChartError> {
    let page = page(chart, &options.command);
    files::write_all(options.folder, &[points(chart)], ("study.json", chart), &page)?;
    Ok(())
}

/// The points with what they sampled, beside the reference.
#[must_use]
pub fn summary(chart: &EnsembleChart) -> Table {
    let caption = "Digits in brackets are one standard error in the last digits. The cost is for each particle and step. V is \
                   independent so many times in a τ. What is off is beyond three standard errors.";
    Table::rows_of("choices", &chart.points)
        .caption(caption)
        .column("Baths", |p| format!("{}: {}", p.number, p.label))
        .column("Cost [µs]", |p| Cell::rounded(p.cost().map(|c| 1e6 * c.median), 3))
        .column("Accepted", |p| Cell::rounded(p.found().and_then(|s| s.acceptance), 2))
        .measured("P − P₀ [(ε/σ³)]", value(|s| s.pressure_off))
        .measured("ρ [σ⁻³]", value(|s| s.density))
        .measured("var V ÷ reference", |p| relative_variance(chart, p))
        .column("V per τ", |p| Cell::rounded(p.found().map(Sampled::pace), 2))
        .measured("Drift [10⁻⁶ ε/τ]", |p| {
            drift(p).map(|(slope, error)| (1e6 * slope, 1e6 * error))
        })
        .column("Off", |p| match (&p.sampled, off(chart, p)) {
            (Some(Outcome::Failed(_)), _) => Cell::words("failed").toned(Tone::Bad),
            (_, words) if words.is_empty() => Cell::default(),
            (_, words) => Cell::words(words.join(", ")).toned(Tone::Bad),
        })
        .table()
}

/// A mean of a point with its error.
fn value(pick: fn(&Sampled) -> Value) -> impl Fn(&EnsemblePoint) -> Option<(f64, f64)> {
    move |p| p.found().map(pick).map(|v| (v.mean, v.standard_error))
}

/// The drift of the conserved energy with its error, ε/τ per particle.
fn drift(point: &EnsemblePoint) -> Option<(f64, f64)> {
    let found = point.found()?.drift;
    Some((found.slope, found.standard_error))
}

/// var V over the variance of the reference, with its error.
fn relative_variance(chart: &EnsembleChart, point: &EnsemblePoint) -> Option<(f64, f64)> {
    let reference = chart.reference.as_ref()?;
    let variance = point.found()?.variance;
    let scale = reference.variance.recip();
    Some((scale * variance.mean, scale * variance.standard_error))
}

/// What is beyond three standard errors of its reference.
fn off(chart: &EnsembleChart, point: &EnsemblePoint) -> Vec<&'static str> {
    let (Some(found), Some(reference)) = (point.found(), &chart.reference) else {
        return Vec::new();
    };
    let beyond =
        |off: f64, error: f64, own: Option<f64>| off.abs() > OFF * error.hypot(own.unwrap_or(0.0));
    let p = found.pressure_off;
    let of_density = found.density.mean - reference.density;
    let of_variance = found.variance.mean - reference.variance;
    let all = [
        ("P", beyond(p.mean, p.standard_error, None)),
        ("ρ", beyond(of_density, found.density.standard_error, reference.density_error)),
        ("var V", beyond(of_variance, found.variance.standard_error, reference.variance_error)),
    ];
    all.into_iter().filter_map(|(name, off)| off.then_some(name)).collect()
}

/// Everything as numbers.
fn points(chart: &EnsembleChart) -> Table {
    Table::rows_of("points", &chart.points)
        .column("number", |p| p.number)
        .column("baths", |p| p.label.clone())
        .column("wall median [s per atom and step]", |p| p.cost().map(|c| c.median))
        .column("wall lowest [s per atom and step]", |p| p.cost().map(|c| c.lowest))
        .column("wall highest [s per atom and step]", |p| p.cost().map(|c| c.highest))
        .column("interval [steps]", |p| p.baths.barostat.interval())
        .column("tau_p [tau]", |p| p.baths.barostat.tau())
        .column("tau_T [tau]", |p| tau_of(&p.baths.thermostat))
        .column("acceptance", |p| p.found().and_then(|s| s.acceptance))
        .column("sampled time [tau]", |p| p.found().map(|s| s.time))
        .measured("T [epsilon/k_B]", value(|s| s.temperature))
        .measured("P [epsilon/sigma^3]", value(|s| s.pressure))
        .measured("P less that of the ensemble [epsilon/sigma^3]", value(|s| s.pressure_off))
        .measured("density [sigma^-3]", value(|s| s.density))
        .measured("V [sigma^3]", value(|s| s.volume))
        .measured("var V [sigma^6]", value(|s| s.variance))
        .measured("var V over reference", |p| relative_variance(chart, p))
        .column("independent volumes per tau", |p| p.found().map(Sampled::pace))
        .measured("energy drift [epsilon/tau per atom]", drift)
        .column("failure", |p| match (&p.sampled, &p.not_timed) {
            (Some(Outcome::Failed(failed)), _) | (_, Some(failed)) => failed.reason.as_str(),
            _ => "",
        })
        .table()
}

fn page(chart: &EnsembleChart, command: &str) -> Page {
    let plan = &chart.plan;
    let mut page = Page {
        title: format!("Barostat and thermostat: {}", chart.scene),
        lead: format!(
            "{} choices at P₀ = {}, T = {} with {} particles, all from one equilibrated start. A right choice has the same ⟨P⟩, density and \
             variance of V as all others, and they differ in cost and pace. **Point at a mark, or tap it, to see what it is.**",
            chart.points.len(),
            significant(chart.pressure, 4),
            significant(chart.temperature, 4),
            chart.atoms,
        ),
        command: Some(command.to_owned()),
        sections: Vec::new(),
        provenance: plan.provenance(command),
    };
    page.provenance.extend([
        (
            "Costs".into(),
            format!(
                "the engine's main loop with the changes of the box, without observables and output, {}; median of {} timings",
                counted(plan.threads, "thread"),
                plan.repeats
            ),
        ),
        (
            "Samples".into(),
            format!("runs of {} τ", significant(plan.time, 3)),
        ),
    ]);
    let mut first = Section::new("All choices");
    if !chart.finished {
        first = first.with(Block::Remark(
            "The chart was stopped before its end. The same command goes on.".into(),
        ));
    }
    if let Some(reference) = &chart.reference {
        first = first.text(format!(
            "The reference is {}: density {}, variance of V {} σ⁶.",
            reference.source,
            significant(reference.density, 5),
            significant(reference.variance, 4)
        ));
    }
    page.sections.push(first.table(summary(chart)));
    let pictures = figures(chart);
    if !pictures.is_empty() {
        page.sections.push(Section::new("Accuracy, pace and cost").with(Block::Figures(pictures)));
    }
    let mut out: Vec<String> =
        (chart.left_out.iter()).map(|l| format!("{}: {}", l.what, l.why)).collect();
    if out.is_empty() {
        out.push("nothing".into());
    }
    page.sections.push(Section::new("Left out").with(Block::List(out)));
    page
}

/// The groups of the legend.
const GROUPS: [(&str, Symbol); 4] = [
    ("stochastic cell rescaling, τ_p of the scene", Symbol::Disc),
    ("with another τ_p", Symbol::Ring),
    ("with another τ_T", Symbol::Square),
    ("MTK", Symbol::Triangle),
];

fn group(chart: &EnsembleChart, point: &EnsemblePoint) -> usize {
    let (own, baths) = (&chart.points[0].baths, &point.baths);
    if baths.barostat.is_inside_step() {
        3
    } else if baths.thermostat != own.thermostat {
        2
    } else if baths.barostat.tau() != own.barostat.tau() {
        1
    } else {
        0
    }
}

/// An ordinate of a point with its standard error.
type Ordinate<'a> = &'a dyn Fn(&EnsemblePoint) -> Option<(f64, Option<f64>)>;

/// A value with its error as a bar.
fn barred((value, error): (f64, f64)) -> (f64, Option<f64>) {
    (value, Some(error))
}

fn figures(chart: &EnsembleChart) -> Vec<Picture> {
    let Some(reference) = &chart.reference else {
        return Vec::new();
    };
    let wall = || Axis::linear("wall time / (µs per atom and step)");
    let cost = |p: &EnsemblePoint| p.cost().map(|c| 1e6 * c.median);
    let picture = |figure: Figure, caption: String| Picture::new(figure, caption, "points.csv");
    let drawn = |name: &str, title: &str, y: Axis, ordinate: Ordinate<'_>| {
        with_points(chart, Figure::new(name, title, wall(), y), &cost, ordinate)
    };
    let pressure =
        drawn("pressure", "Mean pressure", Axis::linear("(P − P₀) / (ε/σ³)"), &|p| {
            value(|s| s.pressure_off)(p).map(barred)
        });
    let density =
        drawn("density", "Mean density", Axis::linear("(ρ − reference) / σ⁻³"), &|p| {
            let (density, error) = value(|s| s.density)(p)?;
            Some(barred((density - reference.density, error)))
        });
    let variance = drawn(
        "variance",
        "Variance of the volume",
        Axis::linear("var V over the reference"),
        &|p| relative_variance(chart, p).map(barred),
    );
    let pace = drawn(
        "pace",
        "Pace of the volume",
        Axis::logarithmic("independent volumes per τ"),
        &|p| p.found().map(|s| (s.pace(), None)),
    );
    let drifts = drawn(
        "drift",
        "Drift of the conserved energy",
        Axis::linear("drift / (10⁻⁶ ε/τ per particle)"),
        &|p| drift(p).map(|(slope, error)| barred((1e6 * slope, 1e6 * error))),
    );
    let zero = |figure: Figure| figure.guided(Guide::Horizontal(0.0, String::new()));
    vec![
        picture(
            variance.guided(Guide::Horizontal(1.0, "reference".into())),
            format!("Fluctuations of V beside {}. Bars are one standard error.", reference.source),
        ),
        picture(
            pace,
            "How soon V forgets itself: the error of a mean falls with the root of this number times the time.".into(),
        ),
        picture(
            zero(pressure),
            "⟨P⟩ less P₀ and less what the missing degrees of freedom of the centre of mass add.".into(),
        ),
        picture(zero(density), format!("⟨ρ⟩ beside {}.", reference.source)),
        picture(
            zero(drifts),
            "Drift of E + V·P_tail − Σ heat, where heat includes the work of the barostat.".into(),
        ),
    ]
}

/// One series for each group, and its entry in the legend.
fn with_points(
    chart: &EnsembleChart,
    mut figure: Figure,
    abscissa: &dyn Fn(&EnsemblePoint) -> Option<f64>,
    ordinate: Ordinate<'_>,
) -> Figure {
    for (k, (name, symbol)) in GROUPS.iter().enumerate() {
        let of_group = chart.points.iter().filter(|p| group(chart, p) == k);
        let points: Vec<Point> = of_group
            .filter_map(|p| {
                let (x, (y, error)) = (abscissa(p)?, ordinate(p)?);
                Some(Point {
                    x,
                    y,
                    error,
                    note: Some(format!("{}: {}", p.number, p.label)),
                    x_range: p.cost().map(|c| (1e6 * c.lowest, 1e6 * c.highest)),
                    label: Some(p.number.to_string()),
                    ..Point::default()
                })
            })
            .collect();
        if !points.is_empty() {
            figure = figure.with(Series::new(*name, Look::Points(*symbol), k, points));
        }
    }
    figure
}
