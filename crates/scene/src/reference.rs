//! The scene reference: every table and key with what it may hold. Error messages, the range checks and
//! the tables of `inputs/README.md` are made from it.

mod tables;

use std::fmt::Write as _;
use std::sync::OnceLock;

pub use lennard_core::options::Allowed;
use lennard_core::options::{KeySpec, Keys, Options};
pub(crate) use lennard_core::options::{MOST_STEPS, quoted};
use lennard_forcefield::CutoffUnit;
pub use tables::TableDoc;

use lennard_integrators::ExchangeOptions;

use crate::MoleculeOptions;

/// The most particles that a scene may ask for; their numbers must fit in 32 bits with room to spare.
pub(crate) const MOST_ATOMS: i64 = 1_000_000_000;
/// The longest box side in σ: beyond it, image flags and the last digits of positions get scarce.
pub(crate) const LONGEST_SIDE: f64 = 1e6;
/// The shortest length of a slab, σ: below it there is no liquid.
const SHORTEST_SIDE: f64 = 1.0;
/// The lowest and the highest temperature of a heat bath, ε/k_B: far outside, numbers overflow or vanish on the way.
pub(crate) const COLDEST: f64 = 1e-9;
pub(crate) const HOTTEST: f64 = 1e6;
/// The lowest and the highest number density, σ⁻³: one particle in the longest box, and far beyond any solid.
pub(crate) const THINNEST: f64 = 1e-18;
pub(crate) const DENSEST: f64 = 1e3;
/// The lowest and the highest pressure of a barostat, ε/σ³: far outside, numbers vanish or overflow on the way.
pub(crate) const LEAST_PRESSURE: f64 = 1e-12;
pub(crate) const LARGEST_PRESSURE: f64 = 1e6;
/// The shortest and the longest time step, τ: far below, the time of a run no longer moves.
pub(crate) const SHORTEST_STEP: f64 = 1e-9;
pub(crate) const LONGEST_STEP: f64 = 1e3;
/// The shortest cutoff, σ: the powers of its inverse are numbers still.
pub(crate) const SHORTEST_CUTOFF: f64 = 0.1;
/// The most stages, and the most observables.
pub(crate) const MOST_ENTRIES: usize = 1000;

/// One key of a scene file.
#[derive(Debug, Clone)]
pub struct KeyDoc {
    /// Its table: `system`, `stage`, `stage.thermostat`; empty for a key outside all tables.
    pub table: &'static str,
    /// The method that the key belongs to, where it belongs to one alone (`soft-sphere`).
    pub method: Option<&'static str>,
    /// The key.
    pub key: &'static str,
    /// What it may hold.
    pub allowed: Allowed,
    /// The value where it is not written, in words.
    pub default: String,
    /// Its unit, empty for a plain number or a name.
    pub unit: &'static str,
    /// What it means.
    pub meaning: &'static str,
}

/// Declares the keys that a table has whatever its method.
macro_rules! keys {
    ($($table:literal { $($key:literal: $allowed:expr, $default:literal, $unit:literal, $meaning:literal;)* })*) => {
        &[$(($table, &[$(KeySpec {
            key: $key,
            allowed: $allowed,
            default: || $default.to_owned(),
            unit: $unit,
            meaning: $meaning,
        },)*]),)*]
    };
}

use Allowed::{Between, Flag, Names, NotNegative, Positive, Whole, Words, ZeroOrBetween};

