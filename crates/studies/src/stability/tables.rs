//! The tables of the oscillator part, as CSV and on the page.

use lennard_observables::{Cell, RowsOf, Table, Tone};

use super::amplification::{MethodMap, theory};
use super::displacement::{Case, Run, STEP};
use super::groups::Group;
use super::map::StepMap;
use super::orders::OrderLine;
use super::study::OscillatorStudy;
use super::variable_step::exact_path;
use crate::report::{Drawn, Given, significant};

/// The largest spectral radius shown.
const TALLEST: f64 = 3.0;
/// |x| in σ at which a line that leaves its figure is not followed any further.
const OUT_OF_SIGHT: f64 = 2e4;
/// Steps shown in the close view of a stiff case.
const CLOSE_STEPS: usize = 24;
/// Points of a line less one.
const DENSE: u32 = 499;

/// What the text of the page names on the oscillator: words, lists, and tables. Tables of the files have columns that figures need.
pub(super) fn given(study: &OscillatorStudy) -> Given {
    let shared = study.groups.iter().filter(|g| g.members.len() > 1);
    let groups = shared.map(|group| {
        let names = group.members.iter().map(|m| format!("`{}`", m.spec.name));
        format!("One map, one line: {}.", names.collect::<Vec<_>>().join(", "))
    });
    let at_infinity = &study.infinite;
    let rigid = at_infinity.rigid.iter().find(|r| r.damping_steps == 0.0);
    let last = rigid.map_or(f64::NAN, |r| r.last_displacement);
    let points = order_points(study);
    let orders = order_columns(Table::rows_of("orders", &points))
        .column("label", |p| &p.label)
        .column("drawn", |p| if p.group.is_some() { "yes" } else { "no" })
        .column("index", |p| p.group.unwrap_or(0))
        .column("error by theory", |p| p.by_theory)
        .table();
    let mut tables = vec![maps(study), cases(study), orders, limits_on_page(study)];
    tables.push(
        Table::rows_of("analytic", &exact_path())
            .column("time", |p| p.0)
            .column("x", |p| p.1)
            .table(),
    );
    tables.extend(csv(study).into_iter().map(|table| extended(study, table)));
    tables.extend(study.cases.iter().map(case_on_page));
    Given {
        tables,
        words: vec![
            ("methods", study.methods.len().to_string()),
            ("steps at infinity", at_infinity.steps.to_string()),
            ("last displacement", significant(last, 7)),
            ("deviation", significant(at_infinity.deviation_from_linear, 1)),
            ("deviation at the limit", significant(at_infinity.at_limit.deviation_from_linear, 1)),
        ],
        lists: vec![("groups", groups.collect())],
    }
}

/// A table with the columns that are drawn alone.
fn extended(study: &OscillatorStudy, table: Table) -> Table {
    let column = |name: &str| table.numbers(name).unwrap_or_default();
    match table.name.as_str() {
        "amplification" => {
            let of_method = |m: &MethodMap| vec![m.group; m.points.len()];
            let groups: Vec<usize> = study.methods.iter().flat_map(of_method).collect();
            let [omega_h, phase, radius] =
                ["omega h", "phase measured", "radius measured"].map(column);
            of_groups(table, &study.groups, &groups)
                .and("radius shown", radius.iter().map(|r| Some(*r).filter(|r| *r <= TALLEST)))
                .and("phase error", omega_h.iter().zip(&phase).map(|(x, p)| phase_error(*x, *p)))
        }
        "exponential-error" => {
            let [wh, wt, root, taylor] = [
                "wh",
                "wt",
                "relative error from the growing root",
                "relative error from the Taylor start",
            ]
            .map(column);
            let over_square = |(error, wh): (&f64, &f64)| error / (wh * wh);
            table
                .and("from q₊", root.iter().zip(&wh).map(over_square))
                .and("from the Taylor start", taylor.iter().zip(&wh).map(over_square))
                .and("wt/24", wt.iter().map(|t| t / 24.0))
                .and("wt/24 + 1/16", wt.iter().map(|t| t / 24.0 + 1.0 / 16.0))
        }
        "infinite-stiffness" => {
            let (steps, x) = (column("step"), column("|x|"));
            let largest = |largest: &mut f64, (n, x): (&f64, &f64)| {
                *largest = if *n == 1.0 { *x } else { largest.max(*x) };
                Some(*largest)
            };
            table
                .and("largest |x|", steps.iter().zip(&x).scan(0.0, largest))
                .and("2n + 1", steps.iter().map(|n| 2.0 * n + 1.0))
        }
        _ => table,
    }
}

/// A table with names and indices of the groups of its rows.
pub(super) fn of_groups(table: Table, groups: &[Group], of_rows: &[usize]) -> Table {
    table
        .and("group", of_rows.iter().map(|g| groups[*g].name.as_str()))
        .and("index", of_rows.iter().copied())
}

/// |θ/(ωh) − 1|.
fn phase_error(omega_h: f64, phase: f64) -> f64 {
    (phase / omega_h - 1.0).abs()
}

