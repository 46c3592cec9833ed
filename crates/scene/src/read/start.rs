//! Reads the tables `[system]` and `[start]`.

use crate::reference;
use std::path::Path;

use lennard_core::DVec3;
use lennard_core::number::short;
use lennard_io::{FileUnits, LARGEST};
use lennard_literature::{ModelKind, TwoPhaseSource, equation_of_state_for, freezing_line};
use toml::Value;

use crate::document::in_short;
use crate::read::{Reader, Resolve};
use crate::tables::start::{
    CrystalKeys, Numbers, PositionKeys, Sides, SlabKeys, StartKeys, SystemKeys, per_cell,
};
use crate::{Arrangement, Geometry, HalfCrystal, SceneError, Slab, System};

/// A row of numbers as a vector.
fn vectors(rows: &[[f64; 3]]) -> Vec<DVec3> {
    rows.iter().map(|row| DVec3::from_array(*row)).collect()
}

/// What is allowed beside a start with two phases.
const BY_PHASES: &str = "nothing: the box follows from `n_atoms` and the keys of `[start]`";

impl Reader<'_> {
    /// The start of particles that are listed, in a box.
    fn listed(
        &self,
        keys: &PositionKeys,
        geometry: Option<Geometry>,
    ) -> Result<Arrangement, SceneError> {
        let refuse = |key: &str, message: &str, found: String, allowed: &str| {
            Err(self.refuse(key, message).found(found).allowed(allowed))
        };
        let velocities = keys.velocities.as_deref();
        let positions = self.of_start("positions", keys.positions.as_deref())?;
        let Some(Geometry::Box(sides)) = geometry else {
            let found = "`positions` without a box".to_owned();
            let allowed = "`box` with one side, or three sides [Lx, Ly, Lz]";
            return refuse("system.box", "is missing", found, allowed);
        };
        if positions.is_empty() {
            let found = "an empty list".to_owned();
            return refuse("start.positions", "has no particle", found, "at least one position");
        }
        for (key, rows) in [("start.positions", Some(positions)), ("start.velocities", velocities)]
        {
            let bad =
                rows.into_iter().flatten().flatten().find(|x| !(-LARGEST..=LARGEST).contains(*x));
            if let Some(x) = bad {
                let allowed = format!("numbers from -{LARGEST:e} to {LARGEST:e}");
                return refuse(key, "is not allowed", x.to_string(), &allowed);
            }
        }
        if let Some(velocities) = velocities
            && velocities.len() != positions.len()
        {
            let found = format!("{} velocities of {} particles", velocities.len(), positions.len());
            let allowed = "one velocity for each of `positions`";
            return refuse("start.velocities", "has another length", found, allowed);
        }
        Ok(Arrangement::Listed {
            sides,
            positions: vectors(positions),
            velocities: velocities.map(vectors),
        })
    }

    /// The held particles by their numbers from 0, from numbers from 1.
    pub fn held(&self, written: &[u64]) -> Result<Vec<usize>, SceneError> {
        let mut held = Vec::new();
        for number in written {
            let place = (*number as usize).wrapping_sub(1);
            if *number == 0 || held.contains(&place) {
                return Err(self
                    .refuse("system.held", "is not allowed")
                    .found(format!("{number} in {written:?}"))
                    .allowed("numbers of particles, from 1, each once"));
            }
            held.push(place);
        }
        held.sort_unstable();
        Ok(held)
    }
}

/// The length of the crystal over its side, where the scene does not say.
const LENGTH_OF_SIDE: f64 = 2.0;

/// The part of the particles that starts as crystal, where the scene does not say.
const SHARE: f64 = 0.5;

/// The least length of both parts, σ: below it the two fronts of a part touch.
const SHORTEST_PART: f64 = 4.0;

