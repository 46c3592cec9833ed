//! What must hold between a mixture and the rest of the scene.

use lennard_forcefield::{CutoffUnit, ForceFieldError, Surface, WallContext};

use crate::{Scene, SceneError, WallTable};

impl Scene {
    /// A force field that does not fit, on the line that it is about. A cutoff that a table `[[pair]]` gives is on the line of that table.
    #[must_use]
    pub fn misfit(&self, error: &ForceFieldError) -> SceneError {
        let ForceFieldError::CutoffOverHalfBox { r_cut, .. } = error else {
            return self.misfit_of(&error.key(), error);
        };
        let mut pairs = self.mixture.iter().flat_map(|m| &m.pairs);
        let own = pairs.position(|pair| {
            let [a, b] = pair.species;
            pair.r_cut.is_some() && self.species_pair(a, b).r_cut == *r_cut
        });
        let key = own.map_or_else(|| error.key(), |pair| format!("pair.{pair}.r_cut"));
        self.misfit_of(&key, error)
    }

    fn misfit_of(&self, key: &str, error: &ForceFieldError) -> SceneError {
        let refused = self.source.refuse(key, error.problem());
        refused.found(error.found()).allowed(error.allowed())
    }
}

/// Whether the species fit the rest of the scene.
pub(crate) fn check(scene: &Scene) -> Result<(), SceneError> {
    let source = &scene.source;
    observables_fit(scene)?;
    let Some(mixture) = &scene.mixture else {
        return match scene.truncation.r_cut_in {
            None | Some(CutoffUnit::Sigma) => Ok(()),
            Some(unit) => Err(source
                .refuse("truncation.r_cut_in", "has no pairs of species to measure by")
                .found(format!("{:?} without `[[species]]`", unit.name()))
                .allowed("a table `[[species]]` for each species, or no such key")),
        };
    };
    let beside = |key: &str, what: &str, allowed: &str| {
        Err(source
            .refuse(key, "does not go with species")
            .found(format!("{what} and `[[species]]`"))
            .allowed(allowed))
    };
    if scene.molecule.is_some() {
        let allowed = "atoms of several species, or molecules of one";
        return beside("molecule", "`[molecule]`", allowed);
    }
    for (i, table) in scene.walls.iter().enumerate() {
        if mixture.species.len() > 1 && has_sites(scene, table) {
            let kind = format!("{:?}", table.options.spec().name);
            let allowed = "\"hard\", \"thermal\" or \"soft\", which act on the centers of all particles: others have no σ and ε for each species";
            return beside(&format!("wall.{i}.kind"), &kind, allowed);
        }
    }
    if source.wrote("output.element") {
        let allowed = "`element` of each species";
        return beside("output.element", "`element` in `[output]`", allowed);
    }
    Ok(())
}

/// Whether a wall acts as sites do, with a σ and an ε of its own: it is neither hit nor a spring.
fn has_sites(scene: &Scene, table: &WallTable) -> bool {
    let context = WallContext { temperature: scene.system.temperature };
    match table.options.surface(&context, false) {
        Surface::Hit(_) => false,
        Surface::Exerts(wall) => wall.contact().is_none(),
    }
}

/// Refuses observables that are for another number of species.
fn observables_fit(scene: &Scene) -> Result<(), SceneError> {
    let n = scene.mixture.as_ref().map_or(1, |m| m.species.len());
    for (i, table) in scene.observables.iter().enumerate() {
        let (spec, fits) = (table.options.spec(), table.options.species());
        let (what, allowed) = if n > 1 && !spec.suits.includes_mixtures() {
            ("is for one species alone", "a scene of one species".to_owned())
        } else if !fits.contains(&n) {
            let allowed = format!("a scene with {} tables `[[species]]`", fits.start());
            ("is for another number of species", allowed)
        } else {
            continue;
        };
        return Err(scene
            .source
            .refuse(&format!("observable.{i}.kind"), what)
            .found(format!("{:?} with {n} species", spec.name))
            .allowed(allowed));
    }
    Ok(())
}
