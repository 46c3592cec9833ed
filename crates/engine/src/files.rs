//! The output folder of a run.
//!
//! | File | Holds |
//! |---|---|
//! | `scene.toml` | the scene as resolved, every default written out |
//! | `run.json` | the run record; `finished` is true only at the very end |
//! | `thermo.csv` | instantaneous values, every stage |
//! | `trajectory.xyz` | frames of the measured stages, if asked for; another format has another ending |
//! | `topology.gro` | names, box and start positions for readers of trajectories, beside one |
//! | `rdf.csv`, … | tables of the observables |
//! | `final.xyz` | the last state, from which another run can start |
//! | `failed.xyz` | the state of a run at the step at which physics stopped it |
//! | `before-failure.xyz` | the last state before that with which nothing was wrong |
//! | `checkpoint-<step>.lennard` | everything for going on to the bit; the last two are kept |
//! | `.lennard-claim` | the process at work there, as long as it is |

use std::borrow::Cow;
use std::path::{Path, PathBuf};

use lennard_core::{Energetics, SpeciesTable, State};
use lennard_io::{
    FileMark, Frame, FrameStyle, RunRecord, TableWriter, TrajectoryFormat, TrajectoryWriter,
    WriteError,
};
use lennard_observables::{Cell, Table};

use crate::foresight::less_precision;
use crate::names::{RECORD, SCENE, THERMO, TOPOLOGY};
use crate::together::made;
use crate::{EngineError, Simulation};

/// Energies over the number of particles, or of molecules.
const PER_PARTICLE: &str = "ε per particle";

/// A column of `thermo.csv`: its name, its unit, and its value for the state as it is.
type ThermoColumn = (&'static str, &'static str, fn(&Simulation) -> Cell);

const THERMO_COLUMNS: &[ThermoColumn] = &[
    ("step", "", |s| s.state.step.into()),
    ("time", "τ", |s| s.state.time.into()),
    ("stage", "", |s| s.stage_run().index.into()),
    ("temperature", "ε/k_B", |s| s.view().temperature().into()),
    ("temperature_half_steps", "ε/k_B", |s| half_steps(s).unwrap_or(f64::NAN).into()),
    ("potential_energy", PER_PARTICLE, |s| {
        s.potential_energy_per_particle().unwrap_or(f64::NAN).into()
    }),
    ("pressure", "ε/σ³", |s| s.pressure().unwrap_or(f64::NAN).into()),
    ("conserved_energy", PER_PARTICLE, |s| {
        s.conserved_energy_per_particle().unwrap_or(f64::NAN).into()
    }),
    ("heat", PER_PARTICLE, |s| (s.stage_run().heat / s.system.n_molecules() as f64).into()),
];

/// Columns that follow in a scene with a barostat.
const BOX_COLUMNS: &[ThermoColumn] = &[
    ("density", "σ⁻³", |s| (s.system.n_molecules() as f64 / s.state.cell.volume()).into()),
    ("box_x", "σ", |s| s.state.cell.lengths().x.into()),
    ("box_y", "σ", |s| s.state.cell.lengths().y.into()),
    ("box_z", "σ", |s| s.state.cell.lengths().z.into()),
];

fn columns_of(simulation: &Simulation) -> impl Iterator<Item = &'static ThermoColumn> {
    let more = if simulation.box_changes() { BOX_COLUMNS } else { &[] };
    THERMO_COLUMNS.iter().chain(more)
}

/// The columns of `thermo.csv`, whose energies are per molecule where there are molecules.
pub(crate) fn thermo_columns(simulation: &Simulation) -> Vec<(&'static str, &'static str)> {
    let unit = |unit: &'static str| match unit {
        PER_PARTICLE => simulation.system.molecules.energy_unit(),
        unit => unit,
    };
    columns_of(simulation).map(|(name, of, _)| (*name, unit(of))).collect()
}

/// The row of `thermo.csv` for the state as it is.
pub(crate) fn thermo_row(simulation: &Simulation) -> Vec<Cell> {
    let hidden = |name| simulation.frames.as_ref().is_some_and(|frames| frames.hides(name));
    let value = |(name, _, value): &ThermoColumn| match hidden(name) {
        true => f64::NAN.into(),
        false => value(simulation),
    };
    columns_of(simulation).map(value).collect()
}

