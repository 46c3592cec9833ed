//! Reads the tables `[accuracy]`, `[output]` and `[checkpoint]`.

use lennard_core::options::Options;
use lennard_core::options::quoted;
use lennard_io::{FormatSpec, TrajectoryFormat};

use crate::read::Reader;
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

impl Reader<'_> {
    pub fn output(&self, has_species: bool) -> Result<Output, SceneError> {
        let section = self.section("output");
        let mut output: Output = section.read(self.table("output"))?;
        if !lennard_io::is_element_symbol(&output.element) {
            return Err(section.not_allowed("element", &output.element.into()));
        }
        let of_molecules = self.source.wrote("molecule");
        if let Some(whole) = output.whole.filter(|_| !of_molecules) {
            let error = self.refuse("output.whole", "needs molecules");
            let allowed = "no such key, or a table [molecule]";
            return Err(error.found(whole).allowed(allowed));
        }
        self.fits_format(&output)?;
        output.whole = of_molecules.then(|| output.whole.unwrap_or(true));
        if has_species {
            // Species have elements of their own.
            output.element.clear();
        }
        let format = output.format;
        Ok(output.in_format(format))
    }

    /// Refuses keys that the format of the trajectory has no place for.
    fn fits_format(&self, output: &Output) -> Result<(), SceneError> {
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
        let velocities = output.velocities && self.source.wrote("output.velocities");
        for (key, there) in [("velocities", velocities), ("forces", output.forces)] {
            if there && !spec.holds_vectors {
                let formats = fitting(|spec| spec.holds_vectors);
                return refuse(key, "true".into(), &format!("false, or a format of {formats}"));
            }
        }
        if let (Some(precision), None) = (output.precision, spec.limits) {
            let found = precision.to_string();
            let formats = fitting(|spec| spec.limits.is_some());
            return refuse("precision", found, &format!("the format {formats}, or no such key"));
        }
        let for_ase = output.ase == Some(true);
        if for_ase && !spec.holds_ase {
            let formats = fitting(|spec| spec.holds_ase);
            return refuse("ase", "true".into(), &format!("false, or a format of {formats}"));
        }
        if output.length_scale != 1.0 && !spec.names_scale {
            let found = output.length_scale.to_string();
            let formats = fitting(|spec| spec.names_scale);
            return refuse("length_scale", found, &format!("1, or a format of {formats}"));
        }
        if for_ase && output.length_scale != 1.0 {
            let found = format!("true, with length_scale = {}", output.length_scale);
            return refuse("ase", found, "`length_scale = 1`: energies are in ε");
        }
        Ok(())
    }

    pub fn checkpoint(&self) -> Result<Checkpoint, SceneError> {
        self.plain("checkpoint")
    }
}
