//! Response functions of a run, where its ensemble gives them.

use crate::{Average, Curvature, Ensemble, Remark};

use super::Thermodynamics;
use crate::response::{self, Setting};
use crate::statistics::mean;

impl Thermodynamics {
    /// Tells how Σ r²u″ follows from energy and virial; `None`, the default, where it does not.
    pub fn set_curvature(&mut self, curvature: Option<Curvature>) {
        self.curvature = curvature;
    }

    fn setting(&self, ensemble: Ensemble, cut: usize) -> Setting {
        let volume = match ensemble {
            Ensemble::Isobaric { .. } => {
                mean(&self.series.rows().volume[cut..]) * self.context.n_molecules() as f64
            }
            _ => self.seen.volume(),
        };
        Setting { ensemble, curvature: self.curvature, n_dof: self.n_dof, mass: self.mass, volume }
    }

    /// The response functions after `cut` rows; none in a fluid with walls or in a field, which has no one density.
    pub(super) fn responses(&self, cut: usize) -> Vec<Average> {
        let rows = self.series.rows();
        let ensemble = self.ensemble.filter(|_| self.confined.is_none());
        let cut = cut.min(rows.time.len());
        ensemble.map_or_else(Vec::new, |ensemble| {
            response::averages(&self.setting(ensemble, cut), rows, cut, &self.context)
        })
    }

    /// How they were found, or why there are none.
    pub(super) fn remark_on_responses(&self) -> Remark {
        let none = |why: &str| Remark::NoResponseFunctions { why: why.to_owned() };
        if !self.context.molecules.are_atoms() {
            return none("they are given for atoms alone");
        }
        if self.confined.is_some() {
            return none("a fluid with walls or in a field has no one density");
        }
        match self.ensemble {
            None => none("the measured stages sample no ensemble that is known"),
            Some(ensemble) => response::remark(&self.setting(ensemble, 0)),
        }
    }
}
