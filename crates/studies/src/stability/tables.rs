//! The tables of the oscillator part, as CSV and on the page.

use lennard_report::{Cell, PageTable, Tone, significant};

use super::OscillatorStudy;
use super::displacement::{Case, STEP};
use super::orders::OrderLine;
use crate::claims::Claim;
use crate::files::{TextTable, exact, exact_or_empty};

/// All CSV tables of the oscillator part.
pub(crate) fn csv(study: &OscillatorStudy) -> Vec<TextTable> {
    let mut tables = vec![
        amplification(study),
        limits(study),
        orders(study),
        growth(study),
        infinite(study),
    ];
    tables.extend(study.cases.iter().map(|c| displacement(study, c)));
    tables.push(summaries(study));
    let mut paths = TextTable::new("variable-step", &["rule", "time [s]", "x [m]"]);
    for run in &study.step_rules {
        for (t, x) in &run.path {
            paths.push([run.rule.to_owned(), exact(*t), exact(*x)]);
        }
    }
    tables.push(paths);
    tables
}

/// The claims as CSV.
pub(crate) fn claims(claims: &[Claim]) -> TextTable {
    let header = [
        "source",
        "claim",
        "judged by",
        "theory",
        "measured",
        "tolerance",
        "tolerance from",
        "theory agrees",
        "verdict",
    ];
    let mut table = TextTable::new("claims", &header);
    for c in claims {
        table.push([
            c.source.to_owned(),
            c.statement.clone(),
            c.quantity.clone(),
            exact_or_empty(c.theory),
            exact(c.measured),
            exact(c.tolerance),
            c.tolerance_reason.to_owned(),
            c.theory_agrees.to_string(),
            match c.verdict {
                crate::claims::Verdict::Holds => "holds".to_owned(),
                crate::claims::Verdict::DoesNotHold => "does not hold".to_owned(),
            },
        ]);
    }
    table
}

fn amplification(study: &OscillatorStudy) -> TextTable {
    let header = [
        "method",
        "omega h",
        "radius by theory",
        "radius measured",
        "phase by theory",
        "phase measured",
    ];
    let mut table = TextTable::new("amplification", &header);
    for m in &study.methods {
        for p in &m.points {
            table.push([
                m.method.to_owned(),
                exact(p.omega_h),
                exact(p.theory_radius),
                exact(p.measured_radius),
                exact_or_empty(p.theory_phase),
                exact_or_empty(p.measured_phase),
            ]);
        }
    }
    table
}

fn limits(study: &OscillatorStudy) -> TextTable {
    let header = [
        "method",
        "limit declared",
        "limit by theory",
        "limit measured",
        "bounded at omega h = 1000",
    ];
    let mut table = TextTable::new("limits", &header);
    for m in &study.methods {
        table.push([
            m.method.to_owned(),
            exact_or_empty(m.declared_limit),
            exact_or_empty(m.theory_limit),
            exact_or_empty(m.measured_limit),
            m.bounded_at_1000.map(|b| b.to_string()).unwrap_or_default(),
        ]);
    }
    table
}

fn orders(study: &OscillatorStudy) -> TextTable {
    let mut table = TextTable::new(
        "orders",
        &[
            "kind",
            "name",
            "order by theory",
            "order measured",
            "h [s]",
            "error",
        ],
    );
    let o = &study.orders;
    let kinds: [(&str, Vec<&OrderLine>); 6] = [
        ("global position", o.positions.iter().collect()),
        ("global velocity", o.velocities.iter().collect()),
        ("start", o.starts.iter().collect()),
        ("velocity estimate", o.velocity_estimates.iter().collect()),
        ("local", o.local.iter().collect()),
        ("energy", vec![&o.energy]),
    ];
    for (kind, lines) in kinds {
        for line in lines {
            for (h, e) in &line.errors {
                table.push([
                    kind.to_owned(),
                    line.name.clone(),
                    exact(line.theory),
                    exact_or_empty(line.measured),
                    exact(*h),
                    exact(*e),
                ]);
            }
        }
    }
    for run in &study.step_rules {
        for (h, e) in &run.errors {
            table.push([
                "changing step".to_owned(),
                run.rule.to_owned(),
                String::new(),
                exact_or_empty(run.order),
                exact(*h),
                exact(*e),
            ]);
        }
    }
    table
}

fn growth(study: &OscillatorStudy) -> TextTable {
    let header = [
        "wh",
        "wt",
        "relative error from the growing root",
        "relative error from the Taylor start",
    ];
    let mut table = TextTable::new("exponential-error", &header);
    for g in &study.growth {
        for ((t, a), b) in g
            .times
            .iter()
            .zip(&g.exact_start_errors)
            .zip(&g.taylor_start_errors)
        {
            table.push([g.wh, *t, *a, *b].map(exact));
        }
    }
    table
}

