//! The tables `[output]` and `[checkpoint]`: what is written, and when.

use lennard_io::{FormatSpec, TrajectoryFormat};

use crate::error::SceneError;
use crate::read::Reader;
use crate::reference::{MOST_STEPS, quoted};
use crate::{Checkpoint, Output, Scene};

const DEFAULT_ELEMENT: &str = "Ar";

lennard_core::options! {
    /// The keys of `[output]`.
    pub(crate) struct OutputKeys {
        /// Steps between two frames of the trajectory; 0 for no trajectory.
        trajectory_every: u64 = 0, Whole(0, MOST_STEPS), in "steps";
        /// Format of the trajectory. `xyz` is extended XYZ as text, and `xyz.gz` the same compressed; `lammps-dump` is the text of LAMMPS, and `xtc` has rounded positions alone.
        format: TrajectoryFormat = TrajectoryFormat::Xyz, Names(TrajectoryFormat::names);
        /// Positions in XTC are multiples of 1/`precision`, with format "xtc" alone.
        precision: Option<f64> = None, else "10,000 for \"xtc\"", Between(10.0, 1e6), in "per σ";
        /// Whether frames hold momenta, masses and the energy under the names that ASE reads, in reduced units; with formats "xyz" and "xyz.gz" alone.
        ase: Option<bool> = None, else "`false`", Flag;
        /// Steps between two samples of the thermodynamics, each a line of `thermo.csv`; the `every` of a `thermodynamics` observable is the same number.
        thermo_every: u64 = 10, Whole(1, MOST_STEPS), in "steps";
        /// Symbol of the particles in the files, for tools that know only elements.
        element: Option<String> = None, else "`\"Ar\"`", Words("an element symbol, or \"X\"");
        /// Whether frames hold velocities.
        velocities: Option<bool> = None, else "`true`; `false` for \"xtc\", which has none", Flag;
        /// Whether frames hold forces; not with "xtc".
        forces: bool = false, Flag;
        /// Positions as they moved, rather than folded into the box with image flags.
        unwrapped: bool = false, Flag;
        /// Whether the sites of a molecule are folded into the box together, by its first site; with molecules alone.
        whole: Option<bool> = None, else "`true`", Flag;
        /// Lengths in the trajectory are multiplied by it (3.405 gives ångström for argon, 0.3405 the nm of XTC); 1 with "lammps-dump", whose files do not name it.
        length_scale: f64 = 1.0, Between(1e-12, 1e12), in "file units per σ";
    }
}

lennard_core::options! {
    /// The keys of `[checkpoint]`. By default a killed run loses ten minutes at most, and a long run pays far below 1 %.
    pub(crate) struct CheckpointKeys {
        /// Steps between two checkpoints; 0 for none.
        every_steps: u64 = 0, Whole(0, MOST_STEPS), in "steps";
        /// Wall-clock seconds between two checkpoints; 0 for none.
        every_seconds: f64 = 600.0, Between(0.0, 1e9), in "s";
    }
}

impl Scene {
    /// The table `[output]` with every default that goes with its format. Species have elements of their own.
    pub(crate) fn output_keys(&self) -> OutputKeys {
        let Output {
            trajectory_every,
            format,
            precision,
            ase,
            thermo_every,
            ref element,
            velocities,
            forces,
            unwrapped,
            whole,
            length_scale,
        } = self.output;
        let spec = format.spec();
        OutputKeys {
            trajectory_every: trajectory_every.unwrap_or(0),
            format,
            precision: spec.limits.map(|_| precision),
            ase: spec.holds_ase.then_some(ase),
            thermo_every,
            element: self.mixture.is_none().then(|| element.clone()),
            velocities: Some(velocities),
            forces,
            unwrapped,
            whole: self.molecule.as_ref().map(|_| whole),
            length_scale,
        }
    }
}

impl Output {
    /// The same in another format, without what that format has no place for.
    #[must_use]
    pub fn in_format(self, format: TrajectoryFormat) -> Self {
        let spec = format.spec();
        Self {
            format,
            ase: self.ase && spec.holds_ase,
            velocities: self.velocities && spec.holds_vectors,
            forces: self.forces && spec.holds_vectors,
            length_scale: if spec.names_scale { self.length_scale } else { 1.0 },
            ..self
        }
    }
}