/// The declared map of each group along ωh. The exact solution has no phase error to show on a logarithmic axis.
fn maps(study: &OscillatorStudy) -> Table {
    let share = |i: u32| f64::from(i) / f64::from(DENSE);
    let groups = study.groups.iter().enumerate();
    let places: Vec<(usize, &Group, f64)> =
        groups.flat_map(|(g, group)| (0..=DENSE).map(move |i| (g, group, share(i)))).collect();
    let along = |share: f64| 0.004 + (4.0 - 0.004) * share;
    let of_phases = |share: f64| 0.05 * (3.2_f64 / 0.05).powf(share);
    Table::rows_of("maps", &places)
        .column("group", |(_, group, _)| &group.name)
        .column("index", |(g, ..)| *g)
        .column("omega h", |(.., share)| along(*share))
        .column("radius", |(_, group, share)| {
            theory(group.first(), along(*share)).map(StepMap::radius)
        })
        .column("omega h of phases", |(.., share)| of_phases(*share))
        .column("phase error", |(_, group, share)| {
            let is_exact = group.first().spec.position_order == 0;
            let phase = theory(group.first(), of_phases(*share)).and_then(StepMap::phase);
            phase.filter(|_| !is_exact).map(|phase| phase_error(of_phases(*share), phase))
        })
        .table()
}

/// A step of a run, with its case.
type CaseStep<'a> = (&'a Case, &'a Run, usize);

/// Every run of every case up to where it leaves all figures. Large swings come first: small ones are drawn over them.
fn cases(study: &OscillatorStudy) -> Table {
    let mut steps: Vec<CaseStep<'_>> = Vec::new();
    for case in &study.cases {
        let mut runs: Vec<&Run> = case.runs.iter().collect();
        let size = |r: &Run| r.positions.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        runs.sort_by(|a, b| size(b).total_cmp(&size(a)));
        for run in runs {
            let sight = run.positions.iter().position(|x| x.abs() > OUT_OF_SIGHT);
            let shown = sight.map_or(run.positions.len(), |n| n + 1);
            steps.extend((0..shown).map(|n| (case, run, n)));
        }
    }
    let time = |n: usize| n as f64 * STEP;
    let stopped = |(_, run, n): &CaseStep<'_>, within: usize| {
        let end = run.positions.len() - 1;
        (*n == 0 && run.stopped.is_some() && end <= within).then(|| time(end))
    };
    let groups: Vec<usize> = steps.iter().map(|(_, run, _)| run.group).collect();
    let table = Table::rows_of("cases", &steps)
        .column("case", |(case, ..)| case.name)
        .column("title", |(case, ..)| case.title)
        .column("omega h", |(case, ..)| Cell::figures(format!("{:.6}", case.omega_h)))
        .column("time", |(.., n)| time(*n))
        .column("x", |(_, run, n)| run.positions[*n])
        .column("x of first steps", |(_, run, n)| (*n <= CLOSE_STEPS).then(|| run.positions[*n]))
        .column("energy", |(_, run, n)| run.energies[*n] / run.energies[0])
        .column("stopped", |step| stopped(step, usize::MAX))
        .column("stopped at first", |step| stopped(step, CLOSE_STEPS));
    of_groups(table.table(), &study.groups, &groups)
}

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
    /// The group that the line stands for, where it is drawn for one.
    group: Option<usize>,
    /// Name and measured order.
    label: String,
    theory: Option<f64>,
    measured: Option<f64>,
    at: (f64, f64),
    /// The error on the line of the order of theory through the middle step.
    by_theory: Option<f64>,
}

fn order_points(study: &OscillatorStudy) -> Vec<OrderPoint<'_>> {
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
            let stands_for =
                |g: &Group| kind.starts_with("global") && g.first().spec.name == line.name;
            let group = study.groups.iter().position(stands_for);
            let name = group.map_or(&line.name, |g| &study.groups[g].name);
            let order = line.measured.map_or("rounding".to_owned(), |p| format!("order {p:.2}"));
            let (h, e) = line.errors[line.errors.len() / 2];
            points.extend(line.errors.iter().map(|at| OrderPoint {
                kind,
                name: &line.name,
                group,
                label: format!("{name}: {order}"),
                theory: Some(line.theory),
                measured: line.measured,
                at: *at,
                by_theory: line.measured.map(|_| e * (at.0 / h).powf(line.theory)),
            }));
        }
    }
    for run in &study.step_rules {
        // Adding zero turns −0.00 into 0.00.
        let order = |order: f64| {
            format!("{}: order {:.2}", run.rule, (100.0 * order).round() / 100.0 + 0.0)
        };
        points.extend(run.errors.iter().map(|at| OrderPoint {
            kind: "changing step",
            name: run.rule,
            group: None,
            label: run.order.map_or(run.rule.to_owned(), order),
            theory: None,
            measured: run.order,
            at: *at,
            by_theory: None,
        }));
    }
    points
}

fn orders(study: &OscillatorStudy) -> Table {
    order_columns(Table::rows_of("orders", &order_points(study))).table()
}

fn order_columns<'a>(table: RowsOf<'a, OrderPoint<'a>>) -> RowsOf<'a, OrderPoint<'a>> {
    table
        .column("kind", |p| p.kind)
        .column("name", |p| p.name)
        .column("order by theory", |p| p.theory)
        .column("order measured", |p| p.measured)
        .column("h [tau]", |p| p.at.0)
        .column("error", |p| p.at.1)
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
fn limits_on_page(study: &OscillatorStudy) -> Table {
    let caption = "The largest stable ωh on the oscillator: as declared, from the declared map, and by \
                   bisection over runs of 50 000 steps, which count as bounded while |x| < 10⁶. The last \
                   column is the largest relative difference between the measured and the declared spectral \
                   radius.";
    Table::rows_of("limits-of-methods", &study.methods)
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
fn case_on_page(case: &Case) -> Table {
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
