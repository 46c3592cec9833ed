//! What must hold between a mixture and the rest of the scene.

use lennard_forcefield::CutoffUnit;

use crate::{Scene, SceneError};

/// Whether the species fit the rest of the scene.
pub(crate) fn check(scene: &Scene) -> Result<(), SceneError> {
    let source = &scene.source;
    let Some(mixture) = &scene.mixture else {
        return match scene.truncation.r_cut_in {
            None | Some(CutoffUnit::Sigma) => Ok(()),
            Some(unit) => Err(source
                .refuse(
                    "truncation.r_cut_in",
                    "has no pairs of species to measure by",
                )
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
    if !scene.walls.is_empty() {
        let allowed = "one species between walls: walls have no σ and ε for others";
        return beside("wall", "`[[wall]]`", allowed);
    }
    if scene.accuracy.is_some() {
        let allowed = "settings of your own: the predictions of errors are for one species";
        return beside("accuracy", "`[accuracy]`", allowed);
    }
    if scene.integrator.split.is_some() {
        let name = format!("{:?}", scene.integrator.method.name());
        let allowed = "a method with one step for all forces, such as \"velocity-verlet\"";
        return beside("integrator.kind", &name, allowed);
    }
    if source.wrote("output.element") {
        let allowed = "`element` of each species";
        return beside("output.element", "`element` in `[output]`", allowed);
    }
    for (i, table) in scene.observables.iter().enumerate() {
        let spec = table.options.spec();
        if mixture.species.len() > 1 && !spec.suits.includes_mixtures() {
            return Err(source
                .refuse(&format!("observable.{i}.kind"), "is for one species alone")
                .found(format!(
                    "{:?} with {} species",
                    spec.name,
                    mixture.species.len()
                ))
                .allowed("a scene of one species"));
        }
    }
    Ok(())
}
