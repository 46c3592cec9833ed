//! Checkpoints of a run: what goes into them besides the simulation, and when they are written.
//!
//! The clock and the signals decide when a checkpoint is written, and never change what a step
//! computes. A run has the same bits with any number of checkpoints, and with none.

use std::time::{Duration, Instant};

use lennard_core::{
    Array, DMat3, DVec3, Energetics, Persist, SpeciesTable, StateArchive, StateReader,
};
use lennard_io::{Checkpoint, CheckpointFolder, CheckpointMetadata, FileMark, WriteError};
use lennard_scene::Scene;

use crate::files::Marks;
use crate::names::THERMO;
use crate::timers::Timers;
use crate::{EngineError, Simulation};

/// What a run that went on from a checkpoint brings along.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Past {
    /// Wall time up to the checkpoint.
    pub wall: Duration,
    /// Remarks for the run record that belong to the whole run, one a line.
    pub remarks: Vec<String>,
    /// Whether the rows and frames of the checkpoint's own step are still to be written: so after a
    /// write that failed.
    pub owes_output: bool,
}

/// Everything that is needed to go on from here, as a checkpoint holds it.
#[must_use]
pub fn capture(simulation: &Simulation, marks: Marks, past: &Past) -> Checkpoint {
    let mut archive = StateArchive::default();
    let mut writer = archive.writer();
    Persist::save(simulation, &mut writer);
    let mut run = writer.section("run");
    run.put_vec3("cell", &[simulation.start_cell.lengths()]);
    save_species(simulation.system.species(), &mut run);
    save_energetics(&simulation.state.energetics, &mut run);
    let Timers { step, observe, write } = simulation.timers;
    run.put_f64("seconds", &[past.wall, step, observe, write].map(|d| d.as_secs_f64()));
    run.put_u64("owes_output", &[u64::from(past.owes_output)]);
    let remarks = past.remarks.join("\n");
    run.put_u64("remarks", &packed(remarks.as_bytes(), LETTERS_PER_NUMBER));
    let name = simulation.scene.output.format.spec().file;
    let trajectory = marks.trajectory.map(|mark| (name.to_owned(), mark));
    Checkpoint {
        metadata: CheckpointMetadata {
            program_version: env!("CARGO_PKG_VERSION").to_owned(),
            scene_name: simulation.scene.name.to_string(),
            isa: simulation.isa.clone(),
            precision: simulation.scene.kernel.precision.name().to_owned(),
            step: simulation.state.step,
            files: [(THERMO.to_owned(), marks.thermo)].into_iter().chain(trajectory).collect(),
        },
        scene: simulation.scene.resolved_toml(),
        archive,
    }
}

/// A simulation by itself as a checkpoint: no file grows beside it.
#[must_use]
pub fn snapshot(simulation: &Simulation) -> Checkpoint {
    let nothing = FileMark { bytes: 0, records: 0 };
    let marks = Marks { thermo: nothing, trajectory: None };
    capture(simulation, marks, &Past::default())
}

/// The other half of [`capture`]: the simulation was built from the scene of the checkpoint.
pub(crate) fn reinstate(
    simulation: &mut Simulation,
    archive: &StateArchive,
) -> Result<Past, lennard_core::RestoreError> {
    let reader = archive.reader();
    simulation.restore(&reader)?;
    let run = reader.section("run");
    simulation.state.energetics = restored_energetics(&run)?;
    let seconds = run.f64s::<4>("seconds")?;
    let [wall, step, observe, write] =
        seconds.map(|s| Duration::try_from_secs_f64(s).unwrap_or_default());
    simulation.timers = Timers { step, observe, write };
    let [owed] = run.u64s("owes_output")?;
    Ok(Past { wall, remarks: restored_remarks(&run)?, owes_output: owed != 0 })
}

/// No run counts so far, and what is counted on from here stays within 64 bits.
const LARGEST_COUNT: u64 = 1 << 60;