/// The growing and the final files of a run. Rank 0 has them. The other ranks go through the same calls, which need what they know.
pub struct RunFiles {
    /// Nothing on the other ranks.
    at: Option<Files>,
}

struct Files {
    folder: PathBuf,
    thermo: TableWriter,
    trajectory: Option<TrajectoryWriter>,
}

/// How far the growing files were at a checkpoint.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Marks {
    /// Of `thermo.csv`.
    pub thermo: FileMark,
    /// Of the trajectory.
    pub trajectory: Option<FileMark>,
}

/// A state of all particles on rank 0, where ranks share them; the other ranks give theirs, and get nothing.
fn whole<'a>(simulation: &Simulation, state: &'a State) -> Cow<'a, State> {
    let own = simulation.system.own();
    if own.team().is_none() {
        return Cow::Borrowed(state);
    }
    Cow::Owned(State {
        step: state.step,
        time: state.time,
        cell: state.cell,
        positions: own.collect_vectors(&state.positions),
        velocities: own.collect_vectors(&state.velocities),
        forces: own.collect_vectors(&state.forces),
        energetics: state.energetics.clone(),
    })
}

/// The species of all particles on rank 0.
fn species(simulation: &Simulation) -> SpeciesTable {
    let (own, species) = (simulation.system.own(), simulation.system.species());
    match species.of_particles() {
        Some(here) if own.team().is_some() => {
            let mut all = Vec::new();
            own.pass_bytes(here, |part| all.extend_from_slice(part));
            SpeciesTable::new(species.all(), &all)
        }
        _ => species.clone(),
    }
}

/// The style of the frames of the trajectory, which are whole on rank 0 where the format is not written by parts.
fn style_of_frames(simulation: &Simulation) -> FrameStyle {
    let style = style(simulation);
    match simulation.team() {
        Some(_) if !simulation.scene.output.format.spec().by_parts => {
            FrameStyle { own: None, species: species(simulation), ..style }
        }
        _ => style,
    }
}

/// The style of a last state, from which another run can start: in reduced units, with velocities where there are some.
pub(crate) fn style_of_last(simulation: &Simulation) -> FrameStyle {
    let velocities = simulation.frames.as_ref().is_none_or(|frames| frames.has_velocities);
    FrameStyle { velocities, length_scale: 1.0, ..style(simulation) }
}

/// The style of the trajectory.
pub(crate) fn style(simulation: &Simulation) -> FrameStyle {
    let output = &simulation.scene.output;
    FrameStyle {
        species: simulation.system.species().clone(),
        velocities: output.velocities,
        forces: output.forces,
        wrapped: !output.unwrapped,
        whole: output.whole.unwrap_or(true),
        for_ase: output.ase == Some(true),
        length_scale: output.length_scale,
        precision: output.precision.unwrap_or(lennard_io::DEFAULT_PRECISION),
        sites_per_molecule: simulation.system.molecules.sites(),
        own: simulation.team().map(|_| simulation.system.own().clone()),
    }
}

impl RunFiles {
    /// Starts the files of a fresh run in an existing, empty folder that no other process works in; without a folder beside rank 0.
    /// With marks, it goes on with the files of an interrupted run, cut back to where its checkpoint was.
    ///
    /// # Errors
    /// [`EngineError`] where a file is shorter than its mark or cannot be written.
    pub fn open(
        folder: Option<&Path>,
        simulation: &Simulation,
        marks: Option<Marks>,
    ) -> Result<Self, EngineError> {
        let described = match marks {
            None => write_descriptions(folder, simulation),
            Some(_) => Ok(()),
        };
        let (style, format) = (style_of_frames(simulation), simulation.scene.output.format);
        let columns = thermo_columns(simulation);
        let files = |folder: &Path| {
            let (file, path) = (folder.join(THERMO), folder.join(format.spec().file));
            let thermo = match marks {
                None => TableWriter::create(&file, &columns)?,
                Some(marks) => TableWriter::resume_at(&file, &columns, marks.thermo)?,
            };
            let mark = marks.and_then(|marks| marks.trajectory);
            let trajectory = simulation.scene.output.trajectory_every.map(|_| match mark {
                Some(mark) if mark != FileMark::default() || path.exists() => {
                    TrajectoryWriter::resume_at(&path, format, &style, mark)
                }
                _ => {
                    if marks.is_some() {
                        // Readers of another format take lengths for other units.
                        let _ = std::fs::remove_file(folder.join(TOPOLOGY));
                    }
                    TrajectoryWriter::create(&path, format, &style)
                }
            });
            Ok(Files { folder: folder.to_owned(), thermo, trajectory: trajectory.transpose()? })
        };
        let at: Result<_, WriteError> = described.and_then(|()| folder.map(files).transpose());
        Ok(Self { at: made(simulation.system.own(), at)? })
    }

