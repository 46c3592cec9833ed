//! Parts of a run that a program brings and no scene file holds.

use serde::{Deserialize, Serialize};

use crate::{Scene, SceneError};

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

impl Scene {
    /// The same scene with parts of a program.
    ///
    /// # Errors
    /// [`SceneError`] where another table does not go with them, such as a tail correction with a field.
    pub fn with_program(mut self, program: ProgramParts) -> Result<Self, SceneError> {
        self.program = program;
        self.check()?;
        Ok(self)
    }

    /// The name of the method that advances time: of the program where it brings one, else of `[integrator]`.
    #[must_use]
    pub fn method_name(&self) -> &str {
        let own = self.program.integrator.as_deref();
        own.unwrap_or_else(|| self.integrator.method.name())
    }
}
