//! Reads the tables `[accuracy]`, `[output]` and `[checkpoint]`.

use lennard_core::options::Options;
use lennard_core::options::quoted;
use lennard_io::{FormatSpec, TrajectoryFormat};

use crate::read::Reader;
use crate::tables::output::{CheckpointKeys, OutputKeys};
use crate::{Accuracy, Checkpoint, Output, SceneError};

impl Reader<'_> {
    /// The table, where there is one.
    pub fn accuracy(&self) -> Result<Option<Accuracy>, SceneError> {
        if !self.source.wrote("accuracy") {
            return Ok(None);
        }
        let accuracy: Accuracy = self.plain("accuracy")?;
        if accuracy.asked().is_empty() {
            let keys: Vec<&str> = Accuracy::KEYS.iter().map(|key| key.key).collect();
            return Err(self
                .refuse("accuracy", "asks for nothing")
                .found("an empty table")
                .allowed(format!("at least one of {}", keys.join(", "))));
        }
        Ok(Some(accuracy))
    }
}

const DEFAULT_ELEMENT: &str = "Ar";

impl Reader<'_> {
    pub fn output(&self) -> Result<Output, SceneError> {
        let section = self.section("output");
        let keys: OutputKeys = section.read(self.table("output"))?;
        let element = keys.element.unwrap_or_else(|| DEFAULT_ELEMENT.to_owned());
        if !lennard_io::is_element_symbol(&element) {
            return Err(section.not_allowed("element", &element.into()));
        }
        if let Some(whole) = keys.whole.filter(|_| !self.source.wrote("molecule")) {
            let error = self.refuse("output.whole", "needs molecules");
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
            let error = self.refuse(&key, "does not go with the format");
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
