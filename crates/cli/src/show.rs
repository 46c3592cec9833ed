//! What a person reads: headers and tables.

mod bench;
mod chart;
mod literature;
mod tune;

pub use bench::bench;
pub use chart::chart;
pub use literature::{compared, sweep, sweep_header};
pub use tune::tuning;

use std::path::Path;

use comfy_table::presets::UTF8_FULL_CONDENSED;
use comfy_table::{CellAlignment, ContentArrangement, Table};
use lennard_engine::{EnergyReport, Plan, Simulation};
use lennard_io::RunRecord;
use lennard_studies::claims::Verdict;
use lennard_studies::compare::ComparedRun;
use lennard_studies::stability::StabilityStudy;

use crate::commands::list::Entry;

/// A table that fits the terminal.
fn table(heading: &[&str], right_aligned: std::ops::Range<usize>) -> Table {
    let mut table = Table::new();
    table
        .load_style(UTF8_FULL_CONDENSED)
        .set_content_arrangement(ContentArrangement::Dynamic)
        .set_header(heading.to_vec());
    for column in right_aligned {
        if let Some(column) = table.column_mut(column) {
            column.set_cell_alignment(CellAlignment::Right);
        }
    }
    table
}

/// A value with its standard error, both to the second digit of the error: `-6.0812 ± 0.0019`.
pub fn with_error(mean: f64, error: f64) -> (String, String) {
    if !(error.is_finite() && error > 0.0) {
        return (format!("{mean:.6}"), "–".into());
    }
    let decimals = (1.0 - error.log10().floor()).clamp(0.0, 17.0) as usize;
    if decimals > 8 {
        return (format!("{mean:.3e}"), format!("{error:.1e}"));
    }
    (format!("{mean:.decimals$}"), format!("{error:.decimals$}"))
}

/// Wall time in words.
pub fn duration(seconds: f64) -> String {
    match seconds {
        s if s < 1e-3 => format!("{:.1} µs", s * 1e6),
        s if s < 1.0 => format!("{:.1} ms", s * 1e3),
        s if s < 120.0 => format!("{s:.1} s"),
        s if s < 7200.0 => format!("{:.1} min", s / 60.0),
        s => format!("{:.1} h", s / 3600.0),
    }
}

/// Bytes in words.
fn bytes(n: u64) -> String {
    match n as f64 {
        b if b < 1e6 => format!("{:.1} kB", b / 1e3),
        b if b < 1e9 => format!("{:.1} MB", b / 1e6),
        b => format!("{:.2} GB", b / 1e9),
    }
}

/// What is about to run.
pub fn header(simulation: &Simulation, threads: usize, folder: &Path) {
    let scene = &simulation.scene;
    let n = simulation.state.len();
    let density = n as f64 / simulation.state.cell.volume();
    let [x, y, z] = simulation.state.cell.lengths().to_array();
    println!("{}", console::style(&scene.name).bold());
    println!("  {n} particles, density {density:.4}, box {x:.4} × {y:.4} × {z:.4} σ");
    println!("  {}", lennard_forcefield::model_name(&scene.force_field()));
    println!(
        "  {}, dt = {} τ, {} steps in {} stages",
        scene.integrator.method.name(),
        scene.integrator.dt,
        scene.total_steps(),
        scene.stages.len()
    );
    println!(
        "  {}, output in {}",
        lennard_report::counted(threads, "thread"),
        folder.display()
    );
}

/// What a run found, and what can be said of it.
pub fn results(record: &RunRecord, compared: &ComparedRun, folder: &Path, all: bool) {
    println!("\n{}", literature::quantities(compared, all));
    literature::below_quantities(compared, all);
    let c = &record.conservation;
    println!(
        "\n  conserved energy: drift {:+.2e} ± {:.1e} ε per particle per τ, fluctuation {:.2e} ε per particle (RMS)",
        c.energy_drift_per_atom_per_tau, c.energy_drift_standard_error, c.energy_rms_per_atom
    );
    if all {
        println!(
            "  largest momentum: {:.1e} σ/τ per particle",
            c.momentum_per_atom
        );
        for remark in &record.remarks {
            println!("  note: {remark}");
        }
    }
    let p = &record.performance;
    println!(
        "  {} steps in {}: {:.2} million atom-steps/s, {:.1} ns per atom-step",
        record.steps,
        duration(record.wall_s),
        p.atom_steps_per_s / 1e6,
        p.ns_per_atom_step
    );
    let s = &p.stages;
    let share = |seconds: f64| {
        format!(
            "{:.0} %",
            100.0 * seconds / record.wall_s.max(f64::MIN_POSITIVE)
        )
    };
    println!(
        "  force {}, neighbor list {}, integrate {}, observe {}, write {}; {} list builds, skin {:.3} σ\n  {}",
        share(s.force),
        share(s.neighbor),
        share(s.integrate),
        share(s.observe),
        share(s.write),
        record.neighbor.builds,
        record.neighbor.skin.unwrap_or(0.0),
        record.neighbor.forces_checked()
    );
    println!("  files in {}", folder.display());
}

