//! The list of walls: one file and one line each.

mod hits;
mod planes;
mod surface;
mod term;

use lennard_core::options::{Keys, OptionError, Options};
use serde::{Deserialize, Serialize};

pub use hard::Response;
pub use hits::KICKS_OF_REST;
pub use planes::{SHALLOWEST_ROOM, SlitPlanes};
pub use surface::{Hit, HitRule, Rebound, Surface, WallForce, WallPoint};
pub use term::{WallPair, Walls};

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
pub trait Wall: Options + 'static {
    /// What the wall declares about itself.
    const SPEC: WallSpec;

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

/// Makes options, dispatch and lists from lines `file::Variant = "name",`.
macro_rules! list_of_walls {
    ($($(#[$doc:meta])* $file:ident::$variant:ident = $name:literal,)*) => {
        $(mod $file; pub use $file::$variant;)*

        /// A pair of walls, at both ends of an axis: what a scene's table `[[wall]]` says beside `axis` and `thickness`.
        #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
        #[serde(tag = "kind")]
        #[non_exhaustive]
        pub enum WallOptions {
            $($(#[$doc])* #[serde(rename = $name)] $variant($variant),)*
        }

        impl WallOptions {
            /// What the wall declares about itself.
            #[must_use]
            pub fn spec(&self) -> &'static WallSpec {
                match self {
                    $(Self::$variant(_) => &<$variant as Wall>::SPEC,)*
                }
            }

            /// What the wall at one end of the axis does to particles.
            #[must_use]
            pub fn surface(&self, context: &WallContext, is_upper: bool) -> Surface {
                match self {
                    $(Self::$variant(wall) => wall.surface(context, is_upper),)*
                }
            }

            /// Whether the options lie in their ranges.
            ///
            /// # Errors
            /// [`OptionError`] with the key that is to blame.
            pub fn check(&self) -> Result<(), OptionError> {
                match self {
                    $(Self::$variant(wall) => {
                        wall.check()?;
                        wall.check_together()
                    })*
                }
            }

            /// The scene keys of every wall, by its name.
            #[must_use]
            pub fn keys() -> Vec<(&'static str, Keys)> {
                vec![$((<$variant as Wall>::SPEC.name, <$variant as Options>::KEYS),)*]
            }

            /// Every wall with its default options, in the order of the list.
            #[must_use]
            pub fn all() -> Vec<Self> {
                vec![$(Self::$variant(<$variant>::default()),)*]
            }
        }

        static WALLS: &[WallSpec] = &[$(<$variant as Wall>::SPEC,)*];
    };
}

list_of_walls! {
    /// Hard planes: particles bounce.
    hard::Hard = "hard",
    /// Hard planes that give a particle a new velocity from a temperature.
    thermal::Thermal = "thermal",
    /// A half space of Lennard-Jones sites.
    lennard_jones_9_3::LennardJones93 = "lennard-jones-9-3",
    /// A layer of Lennard-Jones sites.
    lennard_jones_10_4::LennardJones104 = "lennard-jones-10-4",
    /// The repulsive part of Lennard-Jones.
    wca::WcaWall = "wca",
    /// A spring that pushes back what has passed the plane.
    soft::Soft = "soft",
}

/// Every wall that a scene may name.
#[must_use]
pub fn walls() -> &'static [WallSpec] {
    WALLS
}