impl From<&Checkpoint> for CheckpointKeys {
    fn from(checkpoint: &Checkpoint) -> Self {
        Self {
            every_steps: checkpoint.every_steps.unwrap_or(0),
            every_seconds: checkpoint.every_seconds.unwrap_or(0.0),
        }
    }
}

impl Reader<'_> {
    pub fn output(&self) -> Result<Output, SceneError> {
        let section = self.section("output");
        let keys: OutputKeys = section.read(self.table("output"))?;
        let element = keys.element.unwrap_or_else(|| DEFAULT_ELEMENT.to_owned());
        if !lennard_io::is_element_symbol(&element) {
            return Err(section.not_allowed("element", &element.into()));
        }
        if let Some(whole) = keys.whole.filter(|_| !self.source.wrote("molecule")) {
            let error = self.source.refuse("output.whole", "needs molecules");
            let allowed = "no such key, or a table [molecule]";
            return Err(error.found(whole).allowed(allowed));
        }
        let spec = keys.format.spec();
        let output = Output {
            trajectory_every: Some(keys.trajectory_every).filter(|every| *every > 0),
            format: keys.format,
            precision: keys.precision.unwrap_or(lennard_io::DEFAULT_PRECISION),
            ase: keys.ase.unwrap_or(false),
            thermo_every: keys.thermo_every,
            element,
            velocities: keys.velocities.unwrap_or(spec.holds_vectors),
            forces: keys.forces,
            unwrapped: keys.unwrapped,
            whole: keys.whole.unwrap_or(true),
            length_scale: keys.length_scale,
        };
        self.fits_format(&output, keys.precision.is_some())?;
        Ok(output)
    }

    /// Refuses keys that the format of the trajectory has no place for.
    fn fits_format(&self, output: &Output, has_precision: bool) -> Result<(), SceneError> {
        let spec = output.format.spec();
        let name = output.format.name();
        let refuse = |key: &str, found: String, allowed: &str| {
            let key = format!("output.{key}");
            let error = self.source.refuse(&key, "does not go with the format");
            Err(error.found(format!("{found}, with format {name:?}")).allowed(allowed))
        };
        let fitting = |fits: fn(&FormatSpec) -> bool| {
            let all = TrajectoryFormat::ALL.iter().filter(|f| fits(f.spec()));
            quoted(&all.map(|f| f.name()).collect::<Vec<_>>())
        };
        for (key, there) in [("velocities", output.velocities), ("forces", output.forces)] {
            if there && !spec.holds_vectors {
                let formats = fitting(|spec| spec.holds_vectors);
                return refuse(key, "true".into(), &format!("false, or a format of {formats}"));
            }
        }
        if has_precision && spec.limits.is_none() {
            let found = output.precision.to_string();
            let formats = fitting(|spec| spec.limits.is_some());
            return refuse("precision", found, &format!("the format {formats}, or no such key"));
        }
        if output.ase && !spec.holds_ase {
            let formats = fitting(|spec| spec.holds_ase);
            return refuse("ase", "true".into(), &format!("false, or a format of {formats}"));
        }
        if output.length_scale != 1.0 && !spec.names_scale {
            let found = output.length_scale.to_string();
            let formats = fitting(|spec| spec.names_scale);
            return refuse("length_scale", found, &format!("1, or a format of {formats}"));
        }
        if output.ase && output.length_scale != 1.0 {
            let found = format!("true, with length_scale = {}", output.length_scale);
            return refuse("ase", found, "`length_scale = 1`: energies are in ε");
        }
        Ok(())
    }

    pub fn checkpoint(&self) -> Result<Checkpoint, SceneError> {
        let keys: CheckpointKeys = self.plain("checkpoint")?;
        Ok(Checkpoint {
            every_steps: Some(keys.every_steps).filter(|every| *every > 0),
            every_seconds: Some(keys.every_seconds).filter(|every| *every > 0.0),
        })
    }
}
