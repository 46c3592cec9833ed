//! Response functions of a run that an older version made, from the rows that it has kept.

use lennard_core::{PeriodicBox, Table};
use lennard_engine::responses_of_recorded;
use lennard_io::{AverageRecord, RunRecord};
use lennard_observables::response_functions;
use lennard_scene::Scene;

/// c_v is as old as the program: it does not tell whether a run has response functions.
const OLDEST: &str = "heat_capacity";
/// Fewer particles than a dozen have no response functions of a fluid.
const FEW: u64 = 12;

/// Adds response functions to the record of a run that has none and does not say why. Gives what is to be said: where they are
/// from, or why there are none. `has_two_phases` tells that the run is no homogeneous fluid.
pub(super) fn complete(
    record: &mut RunRecord,
    scene: &Scene,
    cell: PeriodicBox,
    has_two_phases: bool,
    thermo: impl FnOnce() -> Option<Table>,
) -> Vec<String> {
    let has_some = response_functions()
        .filter(|name| *name != OLDEST)
        .any(|name| record.averages.contains_key(name));
    let says_why = |remark: &String| {
        remark.contains("response functions: ") || remark.starts_with("left out: ")
    };
    if has_some || record.remarks.iter().any(says_why) || record.atoms < FEW {
        return Vec::new();
    }
    let added = if has_two_phases {
        Err("two phases side by side have no one density".into())
    } else {
        match thermo() {
            None => Err("the run has kept no thermo.csv that can be read".into()),
            Some(rows) => add(record, scene, cell, &rows),
        }
    };
    added.unwrap_or_else(|why| vec![format!("no response functions: {why}")])
}

fn add(
    record: &mut RunRecord,
    scene: &Scene,
    cell: PeriodicBox,
    rows: &Table,
) -> Result<Vec<String>, String> {
    let counts = record.species.iter().map(|s| s.count as usize);
    let counts: Vec<usize> = counts.collect();
    let species = match counts.as_slice() {
        [] => scene.one_species(record.atoms as usize),
        counts => scene.species_in_order(counts),
    };
    let found = responses_of_recorded(scene, cell, &species, record.n_dof as f64, rows)?;
    let measured = scene.stages.iter().filter(|s| s.measure);
    let steps = measured.map(|s| s.steps).sum();
    for average in &found.averages {
        // What the run itself has said stays.
        let entry = record.averages.entry(average.name.clone());
        entry.or_insert_with(|| AverageRecord::new(average, steps));
    }
    let mut remarks = found.remarks;
    remarks.push(format!(
        "response functions: not in run.json (version {}), and made from thermo.csv now",
        record.version
    ));
    Ok(remarks)
}
