//! The tables of a run's page.

use crate::lists::grouped;
use crate::report::{Block, percent, significant};
use lennard_io::RunRecord;
use lennard_observables::{Cell, Remark, Table, Value};

use crate::compare::{
    ComparedRun, Row, RunFolder, StateCard, Verdict, card_table, quantity_words, table,
};

/// What was measured, beside the literature where there is some.
pub(super) fn comparison(compared: &ComparedRun) -> Vec<Block> {
    let shown = compared.rows.iter().filter(|r| r.primary || r.verdict.is_judged());
    let rows: Vec<&Row> = shown.collect();
    let mut made = table(&rows, false, |row| match row.has_long_reason() {
        true => row.verdict.words().to_owned(),
        false => row.verdict_words(),
    });
    // How far each quantity may be off stands in its note.
    made.caption =
        "Digits in brackets are one standard error (s.e.) in the last digits.".to_owned();
    vec![Block::Table(made)]
}

/// Every measured property beside every equation; nothing where none applies.
pub(super) fn state_card(compared: &ComparedRun) -> Vec<Block> {
    let said =
        |card: &StateCard| [Block::Text(card.sentence.clone()), Block::Table(card_table(card))];
    compared.card.iter().flat_map(said).collect()
}

/// Reasons that are too long for the table, then sources and remarks: quantities with the same ones share a line.
pub(super) fn notes(compared: &ComparedRun) -> Vec<String> {
    let in_lead = |row: &Row| compared.shared_reason.as_ref() == Some(&row.reason);
    let reasons = (compared.rows.iter())
        .filter(|row| row.primary && row.has_long_reason() && !in_lead(row))
        .map(|row| (row.reason.clone(), row));
    let sources = compared.rows.iter().map(|row| {
        let within = match row.tolerance_words.as_str() {
            "" => String::new(),
            words => format!("agrees within {words}"),
        };
        let notes = [&row.source, &within, &row.remark].map(String::as_str);
        let notes: Vec<&str> = notes.into_iter().filter(|t| !t.is_empty()).collect();
        (notes.join("; "), row)
    });
    let notes = reasons.chain(sources).filter(|(notes, _)| !notes.is_empty());
    grouped(notes.map(|(notes, row)| (notes, quantity_words(&row.quantity))))
        .into_iter()
        .map(|(notes, quantities)| format!("**{}**: {notes}", quantities.join(", ")))
        .chain(compared.remarks.iter().map(Remark::to_string))
        .collect()
}

/// The stages, with the baths that any of them has.
pub(super) fn stages(run: &RunFolder) -> Table {
    let scene = &run.scene;
    let frames = run
        .record
        .trajectory_frames
        .map(|frames| format!(" {frames} frames are in `{}`.", scene.output.format.spec().file));
    let caption = format!(
        "Integrator: {}. Model: {}.{}",
        scene.method_name(),
        run.record.model,
        frames.unwrap_or_default()
    );
    let table = Table::rows_of("stages", &scene.stages)
        .caption(caption)
        .column("Stage", |s| s.name.as_str())
        .column("Steps", |s| s.steps)
        .column("dt [τ]", |s| Cell::rounded(scene.stage_dt(s), 4))
        .column("Thermostat", |s| {
            let bath = s.thermostat.as_ref();
            bath.map(|t| format!("{} at {}", t.name(), s.temperature_in_words()))
        })
        .column("Barostat", |s| {
            let bath = s.barostat.as_ref();
            bath.map(|b| format!("{} at {}", b.options.name(), b.pressure_in_words()))
        })
        .column("Measured", |s| if s.measure { "yes" } else { "no" })
        .table();
    without_empty_columns(table)
}

fn without_empty_columns(mut table: Table) -> Table {
    table.columns.retain(|column| column.cells.iter().any(|cell| cell.value != Value::Missing));
    table
}

pub(super) fn averages(compared: &ComparedRun, record: &RunRecord) -> Table {
    let rows: Vec<_> = compared
        .rows
        .iter()
        .filter_map(|row| Some((row, record.averages.get(&row.quantity)?)))
        .collect();
    let mut caption = "Means with their standard errors, their number of independent samples as estimated, and the samples discarded at the start.".to_owned();
    if rows.iter().any(|(row, _)| row.verdict == Verdict::TooShort) {
        caption += " A run is too short by the least that its samples may be worth, which is less than the estimate.";
    }
    let table = Table::rows_of("averages", &rows)
        .caption(caption)
        .column("Quantity", |(row, _)| quantity_words(&row.quantity))
        .measured("Mean", |(_, a)| Some(a.estimate))
        .column("Unit", |(_, a)| &a.unit)
        .column("Independent samples", |(_, a)| Cell::rounded(a.estimate.n_effective, 3))
        .column("Discarded", |(_, a)| a.estimate.equilibration_cut)
        .column("Why no result", |(row, a)| (!a.is_sound()).then(|| row.verdict_words()))
        .table();
    without_empty_columns(table)
}

/// Where the time went. A few bodies spend it on files, and it says nothing of a step.
pub(super) fn performance(record: &RunRecord, is_fluid: bool) -> Table {
    let stages = record.performance.stages;
    let parts = [
        ("forces", stages.force),
        ("neighbor lists", stages.neighbor),
        ("integration", stages.integrate),
        ("observables", stages.observe),
        ("files", stages.write),
        ("whole run", record.wall_s),
    ];
    let speed = match is_fluid {
        true => format!(
            ", {} ns per particle and step",
            significant(record.performance.ns_per_atom_step, 3)
        ),
        false => String::new(),
    };
    let caption = format!(
        "Wall time by kind of work: {} steps of {} particles{speed}; {} list builds; {}.",
        record.steps,
        record.atoms,
        record.neighbor.builds,
        record.neighbor.forces_checked()
    );
    Table::rows_of("performance", &parts)
        .caption(caption)
        .column("Work", |(name, _)| *name)
        .column("Seconds", |(_, seconds)| Cell::rounded(*seconds, 3))
        .column("Share", |(_, seconds)| Cell::figures(percent(seconds / record.wall_s)))
        .table()
}
