//! An input of LAMMPS as a scene, for the commands of its Lennard-Jones benchmarks. Any other command is refused by its line.
//!
//! Source: LAMMPS documentation, one page for each command.

use std::collections::BTreeMap;

use lennard_core::number::short;
use lennard_scene::nearest;
use toml::{Table, Value};

/// The commands that are read, in the forms that have an equal here.
const FORMS: [(&str, &str); 20] = [
    ("units", "units lj"),
    ("atom_style", "atom_style atomic"),
    ("dimension", "dimension 3"),
    ("boundary", "boundary p p p"),
    ("variable", "variable NAME index|equal VALUE, a number or a product"),
    ("lattice", "lattice fcc|bcc|sc DENSITY"),
    ("region", "region ID block X0 X1 Y0 Y1 Z0 Z1, in whole cells of the lattice"),
    ("create_box", "create_box 1 ID"),
    ("create_atoms", "create_atoms 1 box, behind lattice and region"),
    ("mass", "mass 1 1.0, the unit of mass"),
    ("velocity", "velocity all create T SEED"),
    ("pair_style", "pair_style lj/cut R"),
    ("pair_coeff", "pair_coeff 1 1 1.0 1.0 [R], where σ and ε are the units"),
    ("pair_modify", "pair_modify shift yes|no tail yes|no"),
    (
        "fix",
        "fix ID all nve; nvt temp T T TAU [tchain N]; langevin T T DAMP SEED; temp/csvr T T TAU SEED; or temp/rescale N T T 0.0 1.0",
    ),
    ("unfix", "unfix ID"),
    ("timestep", "timestep DT"),
    ("thermo", "thermo N"),
    ("dump", "dump ID all atom|custom|xyz|xtc N FILE"),
    ("run", "run STEPS, with one fix that moves the atoms and one bath at most"),
];
/// Commands that change no result, and are passed over.
const PASSED: &str = "atom_modify, comm_modify, dump_modify, echo, log, neigh_modify, neighbor, newton, processors, \
    reset_timestep, thermo_modify, thermo_style, timer, undump";
/// Commands that may stand behind a run.
const BEHIND_A_RUN: &str = "fix, unfix, timestep, variable, run";

/// The time step of LAMMPS in units lj, τ.
const USUAL_STEP: f64 = 0.005;

/// What stands at the head of a scene.
const HEAD: &str = "\
# Not equal to LAMMPS:
# - velocities: at the same temperature, by another generator;
# - energy: with the shift and the tail that `pair_modify` asks for, and no others. A comparison with equations of state wants
#   `tail_correction = true`;
# - pressure: ρT for N particles, where LAMMPS counts N − 1;
# - lists of neighbors: the skin is chosen here, and a list lasts as long as it is valid;
# - baths: of the same kind, with other random numbers, and Langevin's with the splitting BAOAB.
";

/// What the commands have said so far.
struct Input {
    variables: BTreeMap<String, String>,
    density: f64,
    /// Cells of the lattice along each axis.
    cells: [u32; 3],
    /// Keys of a stage by the name of their fix, and whether the fix moves the atoms.
    fixes: BTreeMap<String, (bool, Table)>,
    /// The step of the stages to come, where it is another than the first one's.
    dt: Option<Value>,
    stages: Vec<Value>,
    scene: Table,
}

/// A scene from the text of an input; `name` stands for the file in it and in messages.
///
/// # Errors
/// File, line, what was found and what is allowed, as a message, for the first command that has no equal.
pub fn scene_of_lammps(text: &str, name: &str) -> Result<String, String> {
    let mut input = Input {
        variables: BTreeMap::new(),
        density: 0.0,
        cells: [0; 3],
        fixes: BTreeMap::new(),
        dt: None,
        stages: Vec::new(),
        scene: Table::new(),
    };
    input.set("integrator", "dt", USUAL_STEP.into());
    input.set("truncation", "kind", "cut".into());
    input.set("truncation", "tail_correction", false.into());
    let mut command = String::new();
    for (number, line) in (1..).zip(text.lines()) {
        let line = line.split('#').next().unwrap_or_default().trim();
        command += line.trim_end_matches('&');
        if line.ends_with('&') {
            continue;
        }
        let found = std::mem::take(&mut command);
        input.command(&found).map_err(|(why, allowed)| {
            format!("{name}, line {number}: {why}\n  found:   {found}\n  allowed: {allowed}")
        })?;
    }
    let needed = [
        ("system", "n_atoms", "create_atoms"),
        ("system", "temperature", "velocity"),
        ("truncation", "r_cut", "pair_style"),
    ];
    let is_there = |(table, key, _): &&(&str, &str, &str)| {
        input.scene.get(*table).is_some_and(|table| table.get(key).is_some())
    };
    let missing = needed.iter().find(|row| !is_there(row)).map(|(.., command)| *command);
    if let Some(missing) = missing.or(input.stages.is_empty().then_some("run")) {
        let form = FORMS.iter().find(|(command, _)| *command == missing).map_or("", |row| row.1);
        return Err(format!("{name}: there is no command `{missing}`\n  allowed: {form}"));
    }
    input.scene.insert("stage".to_owned(), input.stages.into());
    let scene = &input.scene;
    Ok(format!(
        "# A scene from {name}, an input of LAMMPS, by `lennard new --from`.\n#\n{HEAD}\n{scene}"
    ))
}

