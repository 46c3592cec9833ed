//! The list of walls: one file and one line each.

mod hard;
mod lennard_jones_10_4;
mod lennard_jones_9_3;
mod soft;
mod surface;
mod term;
mod thermal;
mod wca;

use lennard_core::options::OptionError;
use serde::Serialize;

pub use hard::{Hard, Response};
pub use soft::Soft;
pub use surface::{Hit, HitRule, Rebound, Surface, WallForce};
pub use term::{KICKS_OF_REST, SHALLOWEST_ROOM, SlitPlanes, WallPair, Walls};

/// What a wall declares about itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct WallSpec {
    /// Name in scene files.
    pub name: &'static str,
    /// One sentence.
    pub summary: &'static str,
    /// The formula, in plain text; z is the distance of a particle from the plane.
    pub equation: &'static str,
    /// Author, title, equation.
    pub source: &'static str,
}

/// What walls may know when they are built.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WallContext {
    /// Temperature of a wall that names none, ε/k_B.
    pub temperature: f64,
}

/// The file of a wall provides this for its options type.
pub trait Wall {
    /// What the wall at one end of the axis does to particles.
    fn surface(&self, context: &WallContext, is_upper: bool) -> Surface;

    /// Whether the options go together; each alone lies in its range.
    ///
    /// # Errors
    /// [`OptionError`] with the key that does not fit the others.
    fn check_together(&self) -> Result<(), OptionError> {
        Ok(())
    }
}

lennard_core::list_of_methods! {
    /// A pair of walls, at both ends of an axis: what a scene's table `[[wall]]` says beside `axis` and `thickness`.
    #[serde(tag = "kind", rename_all = "kebab-case")]
    #[non_exhaustive]
    pub enum WallOptions: Wall, declared by SPEC: WallSpec {
        /// Hard planes: particles bounce.
        Hard: hard::Hard,
        /// Hard planes that give a particle a new velocity from a temperature.
        Thermal: thermal::Thermal,
        /// A half space of Lennard-Jones sites.
        #[serde(rename = "lennard-jones-9-3")]
        LennardJones93: lennard_jones_9_3::LennardJones93,
        /// A layer of Lennard-Jones sites.
        #[serde(rename = "lennard-jones-10-4")]
        LennardJones104: lennard_jones_10_4::LennardJones104,
        /// The repulsive part of Lennard-Jones.
        #[serde(rename = "wca")]
        WcaWall: wca::WcaWall,
        /// A spring that pushes back what has passed the plane.
        Soft: soft::Soft,
    }
}

/// Every wall that a scene may name.
#[must_use]
pub fn walls() -> &'static [WallSpec] {
    WallOptions::SPECS
}
