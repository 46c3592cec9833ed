//! `lennard new --from`: scenes from inputs of LAMMPS.

use crate::program::common::*;

/// `bench/in.lj` of LAMMPS.
const BENCH: &str = "# 3d Lennard-Jones melt

variable\tx index 1
variable\ty index 1
variable\tz index 1

variable\txx equal 20*$x
variable\tyy equal 20*$y
variable\tzz equal 20*$z

units\t\tlj
atom_style\tatomic

lattice\t\tfcc 0.8442
region\t\tbox block 0 ${xx} 0 ${yy} 0 ${zz}
create_box\t1 box
create_atoms\t1 box
mass\t\t1 1.0

velocity\tall create 1.44 87287 loop geom

pair_style\tlj/cut 2.5
pair_coeff\t1 1 1.0 1.0 2.5

neighbor\t0.3 bin
neigh_modify\tdelay 0 every 20 check no

fix\t\t1 all nve

run\t\t100
";

#[test]
fn the_benchmark_of_lammps_becomes_a_scene_that_runs() {
    let place = Place::with(&[("in.lj", BENCH)]);
    contains(&place.succeed("new --from in.lj"), &["lj.toml: a scene from in.lj"]);
    let scene = lennard_scene::Scene::load(&place.path("lj.toml"), &[]).unwrap();
    let cell = scene.placement().unwrap().unwrap().cell;
    assert_eq!(scene.n_particles(), Some(32_000));
    assert!((32_000.0 / cell.volume() - 0.8442).abs() < 1e-12);
    assert_eq!((scene.system.temperature, scene.system.seed), (1.44, 87_287));
    assert_eq!((scene.truncation.r_cut, scene.truncation.tail_correction), (2.5, false));
    assert_eq!((scene.integrator.dt, scene.total_steps(), scene.stages.len()), (0.005, 100, 1));
    contains(&place.read("lj.toml"), &["velocities: ", "energy: ", "lists of neighbors: "]);
    place.succeed("run lj.toml --out out --quiet --no-report");
    // LAMMPS prints −6.7733681 per atom for this input at step 0.
    let of_one = number(&place.json("energy lj.toml")["potential_energy"]) / 32_000.0;
    assert!((of_one + 6.773_368_1).abs() < 1e-6, "{of_one}");
}

#[test]
fn baths_dumps_and_several_runs_of_an_input_become_stages() {
    let input = BENCH
        .replace("fix\t\t1 all nve\n", "fix 1 all nvt temp 2.0 1.0 0.5\ndump d all atom 20 dump.melt\nthermo 50\n")
        .replace("run\t\t100", "run 200\nunfix 1\ntimestep 0.002\nfix 1 all nve\nfix 2 all &\n  langevin 1.0 1.0 2.0 7\nrun 300")
        .replace("20*$x", "2*$x*2/1").replace("20*$y", "4").replace("20*$z", "8");
    let place = Place::with(&[("in.melt", &input)]);
    place.succeed("new mine --from in.melt");
    let scene = lennard_scene::Scene::load(&place.path("mine.toml"), &[]).unwrap();
    assert_eq!(scene.n_particles(), Some(512));
    let [first, second] = &scene.stages[..] else { panic!("{:?}", scene.stages) };
    assert_eq!((first.temperature_from, first.temperature, first.steps), (Some(2.0), 1.0, 200));
    assert_eq!((scene.stage_dt(first), scene.stage_dt(second), second.steps), (0.005, 0.002, 300));
    let baths = [first, second].map(|s| s.thermostat.as_ref().unwrap().name());
    assert_eq!(baths, ["nose-hoover", "langevin"]);
    assert_eq!((scene.output.trajectory_every, scene.output.thermo_every), (Some(20), 50));
    for (from, to, words) in [
        ("pair_style\tlj/cut 2.5", "pair_style eam", "line 22: this form of `pair_style`"),
        ("neighbor", "kspace_style ewald 1e-4\nneighbor", "line 25: the command `kspace_style`"),
        ("20*$x", "20*$w", "line 7: there is no variable `w`"),
        ("fix\t\t1 all nve\n", "", "line 29: this form of `run`"),
        ("units\t\tlj", "units real", "line 11: this form of `units`"),
        ("mass\t\t1 1.0", "mass 1 2.0", "allowed: mass 1 1.0"),
        ("run\t\t100", "run 100\npair_style lj/cut 3.0", "stands behind a run"),
        ("run\t\t100\n", "", "there is no command `run`"),
        (
            "pair_style\tlj/cut 2.5\npair_coeff\t1 1 1.0 1.0 2.5\n",
            "",
            "there is no command `pair_style`",
        ),
        ("velocity\tall create", "velocitie all create", "nearest: velocity"),
    ] {
        let place = Place::with(&[("in.lj", &BENCH.replace(from, to))]);
        place.refused("new --from in.lj", &[words]);
        assert!(!place.has("lj.toml"));
    }
}
