//! Sweeps and comparisons for people.

use std::path::Path;

use lennard_studies::compare::{self, ComparedRun, Row, StateOfMatter, quantity_words};
use lennard_studies::sweep::{self, Sweep, SweepRecord, workers};

use super::table;

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
    let points = sweep::point_table(record).without(&["c_v − equation", "State"]);
    println!("\n{}", table(&points));
    if !record.agreement.is_empty() {
        let together = sweep::agreement_table(record).without(&sweep::CHI_SQUARED);
        println!("\n{}", table(&together));
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
        "  {}, {} measured steps, ρ = {:.4}, {} = {:.4}: {}",
        lennard_report::particles(run.atoms as usize, run.molecules as usize),
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
    // The headline says a reason that most rows share.
    let in_headline = |row: &Row| run.shared_reason.as_ref() == Some(&row.reason);
    let rows: Vec<&Row> = run.rows.iter().filter(|r| all || r.primary).collect();
    table(&compare::table(&rows, |r| {
        if in_headline(r) && !all {
            r.verdict.words().to_owned()
        } else {
            r.verdict_words()
        }
    }))
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
            "  reference: {equation}, at ρ = {:.4} and {} = {:.4}, for {}",
            run.state.density,
            run.state.temperature_words(),
            run.state.temperature,
            lennard_report::particles(run.atoms as usize, run.molecules as usize)
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
