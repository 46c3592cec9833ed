//! What a run is about to do, and what it has found; one evaluation.

use std::path::Path;

use lennard_core::number::short;
use lennard_engine::{EnergyReport, KineticSource, Simulation};
use lennard_io::{Conservation, RunRecord};
use lennard_observables::{Cell, Remark, Table};
use lennard_studies::compare::ComparedRun;
use lennard_studies::report::{Section, counted, particles, physical, signed, significant};

use super::literature;
use super::text::duration;

/// The page of a run or a study.
const PAGE: &str = "report.html";

/// What is about to run.
pub fn header(simulation: &Simulation, threads: usize, folder: &Path) -> Section {
    let scene = &simulation.scene;
    let n = simulation.system.len();
    let molecules = simulation.system.n_molecules();
    let density = molecules as f64 / simulation.state.cell.volume();
    let [x, y, z] = simulation.state.cell.lengths().to_array();
    let of_particles = particles(n, molecules);
    let threads = counted(threads, "thread");
    let workers = match simulation.team() {
        None => threads,
        Some(team) => format!("{} with {threads} each", counted(team.ranks(), "rank")),
    };
    Section::new(scene.name.to_string())
        .text(format!("{of_particles}, density {density:.4}, box {x:.4} × {y:.4} × {z:.4} σ"))
        .text(scene.model_name())
        .texts(simulation.trajectory().is_none().then(|| {
            format!(
                "{}, dt = {} τ, {} steps in {}",
                scene.method_name(),
                short(scene.integrator.dt),
                scene.total_steps(),
                counted(scene.stages.len(), "stage")
            )
        }))
        .texts(scene.units.map(|units| {
            let said = |value, unit| physical(&units, value, unit);
            let temperature = said(scene.system.temperature, "ε/k_B");
            let (density, dt) = (said(density, "σ⁻³"), said(scene.integrator.dt, "τ"));
            format!("{}: {temperature}, {density}, dt = {dt}", units.substance.name)
        }))
        .text(format!("{workers}, output in {}", folder.display()))
}

/// What a run found, and what can be said of it.
pub fn results(
    record: &RunRecord,
    compared: &ComparedRun,
    folder: &Path,
    verbose: bool,
) -> Section {
    let section = Section::new("").text("");
    let section = if compared.is_of_few_bodies() && !verbose {
        let last = folder.join("final.xyz");
        section.heading(&compared.headline).text(format!("last state: {}", last.display()))
    } else {
        literature::quantities(section, compared, verbose)
    };
    let section =
        if verbose { literature::state_card(section, compared, verbose) } else { section };
    let is_measured = record.trajectory.is_some();
    let of_barostat = |remark: &&Remark| match remark {
        Remark::SlowBox { .. } => true,
        Remark::LeftOut { .. } => is_measured,
        _ => false,
    };
    let remarks = match verbose {
        true => record.remarks.clone(),
        false => record.typed_remarks.iter().filter(of_barostat).map(Remark::to_string).collect(),
    };
    let momentum = (verbose && !is_measured).then(|| {
        let momentum = record.conservation.momentum_per_atom;
        format!("largest momentum: {momentum:.1e} σ/τ per particle")
    });
    let page = folder.join(PAGE);
    section
        .text("")
        .texts((!is_measured).then(|| conserved_energy(&record.conservation, energy_unit(record))))
        .texts(record.barostat.as_ref().and_then(|b| b.acceptance_in_words()))
        .texts(momentum)
        .texts(remarks.iter().map(|remark| format!("note: {remark}")))
        .text(speed(record, compared.is_of_few_bodies()))
        .texts(ranks(record))
        .texts(verbose.then(|| where_the_time_went(record)).into_iter().flatten())
        .text(match page.exists() {
            true => format!("page: {}", page.display()),
            false => format!("files in {}", folder.display()),
        })
}

/// How long the run took. The time of a few bodies goes to files and rows, and says nothing of a step.
fn speed(record: &RunRecord, is_of_few_bodies: bool) -> String {
    let p = &record.performance;
    let what = if record.trajectory.is_some() { "frames" } else { "steps" };
    let took = format!("{} {what} in {}", record.steps, duration(record.wall_s));
    match is_of_few_bodies || record.trajectory.is_some() {
        true => took,
        false => format!(
            "{took}: {:.2} million atom-steps/s, {:.1} ns per atom-step",
            p.atom_steps_per_s / 1e6,
            p.ns_per_atom_step
        ),
    }
}

/// What several ranks did.
fn ranks(record: &RunRecord) -> Option<String> {
    let ranks = record.performance.ranks.as_ref()?;
    Some(format!(
        "{}: {:.0} % of the time in messages; rank 0 got {:.0} particles of others for its lists",
        counted(ranks.ranks as usize, "rank"),
        100.0 * ranks.communication,
        ranks.halo
    ))
}

/// Shares of the wall time, and what the lists did.
fn where_the_time_went(record: &RunRecord) -> [String; 2] {
    let s = &record.performance.stages;
    let share =
        |seconds: f64| format!("{:.0} %", 100.0 * seconds / record.wall_s.max(f64::MIN_POSITIVE));
    [
        format!(
            "force {}, neighbor list {}, integrate {}, observe {}, write {}",
            share(s.force),
            share(s.neighbor),
            share(s.integrate),
            share(s.observe),
            share(s.write)
        ),
        format!(
            "{} list builds, skin {:.3} σ; {}",
            record.neighbor.builds,
            record.neighbor.skin.unwrap_or(0.0),
            record.neighbor.forces_checked()
        ),
    ]
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
pub fn energy(report: &EnergyReport) -> Section {
    let from = match report.temperature_from {
        KineticSource::Velocities => "from the velocities of the file",
        KineticSource::SceneTemperature => {
            "from the scene's temperature; the start has no velocities"
        }
    };
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
    let of_particles = particles(report.atoms, report.molecules);
    let (pairs, model) = (report.pairs, &report.model);
    Section::new(format!("{of_particles}, {pairs} pairs within the cutoff, {model}"))
        .table(values.table())
        .text(format!("T is {from}"))
        .texts(&report.remarks)
}

#[cfg(test)]
mod tests {
    use super::*;

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
}
