//! What a wall does to a particle: it exerts a force, or it is hit.

use std::fmt::{self, Debug, Formatter};
use std::sync::Arc;

use lennard_core::DVec3;
use lennard_core::random::CounterRng;

use super::thermal::draw;
use crate::contact_law::{ContactLaw, ForcePoint};

/// A wall that exerts a force at a distance z from its plane, σ; z is positive between the planes.
#[derive(Clone)]
pub struct WallForce {
    at: Arc<dyn Fn(f64) -> ForcePoint + Send + Sync>,
    /// The distance beyond which the wall exerts no force, σ.
    pub reach: f64,
    /// The distance at which the first layer of a lattice may stand, σ.
    pub clearance: f64,
    /// The contact of a wall that is a spring behind its plane. Its dashpot acts in drifts.
    pub contact: Option<ContactLaw>,
}

impl WallForce {
    /// A force between the planes, by its values at z < `reach`.
    pub(super) fn new(
        reach: f64,
        clearance: f64,
        at: impl Fn(f64) -> ForcePoint + Send + Sync + 'static,
    ) -> Self {
        Self { at: Arc::new(at), reach, clearance, contact: None }
    }

    /// Energy, force and curvature at z < [`WallForce::reach`].
    #[must_use]
    pub fn at(&self, z: f64) -> ForcePoint {
        (self.at)(z)
    }
}

impl Debug for WallForce {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.debug_struct("WallForce").field("reach", &self.reach).finish_non_exhaustive()
    }
}

/// A particle at the moment at which it hits a plane.
#[derive(Debug)]
pub struct Hit<'a> {
    /// The axis of the normal: 0, 1, 2 for x, y, z.
    pub axis: usize,
    /// The direction out of the slit along the axis: −1 or +1.
    pub outward: f64,
    /// Velocity before the hit, σ/τ.
    pub velocity: DVec3,
    /// Mass of the particle.
    pub mass: f64,
    /// Random numbers of this particle in this step.
    pub random: &'a mut CounterRng,
}

/// Where in a step a hit happens.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum HitRule {
    /// Where the straight line of the drift meets the plane.
    OnLines,
    /// Where the parabola of a constant acceleration meets the plane.
    OnParabolas,
    /// At the end of a step of kick-drift-kick: position and velocity are mirrored, and both lose their share.
    Mirrored {
        /// The share e that is kept.
        restitution: f64,
    },
    /// At the end of the drift: the position moves to the plane, and the velocity is the displacement over the time.
    Projected,
    /// In no flight: whoever solves for the contacts of bodies solves for this plane too. Walls alone let particles pass it.
    ByContacts,
}

impl HitRule {
    /// Whether hits happen on the way, and not at its end.
    #[must_use]
    pub fn is_on_the_way(self) -> bool {
        matches!(self, Self::OnLines | Self::OnParabolas)
    }

    /// Whether hits happen at the end of the flight.
    #[must_use]
    pub fn is_at_end(self) -> bool {
        matches!(self, Self::Mirrored { .. } | Self::Projected)
    }

    /// Whether the rule is made for steps of kick-drift-kick alone.
    #[must_use]
    pub fn needs_kick_drift_kick(self) -> bool {
        matches!(self, Self::OnParabolas | Self::Mirrored { .. })
    }
}

/// A wall that is hit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Rebound {
    /// A particle keeps its velocity along the plane, and a share of its normal speed.
    Keeps {
        /// The share e.
        restitution: f64,
        /// Where in a step hits happen.
        rule: HitRule,
    },
    /// A particle gets a new velocity from the temperature of the wall.
    Draws {
        /// The temperature, ε/k_B.
        temperature: f64,
    },
}

impl Rebound {
    /// The velocity with which a particle leaves, σ/τ; its outward component is 0 or less.
    #[must_use]
    pub fn leave(self, hit: Hit<'_>) -> DVec3 {
        match self {
            Self::Keeps { restitution, .. } => {
                let mut v = hit.velocity;
                v[hit.axis] *= -restitution;
                v
            }
            Self::Draws { temperature } => draw(temperature, hit),
        }
    }
}

/// What a wall does to particles.
#[derive(Debug, Clone)]
pub enum Surface {
    /// It exerts a force.
    Exerts(WallForce),
    /// It is hit.
    Hit(Rebound),
}

impl Surface {
    /// Where in a step hits of this wall happen; `None` where it is not hit.
    #[must_use]
    pub fn rule(&self) -> Option<HitRule> {
        match self {
            Self::Hit(Rebound::Keeps { rule, .. }) => Some(*rule),
            Self::Hit(Rebound::Draws { .. }) => Some(HitRule::OnLines),
            Self::Exerts(_) => None,
        }
    }

    /// Whether the wall exerts a force at a distance.
    #[must_use]
    pub fn exerts(&self) -> bool {
        matches!(self, Self::Exerts(_))
    }

    /// The share of its normal speed that a particle keeps at a hit; `None` where the wall is not hit or gives a speed of its own.
    #[must_use]
    pub fn restitution(&self) -> Option<f64> {
        match self {
            Self::Hit(Rebound::Keeps { restitution, .. }) => Some(*restitution),
            Self::Hit(Rebound::Draws { .. }) | Self::Exerts(_) => None,
        }
    }

    /// The contact of a wall that is a spring with a dashpot.
    #[must_use]
    pub fn dashpot(&self) -> Option<&ContactLaw> {
        match self {
            Self::Exerts(wall) => wall.contact.as_ref().filter(|contact| contact.is_damped()),
            Self::Hit(_) => None,
        }
    }

    /// ω = √(k/m) of a unit mass at a wall that is a linear spring, τ⁻¹.
    #[must_use]
    pub fn frequency(&self) -> Option<f64> {
        match self {
            Self::Exerts(wall) => wall.contact?.frequency(1.0),
            Self::Hit(_) => None,
        }
    }

    /// The distance at which the first layer of a lattice may stand, σ.
    #[must_use]
    pub fn clearance(&self) -> f64 {
        match self {
            Self::Exerts(force) => force.clearance,
            Self::Hit(_) => 0.0,
        }
    }
}
