//! Response functions of a run from the rows that it has written, by the code of a run.

use lennard_core::{Findings, Observable, PeriodicBox, SpeciesTable, Table};
use lennard_forcefield::tail_in;
use lennard_observables::{
    NO_RESPONSES_REMARK, RESPONSES_REMARK, Recorded, Thermodynamics, response_functions,
};
use lennard_scene::Scene;

use crate::baths::measured_baths;
use crate::build::thermodynamics;
use crate::findings::judged;
use crate::instant::correction;
use crate::own::OwnParts;

/// Response functions, their errors and what was assumed, from the table `thermo` of a finished run of this scene.
///
/// # Errors
/// In words, where the run cannot give them.
pub fn responses_of_recorded(
    scene: &Scene,
    cell: PeriodicBox,
    species: &SpeciesTable,
    n_dof: f64,
    rows: &Table,
) -> Result<Findings, String> {
    let thermodynamics = recorded(scene, cell, species, n_dof, rows)?;
    let equilibrium = thermodynamics.equilibrium();
    let found = thermodynamics.finish(equilibrium.discarded);
    let mut remarks = found.remarks.iter();
    if let Some(why) = remarks.find_map(|r| r.strip_prefix(NO_RESPONSES_REMARK)) {
        return Err(why.to_owned());
    }
    let mut found =
        judged(found, &equilibrium, false, &measured_baths(scene), crate::exchange::doubt(scene));
    found.averages.retain(|average| response_functions().any(|name| name == average.name));
    found.remarks.retain(|remark| remark.starts_with(RESPONSES_REMARK));
    Ok(Findings { tables: Vec::new(), ..found })
}

/// The thermodynamics of the measured stages, read back.
fn recorded(
    scene: &Scene,
    cell: PeriodicBox,
    species: &SpeciesTable,
    n_dof: f64,
    rows: &Table,
) -> Result<Thermodynamics, String> {
    let column =
        |name: &str| rows.numbers(name).ok_or_else(|| format!("thermo.csv has no column `{name}`"));
    let mut thermodynamics =
        thermodynamics(scene, cell, species, &OwnParts::none()).map_err(|e| e.to_string())?;
    let (time, stage) = (column("time")?, column("stage")?);
    let temperature = column("temperature")?;
    let half = column("temperature_half_steps")?;
    let (potential, pressure) = (column("potential_energy")?, column("pressure")?);
    let (conserved, heat) = (column("conserved_energy")?, column("heat")?);
    let density = column("density").ok();
    let n = species.n_particles();
    let has_halves = half.iter().any(|t| t.is_finite());
    thermodynamics.begin_recorded(n_dof, species.mean_mass(), has_halves);
    let options = scene.force_field();
    let mixture = scene.mixture_of(species);
    let sites = scene.molecules().sites();
    let tail_at = |volume: f64| {
        let tail = tail_in(&options, mixture.as_ref(), n, volume);
        correction(tail, sites).unwrap_or_default()
    };
    let at_start = tail_at(cell.volume());
    for i in 0..time.len() {
        let is_measured = scene.stages.get(stage[i] as usize).is_some_and(|s| s.measure);
        if !is_measured {
            continue;
        }
        let (volume, tail) = match &density {
            None => (cell.volume(), at_start),
            Some(density) => {
                let volume = n as f64 / density[i];
                (volume, tail_at(volume))
            }
        };
        thermodynamics.push_recorded(&Recorded {
            time: time[i],
            temperature: temperature[i],
            temperature_half_steps: has_halves.then_some(half[i]),
            potential_energy: potential[i],
            pressure: pressure[i],
            conserved_energy: conserved[i],
            heat: heat[i],
            volume: volume / n as f64,
            tail,
        });
    }
    Ok(thermodynamics)
}