/// Refuses arrays that do not fit `n` particles under way. A right checksum proves little: whoever can write a
/// file can write its checksum. What a method remembers must have a place for each particle.
pub(crate) fn check_particles(
    archive: &StateArchive,
    n: usize,
) -> Result<(), lennard_core::RestoreError> {
    let reader = archive.reader();
    for (name, array) in &archive.arrays {
        if let Array::U64(counts) = array
            && let Some(count) = counts.iter().find(|count| **count > LARGEST_COUNT)
        {
            return Err(reader.misfit(name, format!("a count of {count}")));
        }
        let of_method = name.starts_with("method/");
        if !(of_method || name.starts_with("state/") || name.starts_with("forces/")) {
            continue;
        }
        match array {
            Array::Vec3(all) => {
                // A list that was never built has no positions.
                if all.len() != n && (of_method || !all.is_empty()) {
                    return Err(reader.misfit(name, format!("{} particles, wanted {n}", all.len())));
                }
                if let Some(particle) = all.iter().position(|r| !r.is_finite()) {
                    return Err(reader.misfit(
                        name,
                        format!("particle {particle} has a number that is not finite"),
                    ));
                }
            }
            Array::F64(all) if of_method && !all.iter().all(|x| x.is_finite()) => {
                return Err(reader.misfit(name, "a number that is not finite"));
            }
            Array::I64(all) if of_method && all.len() != 3 * n => {
                return Err(
                    reader.misfit(name, format!("{} integers, wanted {}", all.len(), 3 * n))
                );
            }
            _ => {}
        }
    }
    Ok(())
}

/// The box of the start of a saved run, for which its lists were laid out.
pub(crate) fn saved_start_cell(
    archive: &StateArchive,
) -> Result<DVec3, lennard_core::RestoreError> {
    let reader = archive.reader().section("run");
    match reader.vec3("cell")? {
        [sides] => Ok(*sides),
        others => Err(reader.misfit("cell", format!("{} boxes, wanted 1", others.len()))),
    }
}

/// Species in one number of a checkpoint.
const SPECIES_PER_NUMBER: usize = size_of::<u64>();
/// Bytes of a text in one number: eight could look like a count above [`LARGEST_COUNT`].
const LETTERS_PER_NUMBER: usize = 7;

/// Bytes as numbers, so many in each; zeros fill the last one.
fn packed(bytes: &[u8], per_number: usize) -> Vec<u64> {
    let number = |chunk: &[u8]| {
        let mut bytes = [0; size_of::<u64>()];
        bytes[..chunk.len()].copy_from_slice(chunk);
        u64::from_le_bytes(bytes)
    };
    bytes.chunks(per_number).map(number).collect()
}

/// The bytes of numbers, with the zeros that fill them.
fn unpacked(numbers: &[u64]) -> impl Iterator<Item = u8> {
    numbers.iter().flat_map(|number| number.to_le_bytes())
}

fn restored_remarks(from: &StateReader<'_>) -> Result<Vec<String>, lennard_core::RestoreError> {
    let bytes = unpacked(from.u64("remarks")?).filter(|byte| *byte != 0);
    let text = String::from_utf8_lossy(&bytes.collect::<Vec<_>>()).into_owned();
    Ok(text.lines().map(str::to_owned).collect())
}

/// The species of each particle, one byte each; nothing where there is one species.
fn save_species(species: &SpeciesTable, to: &mut lennard_core::StateWriter<'_>) {
    let Some(of_particles) = species.of_particles() else {
        return;
    };
    to.put_u64("species", &packed(of_particles, SPECIES_PER_NUMBER));
}

/// The species of the `n` particles of a saved run.
pub(crate) fn saved_species(
    archive: &StateArchive,
    scene: &Scene,
    n: usize,
) -> Result<SpeciesTable, lennard_core::RestoreError> {
    let count = scene.mixture.as_ref().map_or(1, |m| m.species.len());
    if count == 1 {
        return Ok(scene.species_table(n, &[]));
    }
    let reader = archive.reader().section("run");
    let numbers = reader.u64("species")?;
    let of_particle: Vec<u8> = unpacked(numbers).take(n).collect();
    if numbers.len() != n.div_ceil(SPECIES_PER_NUMBER) {
        return Err(reader.misfit("species", format!("{} numbers", numbers.len())));
    }
    match of_particle.iter().find(|a| usize::from(**a) >= count) {
        Some(a) => Err(reader.misfit("species", format!("species {a} of {count}"))),
        None => Ok(scene.species_table(n, &of_particle)),
    }
}

