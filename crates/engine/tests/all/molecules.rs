//! Fluids of molecules: identities of the pressure, and files that bring them back.

use lennard_core::exact::exact_sum;
use lennard_core::{Configuration, DVec3, Part, PeriodicBox, Want, rigid};
use lennard_engine::{Simulation, StopAt, Unfollowed, prepare};
use lennard_scene::Scene;

use crate::common::{self, DUMBBELLS, MTK, TRIANGLE, contains, follow, prepared, ran, refused};

fn scene(overrides: &str) -> Scene {
    common::scene(DUMBBELLS, overrides)
}

fn build(overrides: &str) -> Simulation {
    prepared(scene(overrides))
}

#[test]
fn bonds_keep_their_length_and_velocities_have_no_part_along_them() {
    for (way, tolerance) in [("direct", 1e-14), ("relaxation", 1.1e-10)] {
        let s = ran(scene(&format!("bonds.method={way} stage.0.steps=2000")));
        let sums = rigid::constraint_sums(&s.system, &s.state);
        assert!(sums.largest_residual <= tolerance, "{way}: {sums:?}");
        for (x, v) in s.state.positions.chunks(2).zip(s.state.velocities.chunks(2)) {
            let along = (x[1] - x[0]).dot(v[1] - v[0]).abs();
            assert!(along < 1e-9, "{way}: {along:e}");
        }
        let n_dof = s.view().n_dof();
        assert_eq!(n_dof, 6.0 * 108.0 - 108.0 - 3.0);
    }
}

#[test]
fn reversed_velocities_lead_a_fluid_back_over_1000_steps() {
    let mut s = build("bonds.tolerance=1e-13 stage.0.steps=2000 truncation.kind=force-shift");
    let first = s.state.positions.clone();
    for stop in [1000, 2000] {
        s.follow(&mut StopAt::new(stop)).unwrap_or_else(|e| panic!("{e}"));
        s.state.velocities.iter_mut().for_each(|v| *v = -*v);
    }
    let off = s.state.positions.iter().zip(&first);
    let off = off.map(|(x, y)| (*x - *y).length()).fold(0.0, f64::max);
    assert!(off < 1e-9, "{off:e}");
}

/// Long steps of the far force inside which the near force and the bonds have short ones.
#[test]
fn respa_holds_bonds_and_keeps_the_energy_as_its_inner_steps_do() {
    let kept = |overrides: &str| {
        let smooth = "truncation.kind=switch truncation.switch_from=2.0 output.thermo_every=5";
        let s = ran(scene(&format!("{smooth} {overrides}")));
        let sums = rigid::constraint_sums(&s.system, &s.state);
        assert!(sums.largest_residual < 1e-14, "{sums:?}");
        for (x, v) in (s.state.positions.chunks(2)).zip(s.state.velocities.chunks(2)) {
            let along = (x[1] - x[0]).dot(v[1] - v[0]).abs();
            assert!(along < 1e-12, "{along:e}");
        }
        let found = s.thermodynamics().conservation();
        (found.energy_rms_per_atom, s.state.positions.clone())
    };
    let respa = |dt: &str, steps: &str| {
        kept(&format!("integrator.kind=respa integrator.dt={dt} stage.0.steps={steps}"))
    };
    let (coarse, _) = respa("0.008", "250");
    let (fine, _) = respa("0.004", "500");
    let ratio = coarse / fine;
    assert!((3.0..5.5).contains(&ratio), "{ratio}: {coarse:e} {fine:e}");
    // Steps of all forces that are as long as the long steps are worse by far.
    let (plain, _) = kept("integrator.dt=0.008 stage.0.steps=250");
    assert!(coarse < 0.5 * plain, "{coarse:e} {plain:e}");
    // Both follow one path while it is short.
    let short = |kind: &str| {
        kept(&format!("integrator.kind={kind} integrator.dt=0.0005 stage.0.steps=200")).1
    };
    let off = short("respa")
        .iter()
        .zip(&short("velocity-verlet"))
        .map(|(a, b)| (*a - *b).length())
        .fold(0.0, f64::max);
    assert!(off < 1e-4 && off > 0.0, "{off:e}");
}