/// The keys of each table, whatever its method.
static SHARED: &[(&str, Keys)] = keys! {
    "" {
        "name": Words("letters, digits, `-`, `_` and `.`, beginning with a letter or digit"), "the file's name without `.toml`", "", "Name of the scene; the output folder is called after it.";
    }
    "system" {
        "lattice": Names(|| vec!["fcc", "sc", "bcc", "random"]), "`\"fcc\"`", "", "Arrangement at the start. In a cube, fcc takes 4m³ particles, bcc 2m³, sc m³; in another box, 4abc, 2abc or abc with nearly cubic cells (edges within 10 % of each other). `random` takes any number, relaxed until nothing overlaps.";
        "n_atoms": Whole(1, MOST_ATOMS), "needed", "", "Number of particles.";
        "n_molecules": Whole(1, MOST_ATOMS), "needed with `[molecule]`", "", "Number of molecules, in place of `n_atoms`: their centres stand on the lattice, their axes along its body diagonals.";
        "density": Between(THINNEST, DENSEST), "this or `box`", "σ⁻³", "Number density of the start; the box is a cube.";
        "box": Words("one side, or three sides [Lx, Ly, Lz], each a finite number above 0"), "this or `density`", "σ", "Box sides. With a `configuration`, the box of a file that names none.";
        "vacuum": NotNegative, "`0.0`", "σ", "Empty length added to the box along z, with the particles in the middle: a slab between two surfaces. `density` and `box` then describe the filled part.";
        "configuration": Words("the path of a file that can be read"), "none", "", "Start from this file (extended XYZ, LAMMPS dump or data, or the NIST columns; each may be compressed by gzip), relative to the scene file. Takes the place of `lattice`, `n_atoms` and `density`.";
        "positions": Words("a list with one position [x, y, z] for each particle"), "none", "σ", "Start from these positions, in the `box`. Takes the place of `lattice`, `n_atoms` and `density`. With molecules, the sites of each follow each other. Along an axis with walls they count from the lower wall.";
        "velocities": Words("a list with one velocity [vx, vy, vz] for each of `positions`"), "velocities of `temperature`", "σ/τ", "Velocities of the `positions`. Their total momentum is kept.";
        "held": Words("a list of numbers of particles, from 1, each once, and not all of them"), "none", "", "Particles that never move: their mass is infinite.";
        "temperature": ZeroOrBetween(COLDEST, HOTTEST), "needed; `0.0` with `positions`", "ε/k_B", "Temperature of the first velocities (where neither scene nor file gives them) and of every thermostat that names no other.";
        "seed": Whole(0, i64::MAX), "`1`", "", "Seed of every random stream.";
    }
    "slab" {
        "liquid_density": Between(THINNEST, DENSEST), "saturation of the model at `system.temperature`", "σ⁻³", "Density of the liquid at the start.";
        "vapor_density": Between(THINNEST, DENSEST), "saturation of the model at `system.temperature`", "σ⁻³", "Density of the vapor at the start.";
        "thickness": Between(SHORTEST_SIDE, LONGEST_SIDE), "1.5 times the side of the cross-section, or a third of `length`", "σ", "Thickness of the liquid across z; 12 σ or more for the densities and the tension of bulk phases.";
        "length": Between(SHORTEST_SIDE, LONGEST_SIDE), "3 times `thickness`", "σ", "Length of the box along z.";
    }
    "species" {
        "name": Words("letters, digits, `-` and `_`, beginning with a letter, and unlike any other species'"), "needed", "", "Its name in `[[pair]]`, results and overrides (`--set species.NAME.sigma=…`).";
        "fraction": Between(1e-9, 1.0), "this or `count`", "", "Share of all particles; the fractions of all species add up to 1.";
        "count": Whole(1, MOST_ATOMS), "this or `fraction`", "", "Number of particles. With `configuration`, the file has them, and neither key is written.";
        "sigma": Between(0.01, 100.0), "`1.0`", "σ", "σ of two particles of this species.";
        "epsilon": ZeroOrBetween(1e-6, 1e6), "`1.0`", "ε", "ε of two particles of this species; 0 for none.";
        "mass": Between(1e-6, 1e6), "`1.0`", "m", "Mass of each particle.";
        "element": Words("an element symbol, or \"X\", unlike any other species'"), "`name`, where it is a symbol; else Ar, Kr, Xe, … in turn", "", "Symbol of its particles in files.";
    }
    "mixing" {
        "rule": Names(|| lennard_forcefield::combining_rules().iter().map(|r| r.name).collect()), "needed with two species or more", "", "Rule for σ and ε of unlike species.";
    }
    "pair" {
        "a": Words("the name of a species"), "needed", "", "One species.";
        "b": Words("the name of a species"), "needed", "", "The other; the same for a pair of like particles, which has `r_cut` alone.";
        "sigma": Between(0.01, 100.0), "by the rule", "σ", "σ of the pair.";
        "epsilon": ZeroOrBetween(1e-6, 1e6), "by the rule", "ε", "ε of the pair; 0 for none.";
        "k": Between(-1.0, 1.0), "`mixing.k`", "", "Deviation of ε of this pair, with rule \"lorentz-berthelot\" alone.";
        "l": Between(-0.5, 0.5), "`mixing.l`", "", "Deviation of σ of this pair, with rule \"lorentz-berthelot\" alone.";
        "r_cut": Between(SHORTEST_CUTOFF, LONGEST_SIDE), "`truncation.r_cut`", "as `truncation.r_cut_in` says", "Cutoff of this pair.";
    }
    "molecule" {}
    "bonds" {
        "method": Names(|| lennard_integrators::bond_methods().iter().map(|m| m.name).collect()), "`\"direct\"`", "", "How bonds are held.";
    }
    "accuracy" {
        "potential_energy": Positive, "not asked for", "ε per particle", "Largest error of the mean potential energy, at equal temperature: of the full potential, or, where `truncation.kind` and `truncation.r_cut` are both written, of that model.";
        "pressure": Positive, "not asked for", "ε/σ³", "Largest error of the mean pressure, likewise.";
        "drift": Positive, "not asked for", "ε/τ per particle", "Largest drift of the conserved energy.";
    }
    "potential" {
        "kind": Names(|| lennard_forcefield::potentials().iter().map(|p| p.name).collect()), "`\"lennard-jones\"`", "", "The pair potential U(r).";
    }
    "truncation" {
        "kind": Names(|| lennard_forcefield::truncations().iter().map(|t| t.name).collect()), "`\"cut\"`", "", "How the potential ends at `r_cut`.";
        "r_cut": Between(SHORTEST_CUTOFF, LONGEST_SIDE), "`2.5`", "σ", "Cutoff radius; at most half the shortest box side.";
        "r_cut_in": Names(CutoffUnit::names), "`\"sigma\"`", "", "Unit of the cutoffs of a mixture: σ of the scene, or σ_ab of each pair of species.";
        "switch_from": Words("a number between 0 and `r_cut`, with kind \"switch\" or \"xplor\" alone"), "0.8·`r_cut`", "σ", "Where the switch begins.";
        "tail_correction": Words("true, false or \"planar\"; true and \"planar\" with kind \"cut\" alone, true only in a homogeneous fluid, \"planar\" only with surfaces across z"), "`true` for `\"cut\"`, else `false`", "", "Whether U and P are corrected for the fluid beyond the cutoff. `\"planar\"` makes the correction a force across flat surfaces.";
    }
    "neighbor" {
        "mode": Names(|| vec!["auto", "direct", "verlet"]), "`\"auto\"`", "", "Every pair each time, or a Verlet list over a cell grid; `auto` chooses from the scene.";
        "skin": NotNegative, "chosen from density, temperature, dt and precision", "σ", "The list holds pairs up to r_cut + skin; that may not exceed half the shortest box side.";
    }
    "kernel" {
        "kernel": Names(|| vec!["auto", "reference"]), "`\"auto\"`", "", "The fastest loop that suits the scene; the plain double loop that all others are judged by.";
        "precision": Names(|| vec!["double", "mixed"]), "`\"double\"`", "", "Precision of the pair terms; sums and integration are always double.";
        "isa": Names(|| vec!["auto", "avx512", "avx2", "portable"]), "`\"auto\"`", "", "Instruction set of the loop.";
    }
    "integrator" {
        "kind": Names(|| lennard_integrators::integrators().iter().map(|i| i.spec.name).collect()), "`\"velocity-verlet\"`", "", "The method.";
        "dt": Between(SHORTEST_STEP, LONGEST_STEP), "`0.004`", "τ", "Time step.";
    }
    "wall" {
        "kind": Names(|| lennard_forcefield::walls().iter().map(|w| w.name).collect()), "needed", "", "What the walls do to particles.";
        "axis": Names(lennard_core::Axis::names), "`\"z\"`", "", "The axis across which the walls stand.";
        "thickness": Positive, "`r_cut` + 1.0", "σ", "Length of the box behind the planes, which keeps the fluid out of reach of its images; at least `r_cut` + 0.1.";
    }
    "contact" {
        "kind": Names(|| lennard_contacts::contacts().iter().map(|c| c.name).collect()), "`\"soft\"`", "", "What happens where two bodies touch.";
        "diameter": Between(0.01, 100.0), "`1.0`", "σ", "Distance of two centres at which bodies touch; that of two species is times their σ. At most half the shortest box side.";
    }
    "field" {
        "acceleration": Words("three finite numbers [gx, gy, gz]; 0 along an axis without walls"), "`[0.0, 0.0, 0.0]`", "σ/τ²", "Acceleration of every particle.";
    }
    "stage" {
        "name": Words("letters, digits, `-` and `_`, not digits alone, and unlike any other stage's"), "needed", "", "Its name, by which `--set stage.NAME.steps=…` finds it.";
        "steps": Whole(1, MOST_STEPS), "needed", "", "Number of steps.";
        "thermostat": Words("\"none\", the name of a thermostat, or a table with `kind` and its keys"), "`\"none\"`", "", "The heat bath; none is constant energy.";
        "barostat": Words("\"none\", or a table with `kind`, `pressure` and its keys"), "`\"none\"`", "", "The pressure bath; none is constant volume.";
        "exchange": Words("\"none\", \"heat\", \"momentum\", or a table"), "`\"none\"`", "", "An exchange of velocities between two slabs, which drives heat or momentum through the fluid.";
        "temperature": Between(COLDEST, HOTTEST), "`system.temperature`", "ε/k_B", "Temperature of the thermostat, or a ramp `{ from, to }`.";
        "dt": Between(SHORTEST_STEP, LONGEST_STEP), "`integrator.dt`", "τ", "Time step of this stage.";
        "measure": Flag, "`true` for the last stage, else `false`", "", "Whether observables and the trajectory look at this stage. Measured stages must be alike in dt, thermostat, barostat and temperature, since their samples are pooled.";
    }
    "stage.thermostat" {
        "kind": Names(|| lennard_integrators::thermostats().iter().map(|t| t.name).collect()), "needed", "", "The thermostat.";
    }
    "stage.barostat" {
        "kind": Names(|| lennard_integrators::barostats().iter().map(|b| b.name).collect()), "needed", "", "The barostat.";
        "pressure": ZeroOrBetween(LEAST_PRESSURE, LARGEST_PRESSURE), "needed", "ε/σ³", "Pressure to hold, or a ramp `{ from, to }`.";
    }
    "stage.exchange" {}
    "stage.temperature" {
        "from": Between(COLDEST, HOTTEST), "needed", "ε/k_B", "Temperature at the start of the stage.";
        "to": Between(COLDEST, HOTTEST), "needed", "ε/k_B", "Temperature at its end.";
    }
    "stage.barostat.pressure" {
        "from": ZeroOrBetween(LEAST_PRESSURE, LARGEST_PRESSURE), "needed", "ε/σ³", "Pressure at the start of the stage.";
        "to": ZeroOrBetween(LEAST_PRESSURE, LARGEST_PRESSURE), "needed", "ε/σ³", "Pressure at its end.";
    }
    "observable" {
        "kind": Names(|| lennard_observables::observables().iter().map(|o| o.name).collect()), "needed", "", "The observable.";
        "every": Whole(1, MOST_STEPS), "the default of the kind", "steps", "Steps between two samples.";
    }
    "output" {
        "trajectory_every": Whole(0, MOST_STEPS), "`0`", "steps", "Steps between two frames of the trajectory; 0 for no trajectory.";
        "format": Names(lennard_io::TrajectoryFormat::names), "`\"xyz\"`", "", "Format of the trajectory. `xyz` is extended XYZ as text, and `xyz.gz` the same compressed; `lammps-dump` is the text of LAMMPS, and `xtc` has rounded positions alone.";
        "precision": Between(10.0, 1e6), "10,000 for \"xtc\"", "per σ", "Positions in XTC are multiples of 1/`precision`, with format \"xtc\" alone.";
        "ase": Flag, "`false`", "", "Whether frames hold momenta, masses and the energy under the names that ASE reads, in reduced units; with formats \"xyz\" and \"xyz.gz\" alone.";
        "thermo_every": Whole(1, MOST_STEPS), "`10`", "steps", "Steps between two samples of the thermodynamics, each a line of `thermo.csv`; the `every` of a `thermodynamics` observable is the same number.";
        "element": Words("an element symbol, or \"X\""), "`\"Ar\"`", "", "Symbol of the particles in the files, for tools that know only elements.";
        "velocities": Flag, "`true`; `false` for \"xtc\", which has none", "", "Whether frames hold velocities.";
        "forces": Flag, "`false`", "", "Whether frames hold forces; not with \"xtc\".";
        "unwrapped": Flag, "`false`", "", "Positions as they moved, rather than folded into the box with image flags.";
        "length_scale": Between(1e-12, 1e12), "`1.0`", "file units per σ", "Lengths in the trajectory are multiplied by it (3.405 gives ångström for argon, 0.3405 the nm of XTC); 1 with \"lammps-dump\", whose files do not name it.";
    }
    "checkpoint" {
        "every_steps": Whole(0, MOST_STEPS), "`0`", "steps", "Steps between two checkpoints; 0 for none.";
        "every_seconds": NotNegative, "`600.0`", "s", "Wall-clock seconds between two checkpoints; 0 for none.";
    }
};