/// A number as TOML writes it.
fn value(word: &str) -> Option<Value> {
    let whole = word.parse::<i64>().map(Value::from);
    whole.or_else(|_| word.parse::<f64>().map(Value::from)).ok()
}

fn is(word: &str, number: f64) -> bool {
    word.parse() == Ok(number)
}

/// A number, or a product or quotient such as `20*2/1`.
fn product(text: &str) -> Option<f64> {
    let (mut product, mut divides) = (1.0, false);
    for part in text.split_inclusive(['*', '/']) {
        let factor: f64 = part.trim_end_matches(['*', '/']).parse().ok()?;
        product *= if divides { factor.recip() } else { factor };
        divides = part.ends_with('/');
    }
    Some(product)
}

fn table<const N: usize>(entries: [(&str, Value); N]) -> Table {
    entries.into_iter().map(|(key, value)| (key.to_owned(), value)).collect()
}

/// Whether a fix moves the atoms, and the keys of a stage that it stands for.
fn fix_of(words: &[&str]) -> Option<(bool, Table)> {
    let (from, to, bath) = match *words {
        ["nve"] => return Some((true, Table::new())),
        ["nvt", "temp", from, to, tau, ref chain @ ..] => {
            let chain = match *chain {
                [] => 3.into(),
                ["tchain", n] => value(n)?,
                _ => return None,
            };
            (
                from,
                to,
                table([("kind", "nose-hoover".into()), ("tau", value(tau)?), ("chain", chain)]),
            )
        }
        ["langevin", from, to, damp, _seed] => {
            let friction = damp.parse::<f64>().ok()?.recip();
            (from, to, table([("kind", "langevin".into()), ("friction", friction.into())]))
        }
        ["temp/csvr", from, to, tau, _seed] => {
            (from, to, table([("kind", "bussi".into()), ("tau", value(tau)?)]))
        }
        ["temp/rescale", every, from, to, window, part] if is(window, 0.0) && is(part, 1.0) => {
            (from, to, table([("kind", "rescale".into()), ("every", value(every)?)]))
        }
        _ => return None,
    };
    let temperature = match from == to {
        true => value(from)?,
        false => table([("from", value(from)?), ("to", value(to)?)]).into(),
    };
    let keys = table([("temperature", temperature), ("thermostat", bath.into())]);
    Some((words[0] == "nvt", keys))
}

impl Input {
    /// Writes a key of the scene.
    fn set(&mut self, table: &str, key: &str, value: Value) {
        let table = self.scene.entry(table).or_insert_with(|| Table::new().into());
        if let Value::Table(table) = table {
            table.insert(key.to_owned(), value);
        }
    }

    /// Reads a command. The error says why not, and what is allowed.
    fn command(&mut self, line: &str) -> Result<(), (String, String)> {
        let line = self.with_values(line)?;
        let words: Vec<&str> = line.split_whitespace().collect();
        let is_one_of = |list: &str, name: &str| list.split(", ").any(|known| known == name);
        let Some(name) = words.first().filter(|name| !is_one_of(PASSED, name)) else {
            return Ok(());
        };
        let Some((_, form)) = FORMS.iter().find(|(known, _)| known == name) else {
            let known: Vec<&str> = FORMS.iter().map(|(known, _)| *known).collect();
            let meant = nearest(name, known.iter().copied());
            let meant = meant.map_or_else(String::new, |meant| format!("\n  nearest: {meant}"));
            return Err((
                format!("the command `{name}` has no equal in a scene"),
                format!(
                    "{}, and, passed over, {PASSED}; take it out of the input, and write into the scene what it does{meant}",
                    known.join(", ")
                ),
            ));
        };
        if !(self.stages.is_empty() || is_one_of(BEHIND_A_RUN, name)) {
            let why = format!("the command `{name}` stands behind a run, and a scene says it once");
            return Err((why, format!("{BEHIND_A_RUN}; others before the first run")));
        }
        let of_form =
            || (format!("this form of `{name}` has no equal in a scene"), (*form).to_owned());
        self.take(&words).ok_or_else(of_form)
    }

    /// A line with values in the place of `${x}` and `$x`.
    fn with_values(&self, line: &str) -> Result<String, (String, String)> {
        let mut parts = line.split('$');
        let mut out = parts.next().unwrap_or_default().to_owned();
        for part in parts {
            let in_braces = part.strip_prefix('{').and_then(|rest| rest.split_once('}'));
            let first = part.chars().next().map_or(0, char::len_utf8);
            let (name, rest) = in_braces.unwrap_or_else(|| part.split_at(first));
            let value = self.variables.get(name).ok_or_else(|| {
                let known: Vec<&str> = self.variables.keys().map(String::as_str).collect();
                let why = format!("there is no variable `{name}` before this line");
                (why, format!("a variable of the lines before: {}", known.join(", ")))
            })?;
            out = out + value + rest;
        }
        Ok(out)
    }

