//! Sweeps and comparisons for people.

use std::path::Path;

use lennard_report::significant;
use lennard_studies::compare::{ComparedRun, Row, StateOfMatter, Verdict, quantity_words};
use lennard_studies::sweep::{Sweep, SweepRecord, probability_words, workers};

use super::{table, with_error};

/// What is about to run, with the points that are no single stable phase.
pub fn sweep_header(sweep: &Sweep, threads: usize, folder: &Path) {
    println!("{}", console::style(&sweep.name).bold());
    println!(
        "  {} points, {} at a time, output in {}",
        sweep.points.len(),
        workers(sweep.points.len(), threads),
        folder.display()
    );
    for point in &sweep.points {
        let state = planned(point);
        if !state.is_single_stable_phase() {
            println!(
                "  {}: {}; it is run and not judged",
                point.name, state.words
            );
        }
    }
}

fn planned(point: &lennard_studies::sweep::Point) -> StateOfMatter {
    let model = lennard_engine::model_kind(&point.scene);
    let equation = lennard_literature::equation_of_state_for(model).ok();
    StateOfMatter::new(point.density, point.scene.system.temperature, equation)
}

/// The table of a sweep.
pub fn sweep(record: &SweepRecord, folder: &Path) {
    let mut points = table(
        &[
            "point",
            "T, whole steps",
            "T, half steps",
            "U",
            "U − equation",
            "P",
            "P − equation",
            "c_v",
            "verdicts U, P, c_v",
        ],
        1..8,
    );
    for point in &record.points {
        let Some(compared) = &point.compared else {
            let why = if point.failure.is_some() {
                "failed"
            } else {
                "not finished"
            };
            points.add_row([point.name.as_str(), "", "", "", "", "", "", "", why]);
            continue;
        };
        let mut cells = vec![point.name.clone()];
        for quantity in ["temperature", "temperature_half_steps"] {
            let mean = point.row(quantity).map(|r| r.measured);
            cells.push(mean.map_or("–".into(), |t| format!("{t:.4}")));
        }
        let mut verdicts = Vec::new();
        for quantity in ["potential_energy", "pressure", "heat_capacity"] {
            let Some(r) = point.row(quantity) else {
                cells.push("–".into());
                continue;
            };
            cells.push(pair(r.measured, r.standard_error));
            if quantity != "heat_capacity" {
                let difference = r.difference.zip(r.combined_error);
                cells.push(difference.map_or("–".into(), |(d, e)| pair(d, e)));
            }
            verdicts.push(match r.verdict {
                Verdict::PredictedBias => r.verdict_words(),
                other => other.words().to_owned(),
            });
        }
        cells.push(if compared.state.is_single_stable_phase() {
            verdicts.join(", ")
        } else {
            compared.state.words.clone()
        });
        points.add_row(cells);
    }
    println!("\n{points}");
    if !record.agreement.is_empty() {
        let mut all = table(
            &[
                "all single-phase points",
                "points",
                "agree",
                "mean difference",
                "largest",
                "largest error",
                "p",
                "p with the equation's own uncertainty",
            ],
            1..8,
        );
        for a in &record.agreement {
            all.add_row([
                quantity_words(&a.quantity),
                a.points.to_string(),
                a.agree.to_string(),
                significant(a.mean_difference, 3),
                significant(a.largest_difference, 3),
                significant(a.largest_standard_error, 2),
                probability_words(a.p_value),
                probability_words(a.p_value_with_reference),
            ]);
        }
        println!("\n{all}");
    }
    let mut remarks: Vec<&String> = record
        .points
        .iter()
        .filter_map(|p| p.compared.as_ref())
        .flat_map(|c| &c.remarks)
        .collect();
    remarks.sort();
    remarks.dedup();
    // Which points are no single phase stands in the table.
    for remark in remarks.into_iter().filter(|r| !r.starts_with("by ")) {
        println!("  note: {remark}");
    }
    let kept = record.points.iter().filter(|p| p.kept).count();
    if kept > 0 {
        println!("  {kept} points had been finished before and were not run again");
    }
    println!("\n  page: {}", folder.join("report.html").display());
}