/// For rigid dumbbells 2K + W_pairs + W_constraints = Σ M V² + Σ R_ab·F_ab at each instant.
#[test]
fn the_virials_of_sites_and_of_molecules_agree_at_each_instant() {
    let mut s = build("stage.0.thermostat=bussi stage.0.steps=1000");
    for stop in [10, 200, 500, 1000] {
        s.follow(&mut StopAt::new(stop)).unwrap_or_else(|e| panic!("{e}"));
        let view = s.view();
        let pairs = s.state.energetics.scalar_virial().expect("a sampled step");
        let w = rigid::constraint_sums(&s.system, &s.state).virial;
        let of_sites = 2.0 * view.kinetic_energy() + pairs + w.x_axis.x + w.y_axis.y + w.z_axis.z;
        let centers: f64 = exact_sum(s.system.n_molecules(), |m| {
            let v = &s.state.velocities[s.system.molecules.sites_of(m)];
            0.5 * (v[0] + v[1]).length_squared()
        });
        let of_molecules = centers + pairs - view.intramolecular_virial();
        let scale = 2.0 * view.kinetic_energy();
        assert!(
            (of_sites - of_molecules).abs() <= 1e-12 * scale,
            "step {stop}: {of_sites} {of_molecules}"
        );
    }
}

/// The molecular virial is −3V·∂U/∂V under a scaling of the centres of mass alone.
#[test]
fn the_molecular_virial_is_the_derivative_of_the_energy() {
    let mut s = ran(scene("stage.0.steps=500 stage.0.thermostat=bussi"));
    let lengths = s.state.cell.lengths();
    let mut energy_at = |stretch: f64| {
        let cell = PeriodicBox::new(lengths * stretch).unwrap();
        let molecules = &s.system.molecules;
        let mut positions = s.state.positions.clone();
        for (m, sites) in positions.chunks_mut(molecules.sites()).enumerate() {
            let center = molecules.center(&s.system.masses, m * molecules.sites(), sites);
            for r in sites {
                *r += (stretch - 1.0) * center;
            }
        }
        let mut forces = vec![DVec3::ZERO; positions.len()];
        let at = Configuration::at_rest(&cell, &positions);
        let found = s.forces.evaluate(at, Part::All, Want::ENERGY, &mut forces);
        found.unwrap().potential_energy.unwrap()
    };
    let h = 3e-6;
    let slope = (energy_at(1.0 + h) - energy_at(1.0 - h)) / (2.0 * h);
    let view = s.view();
    let molecular = s.state.energetics.scalar_virial().unwrap() - view.intramolecular_virial();
    // dU/dλ at λ = 1 is 3V·∂U/∂V = −W.
    assert!((slope + molecular).abs() < 1e-7 * molecular.abs().max(100.0), "{slope} {molecular}");
}

#[test]
fn a_run_goes_on_from_a_file_of_molecules_folded_into_the_box() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("start.xyz");
    let first = ran(scene("stage.0.steps=300 stage.0.thermostat=bussi"));
    let style =
        lennard_io::FrameStyle { sites_per_molecule: 2, ..lennard_io::FrameStyle::default() };
    let write = |state: &lennard_core::State, path: &std::path::Path| {
        lennard_io::write_frame(path, &style, &lennard_io::Frame { state, extra: &[] }).unwrap();
    };
    // Image flags forgotten: some molecules are cut by a face of the box.
    let mut folded = first.state.clone();
    for r in &mut folded.positions {
        *r = first.state.cell.wrap(*r);
    }
    write(&folded, &path);
    let text = "start = { kind = \"file\", file = \"start.xyz\" }".to_owned()
        + &DUMBBELLS.replace("n_molecules = 108, density = 0.4, ", "");
    let load = |path: &std::path::Path, text: &str| {
        let scene = path.with_extension("toml");
        std::fs::write(
            &scene,
            text.replace("start.xyz", path.file_name().unwrap().to_str().unwrap()),
        )
        .unwrap();
        prepare(Scene::load(&scene, &[]).unwrap_or_else(|e| panic!("{e}")))
    };
    let mut again = load(&path, &text).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(again.system.n_molecules(), 108);
    assert!(rigid::constraint_sums(&again.system, &again.state).largest_residual < 1e-8);
    follow(&mut again);
    // A bond that is too long, and a file that holds half a molecule.
    let mut broken = folded.clone();
    let cell = &first.state.cell;
    let bond = cell.minimum_image(broken.positions[1] - broken.positions[0]);
    broken.positions[1] += 0.01 * bond;
    let path = folder.path().join("broken.xyz");
    write(&broken, &path);
    let words = [
        "a bond of 0.676700 σ between particles 1 and 2 of ",
        "broken.xyz (counted from 1)",
        "molecule.bond_length = 0.67",
    ];
    contains(&refused(load(&path, &text)), &words);
    let mut odd = folded;
    for array in [&mut odd.positions, &mut odd.velocities, &mut odd.forces] {
        array.pop();
    }
    let path = folder.path().join("odd.xyz");
    write(&odd, &path);
    contains(&refused(load(&path, &text)), &["a multiple of molecule.sites = 2"]);
}

