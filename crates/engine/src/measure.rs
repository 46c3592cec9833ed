//! A trajectory of any program in the place of a run: each frame is a step, which the observables of a scene sample.

mod frames;
mod left_out;
mod scene;

use std::path::PathBuf;
use std::time::Instant;

use frames::{Clock, FrameByFrame};
use lennard_core::{Configuration, DVec3, Part, Want};
use lennard_io::{FileUnits, OutputFolder, TrajectoryFrame, is_same_box};
use lennard_observables::Frames as Needs;
use lennard_scene::Scene;
use rand::RngExt;

use crate::course::{Course, Memory};
use crate::follower::{Control, Ending, Follower};
use crate::from_frames::{FromFrames, Rounding};
use crate::own::OwnParts;
use crate::run::{Outcome, write_whole};
use crate::start::thermal_velocities;
use crate::{EngineError, Simulation, build};

/// A displacement between two frames above this share of a side may be one of the next image: then no path is known.
const LARGEST_SHARE: f64 = 0.25;
/// So many frames tell by how much rounded positions raise U and P: each has the mean over all its particles.
const FRAMES_OF_BIAS: u64 = 8;
/// Positions that are rounded less than this many σ count as exact: U and P of a liquid change by less than 10⁻¹¹.
const EXACT: f64 = 1e-7;

/// A trajectory, and what its file does not say.
#[derive(Debug, Clone, PartialEq)]
pub struct Trajectory {
    /// The file: XTC, extended XYZ, LAMMPS dump or GRO.
    pub file: PathBuf,
    /// The time between two frames, τ; `None` where the file says it, or its steps and the `dt` of the scene do.
    pub interval: Option<f64>,
    /// The units of the file.
    pub units: FileUnits,
}

/// A trajectory that is measured: a simulation whose states come from the frames.
pub struct Measurement {
    /// What the scene describes, at the first frame.
    pub simulation: Simulation,
    frames: lennard_io::Frames<'static>,
    clock: Clock,
    /// Frames that were read before their turn.
    ahead: Vec<TrajectoryFrame>,
    /// The largest displacement between two frames along one axis, as a share of the side.
    largest: f64,
    started: Instant,
}

impl Measurement {
    /// Reads the first two frames and builds what the scene describes around them. Number of particles and box are
    /// of the frames. Observables that need what the frames do not have are left out.
    ///
    /// # Errors
    /// [`EngineError`] where the trajectory cannot be read, does not say its times, or does not go with the scene.
    pub fn open(scene: Scene, trajectory: &Trajectory) -> Result<Self, EngineError> {
        let started = Instant::now();
        let Trajectory { file, interval, units } = trajectory;
        let mut frames = lennard_io::Frames::open(file, *units).map_err(EngineError::Trajectory)?;
        let mut next = || frames.next_frame().map_err(EngineError::Trajectory);
        let (first, second) = (next()?, next()?);
        let first = first.ok_or_else(|| {
            EngineError::Trajectory(frames.refuse("no frame", "at least one frame"))
        })?;
        let clock = Clock::new(&scene, *interval, &first, second.as_ref())
            .map_err(|(found, allowed)| EngineError::Trajectory(frames.refuse(found, allowed)))?;
        let has_velocities = first.velocities.is_some() || first.momenta.is_some();
        let (scene, remarks, left_out) =
            scene::of_frames(scene, &first, (file, *units), clock.interval, has_velocities)?;
        let temperature = scene.system.temperature;
        let mut start = first.clone().into_start(first.cell.expect("frames have boxes"), 1);
        if !has_velocities {
            start.velocities = Some(vec![DVec3::ZERO; start.positions.len()]);
        }
        let own = OwnParts::none().method(FrameByFrame);
        let mut simulation = build::prepare_with(scene, Some(start), own)?;
        if !has_velocities {
            // They stand for the temperature of the scene in the kinetic part of the pressure, and are in no result.
            let Simulation { system, state, streams, .. } = &mut simulation;
            state.velocities = thermal_velocities(system, &state.positions, temperature, *streams);
        }
        simulation.state.time = first.time.unwrap_or(0.0) - clock.interval;
        simulation.remarks.extend(remarks);
        let rounding = (first.rounding > EXACT).then_some(Rounding::of_step(first.rounding));
        let file = file.display().to_string();
        simulation.frames = Some(FromFrames { file, has_velocities, left_out, rounding });
        let ahead = second.into_iter().chain([first]).collect();
        Ok(Self { simulation, frames, clock, ahead, largest: 0.0, started })
    }

    /// Samples all frames. Where it is told to stop, nothing is kept.
    ///
    /// # Errors
    /// [`EngineError`] where a frame cannot be read or does not go with the frames before it.
    pub fn read(&mut self, control: Control<'_>) -> Result<Ending, EngineError> {
        self.simulation.begin_recording();
        let mut course = Course::new(&self.simulation, control, u64::MAX, Memory);
        self.simulation.enter_next_stage()?;
        while let Some(frame) = self.next()? {
            self.put(frame)?;
            if self.simulation.state.step < FRAMES_OF_BIAS {
                self.add_bias_of_rounding()?;
            }
            let simulation = &mut self.simulation;
            let step = simulation.state.step + 1;
            simulation.advance_to(step, simulation.wanted_at(step, &course))?;
            simulation.sample();
            // As many frames as the file has if all are as long as the frames that were read.
            let whole = step as f64 / self.frames.part_read().max(f64::MIN_POSITIVE);
            course.end = (whole as u64).max(step + 1);
            if course.after_step(simulation)?.is_break() {
                return Ok(course.ending);
            }
        }
        let step = self.simulation.state.step;
        self.simulation.scene.stages[0].steps = step;
        course.end = step;
        course.tell(&self.simulation);
        Ok(Ending::Finished)
    }