    /// Writes what describes the run anew.
    ///
    /// # Errors
    /// [`WriteError`] where a file cannot be written.
    pub fn refresh(&self, simulation: &Simulation) -> Result<(), WriteError> {
        write_descriptions(self.folder(), simulation)
    }

    /// The folder; `None` beside rank 0.
    #[must_use]
    pub fn folder(&self) -> Option<&Path> {
        self.at.as_ref().map(|files| files.folder.as_path())
    }

    /// How far the growing files are, on disk or on the way there.
    #[must_use]
    pub fn marks(&self) -> Marks {
        let Some(files) = &self.at else { return Marks::default() };
        Marks {
            thermo: files.thermo.mark(),
            trajectory: files.trajectory.as_ref().map(TrajectoryWriter::mark),
        }
    }

    /// How far the growing files are, after making sure that they are on disk.
    ///
    /// # Errors
    /// [`WriteError`] where a file cannot be synced.
    pub fn synced_marks(&mut self) -> Result<Marks, WriteError> {
        if let Some(files) = &mut self.at {
            files.thermo.sync()?;
            if let Some(trajectory) = &mut files.trajectory {
                trajectory.sync()?;
            }
        }
        Ok(self.marks())
    }

    /// Writes the row of this step to `thermo.csv`.
    ///
    /// # Errors
    /// [`WriteError`] where the row cannot be written.
    pub fn write_thermo(&mut self, simulation: &Simulation) -> Result<(), WriteError> {
        let row = thermo_row(simulation);
        self.at.as_mut().map_or(Ok(()), |files| files.thermo.write(&row))
    }

    /// Writes the rows that were kept in memory to `thermo.csv`.
    ///
    /// # Errors
    /// [`WriteError`] where a row cannot be written.
    pub(crate) fn write_kept_rows(&mut self, simulation: &Simulation) -> Result<(), WriteError> {
        let Some(Files { thermo, .. }) = &mut self.at else { return Ok(()) };
        let columns = &simulation.recording.thermo;
        for row in 0..columns.first().map_or(0, Vec::len) {
            let is_whole = |name| matches!(name, "step" | "stage");
            let cell = |(column, (name, _, _)): (&Vec<f64>, &ThermoColumn)| match is_whole(*name) {
                true => (column[row] as u64).into(),
                false => column[row].into(),
            };
            let cells: Vec<Cell> = columns.iter().zip(columns_of(simulation)).map(cell).collect();
            thermo.write(&cells)?;
        }
        thermo.sync()
    }

    /// Writes a frame to the trajectory. Returns a remark where it has less precision than asked for.
    ///
    /// # Errors
    /// [`WriteError`] where the frame cannot be written.
    pub fn write_frame(&mut self, simulation: &Simulation) -> Result<Option<String>, WriteError> {
        if simulation.scene.output.trajectory_every.is_none() {
            return Ok(None);
        }
        let (extra, format) = (header(simulation), simulation.scene.output.format);
        let trajectory = self.at.as_mut().and_then(|files| files.trajectory.as_mut());
        let state = Cow::Borrowed(&simulation.state);
        let by_parts = simulation.team().is_none() || format.spec().by_parts;
        let state = if by_parts { state } else { whole(simulation, &simulation.state) };
        let frame = Frame { state: &state, extra: &extra };
        let precision = match trajectory {
            Some(trajectory) => trajectory.write(&frame)?,
            None if by_parts => {
                lennard_io::give_frame(format, &style(simulation), &frame)?;
                None
            }
            None => None,
        };
        Ok(precision.and_then(|kept| less_precision(&simulation.scene.output, kept)))
    }

