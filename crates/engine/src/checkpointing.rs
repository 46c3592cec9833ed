//! Checkpoints of a run: what goes into them besides the simulation, and when they are written.
//!
//! The clock and the signals decide when a checkpoint is written, and never change what a step
//! computes. A run has the same bits with any number of checkpoints, and with none.

use std::time::{Duration, Instant};

use lennard_core::{
    Array, DMat3, Energetics, PeriodicBox, Persist, RestoreError, SpeciesTable, StateArchive,
    StateReader, StateWriter,
};
use lennard_io::{Checkpoint, CheckpointFolder, CheckpointMetadata, FileMark};
use lennard_scene::Scene;

use crate::files::Marks;
use crate::names::THERMO;
use crate::schedule::Observer;
use crate::simulation::Timers;
use crate::together::made;
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
    let own = simulation.system.own();
    let mut writer = archive.writer();
    let mut run = writer.section("run");
    run.put_vec3("cell", &[simulation.start_cell.lengths()]);
    if let Some(of_particles) = simulation.system.species().of_particles() {
        let mut all = Vec::new();
        own.pass_bytes(of_particles, |part| all.extend_from_slice(part));
        run.put_u64("species", &packed(&all));
    }
    run.put_f64("energetics", &numbers(&simulation.state.energetics));
    let Timers { step, observe, write } = simulation.timers;
    run.put_f64("seconds", &[past.wall, step, observe, write].map(|d| d.as_secs_f64()));
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
            remarks: past.remarks.clone(),
            owes_output: past.owes_output,
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
    checkpoint: &Checkpoint,
) -> Result<Past, RestoreError> {
    let reader = checkpoint.archive.reader();
    simulation.restore(&reader)?;
    let run = reader.section("run");
    simulation.state.energetics = energetics(run.f64s("energetics")?);
    let seconds = run.f64s::<4>("seconds")?;
    let [wall, step, observe, write] =
        seconds.map(|s| Duration::try_from_secs_f64(s).unwrap_or_default());
    simulation.timers = Timers { step, observe, write };
    let CheckpointMetadata { remarks, owes_output, .. } = checkpoint.metadata.clone();
    Ok(Past { wall, remarks, owes_output })
}

/// No run counts so far, and what is counted on from here stays within 64 bits.
const LARGEST_COUNT: u64 = 1 << 60;

/// Refuses arrays that do not fit `n` particles under way. A right checksum proves little: whoever can write a
/// file can write its checksum. What a method remembers must have a place for each particle.
pub(crate) fn check_particles(archive: &StateArchive, n: usize) -> Result<(), RestoreError> {
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
                let is_unbuilt = name.starts_with("forces/") && all.is_empty();
                if all.len() != n && !is_unbuilt {
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
            _ => {}
        }
    }
    Ok(())
}

/// The box of the start of a saved run, for which its lists were laid out.
pub(crate) fn saved_start_cell(archive: &StateArchive) -> Result<PeriodicBox, RestoreError> {
    saved_box(&archive.reader().section("run"), "cell")
}

/// Species in one number of a checkpoint.
const SPECIES_PER_NUMBER: usize = size_of::<u64>();

/// One byte for the species of each particle, eight in a number.
fn packed(of_particles: &[u8]) -> Vec<u64> {
    let number = |chunk: &[u8]| {
        let mut bytes = [0; SPECIES_PER_NUMBER];
        bytes[..chunk.len()].copy_from_slice(chunk);
        u64::from_le_bytes(bytes)
    };
    of_particles.chunks(SPECIES_PER_NUMBER).map(number).collect()
}

/// The species of the `n` particles of a saved run.
pub(crate) fn saved_species(
    archive: &StateArchive,
    scene: &Scene,
    n: usize,
) -> Result<SpeciesTable, RestoreError> {
    let count = scene.mixture.as_ref().map_or(1, |m| m.species.len());
    if count == 1 {
        return Ok(scene.species_table(n, &[]));
    }
    let reader = archive.reader().section("run");
    let numbers = reader.u64("species")?;
    let bytes = numbers.iter().flat_map(|number| number.to_le_bytes());
    let of_particle: Vec<u8> = bytes.take(n).collect();
    if numbers.len() != n.div_ceil(SPECIES_PER_NUMBER) {
        return Err(reader.misfit("species", format!("{} numbers", numbers.len())));
    }
    match of_particle.iter().find(|a| usize::from(**a) >= count) {
        Some(a) => Err(reader.misfit("species", format!("species {a} of {count}"))),
        None => Ok(scene.species_table(n, &of_particle)),
    }
}

/// The totals of the checkpoint's step, which the last frame and the rows owed show; not a number where one is not known.
///
/// Laplacian, pairs and the energies of single particles are used up by observables within the step.
fn numbers(energetics: &Energetics) -> [f64; 12] {
    let Energetics { potential_energy, conserved_potential, virial_trace, virial, .. } = energetics;
    let mut numbers = [f64::NAN; 12];
    let totals = [potential_energy, conserved_potential, virial_trace];
    numbers[..3].copy_from_slice(&totals.map(|total| total.unwrap_or(f64::NAN)));
    numbers[3..].copy_from_slice(&virial.unwrap_or(DMat3::NAN).to_cols_array());
    numbers
}

