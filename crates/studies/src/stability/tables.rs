//! The tables of the oscillator part, as CSV and on the page.

use crate::report::significant;
use lennard_core::{Cell, Table, Tone};

use super::displacement::{Case, STEP};
use super::orders::OrderLine;
use super::study::OscillatorStudy;

/// All CSV tables of the oscillator part.
pub(crate) fn csv(study: &OscillatorStudy) -> Vec<Table> {
    let mut tables =
        vec![amplification(study), limits(study), orders(study), growth(study), infinite(study)];
    tables.extend(study.cases.iter().map(|c| displacement(study, c)));
    tables.push(summaries(study));
    tables.push(paths(study));
    tables
}

fn amplification(study: &OscillatorStudy) -> Table {
    let all = study.methods.iter();
    let points: Vec<_> = all.flat_map(|m| m.points.iter().map(move |p| (m.method, p))).collect();
    Table::rows_of("amplification", &points)
        .column("method", |(method, _)| *method)
        .column("omega h", |(_, p)| p.omega_h)
        .column("radius by theory", |(_, p)| p.theory_radius)
        .column("radius measured", |(_, p)| p.measured_radius)
        .column("phase by theory", |(_, p)| p.theory_phase)
        .column("phase measured", |(_, p)| p.measured_phase)
        .table()
}

fn limits(study: &OscillatorStudy) -> Table {
    Table::rows_of("limits", &study.methods)
        .column("method", |m| m.method)
        .column("limit declared", |m| m.declared_limit)
        .column("limit by theory", |m| m.theory_limit)
        .column("limit measured", |m| m.measured_limit)
        .column("bounded at omega h = 1000", |m| m.bounded_at_1000)
        .table()
}

/// An error at one step, with the line that it belongs to.
struct OrderPoint<'a> {
    kind: &'static str,
    name: &'a str,
    theory: Option<f64>,
    measured: Option<f64>,
    at: (f64, f64),
}