impl Reader<'_> {
    /// The start of `n_atoms` particles at a temperature (ε/k_B); the freezing line of `model` gives densities that are not written.
    fn half_crystal(
        &self,
        table: &CrystalKeys,
        n_atoms: usize,
        temperature: f64,
        model: Option<ModelKind>,
    ) -> Result<HalfCrystal, SceneError> {
        let [crystal_density, liquid_density] = densities(
            ["crystal_density", "liquid_density"],
            [table.crystal_density, table.liquid_density],
            |key, allowed| self.on_freezing_line(temperature, model, key, allowed),
        )?;
        let in_crystal = SHARE * n_atoms as f64;
        let cells = table.cells.unwrap_or_else(|| {
            let cells = (in_crystal / (per_cell() as f64 * LENGTH_OF_SIDE)).cbrt();
            (cells.round() as usize).max(1)
        });
        let of_layer = (per_cell() * cells * cells) as f64;
        let layers = (in_crystal / of_layer).round() as usize;
        let start = HalfCrystal {
            n_atoms,
            cells,
            layers: table.layers.unwrap_or(layers.max(1)),
            crystal_density,
            liquid_density,
        };
        let parts = [start.crystal_length(), start.liquid_length()];
        if parts.iter().any(|length| *length < SHORTEST_PART) {
            return Err(self.refuse("start.layers", "leaves no room for two phases")
                .found(format!(
                    "{} cells along z with {} particles of {n_atoms}: {:.2} σ of crystal, {:.2} σ of liquid",
                    start.layers,
                    start.n_crystal().min(n_atoms),
                    parts[0],
                    parts[1]
                ))
                .allowed(format!(
                    "at least {SHORTEST_PART} σ of both: other `layers` or `cells`, or more `n_atoms`"
                )));
        }
        Ok(start)
    }

    /// The densities of crystal and liquid side by side in the literature.
    fn on_freezing_line(
        &self,
        temperature: f64,
        model: Option<ModelKind>,
        key: &str,
        allowed: &str,
    ) -> Result<[f64; 2], SceneError> {
        let missing = |found: String, allowed: String| {
            let refused = self.refuse(key, "is missing");
            refused.found(found).allowed(allowed)
        };
        let line = freezing_line();
        let equation = model.and_then(|model| equation_of_state_for(model).ok());
        if !equation.is_some_and(|e| e.has_freezing_line()) {
            return Err(missing(
                "nothing, and no freezing line is known for this potential".to_owned(),
                allowed.to_owned(),
            ));
        }
        let on_line = line.melting_density(temperature).zip(line.freezing_density(temperature));
        on_line.map(|(c, l)| [c, l]).ok_or_else(|| {
            missing(
                format!("nothing, at temperature {temperature}"),
                format!(
                    "a temperature above the triple point, {} ({}), or {allowed}",
                    line.t_triple, line.name
                ),
            )
        })
    }
}

/// The two densities of a table as written, and where one is not, as `known` has it. That is given the key of the first that is
/// missing, and all that are missing in words.
fn densities(
    keys: [&str; 2],
    written: [Option<f64>; 2],
    known: impl FnOnce(&str, &str) -> Result<[f64; 2], SceneError>,
) -> Result<[f64; 2], SceneError> {
    let all = keys.into_iter().zip(written);
    let missing: Vec<&str> = all.filter(|(_, x)| x.is_none()).map(|(key, _)| key).collect();
    let Some(first) = missing.first() else {
        return Ok(written.map(Option::unwrap_or_default));
    };
    let words: Vec<String> = missing.iter().map(|key| format!("`{key}`")).collect();
    let allowed = format!("{} in [start]", words.join(" and "));
    let known = known(&format!("start.{first}"), &allowed)?;
    Ok([0, 1].map(|i| written[i].unwrap_or(known[i])))
}

/// The length of the box over the thickness of the slab, where the scene does not say.
const LENGTH_OF_THICKNESS: f64 = 3.0;

/// The thickness over the side of the slab, where the scene does not say.
const THICKNESS_OF_SIDE: f64 = 1.5;