/// One run beside the literature.
pub fn compared(run: &ComparedRun, all: bool) {
    println!("{}", console::style(&run.run).bold());
    println!(
        "  {} particles, {} measured steps, ρ = {:.4}, {} = {:.4}: {}",
        run.atoms,
        run.measured_steps,
        run.state.density,
        run.state.temperature_words(),
        run.state.temperature,
        run.state.words
    );
    println!("{}", quantities(run, all));
    below_quantities(run, all);
    println!();
}

/// The primary quantities of a run with their verdicts, or all of them.
pub(super) fn quantities(run: &ComparedRun, all: bool) -> comfy_table::Table {
    let mut rows = table(
        &[
            "quantity",
            "measured",
            "reference",
            "difference",
            "difference / s.e.",
            "tolerance",
            "verdict",
        ],
        1..6,
    );
    // The headline says a reason that most rows share.
    let in_headline = |row: &Row| run.shared_reason.as_ref() == Some(&row.reason);
    for r in run.rows.iter().filter(|r| all || r.primary) {
        let reference = match (r.reference, r.reference_error) {
            (Some(x), Some(e)) => pair(x, e),
            (Some(x), None) => significant(x, 5),
            (None, _) => "–".into(),
        };
        // As many digits as its error has, which follows from the next column.
        let difference = match (r.difference, r.combined_error) {
            (Some(d), Some(e)) => with_error(d, e).0,
            (Some(d), None) => significant(d, 3),
            (None, _) => "–".into(),
        };
        let quantity = quantity_words(&r.quantity);
        rows.add_row([
            if r.unit.is_empty() {
                quantity
            } else {
                format!("{quantity}, {}", r.unit)
            },
            pair(r.measured, r.standard_error),
            reference,
            difference,
            r.in_standard_errors
                .map_or("–".into(), |z| format!("{z:+.1}")),
            r.tolerance
                .map_or("–".into(), |t| format!("± {}", significant(t, 2))),
            if in_headline(r) && !all {
                r.verdict.words().to_owned()
            } else {
                r.verdict_words()
            },
        ]);
    }
    rows
}

/// What is said below the table: the headline, the model and the reference; with `all` every source and note.
pub(super) fn below_quantities(run: &ComparedRun, all: bool) {
    println!("  {}", console::style(&run.headline).bold());
    println!("  U and P are of: {}", run.model);
    let judged_by = |equation: &&String| {
        let rows = &mut run.rows.iter();
        rows.any(|r| r.verdict.is_judged() && r.source == **equation)
    };
    if let Some(equation) = run.equation.as_ref().filter(judged_by) {
        println!(
            "  reference: {equation}, at ρ = {:.4} and {} = {:.4}, for {} particles",
            run.state.density,
            run.state.temperature_words(),
            run.state.temperature,
            run.atoms
        );
    }
    let hidden = run.rows.iter().filter(|r| !r.primary).count();
    if !all {
        for row in run.rows.iter().filter(|r| r.primary) {
            if let Some(words) = row.range_words() {
                println!("  {}: {words}", quantity_words(&row.quantity));
            }
        }
        if hidden > 0 {
            println!("  {hidden} more quantities, sources and notes: --all");
        }
        return;
    }
    for r in &run.rows {
        let notes: Vec<&str> = [
            r.source.as_str(),
            r.tolerance_words.as_str(),
            r.remark.as_str(),
        ]
        .into_iter()
        .filter(|t| !t.is_empty())
        .collect();
        if !notes.is_empty() {
            println!("  {}: {}", quantity_words(&r.quantity), notes.join("; "));
        }
    }
    for remark in &run.remarks {
        println!("  note: {remark}");
    }
}

/// A value with its standard error; the value alone where it has none.
fn pair(value: f64, error: f64) -> String {
    if !error.is_finite() {
        return significant(value, 5);
    }
    let (value, error) = with_error(value, error);
    format!("{value} ± {error}")
}