    /// Writes the state of a simulation into a file of its own, or an `earlier` one, which has no forces.
    ///
    /// # Errors
    /// [`WriteError`] where it cannot be written.
    pub fn write_state(
        &self,
        name: &str,
        simulation: &Simulation,
        earlier: Option<&State>,
    ) -> Result<(), WriteError> {
        let last = style_of_last(simulation);
        let (style, extra) = match earlier {
            None => (last, header(simulation)),
            Some(_) => (FrameStyle { velocities: true, forces: false, ..last }, Vec::new()),
        };
        let frame = Frame { state: earlier.unwrap_or(&simulation.state), extra: &extra };
        match self.folder() {
            Some(folder) => lennard_io::write_frame(&folder.join(name), &style, &frame),
            None => lennard_io::give_frame(TrajectoryFormat::Xyz, &style, &frame),
        }
    }

    /// Frames written so far, where there is a trajectory.
    #[must_use]
    pub fn frames(&self) -> Option<u64> {
        self.marks().trajectory.map(|mark| mark.records)
    }

    /// Writes the tables of the observables.
    ///
    /// # Errors
    /// [`WriteError`] where one cannot be written.
    pub fn write_tables<'a>(
        &self,
        tables: impl IntoIterator<Item = &'a Table>,
    ) -> Result<(), WriteError> {
        let Some(folder) = self.folder() else { return Ok(()) };
        for table in tables {
            lennard_io::write_table_csv(&folder.join(format!("{}.csv", table.name)), table)?;
        }
        Ok(())
    }

    /// Writes the run record, whole or not at all.
    ///
    /// # Errors
    /// [`WriteError`] where it cannot be written.
    pub fn write_record(&self, record: &RunRecord) -> Result<(), WriteError> {
        let Some(folder) = self.folder() else { return Ok(()) };
        lennard_io::write_json_atomically(&folder.join(RECORD), record)
    }
}

/// The scene as resolved, and names, box and start positions beside a trajectory.
fn write_descriptions(folder: Option<&Path>, simulation: &Simulation) -> Result<(), WriteError> {
    let text = simulation.scene.resolved_toml();
    let written = folder
        .map_or(Ok(()), |folder| lennard_io::write_text_atomically(&folder.join(SCENE), &text));
    let topology = folder.map(|folder| folder.join(TOPOLOGY));
    // A run that goes on has left its start behind: the file is kept as it is.
    let is_missing = topology.as_ref().map(|file| [u64::from(!file.exists())]);
    let is_missing = simulation.system.own().told(is_missing) == Some([1]);
    if simulation.scene.output.trajectory_every.is_none()
        || simulation.state.step > 0 && !is_missing
    {
        return written;
    }
    let (style, format) = (style(simulation), simulation.scene.output.format);
    let (positions, cell) = (&simulation.state.positions, &simulation.start_cell);
    let described = match topology {
        Some(file) => lennard_io::write_topology_gro(&file, positions, cell, format, &style),
        None => lennard_io::give_topology_gro(positions, cell, format, &style),
    };
    written.and(described)
}

/// The temperature of half steps, for methods that kick by halves.
fn half_steps(simulation: &Simulation) -> Option<f64> {
    let view = simulation.view();
    view.half_kick_step.map(|_| view.temperature_of_positions())
}

/// What the header line of a frame says besides time and step.
pub(crate) fn header(simulation: &Simulation) -> Vec<(&'static str, f64)> {
    let mut extra = vec![("temperature", simulation.view().temperature())];
    let Energetics { potential_energy, .. } = simulation.state.energetics;
    if let Some(energy) = potential_energy {
        extra.insert(0, ("total_potential_energy", energy));
        extra.insert(1, ("total_kinetic_energy", simulation.view().kinetic_energy()));
    }
    if let Some(temperature) = half_steps(simulation) {
        extra.push(("temperature_half_steps", temperature));
    }
    if let Some(pressure) = simulation.pressure() {
        extra.push(("pressure", pressure));
    }
    if simulation.frames.as_ref().is_some_and(|frames| !frames.has_velocities) {
        extra.retain(|(name, _)| *name == "total_potential_energy");
    }
    extra
}
