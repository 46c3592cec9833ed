//! Whether molecules and the ways to hold their bonds fit the rest of a scene.

use lennard_core::{Bonds, IntegratorSpec};
use lennard_forcefield::{HitRule, WallContext};
use lennard_integrators::{BarostatOptions, BondOptions, spook, stormer_verlet};

use crate::error::SceneError;
use crate::molecule::{Molecule, MoleculeKind};
use crate::reference::quoted;
use crate::{Lattice, Scene, Start};

/// Whether molecules fit the rest of the scene.
pub(crate) fn check(scene: &Scene) -> Result<(), SceneError> {
    suited_observables(scene)?;
    let Some(molecule) = &scene.molecule else {
        return Ok(());
    };
    let source = &scene.source;
    let lengths = molecule.topology.bonds().iter().map(|bond| bond.length);
    let length = lengths.fold(0.0, f64::max);
    let r_cut = scene.truncation.r_cut;
    let acts = scene.potential.own_end().is_none_or(|end| end.r > 0.0);
    if acts && length >= r_cut {
        return Err(source
            .refuse(molecule.key_of_size(), "is not below the cutoff")
            .found(length)
            .allowed(format!("below truncation.r_cut = {r_cut}")));
    }
    let lattice = match scene.system.start {
        Start::Lattice { lattice, .. } => Some(lattice),
        Start::Slab(_)
        | Start::HalfCrystal(_)
        | Start::Listed { .. }
        | Start::Configuration { .. } => None,
    };
    let by_shape = molecule.options.kind == MoleculeKind::Sites;
    if lattice.is_some() && by_shape && molecule.options.shape.is_none() {
        return Err(source
            .refuse("molecule.shape", "is missing")
            .found("nothing, and a start on a lattice")
            .allowed(
                "the places of the sites of one molecule, or `system.configuration` with a file",
            ));
    }
    if lattice == Some(Lattice::Random) {
        return Err(source
            .refuse("system.lattice", "does not go with molecules")
            .found("\"random\"")
            .allowed("\"fcc\", \"sc\" or \"bcc\", or `configuration` with a file"));
    }
    between_walls(scene, molecule)?;
    for (i, stage) in scene.stages.iter().enumerate() {
        if let Some(control) = &stage.barostat
            && control.options.is_inside_step()
            && matches!(molecule.bonds, BondOptions::Spook(_))
        {
            let name = control.options.name();
            let beside = |options: &&BarostatOptions| !options.is_inside_step();
            let all = BarostatOptions::all();
            let fit: Vec<&str> = (all.iter().filter(beside))
                .map(BarostatOptions::name)
                .collect();
            return Err(source
                .refuse(
                    &format!("stage.{i}.barostat"),
                    "does not go with the bonds of SPOOK",
                )
                .found(format!(
                    "{name:?}, whose step takes the place of the method that solves for them"
                ))
                .allowed(format!("{}; or another way to hold bonds", quoted(&fit))));
        }
    }
    if scene.accuracy.is_some() {
        return Err(source
            .refuse("accuracy", "does not go with molecules")
            .found("`[accuracy]` and `[molecule]`")
            .allowed("settings of your own: the predictions of errors are for atoms"));
    }
    molecule.bonds.check_for(&molecule.topology).map_err(|e| {
        source
            .refuse(&format!("bonds.{}", e.key), "is not allowed")
            .found(e.found)
            .allowed(e.allowed)
    })?;
    suited_methods(scene, molecule)?;
    stable_springs(scene, molecule)
}

/// Refuses walls that act in drifts, where bonds are held too, but for planes that are hit on the way of a flight.
fn between_walls(scene: &Scene, molecule: &Molecule) -> Result<(), SceneError> {
    // Springs that are forces leave drifts alone.
    if molecule.bonds.bonds() == Bonds::Springs {
        return Ok(());
    }
    let context = WallContext {
        temperature: scene.system.temperature,
    };
    for (i, table) in scene.walls.iter().enumerate() {
        let surface = table.options.surface(&context, false);
        // Contacts fly bodies from wall to wall by themselves, without bonds.
        let straight = matches!(molecule.bonds, BondOptions::Spook(_)) || scene.contact.is_some();
        let is_hit = surface.rule() == Some(HitRule::OnLines) && !straight;
        if surface.dashpot().is_none() && (surface.rule().is_none() || is_hit) {
            continue;
        }
        return Err(scene
            .source
            .refuse(&format!("wall.{i}.kind"), "does not go with molecules")
            .found(format!(
                "{:?}, which acts in drifts, and [bonds] method = {:?}",
                table.options.spec().name,
                molecule.bonds.name()
            ))
            .allowed(match straight {
                true => "a wall that only exerts a force: \"lennard-jones-9-3\", \"lennard-jones-10-4\", \"wca\", or \"soft\" with restitution = 1",
                false => "\"hard\" with response = \"billiard\", \"thermal\", or a wall that only exerts a force",
            }));
    }
    Ok(())
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
        false => match molecule.bonds.bonds() {
            Bonds::Springs => true,
            Bonds::Rigid => spec.holds_rigid_bonds,
            // A method on positions alone forgets the velocities that impulses leave.
            Bonds::Impulses => spec.holds_rigid_bonds && spec.name != stormer_verlet::SPEC.name,
        },
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
        let (message, or) = match (by_spook, molecule.bonds.bonds()) {
            (true, _) => (
                "does not go with the bonds of SPOOK",
                "another way to hold bonds",
            ),
            (false, Bonds::Impulses) => (
                "has no drift that implicit springs can act in",
                "bonds.scheme = \"explicit\"",
            ),
            (false, _) => (
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
    // Bonds that share sites vibrate faster together than alone: a long chain √2 times as fast.
    let omega = molecule.bonds.frequency() * (0.5 * molecule.topology.stiffest()).sqrt();
    for (i, stage) in scene.stages.iter().enumerate() {
        // A bath that stands inside the step takes the place of the integrator.
        let limit = scene.method_of(stage).spec().stability_limit;
        let (dt, limit) = (scene.stage_dt(stage), limit.unwrap_or(f64::INFINITY));
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
