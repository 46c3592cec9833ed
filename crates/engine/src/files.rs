//! The output folder of a run.
//!
//! | File | Holds |
//! |---|---|
//! | `scene.toml` | the scene as resolved, every default written out |
//! | `run.json` | the run record; `finished` is true only at the very end |
//! | `thermo.csv` | instantaneous values, every stage |
//! | `trajectory.xyz` | frames of the measured stages, if asked for |
//! | `topology.gro` | names and box for mdtraj, beside a trajectory |
//! | `rdf.csv`, … | tables of the observables |
//! | `final.xyz` | the last state, from which another run can start |
//! | `failed.xyz` | the last state of a run that physics stopped |

use std::path::{Path, PathBuf};

use lennard_core::{Energetics, Table};
use lennard_io::{Cell, FileMark, Frame, FrameStyle, RunRecord, TableWriter, TrajectoryWriter, WriteError};

use crate::Simulation;

const THERMO_COLUMNS: &[(&str, &str)] = &[
    ("step", ""),
    ("time", "τ"),
    ("stage", ""),
    ("temperature", "ε/k_B"),
    ("potential_energy", "ε per particle"),
    ("pressure", "ε/σ³"),
    ("conserved_energy", "ε per particle"),
    ("heat", "ε per particle"),
];

/// The growing and the final files of a run.
pub struct RunFiles {
    folder: PathBuf,
    thermo: TableWriter,
    trajectory: Option<TrajectoryWriter>,
    style: FrameStyle,
}

/// How far the growing files were at a checkpoint.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Marks {
    /// Of `thermo.csv`.
    pub thermo: FileMark,
    /// Of `trajectory.xyz`.
    pub trajectory: Option<FileMark>,
}

fn style(simulation: &Simulation) -> FrameStyle {
    let output = &simulation.scene.output;
    FrameStyle {
        element: output.element.clone(),
        velocities: output.velocities,
        forces: output.forces,
        wrapped: !output.unwrapped,
        length_scale: output.length_scale,
    }
}

impl RunFiles {
    /// Starts the files of a fresh run in an existing, empty folder.
    ///
    /// # Errors
    /// [`WriteError`] where a file cannot be written.
    pub fn create(folder: &Path, simulation: &Simulation) -> Result<Self, WriteError> {
        lennard_io::write_text_atomically(&folder.join("scene.toml"), &simulation.scene.resolved_toml())?;
        let style = style(simulation);
        let thermo = TableWriter::create(&folder.join("thermo.csv"), THERMO_COLUMNS)?;
        let trajectory = match simulation.scene.output.trajectory_every {
            None => None,
            Some(_) => {
                lennard_io::write_topology_gro(
                    &folder.join("topology.gro"),
                    simulation.state.len(),
                    &simulation.cell,
                    &style,
                )?;
                Some(TrajectoryWriter::create(&folder.join("trajectory.xyz"), &style)?)
            }
        };
        Ok(Self { folder: folder.to_owned(), thermo, trajectory, style })
    }

    /// Goes on with the files of an interrupted run, cut back to where its checkpoint was.
    ///
    /// # Errors
    /// [`WriteError`] where a file is shorter than its mark or cannot be written.
    pub fn resume(folder: &Path, simulation: &Simulation, marks: Marks) -> Result<Self, WriteError> {
        let style = style(simulation);
        let thermo = TableWriter::resume_at(&folder.join("thermo.csv"), THERMO_COLUMNS, marks.thermo)?;
        let trajectory = marks
            .trajectory
            .map(|mark| TrajectoryWriter::resume_at(&folder.join("trajectory.xyz"), &style, mark))
            .transpose()?;
        Ok(Self { folder: folder.to_owned(), thermo, trajectory, style })
    }

