//! What a person reads: headers and tables.

mod bench;
mod chart;
mod eos;
mod list;
mod literature;
mod plan;
mod tables;
mod tune;

pub use bench::bench;
pub use chart::{chart, ensembles};
pub use eos::{coexistence, curve, freezing, state};
pub use list::{entries, list};
pub use literature::{compared, sweep, sweep_header};
pub use plan::plan;
pub use tune::tuning;

use std::path::Path;

use lennard_core::{Cell, Table};
use lennard_engine::{EnergyReport, Simulation};
use lennard_io::{Conservation, RunRecord};
use lennard_studies::claims::{self, Claim};
use lennard_studies::compare::ComparedRun;
use lennard_studies::report::{signed, significant};

use tables::{narrow_table, table};

use crate::program::out;

/// Columns of a terminal for which tables are made, and of output that no terminal shows.
const WIDTH: u16 = 100;

/// Prints a note below a table, in lines that fit the terminal.
fn note(text: &str) {
    for line in wrapped(text) {
        println!("{line}");
    }
}

/// Lines of at most [`WIDTH`] columns: the first stands two columns to the right, the others four.
fn wrapped(text: &str) -> Vec<String> {
    let mut lines = Vec::new();
    let mut line = String::from(" ");
    for word in text.split(' ') {
        let width = line.chars().count() + 1 + word.chars().count();
        if width > usize::from(WIDTH) && !line.trim().is_empty() {
            lines.push(std::mem::replace(&mut line, String::from("   ")));
        }
        line.push(' ');
        line.push_str(word);
    }
    lines.push(line);
    lines
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
    let molecules = simulation.system.n_molecules();
    let density = molecules as f64 / simulation.state.cell.volume();
    let [x, y, z] = simulation.state.cell.lengths().to_array();
    out::heading(&scene.name);
    let particles = lennard_studies::report::particles(n, molecules);
    println!("  {particles}, density {density:.4}, box {x:.4} × {y:.4} × {z:.4} σ");
    println!("  {}", scene.model_name());
    println!(
        "  {}, dt = {} τ, {} steps in {}",
        scene.method_name(),
        lennard_core::number::short(scene.integrator.dt),
        scene.total_steps(),
        lennard_studies::report::counted(scene.stages.len(), "stage")
    );
    let threads = lennard_studies::report::counted(threads, "thread");
    let workers = match &simulation.team {
        None => threads,
        Some(team) => {
            let ranks = lennard_studies::report::counted(team.ranks(), "rank");
            format!("{ranks} with {threads} each")
        }
    };
    println!("  {workers}, output in {}", folder.display());
    if simulation.team.is_some() && !simulation.shares_forces {
        println!("  each rank computes all pair forces: this search for pairs has no shared form");
    }
}

/// What a run found, and what can be said of it.
pub fn results(record: &RunRecord, compared: &ComparedRun, folder: &Path, verbose: bool) {
    if compared.is_of_few_bodies() && !verbose {
        println!();
        literature::headline(compared);
        println!("  last state: {}", folder.join("final.xyz").display());
    } else {
        println!("\n{}", literature::quantities(compared, verbose));
        literature::below_quantities(compared, verbose);
    }
    if verbose {
        literature::state_card(compared);
    }
    println!();
    note(&conserved_energy(&record.conservation, energy_unit(record)));
    if let Some(words) = record.barostat.as_ref().and_then(|b| b.acceptance_in_words()) {
        println!("  {words}");
    }
    for remark in record.remarks.iter().filter(|r| r.starts_with("barostat: ") && !verbose) {
        note(&format!("note: {remark}"));
    }
    if verbose {
        println!(
            "  largest momentum: {:.1e} σ/τ per particle",
            record.conservation.momentum_per_atom
        );
        for remark in &record.remarks {
            note(&format!("note: {remark}"));
        }
    }
    let p = &record.performance;
    // The time of a few bodies goes to files and rows, and says nothing of a step.
    let speed = match compared.is_of_few_bodies() {
        true => String::new(),
        false => format!(
            ": {:.2} million atom-steps/s, {:.1} ns per atom-step",
            p.atom_steps_per_s / 1e6,
            p.ns_per_atom_step
        ),
    };
    println!("  {} steps in {}{speed}", record.steps, duration(record.wall_s));
    if let Some(ranks) = &p.ranks {
        let number = lennard_studies::report::counted(ranks.ranks as usize, "rank");
        let halo = match ranks.shared_forces {
            true => format!("rank 0 got {:.0} particles of others for its lists", ranks.halo),
            false => "pair forces were not shared".to_owned(),
        };
        println!(
            "  {number}: {:.0} % of the time in messages; {halo}",
            100.0 * ranks.communication
        );
    }
    if verbose {
        where_the_time_went(record);
    }
    if folder.join(PAGE).exists() {
        println!("  page: {}", folder.join(PAGE).display());
    } else {
        println!("  files in {}", folder.display());
    }
}

/// The page of a run or a study.
const PAGE: &str = "report.html";

