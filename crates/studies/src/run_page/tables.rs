//! The tables of a run's page.

use lennard_core::{Cell, Table};
use lennard_io::RunRecord;
use lennard_report::{Section, percent, significant};

use crate::compare::{ComparedRun, Row, RunFolder, card_table, quantity_words, table};

pub(super) fn comparison(compared: &ComparedRun) -> Table {
    let shown = compared
        .rows
        .iter()
        .filter(|r| r.primary || r.verdict.is_judged());
    table(&shown.collect::<Vec<_>>(), Row::verdict_words)
}

/// Every measured property beside every equation.
pub(super) fn state_card(compared: &ComparedRun) -> Section {
    let section = Section::new("State card");
    match &compared.card {
        Some(card) => section.text(card.sentence.as_str()).table(card_table(card)),
        None => section.text(format!(
            "No equation of state is shown: {}.",
            compared.state.words
        )),
    }
}

/// Sources and remarks: quantities with the same ones share a line.
pub(super) fn sources(compared: &ComparedRun) -> Vec<String> {
    let mut shared: Vec<(String, Vec<String>)> = Vec::new();
    for row in &compared.rows {
        let notes = [row.source.as_str(), row.remark.as_str()];
        let notes: Vec<&str> = notes.into_iter().filter(|t| !t.is_empty()).collect();
        if notes.is_empty() {
            continue;
        }
        let (notes, words) = (notes.join("; "), quantity_words(&row.quantity));
        match shared.iter_mut().find(|(known, _)| *known == notes) {
            Some((_, quantities)) => quantities.push(words),
            None => shared.push((notes, vec![words])),
        }
    }
    shared
        .into_iter()
        .map(|(notes, quantities)| format!("**{}**: {notes}", quantities.join(", ")))
        .chain(compared.remarks.iter().cloned())
        .collect()
}

pub(super) fn stages(run: &RunFolder) -> Table {
    let scene = &run.scene;
    let caption = format!(
        "Integrator: {}. Model: {}.",
        scene.method_name(),
        run.record.model
    );
    Table::rows_of("stages", &scene.stages)
        .caption(caption)
        .column("Stage", |s| &s.name)
        .column("Steps", |s| s.steps)
        .column("dt [τ]", |s| Cell::rounded(scene.stage_dt(s), 4))
        .column("Thermostat", |s| {
            s.thermostat
                .as_ref()
                .map_or("none: constant energy".into(), |t| {
                    format!("{} at {}", t.name(), s.temperature_in_words())
                })
        })
        .column("Barostat", |s| {
            s.barostat
                .as_ref()
                .map_or("none: constant volume".into(), |b| {
                    format!("{} at {}", b.options.name(), b.pressure_in_words())
                })
        })
        .column("Measured", |s| if s.measure { "yes" } else { "no" })
        .table()
}

/// What this run did not measure.
pub(super) fn left_out(run: &RunFolder) -> Vec<String> {
    let asked: Vec<&str> = run
        .scene
        .observables
        .iter()
        .map(|o| o.options.name())
        .collect();
    let missing: Vec<&str> = lennard_observables::observables()
        .iter()
        .map(|spec| spec.name)
        .filter(|name| *name != "thermodynamics" && !asked.contains(name))
        .collect();
    let mut points = vec![if missing.is_empty() {
        "Every observable was measured.".to_owned()
    } else {
        format!("Not asked for, and not computed: {}.", missing.join(", "))
    }];
    match run.record.trajectory_frames {
        Some(frames) => {
            let file = run.scene.output.format.spec().file;
            points.push(format!("{frames} frames are in `{file}`."));
        }
        None => points.push("No trajectory was written.".into()),
    }
    points
}

pub(super) fn averages(compared: &ComparedRun, record: &RunRecord) -> Table {
    let rows: Vec<_> = compared
        .rows
        .iter()
        .filter_map(|row| Some((row, record.averages.get(&row.quantity)?)))
        .collect();
    let caption = "Means with their standard errors, their number of independent samples, the samples discarded at the start, and why a \
                   mean has no error.";
    Table::rows_of("averages", &rows)
        .caption(caption)
        .column("Quantity", |(row, _)| quantity_words(&row.quantity))
        .measured("Mean", |(_, a)| Some((a.mean, a.standard_error)))
        .column("Unit", |(_, a)| &a.unit)
        .column("Independent samples", |(_, a)| {
            Cell::rounded(a.n_effective, 3)
        })
        .column("Discarded", |(_, a)| a.equilibration_cut)
        .column("Why no result", |(row, a)| {
            if a.is_sound() {
                String::new()
            } else {
                row.verdict_words()
            }
        })
        .table()
}

pub(super) fn performance(record: &RunRecord) -> Table {
    let stages = record.performance.stages;
    let parts = [
        ("forces", stages.force),
        ("neighbor lists", stages.neighbor),
        ("integration and thermostat", stages.integrate),
        ("observables", stages.observe),
        ("files", stages.write),
        ("whole run", record.wall_s),
    ];
    let caption = format!(
        "Wall time by kind of work: {} steps of {} particles, {} ns per particle and step; {} list builds; {}.",
        record.steps,
        record.atoms,
        significant(record.performance.ns_per_atom_step, 3),
        record.neighbor.builds,
        record.neighbor.forces_checked()
    );
    Table::rows_of("performance", &parts)
        .caption(caption)
        .column("Work", |(name, _)| *name)
        .column("Seconds", |(_, seconds)| Cell::rounded(*seconds, 3))
        .column("Share", |(_, seconds)| {
            Cell::figures(percent(seconds / record.wall_s))
        })
        .table()
}