/// The keys of the split force, which multiple time steps bring along.
static SPLIT: Keys = &[
    KeySpec {
        key: "r_split",
        allowed: Positive,
        default: || "`1.7`".to_owned(),
        unit: "σ",
        meaning: "Where the near force ends; below `truncation.r_cut`.",
    },
    KeySpec {
        key: "split_width",
        allowed: Positive,
        default: || "`0.4`".to_owned(),
        unit: "σ",
        meaning: "Over which distance it ends; at most `r_split`.",
    },
];

/// The keys of the methods of a table, each declared in the method's own file.
fn of_methods(table: &str) -> Vec<(&'static str, Keys)> {
    match table {
        "potential" => lennard_forcefield::PotentialOptions::keys(),
        "mixing" => lennard_forcefield::CombiningOptions::keys(),
        "bonds" => lennard_integrators::BondOptions::keys(),
        "integrator" => {
            let mut all = lennard_integrators::IntegratorOptions::keys();
            all.push((lennard_integrators::respa::SPEC.name, SPLIT));
            all
        }
        "contact" => lennard_contacts::ContactOptions::keys(),
        "wall" => lennard_forcefield::WallOptions::keys(),
        "stage.barostat" => lennard_integrators::BarostatOptions::keys(),
        "stage.thermostat" => lennard_integrators::ThermostatOptions::keys(),
        "observable" => lennard_observables::ObservableOptions::keys(),
        _ => Vec::new(),
    }
}

