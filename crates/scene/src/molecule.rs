//! The tables `[molecule]` and `[bonds]`: what the molecules are, and how their bonds are held.

use lennard_core::{Bonds, IntegratorSpec, MOST_SITES, Molecules};
use lennard_integrators::{BondOptions, spook};

use crate::error::SceneError;
use crate::read::{Reader, with_tag};
use crate::{Lattice, Scene, Start};

lennard_core::choices! {
    /// The kind of the molecules.
    pub enum MoleculeKind {
        /// Two sites.
        #[default]
        Dumbbell = "dumbbell",
        /// A chain of sites.
        Chain = "chain",
    }
}

lennard_core::options! {
    /// The table `[molecule]`.
    pub struct MoleculeOptions {
        /// Kind of the molecules: a dumbbell has two sites, a chain 2 to 64. The two sites of a bond do not interact.
        kind: MoleculeKind = MoleculeKind::Dumbbell, Names(MoleculeKind::names);
        /// Sites of each molecule; a scene of chains must say.
        sites: u32 = 2, Whole(2, MOST_SITES as i64);
        /// Length of each bond, below `truncation.r_cut`; it must be written.
        bond_length: f64 = 1.0, Between(0.01, 100.0), in "σ";
    }
}

/// The molecules of a scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Molecule {
    /// The table `[molecule]`.
    pub options: MoleculeOptions,
    /// The table `[bonds]`.
    pub bonds: BondOptions,
}

impl Molecule {
    /// The molecules as a system has them.
    #[must_use]
    pub fn molecules(&self) -> Molecules {
        let sites = self.options.sites as usize;
        Molecules::chains(sites, self.options.bond_length, self.bonds.bonds())
    }
}

impl Scene {
    /// The model in words: potential, truncation, and molecules where there are some.
    #[must_use]
    pub fn model_name(&self) -> String {
        let pairs = lennard_forcefield::model_name(&self.force_field());
        let Some(Molecule { options, bonds }) = &self.molecule else {
            return pairs;
        };
        let (sites, length) = (options.sites, options.bond_length);
        let kind = match options.kind {
            MoleculeKind::Dumbbell => "dumbbells".to_owned(),
            MoleculeKind::Chain => format!("chains of {sites} sites"),
        };
        let held = match bonds.bonds() {
            Bonds::Rigid => format!("rigid bonds of {length} σ, {}", bonds.name()),
            Bonds::Springs => format!("bonds of {length} σ, {}", bonds.name()),
        };
        format!("{pairs}; {kind} with {held}")
    }

    /// The molecules of the scene; atoms where it has none.
    #[must_use]
    pub fn molecules(&self) -> Molecules {
        self.molecule
            .as_ref()
            .map_or(Molecules::ATOMS, Molecule::molecules)
    }
}

impl Reader<'_> {
    pub fn molecule(&self) -> Result<Option<Molecule>, SceneError> {
        if !self.source.wrote("molecule") {
            if self.source.wrote("bonds") {
                return Err(self
                    .source
                    .refuse("bonds", "has no bonds to hold")
                    .found("`[bonds]` without `[molecule]`")
                    .allowed("a table `[molecule]` beside it"));
            }
            return Ok(None);
        }
        let section = self.section("molecule");
        let options: MoleculeOptions = section.read(self.node("molecule"))?;
        let needed = |key: &str, allowed: &str| {
            self.source
                .refuse(&format!("molecule.{key}"), "is missing")
                .found("nothing")
                .allowed(allowed)
        };
        if !self.source.wrote("molecule.bond_length") {
            return Err(needed(
                "bond_length",
                "a length above 0 and below `truncation.r_cut`, σ",
            ));
        }
        match options.kind {
            MoleculeKind::Dumbbell if options.sites != 2 => {
                return Err(section.impossible(
                    "sites",
                    &options.sites.to_string(),
                    "2 for a dumbbell; kind = \"chain\" takes more",
                ));
            }
            MoleculeKind::Chain if !self.source.wrote("molecule.sites") => {
                return Err(needed("sites", "a whole number from 2 to 64"));
            }
            _ => {}
        }
        let section = self.section("bonds").with(&["method"]);
        let node = with_tag(self.node("bonds"), "method", BondOptions::default().name());
        let bonds: BondOptions = section.read(&node)?;
        bonds
            .check()
            .map_err(|e| section.impossible(e.key, &e.found, &e.allowed))?;
        Ok(Some(Molecule { options, bonds }))
    }
}