fn infinite(study: &OscillatorStudy) -> TextTable {
    let mut table = TextTable::new("infinite-stiffness", &["run", "step", "|x| [m]"]);
    let found = &study.infinite;
    let named = found
        .rigid
        .iter()
        .map(|r| {
            (
                format!("k = inf, tau/h = {}", r.damping_steps),
                &r.displacements,
            )
        })
        .chain(
            found
                .stiff
                .iter()
                .map(|r| (format!("omega h = {}", r.omega_h), &r.displacements)),
        );
    for (name, displacements) in named {
        for (n, x) in found.shown_steps.iter().zip(displacements) {
            table.push([name.clone(), n.to_string(), exact(*x)]);
        }
    }
    table
}

/// One row a step, two columns a method; empty where a method had stopped.
fn displacement(study: &OscillatorStudy, case: &Case) -> TextTable {
    let name = match case.name {
        "k-100" => "displacement-k-100",
        "k-inside" => "displacement-k-inside",
        "k-outside" => "displacement-k-outside",
        _ => "displacement-k-aliasing",
    };
    let mut table = TextTable::new(name, &["time [s]"]);
    for run in &case.runs {
        let label = &study.groups[run.group].name;
        table.header.push(format!("{label}: x [m]"));
        table.header.push(format!("{label}: energy [J]"));
    }
    let steps = case
        .runs
        .iter()
        .map(|r| r.positions.len())
        .max()
        .unwrap_or(0);
    for n in 0..steps {
        let mut row = vec![exact(n as f64 * STEP)];
        for run in &case.runs {
            row.push(exact_or_empty(run.positions.get(n).copied()));
            row.push(exact_or_empty(run.energies.get(n).copied()));
        }
        table.push(row);
    }
    table
}

fn summaries(study: &OscillatorStudy) -> TextTable {
    let header = [
        "k [N/m]",
        "omega h",
        "method",
        "radius by theory",
        "amplitude by theory [m]",
        "amplitude measured [m]",
        "growth of halves",
        "period ratio by theory",
        "period ratio measured",
    ];
    let mut table = TextTable::new("stiffnesses", &header);
    for case in &study.cases {
        for s in &case.summaries {
            table.push([
                exact(case.stiffness),
                exact(case.omega_h),
                s.method.to_owned(),
                exact(s.theory_radius),
                exact_or_empty(s.theory_amplitude),
                exact_or_empty(s.measured_amplitude),
                exact_or_empty(s.growth_of_halves),
                exact_or_empty(s.theory_period_ratio),
                exact_or_empty(s.measured_period_ratio),
            ]);
        }
    }
    table
}

fn number(value: Option<f64>, digits: usize, missing: &str) -> Cell {
    value.map_or(Cell::number(missing), |v| {
        Cell::number(significant(v, digits))
    })
}

/// The largest stable ωh of every method.
pub(crate) fn limits_on_page(study: &OscillatorStudy, command: &str) -> PageTable {
    let rows = study
        .methods
        .iter()
        .map(|m| {
            let none = if m.bounded_at_1000 == Some(true) {
                "none (bounded at 1000)"
            } else {
                "none"
            };
            vec![
                Cell::text(format!("`{}`", m.method)),
                number(m.declared_limit, 8, "none"),
                number(m.theory_limit, 9, "none up to 12"),
                number(m.measured_limit, 9, none),
                Cell::number(significant(m.largest_radius_difference, 1)),
            ]
        })
        .collect();
    PageTable {
        caption: "The largest stable ωh on the oscillator: as declared, from the declared map, and by \
                  bisection over runs of 50 000 steps, which count as bounded while |x| < 10⁶. The last \
                  column is the largest relative difference between the measured and the declared spectral \
                  radius."
            .into(),
        command: Some(command.to_owned()),
        header: ["Method", "Declared", "Theory", "Measured", "Map differs by"].map(str::to_owned).to_vec(),
        rows,
    }
}

/// What each method did at one stiffness.
pub(crate) fn case_on_page(case: &Case, command: &str) -> PageTable {
    let rows = case
        .summaries
        .iter()
        .map(|s| {
            let (fate, tone) = match s.growth_of_halves {
                None => ("diverges", Tone::Bad),
                Some(g) if g > 1.001 => ("grows", Tone::Bad),
                Some(g) if g < 0.9 => ("dies away", Tone::Careful),
                Some(_) => ("bounded", Tone::Good),
            };
            vec![
                Cell::text(format!("`{}`", s.method)),
                Cell::toned(fate, tone),
                Cell::number(significant(s.theory_radius, 6)),
                number(s.theory_amplitude, 7, "–"),
                number(s.measured_amplitude, 7, "–"),
                number(s.theory_period_ratio, 6, "–"),
                number(s.measured_period_ratio, 6, "–"),
            ]
        })
        .collect();
    let steps = case.summaries.first().map_or(0, |s| s.steps);
    PageTable {
        caption: format!(
            "{} = {} N/m, ωh = {:.6}, over {steps} steps. The amplitude by theory is that of the one-step \
             map; the measured one is the largest |x|.",
            case.title,
            significant(case.stiffness, 7),
            case.omega_h
        ),
        command: Some(command.to_owned()),
        header: [
            "Method",
            "Fate",
            "Growth a step",
            "Amplitude / m, theory",
            "measured",
            "Period / true, theory",
            "measured",
        ]
        .map(str::to_owned)
        .to_vec(),
        rows,
    }
}