/// Every key of a scene file, table by table.
#[must_use]
pub fn keys() -> &'static [KeyDoc] {
    static ALL: OnceLock<Vec<KeyDoc>> = OnceLock::new();
    ALL.get_or_init(|| {
        let document = |table, method, key: &KeySpec| KeyDoc {
            table,
            method,
            key: key.key,
            allowed: key.allowed,
            default: (key.default)(),
            unit: key.unit,
            meaning: key.meaning,
        };
        let mut all = Vec::new();
        for (table, shared) in SHARED {
            let own: Keys = match *table {
                "molecule" => <MoleculeOptions as Options>::KEYS,
                "stage.exchange" => <ExchangeOptions as Options>::KEYS,
                _ => &[],
            };
            all.extend(
                shared
                    .iter()
                    .chain(own)
                    .map(|key| document(table, None, key)),
            );
            for (method, own) in of_methods(table) {
                all.extend(own.iter().map(|key| document(table, Some(method), key)));
            }
        }
        all
    })
}

/// Every table of a scene file.
#[must_use]
pub fn tables() -> &'static [TableDoc] {
    tables::TABLES
}

/// What is known of a key: `table` without indices (`stage.thermostat`).
pub(crate) fn find(table: &str, method: Option<&str>, key: &str) -> Option<&'static KeyDoc> {
    keys().iter().find(|doc| {
        doc.table == table && doc.key == key && (doc.method.is_none() || doc.method == method)
    })
}

/// The scene reference as Markdown: a section a table, a row a key.
#[must_use]
pub fn markdown() -> String {
    let mut out = String::new();
    for table in tables() {
        let _ = write!(out, "### {}\n\n{}\n\n", table.heading, table.meaning);
        out.push_str("| Key | Allowed | Default | Unit | Meaning |\n|---|---|---|---|---|\n");
        for doc in keys().iter().filter(|doc| doc.table == table.table) {
            let only = match doc.method {
                Some(method) => format!(" (`{method}`)"),
                None => String::new(),
            };
            let _ = writeln!(
                out,
                "| `{}`{only} | {} | {} | {} | {} |",
                doc.key,
                doc.allowed.text(),
                doc.default,
                doc.unit,
                doc.meaning
            );
        }
        out.push('\n');
    }
    out
}