/// One evaluation.
pub fn energy(report: &EnergyReport) {
    let from = match report.temperature_from {
        lennard_engine::KineticSource::Velocities => "from the velocities of the file",
        lennard_engine::KineticSource::SceneTemperature => {
            "from the scene's temperature; the start has no velocities"
        }
    };
    println!(
        "{} particles, {} pairs within the cutoff, {}",
        report.atoms, report.pairs, report.model
    );
    let mut t = table(&["quantity", "value", "unit"], 1..2);
    for (name, value, unit) in [
        ("U, pairs", report.potential_energy, "ε"),
        ("U, tail", report.tail_energy, "ε"),
        ("W = Σ r_ij·F_ij, pairs", report.virial, "ε"),
        ("W, tail", report.tail_virial, "ε"),
        ("P = ρT + W/(3V), with tail", report.pressure, "ε/σ³"),
        ("T of the kinetic part", report.temperature, "ε/k_B"),
    ] {
        t.add_row([name.to_owned(), format!("{value:.15e}"), unit.to_owned()]);
    }
    println!("{t}");
    println!("  T is {from}");
}

/// What a scene computes.
pub fn plan(plan: &Plan) {
    println!(
        "{}: {} particles at density {:.4}, {} steps",
        plan.scene, plan.atoms, plan.density, plan.steps
    );
    println!("  {}", plan.model);
    let mut t = table(&["part", "", "share", "how, or why not"], 2..3);
    for item in &plan.items {
        let share = item.share.map_or_else(String::new, |s| match 100.0 * s {
            s if s < 0.05 => "< 0.1 %".to_owned(),
            s => format!("{s:.1} %"),
        });
        t.add_row([
            item.part.as_str(),
            if item.on { "on" } else { "off" },
            share.as_str(),
            item.why.as_str(),
        ]);
    }
    println!("{t}");
    println!(
        "  memory: about {} ({:.0} bytes per particle)",
        bytes(plan.bytes),
        plan.bytes as f64 / plan.atoms as f64
    );
    println!(
        "  time: about {} on {} ({} a step with everything off, median of {} measured steps; shares are those of this measurement, and the start may differ from the rest)",
        duration(plan.estimated_seconds),
        lennard_report::counted(plan.threads, "thread"),
        duration(plan.seconds_per_step),
        plan.measured_steps
    );
}

/// The verdicts of the stability study, and the largest stable steps.
pub fn stability(study: &StabilityStudy, folder: &Path) {
    let mut claims = table(&["source", "claim", "measured", "theory", "verdict"], 2..4);
    for claim in &study.claims {
        let verdict = match claim.verdict {
            Verdict::Holds => "holds",
            Verdict::DoesNotHold => "does not hold",
        };
        claims.add_row([
            claim.source.to_owned(),
            claim.statement.clone(),
            format!("{:.6}", claim.measured),
            claim
                .theory
                .map_or_else(|| "–".into(), |t| format!("{t:.6}")),
            verdict.to_owned(),
        ]);
    }
    println!("{claims}");
    println!("  page: {}", folder.join("report.html").display());
}

/// A list of methods.
pub fn list(entries: &[Entry]) {
    for entry in entries {
        println!("{}", console::style(&entry.name).bold());
        println!("  {}", entry.summary);
        if let Some(equation) = &entry.equation {
            println!("  {equation}");
        }
        for (name, value) in &entry.properties {
            let shown = match value {
                serde_json::Value::Bool(b) => if *b { "yes" } else { "no" }.to_owned(),
                serde_json::Value::Null => "–".to_owned(),
                serde_json::Value::String(s) => s.clone(),
                other => other.to_string(),
            };
            println!("  {name}: {shown}");
        }
        println!("  source: {}", entry.source);
    }
}

#[cfg(test)]
mod tests {
    use super::with_error;

    #[test]
    fn a_mean_is_shown_to_the_second_digit_of_its_error() {
        assert_eq!(
            with_error(-6.081_234, 0.001_94),
            ("-6.0812".into(), "0.0019".into())
        );
        assert_eq!(with_error(0.164_9, 0.032), ("0.165".into(), "0.032".into()));
        assert_eq!(with_error(108.9, 12.0), ("109".into(), "12".into()));
        assert_eq!(with_error(1.0, f64::NAN), ("1.000000".into(), "–".into()));
    }
}
