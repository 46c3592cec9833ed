//! Whether molecules and the ways to hold their bonds fit the rest of a scene.

use lennard_core::{Bonds, IntegratorSpec};
use lennard_forcefield::{HitRule, Response};
use lennard_integrators::{BarostatOptions, stormer_verlet, thermostats};

use crate::error::SceneError;
use crate::molecule::{Molecule, MoleculeKind};
use crate::reference::quoted;
use crate::stiff::TooStiff;
use crate::walls::WallTable;
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
    under_barostats(scene, molecule)?;
    if scene.accuracy.is_some() && molecule.bonds.spec().integrator.is_some() {
        return Err(source
            .refuse("accuracy", "does not go with bonds that are solved for in a step of their own")
            .found(format!("`[accuracy]` and [bonds] method = {:?}", molecule.bonds.name()))
            .allowed("another way to hold bonds, or settings of your own"));
    }
    molecule.bonds.check_for(&molecule.topology).map_err(|e| {
        source
            .refuse(&format!("bonds.{}", e.key), "is not allowed")
            .found(e.found)
            .allowed(e.allowed)
    })?;
    solved_with_contacts(scene, molecule)?;
    suited_methods(scene, molecule)?;
    stable_springs(scene, molecule)
}

/// Refuses sweeps over bonds alone where contacts of SPOOK are solved for with them.
fn solved_with_contacts(scene: &Scene, molecule: &Molecule) -> Result<(), SceneError> {
    let sweeps = molecule.bonds.sweeps_alone();
    if sweeps == 0 || !scene.solves_contacts() {
        return Ok(());
    }
    Err(scene
        .source
        .refuse("bonds.sweeps", "counts sweeps over bonds alone")
        .found(format!("{sweeps} with [contact] kind = \"spook\""))
        .allowed("0; `contact.sweeps` counts sweeps over bonds and contacts together"))
}

/// Refuses barostats whose step takes the place of the method, where that method holds the bonds or there is one molecule.
fn under_barostats(scene: &Scene, molecule: &Molecule) -> Result<(), SceneError> {
    let is_alone = scene.n_particles() == Some(molecule.topology.sites());
    let by_method = molecule.bonds.spec().integrator.is_some();
    for (i, stage) in scene.stages.iter().enumerate() {
        let inside = |options: &BarostatOptions| options.is_inside_step();
        let Some(control) = (stage.barostat.as_ref()).filter(|c| inside(&c.options)) else {
            continue;
        };
        let name = control.options.name();
        let (message, found, or) = if by_method {
            (
                "does not go with the bonds of SPOOK",
                format!("{name:?}, whose step takes the place of the method that solves for them"),
                "another way to hold bonds",
            )
        } else if is_alone {
            (
                "needs more than one molecule",
                format!("{name:?} with one molecule, whose centre has no degree of freedom"),
                "more molecules",
            )
        } else {
            continue;
        };
        let all = BarostatOptions::all();
        let fit: Vec<&str> =
            (all.iter().filter(|options| !inside(options))).map(BarostatOptions::name).collect();
        return Err(scene
            .source
            .refuse(&format!("stage.{i}.barostat"), message)
            .found(found)
            .allowed(format!("{}; or {or}", quoted(&fit))));
    }
    Ok(())
}

/// Refuses walls that act where bonds are held too, but for hits on the way of a flight, dashpots, and planes among contacts of SPOOK.
fn between_walls(scene: &Scene, molecule: &Molecule) -> Result<(), SceneError> {
    // Springs that are forces leave drifts alone.
    if molecule.bonds.bonds() == Bonds::Springs {
        return Ok(());
    }
    let by_spook = molecule.bonds.spec().integrator.is_some();
    // Contacts fly bodies from wall to wall by themselves, without bonds.
    let takes_hits = !by_spook && scene.contact.is_none();
    let solves = by_spook && scene.solves_contacts();
    for (i, table) in scene.walls.iter().enumerate() {
        let surface = scene.surface(table);
        let fits = match surface.rule() {
            None => surface.dashpot().is_none() || takes_hits,
            Some(HitRule::OnLines) => takes_hits,
            Some(HitRule::ByContacts) => solves,
            Some(_) => false,
        };
        if !fits {
            return Err(unsuited_wall(scene, molecule, (i, table), takes_hits));
        }
    }
    Ok(())
}

