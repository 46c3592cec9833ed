//! The tables of a run's page.

use crate::report::{Section, percent, significant};
use lennard_core::{Cell, Remark, Table};
use lennard_io::RunRecord;

use crate::compare::{ComparedRun, Row, RunFolder, card_table, quantity_words, table};

/// The columns of a reference.
const BESIDE: [&str; 4] = ["Reference", "Difference", "Difference / s.e.", "Tolerance"];

/// What was measured, beside the literature where there is some.
pub(super) fn comparison(compared: &ComparedRun) -> Table {
    let shown = compared.rows.iter().filter(|r| r.primary || r.verdict.is_judged());
    let rows: Vec<&Row> = shown.collect();
    let made = table(&rows, |row| match row.has_long_reason() {
        true => row.verdict.words().to_owned(),
        false => row.verdict_words(),
    });
    match rows.iter().any(|row| row.reference.is_some()) {
        true => made,
        false => made.without(&BESIDE),
    }
}

/// Every measured property beside every equation.
pub(super) fn state_card(compared: &ComparedRun) -> Section {
    let section = Section::new("State card");
    match &compared.card {
        Some(card) => section.text(card.sentence.as_str()).table(card_table(card)),
        None => section.text(format!("No equation of state is shown: {}.", compared.state.words)),
    }
}

/// Reasons that are too long for the table, then sources and remarks: quantities with the same ones share a line.
pub(super) fn notes(compared: &ComparedRun) -> Vec<String> {
    let in_lead = |row: &Row| compared.shared_reason.as_ref() == Some(&row.reason);
    let reasons = (compared.rows.iter())
        .filter(|row| row.primary && row.has_long_reason() && !in_lead(row))
        .map(|row| (row.reason.clone(), row));
    let sources = compared.rows.iter().map(|row| {
        let notes = [row.source.as_str(), row.remark.as_str()];
        let notes: Vec<&str> = notes.into_iter().filter(|t| !t.is_empty()).collect();
        (notes.join("; "), row)
    });
    let mut shared: Vec<(String, Vec<String>)> = Vec::new();
    for (notes, row) in reasons.chain(sources) {
        let words = quantity_words(&row.quantity);
        match shared.iter_mut().find(|(known, _)| *known == notes) {
            _ if notes.is_empty() => {}
            Some((_, quantities)) => quantities.push(words),
            None => shared.push((notes, vec![words])),
        }
    }
    shared
        .into_iter()
        .map(|(notes, quantities)| format!("**{}**: {notes}", quantities.join(", ")))
        .chain(compared.remarks.iter().map(Remark::to_string))
        .collect()
}

pub(super) fn stages(run: &RunFolder) -> Table {
    let scene = &run.scene;
    let caption = format!("Integrator: {}. Model: {}.", scene.method_name(), run.record.model);
    Table::rows_of("stages", &scene.stages)
        .caption(caption)
        .column("Stage", |s| s.name.as_str())
        .column("Steps", |s| s.steps)
        .column("dt [τ]", |s| Cell::rounded(scene.stage_dt(s), 4))
        .column("Thermostat", |s| {
            s.thermostat.as_ref().map_or("none: constant energy".into(), |t| {
                format!("{} at {}", t.name(), s.temperature_in_words())
            })
        })
        .column("Barostat", |s| {
            s.barostat.as_ref().map_or("none: constant volume".into(), |b| {
                format!("{} at {}", b.options.name(), b.pressure_in_words())
            })
        })
        .column("Measured", |s| if s.measure { "yes" } else { "no" })
        .table()
}

/// What this run did not measure.
pub(super) fn left_out(run: &RunFolder) -> Vec<String> {
    let asked: Vec<&str> = run.scene.observables.iter().map(|o| o.options.name()).collect();
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
    let caption = "Means with their standard errors, their number of independent samples as estimated, the samples discarded at the start, \
                   and why a mean has no error. A run is too short by the least that its samples may be worth, which is less than the estimate.";
    Table::rows_of("averages", &rows)
        .caption(caption)
        .column("Quantity", |(row, _)| quantity_words(&row.quantity))
        .measured("Mean", |(_, a)| Some((a.estimate.mean, a.estimate.standard_error)))
        .column("Unit", |(_, a)| &a.unit)
        .column("Independent samples", |(_, a)| Cell::rounded(a.estimate.n_effective, 3))
        .column("Discarded", |(_, a)| a.estimate.equilibration_cut)
        .column(
            "Why no result",
            |(row, a)| {
                if a.is_sound() { String::new() } else { row.verdict_words() }
            },
        )
        .table()
}

/// Where the time went. A few bodies spend it on files, and it says nothing of a step.
pub(super) fn performance(record: &RunRecord, is_fluid: bool) -> Table {
    let stages = record.performance.stages;
    let parts = [
        ("forces", stages.force),
        ("neighbor lists", stages.neighbor),
        ("integration and thermostat", stages.integrate),
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