fn orders(study: &OscillatorStudy) -> Table {
    let o = &study.orders;
    let kinds: [(&'static str, &[OrderLine]); 6] = [
        ("global position", &o.positions),
        ("global velocity", &o.velocities),
        ("start", &o.starts),
        ("velocity estimate", &o.velocity_estimates),
        ("local", &o.local),
        ("energy", std::slice::from_ref(&o.energy)),
    ];
    let mut points = Vec::new();
    for (kind, lines) in kinds {
        for line in lines {
            points.extend(line.errors.iter().map(|at| OrderPoint {
                kind,
                name: &line.name,
                theory: Some(line.theory),
                measured: line.measured,
                at: *at,
            }));
        }
    }
    for run in &study.step_rules {
        points.extend(run.errors.iter().map(|at| OrderPoint {
            kind: "changing step",
            name: run.rule,
            theory: None,
            measured: run.order,
            at: *at,
        }));
    }
    Table::rows_of("orders", &points)
        .column("kind", |p| p.kind)
        .column("name", |p| p.name)
        .column("order by theory", |p| p.theory)
        .column("order measured", |p| p.measured)
        .column("h [tau]", |p| p.at.0)
        .column("error", |p| p.at.1)
        .table()
}

fn growth(study: &OscillatorStudy) -> Table {
    let steps = |g: &super::discretisation::GrowthError| 0..g.times.len();
    let points: Vec<_> = study.growth.iter().flat_map(|g| steps(g).map(move |n| (g, n))).collect();
    Table::rows_of("exponential-error", &points)
        .column("wh", |(g, _)| g.wh)
        .column("wt", |(g, n)| g.times[*n])
        .column("relative error from the growing root", |(g, n)| g.exact_start_errors[*n])
        .column("relative error from the Taylor start", |(g, n)| g.taylor_start_errors[*n])
        .table()
}

fn infinite(study: &OscillatorStudy) -> Table {
    let found = &study.infinite;
    let rigid = found.rigid.iter().map(|r| {
        let name = format!("k = inf, tau/h = {}", r.damping_steps);
        (name, &r.displacements)
    });
    let stiff = found.stiff.iter().map(|r| (format!("omega h = {}", r.omega_h), &r.displacements));
    let runs: Vec<_> = rigid.chain(stiff).collect();
    let points: Vec<_> = runs
        .iter()
        .flat_map(|(name, x)| found.shown_steps.iter().zip(*x).map(move |p| (name, p)))
        .collect();
    Table::rows_of("infinite-stiffness", &points)
        .column("run", |(name, _)| *name)
        .column("step", |(_, (n, _))| **n)
        .column("|x| [sigma]", |(_, (_, x))| **x)
        .table()
}

/// One row per step and two columns per method; a cell is empty where a method had stopped.
fn displacement(study: &OscillatorStudy, case: &Case) -> Table {
    let steps = case.runs.iter().map(|r| r.positions.len()).max();
    let steps: Vec<usize> = (0..steps.unwrap_or(0)).collect();
    let mut table = Table::rows_of(format!("displacement-{}", case.name), &steps)
        .column("time [tau]", |n| *n as f64 * STEP);
    for run in &case.runs {
        let label = &study.groups[run.group].name;
        table = table
            .column(&format!("{label}: x [sigma]"), |n| run.positions.get(*n).copied())
            .column(&format!("{label}: energy [epsilon]"), |n| run.energies.get(*n).copied());
    }
    table.table()
}

fn summaries(study: &OscillatorStudy) -> Table {
    let all: Vec<_> =
        study.cases.iter().flat_map(|case| case.summaries.iter().map(move |s| (case, s))).collect();
    Table::rows_of("stiffnesses", &all)
        .column("k [epsilon/sigma^2]", |(case, _)| case.stiffness)
        .column("omega h", |(case, _)| case.omega_h)
        .column("method", |(_, s)| s.method)
        .column("radius by theory", |(_, s)| s.theory_radius)
        .column("amplitude by theory [sigma]", |(_, s)| s.theory_amplitude)
        .column("amplitude measured [sigma]", |(_, s)| s.measured_amplitude)
        .column("growth of halves", |(_, s)| s.growth_of_halves)
        .column("period ratio by theory", |(_, s)| s.theory_period_ratio)
        .column("period ratio measured", |(_, s)| s.measured_period_ratio)
        .table()
}

fn paths(study: &OscillatorStudy) -> Table {
    let points: Vec<_> = study
        .step_rules
        .iter()
        .flat_map(|run| run.path.iter().map(move |p| (run.rule, p)))
        .collect();
    Table::rows_of("variable-step", &points)
        .column("rule", |(rule, _)| *rule)
        .column("time [tau]", |(_, p)| p.0)
        .column("x [sigma]", |(_, p)| p.1)
        .table()
}

/// The largest stable ωh of every method.
pub(crate) fn limits_on_page(study: &OscillatorStudy) -> Table {
    let caption = "The largest stable ωh on the oscillator: as declared, from the declared map, and by \
                   bisection over runs of 50 000 steps, which count as bounded while |x| < 10⁶. The last \
                   column is the largest relative difference between the measured and the declared spectral \
                   radius.";
    Table::rows_of("limits", &study.methods)
        .caption(caption)
        .column("Method", |m| format!("`{}`", m.method))
        .column("Declared", |m| Cell::rounded(m.declared_limit, 8).or_figures("none"))
        .column("Theory", |m| Cell::rounded(m.theory_limit, 9).or_figures("none up to 12"))
        .column("Measured", |m| {
            let bounded = m.bounded_at_1000 == Some(true);
            Cell::rounded(m.measured_limit, 9).or_figures(if bounded {
                "none (bounded at 1000)"
            } else {
                "none"
            })
        })
        .column("Map differs by", |m| Cell::rounded(m.largest_radius_difference, 1))
        .table()
}

/// The fate of each method at one stiffness.
pub(crate) fn case_on_page(case: &Case) -> Table {
    let steps = case.summaries.first().map_or(0, |s| s.steps);
    let caption = format!(
        "{} = {} ε/σ², ωh = {:.6}, over {steps} steps. The amplitude by theory is the amplitude of the one-step \
         map; the measured one is the largest |x|.",
        case.title,
        significant(case.stiffness, 7),
        case.omega_h
    );
    Table::rows_of(case.name, &case.summaries)
        .caption(caption)
        .column("Method", |s| format!("`{}`", s.method))
        .column("Fate", |s| {
            let (fate, tone) = match s.growth_of_halves {
                None => ("diverges", Tone::Bad),
                Some(g) if g > 1.001 => ("grows", Tone::Bad),
                Some(g) if g < 0.9 => ("dies away", Tone::Careful),
                Some(_) => ("bounded", Tone::Good),
            };
            Cell::words(fate).toned(tone)
        })
        .column("Growth per step", |s| Cell::rounded(s.theory_radius, 6))
        .column("Amplitude by theory [σ]", |s| Cell::rounded(s.theory_amplitude, 7))
        .column("measured [σ]", |s| Cell::rounded(s.measured_amplitude, 7))
        .column("Period over the true one, theory", |s| Cell::rounded(s.theory_period_ratio, 6))
        .column("measured", |s| Cell::rounded(s.measured_period_ratio, 6))
        .table()
}
