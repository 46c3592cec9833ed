//! Springs with dashpots in a fluid: what they take is heat, and vibrations stay colder than the rest.

use lennard_engine::Simulation;
use lennard_observables::{Average, Doubt};

use crate::common::{self, DUMBBELLS};

const SCHEMES: [&str; 3] = ["explicit", "midpoint", "linearly-implicit"];

fn run(overrides: &str) -> Simulation {
    common::ran(common::scene(DUMBBELLS, &format!("bonds.method=spring {overrides}")))
}

/// The energy of each row, kinetic and potential.
fn energies(s: &Simulation) -> Vec<f64> {
    let series = s.thermodynamics().series();
    series.kinetic_energy.iter().zip(&series.potential_energy).map(|(k, u)| k + u).collect()
}

/// The change of E over a run, and the RMS of E less the heat.
fn change(s: &Simulation) -> (f64, f64) {
    let energies = energies(s);
    let rms = s.thermodynamics().conservation().energy_rms_per_atom;
    (energies[energies.len() - 1] - energies[0], rms)
}

fn average(s: &Simulation, name: &str) -> Average {
    common::average(&s.findings(), name).expect(name).clone()
}

/// Per molecule and over the run: the change of E, and the RMS of E less the heat.
#[test]
fn what_dashpots_take_is_counted_as_heat() {
    for scheme in SCHEMES {
        for way in [
            "",
            "integrator.kind=respa integrator.inner_steps=2",
            r#"wall=[{ kind = "hard" }] observable=[]"#,
        ] {
            let (heat, rms) = change(&run(&format!(
                "bonds.scheme={scheme} bonds.damping=10.0 bonds.stiffness=1000.0 stage.0.steps=1000
                    output.thermo_every=1 {way}"
            )));
            assert!(heat < -0.3, "{scheme} {way}: {heat}");
            assert!(rms < 0.01, "{scheme} {way}: {rms} beside {heat}");
        }
    }
}

/// Bonds of SPOOK with a compliance are springs with dashpots too: their energy is in U, and what damping takes is heat.
#[test]
fn spook_with_a_compliance_has_the_energy_of_its_springs_and_counts_its_damping() {
    for (damping, sweeps) in [("0.0", "0"), ("2.0", "0"), ("2.0", "50")] {
        for threads in [1, 3] {
            let keys = format!(
                "bonds.method=spook bonds.compliance=1e-4 bonds.damping_steps={damping}
                    bonds.sweeps={sweeps} integrator.kind=spook integrator.dt=0.001
                    stage.0.steps=1000 output.thermo_every=1"
            );
            let s = common::on_threads(threads, || run(&keys));
            let (change, rms) = change(&s);
            // Half a step of velocities is some s/2 = 7 % of the vibrations' share of ε.
            assert!(rms < 0.1, "{damping} {sweeps}: {rms}");
            assert_eq!(damping != "0.0", change < -0.5, "{damping} {sweeps}: {change}");
            let conserved = &s.thermodynamics().series().conserved_energy;
            let off = conserved[conserved.len() - 1] - conserved[0];
            assert!(off.abs() < 0.12, "{damping} {sweeps}: {off} of {change}");
        }
    }
}

/// A vibration that loses speed at the rates γ to a bath of T and β = c·κ to its dashpot has T·γ/(γ + β) in molecules without other forces.
#[test]
fn vibrations_with_dashpots_stay_colder_than_their_bath_and_means_say_so() {
    for scheme in &SCHEMES[..2] {
        let with = |damping: &str| {
            run(&format!(
                r#"bonds.scheme={scheme} bonds.damping={damping} bonds.stiffness=4000.0
                    potential={{ kind = "none" }} truncation={{}} integrator.dt=0.003
                    stage.0.steps=6000
                    stage.0.thermostat={{ kind = "langevin", friction = 5.0 }}"#
            ))
        };
        let [free, weak, damped] = ["0.0", "0.02", "10.0"].map(with);
        let mean = |s: &Simulation, of: &str| {
            let name = format!("temperature_of_{of}");
            average(s, &name).estimate.mean
        };
        // ωh = 0.27, whose square over 4 is missing at whole steps.
        for of in ["centers", "rotation", "vibration"] {
            let t = mean(&free, of);
            assert!((t - 2.0).abs() < 0.1, "{scheme}: T of {of} {t}");
        }
        // γ = 5 and β = 20: a fifth of 2.
        let t = mean(&damped, "vibration");
        assert!((t - 0.4).abs() < 0.06, "{scheme}: T of vibration {t}");
        let t = mean(&damped, "rotation");
        assert!((t - 2.0).abs() < 0.15, "{scheme}: T of rotation {t}");
        let doubt = |s: &Simulation| average(s, "temperature_of_centers").doubt;
        let is_by_bonds = |doubt: Option<Doubt>| {
            doubt.is_some_and(|d| d.reason(1).contains("take energy from vibrations"))
        };
        assert!(is_by_bonds(doubt(&weak)), "{:?}", doubt(&weak));
        assert!(!is_by_bonds(doubt(&free)), "{:?}", doubt(&free));
        // Fluctuations are of no known ensemble.
        let has_heat_capacity = |s: &Simulation| {
            let all = s.findings();
            let mut averages = all.iter().flat_map(|found| &found.averages);
            averages.any(|a| a.name == "heat_capacity")
        };
        assert!(has_heat_capacity(&free) && !has_heat_capacity(&weak));
        // A mean over all degrees of freedom is off so far that the fluid is not at the temperature of its bath.
        let far = average(&damped, "temperature").doubt;
        let is_far = matches!(far, Some(Doubt::NotInEquilibrium(_)));
        assert!(is_far, "{far:?}");
    }
}

/// The watchdog allows 1 ε per site: a chain of 64 has 63 bonds, whose energies of half steps add up.
#[test]
fn a_long_chain_may_change_its_energy_by_more_than_a_dumbbell() {
    let s = run("system.n_molecules=8 start.lattice=sc system.density=0.00005 molecule.kind=chain
        molecule.sites=64 molecule.bond_length=1.0 bonds.method=spook bonds.compliance=1e-4
        bonds.damping_steps=0.0 integrator.kind=spook integrator.dt=0.001 output.thermo_every=1");
    let conserved = &s.thermodynamics().series().conserved_energy;
    let off = conserved.iter().map(|e| (e - conserved[0]).abs());
    let largest = off.fold(0.0, f64::max);
    // Beyond the limit for one site, and far below the limit for 64.
    assert!(largest > 1.0 && largest < 10.0, "{largest}");
}