impl Reader<'_> {
    /// The slab of `n_atoms` particles at a temperature (ε/k_B); the literature of `model` gives densities that are not written.
    fn slab(
        &self,
        table: &SlabKeys,
        n_atoms: usize,
        temperature: f64,
        model: Option<ModelKind>,
    ) -> Result<Slab, SceneError> {
        let [liquid_density, vapor_density] = densities(
            ["liquid_density", "vapor_density"],
            [table.liquid_density, table.vapor_density],
            |key, allowed| self.coexisting(temperature, model, key, allowed),
        )?;
        if vapor_density >= liquid_density {
            return Err(self
                .refuse("start.vapor_density", "is not below the density of the liquid")
                .found(vapor_density)
                .allowed(format!("below {liquid_density} σ⁻³")));
        }
        let per_volume = liquid_density + (LENGTH_OF_THICKNESS - 1.0) * vapor_density;
        let side = (n_atoms as f64 / (THICKNESS_OF_SIDE * per_volume)).cbrt();
        let (thickness, length) = match (table.thickness, table.length) {
            (Some(thickness), Some(length)) => (thickness, length),
            (Some(thickness), None) => (thickness, LENGTH_OF_THICKNESS * thickness),
            (None, Some(length)) => (length / LENGTH_OF_THICKNESS, length),
            (None, None) => {
                let thickness = THICKNESS_OF_SIDE * side;
                (thickness, LENGTH_OF_THICKNESS * thickness)
            }
        };
        if thickness + Slab::LEAST_VAPOR > length {
            return Err(self
                .refuse("start.thickness", "leaves no room for vapor")
                .found(thickness)
                .allowed(format!(
                    "{} σ below the length of the box, {} σ",
                    Slab::LEAST_VAPOR,
                    short(length)
                )));
        }
        Ok(Slab { n_atoms, liquid_density, vapor_density, thickness, length })
    }

    /// The densities of liquid and vapor in the literature.
    fn coexisting(
        &self,
        temperature: f64,
        model: Option<ModelKind>,
        key: &str,
        allowed: &str,
    ) -> Result<[f64; 2], SceneError> {
        let missing = |found: String| {
            let refused = self.refuse(key, "is missing");
            refused.found(found).allowed(allowed)
        };
        let Some(model) = model else {
            return Err(missing("nothing, and no literature for a slab of several species".into()));
        };
        let source =
            TwoPhaseSource::of(model).map_err(|none| missing(format!("nothing, and {none}")))?;
        let phases = source.at(temperature).ok_or_else(|| {
            self.refuse("system.temperature", "has no liquid beside its vapor")
                .found(temperature)
                .allowed(format!(
                    "below the critical temperature {} ({}) and not far below the triple point, or {allowed}",
                    source.critical().temperature,
                    source.name()
                ))
        })?;
        let s = phases.saturation;
        Ok([s.liquid_density, s.vapor_density])
    }

    /// Both tables; `counted` is the number of particles that the species have together, where they are counted, and `model`
    /// the model of atoms of one species.
    pub fn system(
        &self,
        resolve: Resolve<'_>,
        counted: Option<usize>,
        model: Option<ModelKind>,
    ) -> Result<System, SceneError> {
        let written = self.table("system");
        if let Some(sides) = written.get("box") {
            self.refuse_triclinic(sides)?;
        }
        let table: SystemKeys = self.section("system").read(written)?;
        let keys: StartKeys = self.section("start").method(self.table("start"))?;
        let geometry = match (table.density, table.sides) {
            (Some(_), Some(_)) => {
                return Err(self
                    .refuse("system.box", "and `density` are both given")
                    .found("both")
                    .allowed(
                        "one of them (and `start.vacuum` for empty space beside the particles)",
                    ));
            }
            (Some(density), None) => Some(Geometry::Density(density)),
            (None, Some(Sides(sides))) => Some(Geometry::Box(sides)),
            (None, None) => None,
        };
        self.said_by_start(&keys)?;
        let is_listed = matches!(keys, StartKeys::Positions(_));
        let temperature = match table.temperature {
            // Bodies that are listed are at rest unless the scene says otherwise.
            None if is_listed => 0.0,
            temperature => temperature.ok_or_else(|| self.needed("temperature"))?,
        };
        let count = || self.count(table.n_atoms.or(counted), table.n_molecules);
        let filled = |lattice, vacuum| {
            let n_atoms = count()?;
            let geometry = geometry.ok_or_else(|| self.needed("density"))?;
            Ok(Arrangement::Lattice { lattice, n_atoms, geometry, vacuum })
        };
        let start = match &keys {
            StartKeys::Lattice(keys) => filled(Some(keys.lattice), keys.vacuum)?,
            StartKeys::Random(keys) => filled(None, keys.vacuum)?,
            StartKeys::Slab(keys) => {
                Arrangement::Slab(self.slab(keys, count()?, temperature, model)?)
            }
            StartKeys::HalfCrystal(keys) => {
                Arrangement::HalfCrystal(self.half_crystal(keys, count()?, temperature, model)?)
            }
            StartKeys::Positions(keys) => self.listed(keys, geometry)?,
            StartKeys::File(keys) => {
                let substance = self.units.map(|units| units.length_time_mass());
                let units = FileUnits::new(keys.length_scale, keys.time_scale, substance);
                if let (Some(found), None, None) = (units.time, units.length, substance) {
                    return Err(self
                        .refuse("start.time_scale", "is of a file in other units")
                        .found(found)
                        .allowed("`length_scale` beside it"));
                }
                let path = self.of_start("file", keys.file.as_ref())?;
                let path = resolve(self.source, "start.file", Path::new(path))?;
                Arrangement::File { path, geometry, units }
            }
        };
        let held = table.held.map_or(Ok(Vec::new()), |Numbers(numbers)| self.held(&numbers))?;
        Ok(System { start, temperature, seed: table.seed, held })
    }

    /// Refuses a key of `[system]` that the start says itself.
    fn said_by_start(&self, start: &StartKeys) -> Result<(), SceneError> {
        const COUNTS: [&str; 3] = ["n_atoms", "n_molecules", "density"];
        let (kind, keys, allowed) = match start {
            StartKeys::Lattice(_) | StartKeys::Random(_) => return Ok(()),
            StartKeys::Positions(_) => ("positions", &COUNTS[..], "nothing: the positions say it"),
            StartKeys::File(_) => ("file", &COUNTS[..], "no such key: the file has it"),
            StartKeys::Slab(_) => ("slab", &["density", "box"][..], BY_PHASES),
            StartKeys::HalfCrystal(_) => ("half-crystal", &["density", "box"][..], BY_PHASES),
        };
        let written = self.table("system");
        match keys.iter().find_map(|key| Some((key, written.get(*key)?))) {
            None => Ok(()),
            Some((key, value)) => Err(self
                .refuse(
                    &format!("system.{key}"),
                    format!("does not go with `start.kind = {kind:?}`"),
                )
                .found(in_short(value))
                .allowed(allowed)),
        }
    }

    /// The value of a key of `[start]` that its kind needs.
    fn of_start<V>(&self, key: &str, value: Option<V>) -> Result<V, SceneError> {
        self.section("start").needed(self.table("start"), key, value)
    }

    /// The number of particles, or of molecules where the scene has some.
    fn count(&self, atoms: Option<usize>, molecules: Option<usize>) -> Result<usize, SceneError> {
        let bonded = self.source.wrote("molecule");
        let (own, other) = match bonded {
            true => ("n_molecules", ("n_atoms", atoms)),
            false => ("n_atoms", ("n_molecules", molecules)),
        };
        if let (key, Some(found)) = other {
            let message = match bonded {
                true => "does not go with `[molecule]`",
                false => "has no `[molecule]` beside it",
            };
            return Err(self
                .refuse(&format!("system.{key}"), message)
                .found(found)
                .allowed(format!("`{own}`")));
        }
        let count = if bonded { molecules } else { atoms };
        count.ok_or_else(|| self.needed(own))
    }

    fn needed(&self, key: &str) -> SceneError {
        let allowed = reference::find("system", None, key).map(|doc| doc.allowed.text());
        let or = match key {
            "density" => ", or `box` with three sides",
            "n_atoms" | "n_molecules" => ", or `[start]` with `positions` or a `file`",
            _ => "",
        };
        self.refuse(&format!("system.{key}"), "is missing")
            .found("nothing")
            .allowed(format!("{}{or}", allowed.unwrap_or_default()))
    }

    fn refuse_triclinic(&self, sides: &Value) -> Result<(), SceneError> {
        /// Numbers of a box with tilt factors, and of three cell vectors.
        const TRICLINIC: [usize; 2] = [6, 9];
        let Value::Array(items) = sides else {
            return Ok(());
        };
        if TRICLINIC.contains(&items.len()) || items.iter().any(Value::is_array) {
            return Err(self
                .refuse("system.box", "cannot be used: triclinic boxes are not available yet")
                .found(in_short(sides))
                .allowed("one side, or three sides [Lx, Ly, Lz], of a box with right angles"));
        }
        let is_side = |item: &Value| match item {
            Value::Float(x) => x.is_finite() && *x > 0.0,
            Value::Integer(x) => *x > 0,
            _ => false,
        };
        match items.iter().all(is_side) {
            true => Ok(()),
            false => Err(self.section("system").not_allowed("box", sides)),
        }
    }
}
