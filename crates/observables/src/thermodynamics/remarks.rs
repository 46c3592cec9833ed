//! What belongs beside the thermodynamic averages, and what speaks against them.

use crate::{Average, Doubt};

use super::Thermodynamics;

/// What takes a meaning away from averages of a homogeneous fluid.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Confined {
    /// Whether walls, a field or held particles take the fluid's homogeneity away.
    pub is_inhomogeneous: bool,
    /// Whether particles hit walls or each other in flight: their momentum at hits is in no force.
    pub by_hits: bool,
}

impl Thermodynamics {
    /// Tells that walls or a field confine the fluid, which then has no one pressure, or that impulses are in no virial. `None` is the
    /// default.
    pub fn set_confined(&mut self, confined: Option<Confined>) {
        self.confined = confined;
    }

    /// Says of averages that mean nothing between walls or in a field why they do not.
    pub(super) fn doubt_of_confined(&self, averages: &mut [Average]) {
        let Some(confined) = self.confined else {
            return;
        };
        for average in averages {
            let why = match average.name.as_str() {
                "pressure" | "pressure_without_tail" if !confined.is_inhomogeneous => {
                    "the impulses of contacts in flight are not in the virial"
                }
                "pressure" | "pressure_without_tail" => {
                    "a fluid with walls or in a field has no one pressure: see `wall-pressure`"
                }
                "configurational_temperature" if confined.by_hits => {
                    "the momentum of hits is in no force: terms of the planes are missing"
                }
                _ => continue,
            };
            average.doubt = Some(Doubt::Incomplete(why.to_owned()));
        }
    }
}