    /// The folder.
    #[must_use]
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// How far the growing files are, after making sure that they are on disk.
    ///
    /// # Errors
    /// [`WriteError`] where a file cannot be synced.
    pub fn marks(&mut self) -> Result<Marks, WriteError> {
        self.thermo.sync()?;
        if let Some(trajectory) = &mut self.trajectory {
            trajectory.sync()?;
        }
        Ok(Marks { thermo: self.thermo.mark(), trajectory: self.trajectory.as_ref().map(TrajectoryWriter::mark) })
    }

    /// Writes the row of this step to `thermo.csv`.
    ///
    /// # Errors
    /// [`WriteError`] where the row cannot be written.
    pub fn write_thermo(&mut self, simulation: &Simulation) -> Result<(), WriteError> {
        let n = simulation.state.len() as f64;
        let temperature = simulation.dynamics.temperature(&simulation.state.velocities);
        let potential = simulation.potential_energy_per_particle().unwrap_or(f64::NAN);
        let pressure = simulation.pressure().unwrap_or(f64::NAN);
        let conserved = simulation.conserved_energy_per_particle().unwrap_or(f64::NAN);
        let heat = simulation.stage_run().heat / n;
        self.thermo.write(&[
            Cell::Integer(simulation.state.step),
            Cell::Number(simulation.state.time),
            Cell::Integer(simulation.stage_run().index as u64),
            Cell::Number(temperature),
            Cell::Number(potential),
            Cell::Number(pressure),
            Cell::Number(conserved),
            Cell::Number(heat),
        ])
    }

    /// Writes a frame to the trajectory.
    ///
    /// # Errors
    /// [`WriteError`] where the frame cannot be written.
    pub fn write_frame(&mut self, simulation: &Simulation) -> Result<(), WriteError> {
        match &mut self.trajectory {
            None => Ok(()),
            Some(trajectory) => {
                let extra = header(simulation);
                trajectory.write(&Frame { cell: &simulation.cell, state: &simulation.state, extra: &extra })
            }
        }
    }

    /// Writes a state into a file of its own.
    ///
    /// # Errors
    /// [`WriteError`] where it cannot be written.
    pub fn write_state(&self, name: &str, simulation: &Simulation) -> Result<(), WriteError> {
        // A start configuration needs velocities and reduced units whatever the trajectory has.
        let style = FrameStyle { velocities: true, length_scale: 1.0, ..self.style.clone() };
        let frame = Frame { cell: &simulation.cell, state: &simulation.state, extra: &header(simulation) };
        lennard_io::write_frame(&self.folder.join(name), &style, &frame)
    }

    /// Frames written so far, where there is a trajectory.
    #[must_use]
    pub fn frames(&self) -> Option<u64> {
        self.trajectory.as_ref().map(|t| t.mark().records)
    }

    /// Writes the tables of the observables.
    ///
    /// # Errors
    /// [`WriteError`] where one cannot be written.
    pub fn write_tables<'a>(&self, tables: impl IntoIterator<Item = &'a Table>) -> Result<(), WriteError> {
        for table in tables {
            lennard_io::write_table_csv(&self.folder.join(format!("{}.csv", table.name)), table)?;
        }
        Ok(())
    }

    /// Writes the run record, whole or not at all.
    ///
    /// # Errors
    /// [`WriteError`] where it cannot be written.
    pub fn write_record(&self, record: &RunRecord) -> Result<(), WriteError> {
        lennard_io::write_json_atomically(&self.folder.join("run.json"), record)
    }
}

/// What the header line of a frame says besides time and step.
fn header(simulation: &Simulation) -> Vec<(&'static str, f64)> {
    let mut extra = vec![("temperature", simulation.dynamics.temperature(&simulation.state.velocities))];
    let Energetics { potential_energy, .. } = simulation.state.energetics;
    if let Some(energy) = potential_energy {
        extra.insert(0, ("potential_energy", energy));
        extra.insert(1, ("kinetic_energy", simulation.dynamics.kinetic_energy(&simulation.state.velocities)));
    }
    if let Some(pressure) = simulation.pressure() {
        extra.push(("pressure", pressure));
    }
    extra
}