    /// Writes the folder of a run, which this process holds and which is empty: files, tables, and the record.
    ///
    /// # Errors
    /// [`EngineError`] where a file cannot be written.
    pub fn write(mut self, folder: &OutputFolder) -> Result<Outcome, EngineError> {
        if self.largest > 0.0 {
            self.simulation.remarks.push(format!(
                "paths were unwrapped by nearest images: the largest displacement between two frames is {:.3} of a side",
                self.largest
            ));
        }
        write_whole(&mut self.simulation, folder, self.started)
    }

    fn next(&mut self) -> Result<Option<TrajectoryFrame>, EngineError> {
        match self.ahead.pop() {
            Some(frame) => Ok(Some(frame)),
            None => self.frames.next_frame().map_err(EngineError::Trajectory),
        }
    }

    fn refuse(&self, found: impl Into<String>, allowed: impl Into<String>) -> EngineError {
        EngineError::Trajectory(self.frames.refuse(found, allowed))
    }

    /// Puts a frame into the state.
    fn put(&mut self, mut frame: TrajectoryFrame) -> Result<(), EngineError> {
        self.clock.check(&frame).map_err(|(found, allowed)| self.refuse(found, allowed))?;
        let cell = self.simulation.start_cell;
        if let Some(other) = frame.cell.filter(|other| !is_same_box(&cell, other)) {
            let found = format!("the box {} where frame 1 has {}", other.lengths(), cell.lengths());
            let allowed = "one box in all frames, since means at a changing volume need the barostat that made them: frames at constant volume, \
                 or for constant pressure a run of the scene with `[stage.barostat]`";
            return Err(self.refuse(found, allowed));
        }
        self.follow(&mut frame)?;
        let mut frame = frame.into_start(cell, 1);
        let masses = &self.simulation.system.masses;
        frame.take_momenta(|i| masses.of(i)).map_err(|(f, a)| self.refuse(f, a))?;
        let has_velocities = self.simulation.frames.as_ref().is_some_and(|f| f.has_velocities);
        if frame.velocities.is_none() && has_velocities {
            return Err(self.refuse("no velocities", "velocities, as in frame 1"));
        }
        let state = &mut self.simulation.state;
        state.positions = frame.positions;
        if let Some(velocities) = frame.velocities.filter(|_| has_velocities) {
            state.velocities = velocities;
        }
        Ok(())
    }

    /// Unwraps the positions of a frame by the images nearest to the positions before, unless the file says the images itself.
    fn follow(&mut self, frame: &mut TrajectoryFrame) -> Result<(), EngineError> {
        let state = &self.simulation.state;
        let is_first = state.step == 0;
        if frame.unwrapped && !is_first {
            return Ok(());
        }
        let sides = state.cell.lengths();
        let mut largest = DVec3::ZERO;
        for (now, before) in frame.positions.iter_mut().zip(&state.positions) {
            *now += ((*before - *now) / sides).round() * sides;
            largest = largest.max((*now - *before).abs());
        }
        if is_first {
            return Ok(());
        }
        let share = (largest / sides).max_element();
        let mut observables = self.simulation.scene.observables.iter();
        if share > LARGEST_SHARE && observables.any(|o| o.options.spec().frames == Needs::Paths) {
            let found = format!("a displacement of {share:.2} of a side since the frame before");
            let allowed = format!(
                "at most {LARGEST_SHARE} where paths are unwrapped by nearest images: frames at shorter times, coordinates that \
                 are not folded (xu yu zu, image flags), or a scene without `msd`"
            );
            return Err(self.refuse(found, allowed));
        }
        self.largest = self.largest.max(share);
        Ok(())
    }

    /// Adds by how much rounded positions raise U and P of a frame to the mean over the first frames.
    ///
    /// Rounding adds a uniform error of half a step at most to each coordinate. Adding another such error, once with each
    /// sign, changes the mean of U and P by as much again, up to fourth order in the step.
    fn add_bias_of_rounding(&mut self) -> Result<(), EngineError> {
        let simulation = &mut self.simulation;
        let Some(rounding) = simulation.frames.as_mut().and_then(|f| f.rounding.as_mut()) else {
            return Ok(());
        };
        let (cell, positions) = (simulation.state.cell, &simulation.state.positions);
        let mut random =
            simulation.streams.sequential(&format!("rounding of frame {}", simulation.state.step));
        let mut error = || rounding.step * (random.random::<f64>() - 0.5);
        let errors: Vec<DVec3> =
            positions.iter().map(|_| DVec3::new(error(), error(), error())).collect();
        let mut forces = simulation.state.forces.clone();
        let mut at = |sign: f64| {
            let moved: Vec<DVec3> =
                positions.iter().zip(&errors).map(|(r, e)| *r + sign * *e).collect();
            let at = Configuration::at_rest(&cell, &moved);
            let found =
                simulation.forces.evaluate(at, Part::All, Want::ENERGY_AND_VIRIAL, &mut forces)?;
            let [u, w] = [found.potential_energy, found.scalar_virial()];
            Ok([u.unwrap_or(f64::NAN), w.unwrap_or(f64::NAN)])
        };
        let mut all = || Ok([at(1.0)?, at(-1.0)?, at(0.0)?]);
        let [one, other, here] =
            all().map_err(|e: lennard_core::ForceError| scene::unfit(&simulation.scene, &e))?;
        let more = |k: usize| 0.5 * (one[k] + other[k]) - here[k];
        let bias =
            [more(0) / simulation.system.n_molecules() as f64, more(1) / (3.0 * cell.volume())];
        rounding.add(bias);
        Ok(())
    }
}