/// A step far too long turns a bond by more than a right angle: physics stops the run, and says which bond.
#[test]
fn a_bond_that_turns_too_far_stops_the_run() {
    for walls in ["[]", r#"[{ kind = "hard" }]"#] {
        let hot = "integrator.dt=0.2 system.temperature=10.0 system.density=0.01 observable=[]";
        let failed = build(&format!("{hot} wall={walls}")).follow(&mut Unfollowed);
        let words = [" (counted from 1) turned too far in one step", "take a smaller dt"];
        contains(&refused(failed), &words);
    }
}

#[test]
fn a_barostat_moves_molecules_by_their_centres_and_keeps_what_is_inside() {
    let rescaling =
        "{ kind = \"stochastic-cell-rescaling\", pressure = 1.0, tau = 0.2, interval = 5 }";
    let baths = [("bussi", rescaling), ("nose-hoover", MTK)];
    let ways = ["bonds.method=direct", "bonds.method=spring", TRIANGLE];
    for (way, (thermostat, barostat)) in ways.iter().flat_map(|way| baths.map(|bath| (*way, bath)))
    {
        let held = format!("stage.0.thermostat={thermostat} stage.0.barostat={barostat}");
        let mut s = build(&format!("{held} observable=[] {way}"));
        let start = s.state.cell.volume();
        follow(&mut s);
        assert!((s.state.cell.volume() / start - 1.0).abs() > 1e-3, "{way:?}");
        let molecules = &s.system.molecules;
        let longest = |x: &[DVec3]| {
            let strain =
                |bond: &lennard_core::Bond| (bond.vector(x).length() / bond.length - 1.0).abs();
            molecules.bonds().iter().map(strain).fold(0.0, f64::max)
        };
        let strain = (s.state.positions.chunks(molecules.sites())).map(longest).fold(0.0, f64::max);
        let limit = if molecules.are_rigid() { 1e-9 } else { 0.2 };
        assert!(strain < limit, "{strain} {way:?}");
    }
}

#[test]
fn an_ideal_gas_of_rigid_dumbbells_has_the_volume_of_its_centres() {
    // Without pair forces p(V) ∝ V^(M − 1)·e^(−P₀V/T) for M molecules without total momentum: ⟨V⟩ = M·T/P₀.
    let barostat = "{ kind = \"stochastic-cell-rescaling\", pressure = 0.5, tau = 0.05, interval = 1, compressibility = 2.0 }";
    let (mean, error) = volume_of_a_gas("bussi", barostat, "none");
    assert!(error < 1.5 && (mean - 128.0).abs() < 4.0 * error, "{mean} ± {error}");
}

/// The mean volume of 32 dumbbells at T = 2 over 240 τ, with its error.
fn volume_of_a_gas(thermostat: &str, barostat: &str, potential: &str) -> (f64, f64) {
    let s = ran(scene(&format!(
        "system.n_molecules=32 system.density=0.25 potential={{ kind = \"{potential}\" }}
            truncation={{}}
            stage.0.thermostat={thermostat} stage.0.barostat={barostat} stage.0.steps=120000
            observable=[]"
    )));
    let changing: &lennard_observables::ChangingBox = s.observable().unwrap();
    let found = [lennard_observables::Observable::finish(changing, 0.05)];
    let volume = common::average(&found, "volume").unwrap();
    (volume.estimate.mean, volume.estimate.standard_error)
}