/// Shares of the wall time, and what the lists did.
fn where_the_time_went(record: &RunRecord) {
    let s = &record.performance.stages;
    let share =
        |seconds: f64| format!("{:.0} %", 100.0 * seconds / record.wall_s.max(f64::MIN_POSITIVE));
    println!(
        "  force {}, neighbor list {}, integrate {}, observe {}, write {}",
        share(s.force),
        share(s.neighbor),
        share(s.integrate),
        share(s.observe),
        share(s.write)
    );
    println!(
        "  {} list builds, skin {:.3} σ; {}",
        record.neighbor.builds,
        record.neighbor.skin.unwrap_or(0.0),
        record.neighbor.forces_checked()
    );
}

/// The unit of energies: per particle, or per molecule.
fn energy_unit(record: &RunRecord) -> &str {
    let average = record.averages.get("conserved_energy");
    average.map_or("ε per particle", |average| &average.unit)
}

/// How well the energy was conserved, in words.
fn conserved_energy(c: &Conservation, energy: &str) -> String {
    let (drift, error) = (c.energy_drift_per_atom_per_tau, c.energy_drift_standard_error);
    let unit = format!("{energy} per τ");
    let drift = match (drift.is_finite(), error.is_finite()) {
        (true, true) => format!("drift {} ± {} {unit}", signed(drift, 3), significant(error, 2)),
        (true, false) => {
            format!("drift {} {unit} (too few samples for an error)", signed(drift, 3))
        }
        (false, _) => "too few samples for a drift".to_owned(),
    };
    let rms = c.energy_rms_per_atom;
    if !rms.is_finite() {
        return format!("conserved energy: {drift}");
    }
    let rms = significant(rms, 3);
    format!("conserved energy: {drift}, fluctuation {rms} {energy} (RMS)")
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
        "{}, {} pairs within the cutoff, {}",
        lennard_studies::report::particles(report.atoms, report.molecules),
        report.pairs,
        report.model
    );
    let pressure = if report.atoms == report.molecules {
        "P = ρT + W/(3V), with tail"
    } else {
        "P over centres of mass, with tail"
    };
    let values = [
        ("U, pairs", report.potential_energy, "ε"),
        ("U, tail", report.tail_energy, "ε"),
        ("W = Σ r_ij·F_ij, pairs", report.virial, "ε"),
        ("W, tail", report.tail_virial, "ε"),
        (pressure, report.pressure, "ε/σ³"),
        ("T of the kinetic part", report.temperature, "ε/k_B"),
    ];
    let values = Table::rows_of("energy", &values)
        .column("quantity", |v| v.0)
        .column("value", |v| Cell::figures(format!("{:.15e}", v.1)))
        .column("unit", |v| v.2);
    println!("{}", table(&values.table()));
    println!("  T is {from}");
}

/// The verdicts of a study of claims.
pub fn verdicts(found: &[Claim], folder: &Path) {
    let claims = claims::table(found).without(&["Judged by", "Wanted"]);
    println!("{}", table(&claims));
    println!("  page: {}", folder.join("report.html").display());
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn notes_are_wrapped_between_words() {
        let lines = wrapped(&["word"; 40].join(" "));
        assert_eq!(lines.len(), 3);
        assert!(lines.iter().all(|l| l.chars().count() <= 100), "{lines:?}");
        assert!(lines[0].starts_with("  word") && lines[1].starts_with("    word"));
        let long = "x".repeat(200);
        assert_eq!(wrapped(&long), [format!("  {long}")]);
    }

    #[test]
    fn a_drift_without_an_error_says_why() {
        let said = |drift, error, rms| {
            conserved_energy(
                &Conservation {
                    energy_drift_per_atom_per_tau: drift,
                    energy_drift_standard_error: error,
                    energy_rms_per_atom: rms,
                    momentum_per_atom: 0.0,
                },
                "ε per particle",
            )
        };
        let end = ", fluctuation 5.40·10⁻⁵ ε per particle (RMS)";
        for (drift, error, words) in [
            (-1.04e-7, 4.5e-7, "drift −1.04·10⁻⁷ ± 4.5·10⁻⁷ ε per particle per τ"),
            (2e-3, f64::NAN, "drift +0.00200 ε per particle per τ (too few samples for an error)"),
            (f64::NAN, f64::NAN, "too few samples for a drift"),
        ] {
            assert_eq!(said(drift, error, 5.4e-5), format!("conserved energy: {words}{end}"));
        }
        // Of two samples there is no fluctuation about a line.
        let none = said(f64::NAN, f64::NAN, f64::NAN);
        assert_eq!(none, "conserved energy: too few samples for a drift");
    }

    #[test]
    fn numbers_stand_on_the_right_and_errors_beside_them() {
        let items = [("a", Some((1.5, 0.25))), ("longer", None)];
        let items =
            Table::rows_of("t", &items).column("name", |i| i.0).measured("x [σ]", |i| i.1).table();
        let text = table(&items).to_string();
        for line in
            ["│ name   ┆       x / σ │", "│ a      ┆ 1.50 ± 0.25 │", "│ longer ┆           – │"]
        {
            assert!(text.contains(line), "{line} in\n{text}");
        }
    }
}