/// What is said of a wall that does not go with the bonds.
fn unsuited_wall(
    scene: &Scene,
    molecule: &Molecule,
    (i, table): (usize, &WallTable),
    takes_hits: bool,
) -> SceneError {
    let by_spook = molecule.bonds.spec().integrator.is_some();
    let bonds = format!("[bonds] method = {:?}", molecule.bonds.name());
    let exerts = "a wall that only exerts a force";
    let kinds =
        "\"lennard-jones-9-3\", \"lennard-jones-10-4\", \"wca\", or \"soft\" with restitution = 1";
    let source = &scene.source;
    let rule = scene.surface(table).rule();
    let of_single_sites = match rule {
        Some(HitRule::OnParabolas) => Some(Response::Event),
        Some(HitRule::Mirrored { .. }) => Some(Response::Mirror),
        Some(HitRule::Projected) => Some(Response::Project),
        _ => None,
    };
    if let Some(response) = of_single_sites
        && takes_hits
    {
        return source
            .refuse(&format!("wall.{i}.response"), "moves single sites, off their bonds")
            .found(format!("{:?} with {bonds}", response.name()))
            .allowed(format!("\"billiard\"; or a \"thermal\" wall, or {exerts}"));
    }
    let kind = table.options.spec().name;
    let on_lines = rule == Some(HitRule::OnLines);
    let (beside, or) = match by_spook {
        true => (
            format!("and {bonds}"),
            "\"hard\" with response = \"contact\" and [contact] kind = \"spook\"",
        ),
        // Molecules hit this wall where there are no contacts.
        false if on_lines => ("beside [contact]".to_owned(), "no [contact]"),
        false => (format!("and {bonds}"), "\"hard\" without [contact]"),
    };
    source
        .refuse(&format!("wall.{i}.kind"), "does not go with molecules")
        .found(format!("{kind:?}, which acts in drifts, {beside}"))
        .allowed(format!("{exerts}: {kinds}; or {or}"))
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
    let solver = molecule.bonds.spec().integrator;
    let by_spook = solver.is_some();
    let suits = |spec: &IntegratorSpec| match solver {
        Some(name) => spec.name == name,
        None => match molecule.bonds.bonds() {
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
        let by_bath = spec.name != scene.integrator.method.spec().name;
        let (key, fit) = if by_bath && suits(scene.integrator.method.spec()) {
            // The bath stands in the place of a method that holds them: another bath lets it.
            let baths = thermostats().iter().filter(|bath| bath.keeps_motion);
            let names: Vec<_> = baths.map(|bath| bath.name).collect();
            (format!("stage.{i}.thermostat"), format!("thermostat = one of {}", quoted(&names)))
        } else {
            let methods = lennard_integrators::integrators().iter();
            let fit = methods.filter(|entry| suits(entry.spec));
            let names: Vec<_> = fit.map(|entry| entry.spec.name).collect();
            (
                match by_bath {
                    true => format!("stage.{i}.thermostat"),
                    false => "integrator.kind".to_owned(),
                },
                format!("[integrator] kind = {}", quoted(&names)),
            )
        };
        let (message, or) = match (by_spook, molecule.bonds.bonds()) {
            (true, _) => ("does not go with the bonds of SPOOK", "another way to hold bonds"),
            (false, Bonds::Impulses) => (
                "has no drift that implicit springs or dashpots can act in",
                "bonds.scheme = \"explicit\" with bonds.damping = 0",
            ),
            (false, _) => ("has no form that holds rigid bonds", "[bonds] method = \"spring\""),
        };
        let places = [key.as_str(), "bonds", "molecule"];
        let place = places.iter().find_map(|key| scene.source.place(key));
        return Err(scene
            .source
            .refuse(&key, message)
            .at(place.cloned())
            .found(format!("{:?} with [bonds] method = {:?}", spec.name, molecule.bonds.name()))
            .allowed(format!("{fit}; or {or}")));
    }
    Ok(())
}

/// Refuses steps that a stiff spring does not bear: ω·h must stay below the limit of the method.
fn stable_springs(scene: &Scene, molecule: &Molecule) -> Result<(), SceneError> {
    let omega = molecule.fastest_vibration();
    let Some(TooStiff { stage, dt, limit }) = scene.too_stiff(omega) else {
        return Ok(());
    };
    let key = match scene.stages[stage].dt {
        Some(_) => format!("stage.{stage}.dt"),
        None => "integrator.dt".to_owned(),
    };
    Err(scene
        .source
        .refuse(&key, "is too long for the springs")
        .found(format!("{dt}: ω·dt = {:.3}, with ω = {omega:.3} per τ", omega * dt))
        .allowed(format!("below {:.3e} τ, or softer springs", limit / omega)))
}