#[test]
#[ignore = "ten seconds of a processor: run by `cargo xtask physics`"]
fn both_barostats_give_a_gas_of_dumbbells_the_same_volume() {
    // Dumbbells that repel each other: their hits share the energy among all degrees of freedom. One molecule in 32 would be 3 %.
    let rescaling = "{ kind = \"stochastic-cell-rescaling\", pressure = 0.5, tau = 0.1, interval = 2, compressibility = 1.0 }";
    let mtk = "{ kind = \"mtk\", pressure = 0.5, tau = 0.5 }";
    let (a, of_a) = volume_of_a_gas("bussi", rescaling, "wca");
    let (b, of_b) = volume_of_a_gas("nose-hoover", mtk, "wca");
    let error = of_a.hypot(of_b);
    assert!(error < 0.012 * a && (a - b).abs() < 4.0 * error, "{a} ± {of_a}, {b} ± {of_b}");
}

#[test]
fn the_deterministic_barostat_conserves_its_energy_with_molecules_to_the_square_of_the_step() {
    for way in ["bonds.method=direct", "bonds.method=spring bonds.stiffness=500.0", TRIANGLE] {
        let off = |dt: &str, steps: &str| {
            let s = ran(scene(&format!(
                "stage.0.thermostat=nose-hoover stage.0.barostat={MTK} observable=[]
                    integrator.dt={dt} stage.0.steps={steps} {way}"
            )));
            s.thermodynamics().conservation().energy_rms_per_atom
        };
        let (coarse, fine) = (off("0.004", "500"), off("0.002", "1000"));
        let order = (coarse / fine).log2();
        assert!((order - 2.0).abs() < 0.35 && fine < 2e-3, "{way:?}: {coarse} {fine}");
    }
}

#[test]
fn rigid_molecules_between_walls_that_are_hit_keep_energy_and_bonds_and_both_walls_feel_them_alike()
{
    for way in ["bonds.method=direct", TRIANGLE] {
        let rms = |dt: &str, steps: &str| {
            let s = ran(scene(&format!(
                r#"wall=[{{ kind = "hard" }}] observable=[{{ kind = "wall-pressure" }}]
                    integrator.dt={dt} stage.0.steps={steps} {way}"#
            )));
            let walls = s.forces.walls();
            assert!(walls.iter().all(|wall| wall.hits > 5), "{walls:?}");
            let [lower, upper] = [walls[0].impulse, walls[1].impulse];
            assert!((lower / upper - 1.0).abs() < 0.3, "{lower} {upper}");
            let slit = s.scene.slits(&s.state.cell)[0];
            for x in &s.state.positions {
                assert!(x.z > slit.lower - 1e-9 && x.z < slit.upper + 1e-9, "{x}");
            }
            let residual = s.view().constraint_sums().largest_residual;
            assert!(residual < 1e-10, "{residual}");
            s.thermodynamics().conservation().energy_rms_per_atom
        };
        let (coarse, fine) = (rms("0.004", "1000"), rms("0.002", "2000"));
        let order = (coarse / fine).log2();
        assert!(order > 1.3 && fine < 2e-3, "{way:?}: {coarse} {fine}");
    }
}

#[test]
fn a_step_that_is_long_for_springs_is_told_and_a_shorter_one_is_not() {
    let told = |stiffness: &str| {
        let s = build(&format!("bonds.method=spring bonds.stiffness={stiffness}"));
        let mut remarks = s.remarks.iter();
        remarks.any(|r| r.contains("is long for the springs of the bonds: ω·dt = 0.89"))
    };
    // ω = √(2k) per τ, and dt = 0.002 τ.
    assert!(told("100000.0"));
    assert!(!told("30000.0"));
}

/// The rule along the new bond drifts: it samples no ensemble, so its means bear a doubt and have no fluctuation formulas.
#[test]
fn bonds_along_the_new_direction_sample_no_known_ensemble() {
    for (direction, is_known) in [("old", true), ("new", false)] {
        let s = ran(scene(&format!(
            r#"bonds.method=relaxation bonds.direction={direction} stage.0.steps=8000
                stage.0.thermostat={{ kind = "bussi", tau = 0.2 }}"#
        )));
        let all = s.findings();
        let of = |name: &str| common::average(&all, name);
        let doubt = of("pressure").and_then(|a| a.doubt.clone());
        let by_direction = doubt.is_some_and(|d| d.reason(1).contains("does not run back"));
        assert_eq!(by_direction, !is_known, "{direction}: {:?}", of("pressure"));
        assert_eq!(of("heat_capacity").is_some(), is_known, "{direction}");
    }
}
