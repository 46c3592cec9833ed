//! Response functions of a run that an older version made, from the rows that it has kept.

use std::path::Path;

use lennard_engine::responses_of_recorded;
use lennard_io::AverageRecord;
use lennard_observables::{NO_RESPONSES_REMARK, RESPONSES_REMARK, response_functions};

use super::read::{ReadError, RunFolder, is_of_few_bodies};

/// c_v is as old as the program: it does not tell whether a run has response functions.
const OLDEST: &str = "heat_capacity";
/// The table of the rows that they are made from.
const ROWS: &str = "thermo";

impl RunFolder {
    /// Reads the folder of a finished run. Response functions that its version did not give are added from `thermo.csv`.
    ///
    /// # Errors
    /// [`ReadError`] where there is no run, it did not finish, or a file of it cannot be read.
    pub fn open(folder: &Path) -> Result<Self, ReadError> {
        let mut run = Self::open_any(folder)?;
        if run.record.finished {
            run.notes = complete(&mut run);
            return Ok(run);
        }
        let why = run.record.remarks.first().map(|r| format!(": {r}")).unwrap_or_default();
        Err(ReadError::Unfinished {
            folder: folder.to_owned(),
            steps: run.record.steps,
            total: run.scene.total_steps(),
            why,
        })
    }
}

/// Adds response functions to the record of a run that has none and does not say why. Gives what is to be said: where they are
/// from, or why there are none.
fn complete(run: &mut RunFolder) -> Vec<String> {
    let has_some = response_functions()
        .filter(|name| *name != OLDEST)
        .any(|name| run.record.averages.contains_key(name));
    let says_why =
        |remark: &String| remark.contains(RESPONSES_REMARK) || remark.starts_with("left out: ");
    let is_said = run.record.remarks.iter().any(says_why);
    if has_some || is_said || is_of_few_bodies(run.molecules()) {
        return Vec::new();
    }
    let added = match run.has_two_phases() || run.scene.half_crystal().is_some() {
        true => Err("two phases side by side have no one density".into()),
        false => add(run),
    };
    added.unwrap_or_else(|why| vec![format!("{NO_RESPONSES_REMARK}{why}")])
}

fn add(run: &mut RunFolder) -> Result<Vec<String>, String> {
    let file = run.table_file(ROWS);
    if !file.exists() {
        return Err(format!("the run has kept no {ROWS}.csv"));
    }
    let rows = lennard_io::read_table_csv(&file).map_err(|bad| bad.to_string())?;
    let (steps, record, scene) = (run.measured_steps(), &mut run.record, &run.scene);
    let counts = record.species.iter().map(|s| s.count as usize);
    let counts: Vec<usize> = counts.collect();
    let species = match counts.as_slice() {
        [] => scene.one_species(record.atoms as usize),
        counts => scene.species_in_order(counts),
    };
    let found = responses_of_recorded(scene, run.cell, &species, record.n_dof as f64, &rows)?;
    for average in &found.averages {
        // What the run itself has said stays.
        let entry = record.averages.entry(average.name.clone());
        entry.or_insert_with(|| AverageRecord::new(average, steps));
    }
    let mut remarks = found.remarks;
    remarks.push(format!(
        "{RESPONSES_REMARK}not in run.json (version {}), and made from {ROWS}.csv now",
        record.version
    ));
    Ok(remarks)
}
