//! The tables of a run's page.

use lennard_io::RunRecord;
use lennard_report::{Cell, PageTable, significant, with_error};

use crate::compare::{ComparedRun, RunFolder, quantity_words};
use crate::sweep::verdict_cell;

pub(crate) fn comparison(compared: &ComparedRun) -> PageTable {
    let header = [
        "Quantity",
        "Measured",
        "Reference",
        "Difference",
        "Difference / s.e.",
        "Tolerance",
        "Verdict",
    ];
    let rows = compared
        .rows
        .iter()
        .filter(|r| r.primary || r.verdict.is_judged())
        .map(|r| {
            let number = |x: Option<f64>| x.map_or("–".into(), |x| significant(x, 5));
            let reference = match (r.reference, r.reference_error) {
                (Some(x), Some(e)) => with_error(x, e),
                (x, _) => number(x),
            };
            let difference = match (r.difference, r.combined_error) {
                (Some(d), Some(e)) => with_error(d, e),
                (d, _) => number(d),
            };
            let measured = with_error(r.measured, r.standard_error);
            vec![
                Cell::text(quantity_words(&r.quantity)),
                Cell::number(if r.unit.is_empty() {
                    measured
                } else {
                    format!("{measured} {}", r.unit)
                }),
                Cell::number(reference),
                Cell::number(difference),
                Cell::number(
                    r.in_standard_errors
                        .map_or("–".into(), |z| significant(z, 2)),
                ),
                Cell::number(r.tolerance.map_or("–".into(), |t| significant(t, 2))),
                verdict_cell(r),
            ]
        })
        .collect();
    PageTable {
        caption: "Digits in brackets are one standard error (s.e.) in the last digits; a number without them has none, and the verdict says why. Energy and pressure agree within 4 standard errors and what the \
                  equation of state may be off by (0.003 ε and 0.005 ε/σ³), c_v within 2 standard errors and 2 %, transport coefficients within 2 \
                  combined standard errors and 3 %."
            .into(),
        command: None,
        header: header.map(str::to_owned).to_vec(),
        rows,
    }
}

/// Sources and remarks, quantity by quantity.
pub(super) fn sources(compared: &ComparedRun) -> Vec<String> {
    compared
        .rows
        .iter()
        .filter_map(|r| {
            let notes: Vec<&str> = [r.source.as_str(), r.remark.as_str()]
                .into_iter()
                .filter(|t| !t.is_empty())
                .collect();
            (!notes.is_empty())
                .then(|| format!("**{}**: {}", quantity_words(&r.quantity), notes.join("; ")))
        })
        .chain(compared.remarks.iter().cloned())
        .collect()
}

pub(super) fn stages(run: &RunFolder) -> PageTable {
    let scene = &run.scene;
    let rows = scene
        .stages
        .iter()
        .map(|stage| {
            vec![
                Cell::text(stage.name.clone()),
                Cell::number(stage.steps.to_string()),
                Cell::number(significant(scene.stage_dt(stage), 4)),
                Cell::text(
                    stage
                        .thermostat
                        .as_ref()
                        .map_or("none: constant energy".into(), |t| {
                            format!("{} at T = {}", t.name(), stage.temperature)
                        }),
                ),
                Cell::text(if stage.measure { "yes" } else { "no" }),
            ]
        })
        .collect();
    PageTable {
        caption: format!(
            "Integrator: {}. Model: {}.",
            scene.integrator.method.name(),
            run.record.model
        ),
        command: None,
        header: ["Stage", "Steps", "dt / τ", "Thermostat", "Measured"]
            .map(str::to_owned)
            .to_vec(),
        rows,
    }
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
        Some(frames) => points.push(format!("{frames} frames are in `trajectory.xyz`.")),
        None => points.push("No trajectory was written.".into()),
    }
    points
}

pub(super) fn averages(compared: &ComparedRun, record: &RunRecord) -> PageTable {
    let rows = compared
        .rows
        .iter()
        .filter_map(|row| {
            let a = record.averages.get(&row.quantity)?;
            let standing = if a.is_sound() {
                String::new()
            } else {
                row.verdict_words()
            };
            Some(vec![
                Cell::text(quantity_words(&row.quantity)),
                Cell::number(with_error(a.mean, a.standard_error)),
                Cell::text(a.unit.clone()),
                Cell::number(significant(a.n_effective, 3)),
                Cell::number(a.equilibration_cut.to_string()),
                Cell::text(standing),
            ])
        })
        .collect();
    PageTable {
        caption: "Means with their standard errors, the number of independent samples that they are worth, the samples discarded at the start, and why a \
                  mean has no error."
            .into(),
        command: None,
        header: [
            "Quantity",
            "Mean",
            "Unit",
            "Independent samples",
            "Discarded",
            "Why no result",
        ]
        .map(str::to_owned)
        .to_vec(),
        rows,
    }
}

pub(super) fn performance(record: &RunRecord) -> PageTable {
    let stages = record.performance.stages;
    let named = [
        ("forces", stages.force),
        ("neighbor lists", stages.neighbor),
        ("integration and thermostat", stages.integrate),
        ("observables", stages.observe),
        ("files", stages.write),
    ];
    let mut rows: Vec<Vec<Cell>> = named
        .iter()
        .map(|(name, seconds)| {
            vec![
                Cell::text(*name),
                Cell::number(significant(*seconds, 3)),
                Cell::number(format!("{:.1} %", 100.0 * seconds / record.wall_s)),
            ]
        })
        .collect();
    rows.push(vec![
        Cell::text("whole run"),
        Cell::number(significant(record.wall_s, 3)),
        Cell::number("100 %"),
    ]);
    PageTable {
        caption: format!(
            "Wall time by kind of work: {} steps of {} particles, {} ns per particle and step; {} list builds; {}.",
            record.steps,
            record.atoms,
            significant(record.performance.ns_per_atom_step, 3),
            record.neighbor.builds,
            record.neighbor.forces_checked()
        ),
        command: None,
        header: ["Work", "Seconds", "Share"].map(str::to_owned).to_vec(),
        rows,
    }
}