/// Whether molecules fit the rest of the scene.
pub(crate) fn check(scene: &Scene) -> Result<(), SceneError> {
    suited_observables(scene)?;
    let Some(molecule) = &scene.molecule else {
        return Ok(());
    };
    let source = &scene.source;
    let length = molecule.options.bond_length;
    let r_cut = scene.truncation.r_cut;
    if length >= r_cut {
        return Err(source
            .refuse("molecule.bond_length", "is not below the cutoff")
            .found(length)
            .allowed(format!("below truncation.r_cut = {r_cut}")));
    }
    if let Start::Lattice { lattice, .. } = scene.system.start
        && lattice == Lattice::Random
    {
        return Err(source
            .refuse("system.lattice", "does not go with molecules")
            .found("\"random\"")
            .allowed("\"fcc\", \"sc\" or \"bcc\", or `configuration` with a file"));
    }
    if !scene.walls.is_empty() {
        return Err(source
            .refuse("wall", "does not go with molecules")
            .found("`[[wall]]` and `[molecule]`")
            .allowed("atoms between walls, or molecules in a periodic box"));
    }
    for (i, stage) in scene.stages.iter().enumerate() {
        if stage.barostat.is_some() {
            return Err(source
                .refuse(&format!("stage.{i}.barostat"), "does not go with molecules")
                .found("a barostat and `[molecule]`")
                .allowed("a fixed box: barostats here scale sites, which would stretch bonds"));
        }
    }
    if scene.accuracy.is_some() {
        return Err(source
            .refuse("accuracy", "does not go with molecules")
            .found("`[accuracy]` and `[molecule]`")
            .allowed("settings of your own: the predictions of errors are for atoms"));
    }
    suited_methods(scene, molecule)?;
    stable_springs(scene, molecule)
}

/// Refuses observables for atoms in a scene of molecules, and the other way round.
fn suited_observables(scene: &Scene) -> Result<(), SceneError> {
    let is_molecular = scene.molecule.is_some();
    for (i, table) in scene.observables.iter().enumerate() {
        let spec = table.options.spec();
        if spec.suits.includes(is_molecular) {
            continue;
        }
        let (message, beside) = match is_molecular {
            true => ("is for atoms alone", "with `[molecule]`"),
            false => ("is for molecules alone", "without `[molecule]`"),
        };
        let names = lennard_observables::observables()
            .iter()
            .filter(|spec| spec.suits.includes(is_molecular))
            .map(|spec| format!("{:?}", spec.name));
        return Err(scene
            .source
            .refuse(&format!("observable.{i}.kind"), message)
            .found(format!("{:?} {beside}", spec.name))
            .allowed(names.collect::<Vec<_>>().join(", ")));
    }
    Ok(())
}

/// Refuses ways to hold bonds under a method that does not hold them, in any stage.
fn suited_methods(scene: &Scene, molecule: &Molecule) -> Result<(), SceneError> {
    let by_spook = matches!(molecule.bonds, BondOptions::Spook(_));
    let suits = |spec: &IntegratorSpec| match by_spook {
        true => spec.name == spook::SPEC.name,
        false => spec.holds_rigid_bonds || molecule.bonds.bonds() == Bonds::Springs,
    };
    for (i, stage) in scene.stages.iter().enumerate() {
        let spec = scene.method_of(stage).spec();
        if suits(spec) {
            continue;
        }
        let key = match spec.name == scene.integrator.method.spec().name {
            true => "integrator.kind".to_owned(),
            false => format!("stage.{i}.thermostat"),
        };
        let names = lennard_integrators::integrators()
            .iter()
            .filter(|entry| suits(entry.spec))
            .map(|entry| format!("{:?}", entry.spec.name));
        let names = names.collect::<Vec<_>>().join(", ");
        let (message, or) = match by_spook {
            true => (
                "does not go with the bonds of SPOOK",
                "another way to hold bonds",
            ),
            false => (
                "has no form that holds rigid bonds",
                "[bonds] method = \"spring\"",
            ),
        };
        let places = [key.as_str(), "bonds", "molecule"];
        let place = places.iter().find_map(|key| scene.source.place(key));
        return Err(scene
            .source
            .refuse(&key, message)
            .at(place.cloned())
            .found(format!(
                "{:?} with [bonds] method = {:?}",
                spec.name,
                molecule.bonds.name()
            ))
            .allowed(format!("[integrator] kind = {names}; or {or}")));
    }
    Ok(())
}

/// Refuses steps that a stiff spring does not bear: ω·h must stay below the limit of the method.
fn stable_springs(scene: &Scene, molecule: &Molecule) -> Result<(), SceneError> {
    // A site of a chain has two bonds: the fastest vibration of a long chain is √2 times as fast as of one bond.
    let phase = 0.5 * std::f64::consts::PI * (1.0 - 1.0 / f64::from(molecule.options.sites));
    let omega = molecule.bonds.frequency() * std::f64::consts::SQRT_2 * phase.sin();
    let limit = scene.integrator.method.spec().stability_limit;
    let limit = limit.unwrap_or(f64::INFINITY);
    for (i, stage) in scene.stages.iter().enumerate() {
        let dt = scene.stage_dt(stage);
        if omega * dt < limit {
            continue;
        }
        let key = match stage.dt {
            Some(_) => format!("stage.{i}.dt"),
            None => "integrator.dt".to_owned(),
        };
        return Err(scene
            .source
            .refuse(&key, "is too long for the springs")
            .found(format!(
                "{dt}: ω·dt = {:.3}, with ω = {omega:.3} per τ",
                omega * dt
            ))
            .allowed(format!("below {:.3e} τ, or softer springs", limit / omega)));
    }
    Ok(())
}