/// The totals of the checkpoint's step: the last frame and the rows owed show them.
fn save_energetics(energetics: &Energetics, to: &mut lennard_core::StateWriter<'_>) {
    // Laplacian, pairs and the energies of single particles are used up by observables within the step.
    let Energetics {
        potential_energy,
        conserved_potential,
        virial,
        virial_trace,
        laplacian: _,
        pairs: _,
        per_particle: _,
    } = energetics;
    let one = |value: &Option<f64>| Array::F64(value.iter().copied().collect());
    to.put("potential_energy", one(potential_energy));
    to.put("conserved_potential", one(conserved_potential));
    let columns = virial.iter().flat_map(|w| [w.x_axis, w.y_axis, w.z_axis]);
    to.put("virial", Array::Vec3(columns.collect()));
    to.put("virial_trace", one(virial_trace));
}

fn restored_energetics(from: &StateReader<'_>) -> Result<Energetics, lennard_core::RestoreError> {
    Ok(Energetics {
        potential_energy: from.f64("potential_energy")?.first().copied(),
        conserved_potential: from.f64("conserved_potential")?.first().copied(),
        virial: match from.vec3("virial")? {
            [x, y, z] => Some(DMat3::from_cols(*x, *y, *z)),
            _ => None,
        },
        virial_trace: from.f64("virial_trace")?.first().copied(),
        ..Energetics::default()
    })
}

/// Writes checkpoints when they are due.
pub(crate) struct Checkpointer {
    folder: CheckpointFolder,
    every: Option<Duration>,
    last_written: Instant,
    last_step: Option<u64>,
}

impl Checkpointer {
    pub(crate) fn new(folder: &std::path::Path, plan: &lennard_scene::Checkpoint) -> Self {
        Self {
            folder: CheckpointFolder::new(folder),
            every: plan.every_seconds.and_then(|s| Duration::try_from_secs_f64(s).ok()),
            last_written: Instant::now(),
            last_step: None,
        }
    }

    /// Whether the time between two checkpoints is over.
    pub(crate) fn time_is_up(&self) -> bool {
        self.every.is_some_and(|every| self.last_written.elapsed() >= every)
    }

    /// Writes one, unless this step has one already. A state that the watchdog does not like is never written.
    pub(crate) fn write(
        &mut self,
        simulation: &Simulation,
        marks: Marks,
        past: &Past,
    ) -> Result<(), EngineError> {
        if self.last_step == Some(simulation.state.step) {
            return Ok(());
        }
        simulation.watch_closely()?;
        self.write_unwatched(simulation, marks, past)?;
        Ok(())
    }

    /// Writes one without looking again, and in place of any of the same step.
    pub(crate) fn write_unwatched(
        &mut self,
        simulation: &Simulation,
        marks: Marks,
        past: &Past,
    ) -> Result<(), WriteError> {
        self.folder.write(&capture(simulation, marks, past))?;
        self.last_written = Instant::now();
        self.last_step = Some(simulation.state.step);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn remarks_come_back_and_take_a_byte_a_letter() {
        let remarks = ["ÿÿÿÿÿÿÿÿ σ²/τ".to_owned(), "instruction set ".repeat(20)];
        let text = remarks.join("\n");
        let mut archive = StateArchive::default();
        let numbers = packed(text.as_bytes(), LETTERS_PER_NUMBER);
        archive.writer().put_u64("remarks", &numbers);
        assert!(archive.arrays["remarks"].bytes() <= text.len() * 8 / 7 + 8);
        check_particles(&archive, 1).expect("no count is too large");
        assert_eq!(restored_remarks(&archive.reader()).unwrap(), remarks);
        // Checkpoints that have one byte in each number are read too.
        assert_eq!(unpacked(&packed(b"one", 1)).filter(|b| *b != 0).collect::<Vec<_>>(), b"one");
    }
}