    /// Takes a command whose name is known; `None` where its form is not.
    fn take(&mut self, words: &[&str]) -> Option<()> {
        match *words {
            ["units", "lj"] | ["atom_style", "atomic"] | ["create_box", "1", _] | ["run", "0"] => {}
            ["dimension", "3"] | ["boundary", "p", "p", "p"] => {}
            ["mass", "1", mass] if is(mass, 1.0) => {}
            ["variable", name, "index" | "equal", value] => {
                self.variables.insert(name.to_owned(), short(product(value)?));
            }
            ["lattice", kind @ ("fcc" | "bcc" | "sc"), density] => {
                self.density = density.parse().ok()?;
                self.set("start", "lattice", kind.into());
            }
            ["region", _, "block", ref bounds @ ..] if bounds.len() == 6 => {
                for (cells, ends) in self.cells.iter_mut().zip(bounds.chunks(2)) {
                    let n = ends[1].parse::<f64>().ok()? - ends[0].parse::<f64>().ok()?;
                    *cells = (n >= 1.0 && n.fract() == 0.0).then_some(n as u32)?;
                }
            }
            ["create_atoms", "1", "box"] | ["create_atoms", "1", "region", _] => self.fill()?,
            ["velocity", "all", "create", temperature, seed, ..] => {
                self.set("system", "temperature", value(temperature)?);
                self.set("system", "seed", value(seed)?);
            }
            ["pair_style", "lj/cut", r_cut] => self.set("truncation", "r_cut", value(r_cut)?),
            ["pair_coeff", "1" | "*", "1" | "*", epsilon, sigma, ref r_cut @ ..]
                if is(epsilon, 1.0) && is(sigma, 1.0) && r_cut.len() < 2 =>
            {
                if let Some(r_cut) = r_cut.first() {
                    self.set("truncation", "r_cut", value(r_cut)?);
                }
            }
            ["pair_modify", ref settings @ ..] if settings.len() % 2 == 0 => {
                for setting in settings.chunks(2) {
                    let (key, value) = match setting {
                        ["shift", "yes"] => ("kind", "shift".into()),
                        ["shift", "no"] => ("kind", "cut".into()),
                        ["tail", word @ ("yes" | "no")] => {
                            ("tail_correction", (*word == "yes").into())
                        }
                        _ => return None,
                    };
                    self.set("truncation", key, value);
                }
            }
            ["timestep", dt] if self.stages.is_empty() => self.set("integrator", "dt", value(dt)?),
            ["timestep", dt] => self.dt = Some(value(dt)?),
            ["thermo", every] => self.set("output", "thermo_every", value(every)?),
            ["dump", _, "all", kind @ ("atom" | "custom" | "xyz" | "xtc"), every, _file, ..] => {
                let format = if matches!(kind, "atom" | "custom") { "lammps-dump" } else { kind };
                self.set("output", "format", format.into());
                self.set("output", "trajectory_every", value(every)?);
            }
            ["fix", id, "all", ref fix @ ..] => {
                drop(self.fixes.insert(id.to_owned(), fix_of(fix)?))
            }
            ["unfix", id] => drop(self.fixes.remove(id)?),
            ["run", steps] => self.run(value(steps)?)?,
            _ => return None,
        }
        Some(())
    }

    /// Fills the region; `None` where there is no lattice or region yet.
    fn fill(&mut self) -> Option<()> {
        let lattice = self.scene.get("start")?.get("lattice")?.as_str()?;
        let per_cell = match lattice {
            "fcc" => 4,
            "bcc" => 2,
            _ => 1,
        };
        let [x, y, z] = self.cells;
        let n_atoms = per_cell * self.cells.iter().map(|n| i64::from(*n)).product::<i64>();
        self.set("system", "n_atoms", (n_atoms > 0).then_some(n_atoms)?.into());
        if x == y && y == z {
            self.set("system", "density", self.density.into());
        } else {
            let cell = (per_cell as f64 / self.density).cbrt();
            let sides = self.cells.map(|n| Value::from(f64::from(n) * cell));
            self.set("system", "box", sides.to_vec().into());
        }
        Some(())
    }

    /// A stage of so many steps; `None` unless one fix moves the atoms, beside one bath at most.
    fn run(&mut self, steps: Value) -> Option<()> {
        let is_bath = |(_, keys): &&(bool, Table)| !keys.is_empty();
        let movers = self.fixes.values().filter(|(moves, _)| *moves).count();
        if movers != 1 || self.fixes.values().filter(is_bath).count() > 1 {
            return None;
        }
        let name = format!("run-{}", self.stages.len() + 1);
        let mut stage = table([("name", name.into()), ("steps", steps)]);
        stage.extend(self.fixes.values().flat_map(|(_, keys)| keys.clone()));
        stage.extend(self.dt.clone().map(|dt| ("dt".to_owned(), dt)));
        self.stages.push(stage.into());
        Some(())
    }
}