/// The totals of [`numbers`].
fn energetics([potential, conserved, trace, virial @ ..]: [f64; 12]) -> Energetics {
    let known = |total: f64| (!total.is_nan()).then_some(total);
    Energetics {
        potential_energy: known(potential),
        conserved_potential: known(conserved),
        virial_trace: known(trace),
        virial: known(virial[0]).map(|_| DMat3::from_cols_array(&virial)),
        ..Energetics::default()
    }
}

/// Writes checkpoints when they are due.
pub(crate) struct Checkpointer {
    /// Nothing beside rank 0.
    folder: Option<CheckpointFolder>,
    every: Option<Duration>,
    last_written: Instant,
    last_step: Option<u64>,
}

impl Checkpointer {
    pub(crate) fn new(folder: Option<&std::path::Path>, plan: &lennard_scene::Checkpoint) -> Self {
        Self {
            folder: folder.map(CheckpointFolder::new),
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
        self.write_unwatched(simulation, marks, past)
    }

    /// Writes one without looking again, and in place of any of the same step.
    pub(crate) fn write_unwatched(
        &mut self,
        simulation: &Simulation,
        marks: Marks,
        past: &Past,
    ) -> Result<(), EngineError> {
        let checkpoint = capture(simulation, marks, past);
        let own = simulation.system.own();
        let written = match &self.folder {
            Some(folder) => folder.write(&checkpoint, own).map(drop),
            None => {
                lennard_io::give_checkpoint(&checkpoint, own);
                Ok(())
            }
        };
        made(own, written)?;
        self.last_written = Instant::now();
        self.last_step = Some(simulation.state.step);
        Ok(())
    }
}

// A simulation as a checkpoint keeps it.

impl Persist for Simulation {
    fn save(&self, to: &mut StateWriter<'_>) {
        self.state.save(&mut to.section("state"));
        if self.state.cell != self.start_cell {
            to.put_vec3("box", &[self.state.cell.lengths()]);
        }
        self.forces.save(&mut to.section("forces"));
        let mut observables = to.section("observables");
        for Observer { observable, .. } in &self.observers {
            observable.save(&mut observables.section(observable.spec().name));
        }
        self.force_check.save(&mut to.section("force_check"));
        to.put_u64("measured_steps", &[self.measured_steps]);
        if let Some(stage) = &self.stage {
            to.put_u64("stage", &[stage.index as u64, stage.steps_done]);
            to.put_f64("stage_energy", &[stage.heat, stage.start_energy]);
            stage.integrator.save(&mut to.section("method"));
        }
    }

    fn restore(&mut self, from: &StateReader<'_>) -> Result<(), RestoreError> {
        self.state.restore(&from.section("state"))?;
        self.state.cell = match saved_box(from, "box") {
            // It is still the box of the start.
            Err(RestoreError::Missing(_)) => self.start_cell,
            cell => cell?,
        };
        self.forces.restore(&from.section("forces"))?;
        let observables = from.section("observables");
        for Observer { observable, .. } in &mut self.observers {
            let name = observable.spec().name;
            observable.restore(&observables.section(name))?;
        }
        self.force_check.restore(&from.section("force_check"))?;
        [self.measured_steps] = from.u64s("measured_steps")?;
        let [index, steps_done] = match from.u64s("stage") {
            // It was saved before its first step.
            Err(RestoreError::Missing(_)) if self.state.step == 0 => return Ok(()),
            stage => stage?,
        };
        let index = index as usize;
        let Some(of_stage) = self.scene.stages.get(index).map(|stage| stage.steps) else {
            let found = format!("stage {index} of {}", self.scene.stages.len());
            return Err(from.misfit("stage", found));
        };
        let (before, step) = (self.scene.steps_before(index), self.state.step);
        if steps_done > of_stage || before + steps_done != step {
            let found = format!("{steps_done} of {of_stage} steps after {before}, at step {step}");
            return Err(from.misfit("stage", found));
        }
        if self.measured_steps > step {
            let found = format!("{} of {step}", self.measured_steps);
            return Err(from.misfit("measured_steps", found));
        }
        let mut stage = self.stage_run_for(index);
        stage.steps_done = steps_done;
        [stage.heat, stage.start_energy] = from.f64s("stage_energy")?;
        stage.integrator.restore(&from.section("method"))?;
        self.stage = Some(stage);
        Ok(())
    }
}

/// A box of a saved run.
fn saved_box(from: &StateReader<'_>, name: &str) -> Result<PeriodicBox, RestoreError> {
    match from.vec3(name)? {
        [sides] => PeriodicBox::new(*sides).map_err(|e| from.misfit(name, e.to_string())),
        others => Err(from.misfit(name, format!("{} boxes, wanted 1", others.len()))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn totals_and_species_come_back_as_far_as_they_were_known() {
        let known = Energetics {
            potential_energy: Some(-1.5),
            virial: Some(DMat3::IDENTITY),
            ..Energetics::default()
        };
        assert_eq!(energetics(numbers(&known)), known);
        assert_eq!(energetics(numbers(&Energetics::default())), Energetics::default());
        assert_eq!(packed(&[1; 9]), [0x0101_0101_0101_0101, 1]);
    }
}
