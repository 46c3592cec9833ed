//! The tables `[output]`, `[checkpoint]` and `[program]`: what is written, when, and what a program added.

use lennard_core::options::MOST_STEPS;
use lennard_io::TrajectoryFormat;
use serde::{Deserialize, Serialize};

/// A number of which 0 in a file stands for none.
mod zero_is_none {
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    pub fn serialize<T, S>(number: &Option<T>, to: S) -> Result<S::Ok, S::Error>
    where
        T: Copy + Default + Serialize,
        S: Serializer,
    {
        number.unwrap_or_default().serialize(to)
    }

    pub fn deserialize<'de, T, D>(from: D) -> Result<Option<T>, D::Error>
    where
        T: Default + PartialEq + Deserialize<'de>,
        D: Deserializer<'de>,
    {
        T::deserialize(from).map(|number| Some(number).filter(|number| *number != T::default()))
    }
}

lennard_core::options! {
    /// The table `[output]`. Where the format or the scene has no place for a value, there is none.
    pub struct Output {
        /// Steps between two frames of the trajectory; 0 for no trajectory.
        trajectory_every with "zero_is_none": Option<u64> = None, as "`0`", Whole(0, MOST_STEPS), in "steps";
        /// Format of the trajectory. `xyz` is extended XYZ as text, and `xyz.gz` the same compressed; `lammps-dump` is the text of LAMMPS, and `xtc` has rounded positions alone.
        format: TrajectoryFormat = TrajectoryFormat::Xyz, Names(TrajectoryFormat::names);
        /// Positions in XTC are multiples of 1/`precision`, with format "xtc" alone.
        precision: Option<f64> = None, else "10,000 for \"xtc\"", Between(10.0, 1e6), in "per σ";
        /// Whether frames hold momenta, masses and the energy under the names that ASE reads, in reduced units; with formats "xyz" and "xyz.gz" alone.
        ase: Option<bool> = None, else "`false`", Flag;
        /// Steps between two samples of the thermodynamics, each a line of `thermo.csv`; the `every` of a `thermodynamics` observable is the same number.
        thermo_every: u64 = 10, Whole(1, MOST_STEPS), in "steps";
        /// Symbol of the particles in the files, for tools that know only elements.
        element skip "String::is_empty": String = "Ar".to_owned(), Words("an element symbol, or \"X\"");
        /// Whether frames hold velocities.
        velocities: bool = true, as "`true`; `false` for \"xtc\", which has none", Flag;
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
    /// The table `[checkpoint]`. By default a killed run loses ten minutes at most, and a long run pays far below 1 %.
    pub struct Checkpoint {
        /// Steps between two checkpoints; 0 for none.
        every_steps with "zero_is_none": Option<u64> = None, as "`0`", Whole(0, MOST_STEPS), in "steps";
        /// Wall-clock seconds between two checkpoints; 0 for none.
        every_seconds with "zero_is_none": Option<f64> = Some(600.0), Between(0.0, 1e9), in "s";
    }
}

impl Output {
    /// The same in another format, with the defaults of that format and without what it has no place for.
    #[must_use]
    pub fn in_format(self, format: TrajectoryFormat) -> Self {
        let spec = format.spec();
        Self {
            format,
            precision: spec.limits.map(|_| self.precision.unwrap_or(lennard_io::DEFAULT_PRECISION)),
            ase: spec.holds_ase.then(|| self.ase.unwrap_or(false)),
            velocities: self.velocities && spec.holds_vectors,
            forces: self.forces && spec.holds_vectors,
            length_scale: if spec.names_scale { self.length_scale } else { 1.0 },
            ..self
        }
    }
}

/// The table `[program]`: names of what the program of a run added to the scene.
///
/// A scene file cannot hold these parts. It names them, so that whoever reads it knows that the rest alone is another run.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ProgramParts {
    /// Forces that change the total momentum, as fields do.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub fields: Vec<String>,
    /// Forces that leave the total momentum as it is.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub forces: Vec<String>,
    /// The method that takes the place of `[integrator]`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub integrator: Option<String>,
    /// Observables.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub observables: Vec<String>,
}

impl ProgramParts {
    /// Whether there is none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    /// Whether a force acts that the scene does not name.
    #[must_use]
    pub fn have_forces(&self) -> bool {
        !(self.fields.is_empty() && self.forces.is_empty())
    }

    /// The parts in words: "field `trap`, integrator `mine`".
    #[must_use]
    pub fn in_words(&self) -> String {
        let kinds = [
            ("field", &self.fields),
            ("force", &self.forces),
            ("integrator", &self.integrator.iter().cloned().collect()),
            ("observable", &self.observables),
        ];
        let named = kinds.into_iter().flat_map(|(kind, names)| {
            let each = names.iter().map(move |name| format!("{kind} `{name}`"));
            each.collect::<Vec<_>>()
        });
        match named.collect::<Vec<_>>() {
            none if none.is_empty() => "no part".to_owned(),
            all => all.join(", "),
        }
    }
}
