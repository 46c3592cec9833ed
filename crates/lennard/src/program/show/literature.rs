//! Sweeps and comparisons for people.

use std::collections::BTreeSet;
use std::path::Path;

use lennard_core::{Cell, Remark, Table};
use lennard_scene::Scene;
use lennard_studies::compare::{self, ComparedRun, Row, StateOfMatter, quantity_words};
use lennard_studies::report::{Section, counted, particles, signed, significant};
use lennard_studies::sweep::{Sweep, SweepRecord, workers};

/// What is about to run, with the points that are no single stable phase. Two phases that the start puts side by side are
/// meant, and are judged by saturation.
pub fn sweep_header(sweep: &Sweep, threads: usize, folder: &Path) -> Section {
    let points = sweep.points.len();
    let is_meant = |scene: &Scene| scene.surfaces().is_some() || scene.half_crystal().is_some();
    let unstable = sweep.points.iter().filter(|p| !is_meant(&p.scene)).filter_map(|point| {
        let state = planned(point);
        let said = format!("{}: {}; it is run and not judged", point.name, state.words);
        (!state.is_single_stable_phase()).then_some(said)
    });
    Section::new(&*sweep.name)
        .text(format!(
            "{}, {} at a time, output in {}",
            counted(points, "point"),
            workers(points, threads),
            folder.display()
        ))
        .texts(unstable)
}

fn planned(point: &lennard_studies::sweep::Point) -> StateOfMatter {
    let model = lennard_scene::model_kind(&point.scene);
    let equation = lennard_literature::equation_of_state_for(model).ok();
    StateOfMatter::new(point.density, point.scene.system.temperature, equation)
}

/// The tables of a sweep, and what they say.
pub fn sweep(record: &SweepRecord, folder: &Path) -> Section {
    let mut section = Section::new("");
    for table in &record.terminal {
        section = section.text("").table(table.clone());
    }
    // Which points are no single phase stands in the table.
    let compared = record.points.iter().filter_map(|p| p.compared.as_ref());
    let remarks = compared.flat_map(|c| &c.remarks);
    let remarks: BTreeSet<String> = remarks
        .filter(|remark| !matches!(remark, Remark::NotJudged { .. }))
        .map(Remark::to_string)
        .collect();
    let kept = record.points.iter().filter(|p| p.kept).count();
    let kept = (kept > 0)
        .then(|| format!("{kept} points had been finished before and were not run again"));
    section
        .texts(&record.sentences)
        .texts(remarks.iter().map(|remark| format!("note: {remark}")))
        .texts(kept)
        .text("")
        .text(format!("page: {}", folder.join("report.html").display()))
}

/// One run beside the literature.
pub fn compared(run: &ComparedRun, verbose: bool) -> Section {
    let of_particles = particles(run.atoms as usize, run.molecules as usize);
    let section = Section::new(&run.run).text(format!(
        "{of_particles}, {} measured steps, {}: {}",
        run.measured_steps,
        run.state.in_numbers(),
        run.state.words
    ));
    state_card(quantities(section, run, verbose), run, verbose).text("")
}

/// Every measured property beside every equation, and what follows.
/// Its sentence has the verdicts, for which the table has room with `verbose` alone.
pub(super) fn state_card(section: Section, run: &ComparedRun, verbose: bool) -> Section {
    let without: &[&str] = if verbose { &[] } else { &["Verdict"] };
    match &run.card {
        Some(card) => {
            section.table(compare::card_table(card).without(without)).text(&card.sentence)
        }
        None => section,
    }
}

/// The primary quantities of a run with their verdicts, and the lines below them. With `verbose` these are all quantities, and
/// each has the parts of its verdict.
pub(super) fn quantities(section: Section, run: &ComparedRun, verbose: bool) -> Section {
    let rows: Vec<&Row> = run.rows.iter().collect();
    let table = match verbose {
        true => compare::table(&rows, Row::verdict_words),
        false => narrow(run),
    };
    let section = section.table(table).heading(&run.headline);
    let words = |row: &Row, text: &str| format!("{}: {text}", quantity_words(&row.quantity));
    let primary = || rows.iter().filter(|r| r.primary && !verbose);
    let reasons = primary().filter(|row| has_note(run, row)).map(|row| words(row, &row.reason));
    let of_one = if run.molecules == run.atoms { "particle" } else { "molecule" };
    let judges =
        |equation: &&String| rows.iter().any(|r| r.verdict.is_judged() && r.source == **equation);
    let of_particles = particles(run.atoms as usize, run.molecules as usize);
    let reference = run.equation.as_ref().filter(judges).map(|equation| {
        format!("reference: {equation}, at {}, for {of_particles}", run.state.in_numbers())
    });
    let section = section
        .texts(reasons)
        .text(format!("U and P are of: {}; energies are per {of_one}", run.model))
        .texts(reference);
    if verbose {
        let notes = rows.iter().filter_map(|r| {
            let notes = [&r.source, &r.tolerance_words, &r.remark].map(String::as_str);
            let notes: Vec<&str> = notes.into_iter().filter(|t| !t.is_empty()).collect();
            (!notes.is_empty()).then(|| words(r, &notes.join("; ")))
        });
        return section.texts(notes).texts(run.remarks.iter().map(|r| format!("note: {r}")));
    }
    let ranges = primary().filter_map(|row| Some(words(row, &row.range_words()?)));
    let hidden = rows.iter().filter(|r| !r.primary).count();
    let more =
        (hidden > 0).then(|| format!("{hidden} more quantities, sources and notes: --verbose"));
    section.texts(ranges).texts(more)
}

/// The primary quantities in columns that fit a terminal: the difference stands beside the one that is allowed.
fn narrow(run: &ComparedRun) -> Table {
    let rows: Vec<&Row> = run.rows.iter().filter(|r| r.primary).collect();
    let rounded = |value: Option<f64>| Cell::rounded(value, 5);
    Table::rows_of("results", &rows)
        .column("Quantity", |r| {
            let unit = r.unit.split(" per ").next().unwrap_or_default();
            let words = quantity_words(&r.quantity)
                .replace("configurational temperature", "T, configurational");
            match unit {
                "" => words,
                unit => format!("{words}, {unit}"),
            }
        })
        .measured("Measured", |r| Some((r.measured, r.standard_error)))
        .column("Reference", |r| rounded(r.reference))
        .column("Difference", |r| {
            if r.is_in_range() {
                return Some(Cell::figures("in range"));
            }
            let figures = r.difference.map(|d| signed(d, 2));
            figures.map(Cell::figures)
        })
        .column("Allowed", |r| {
            let figures = r.tolerance.map(|t| format!("± {}", significant(t, 2)));
            figures.map(Cell::figures)
        })
        .column("Verdict", |r| {
            let in_headline = is_in_headline(run, r);
            let words = if in_headline || r.verdict.is_judged() || has_note(run, r) {
                r.verdict.words().to_owned()
            } else {
                r.verdict_words()
            };
            Cell::words(words).toned(r.verdict.tone())
        })
        .table()
}

/// Whether the headline says the reason of a row: most rows share it.
fn is_in_headline(run: &ComparedRun, row: &Row) -> bool {
    run.shared_reason.as_ref() == Some(&row.reason)
}

/// Whether the reason of a row stands below the table: it would fill several lines of a cell.
fn has_note(run: &ComparedRun, row: &Row) -> bool {
    row.has_long_reason() && !is_in_headline(run, row)
}
