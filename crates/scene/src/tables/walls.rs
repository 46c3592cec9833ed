//! The tables `[[wall]]`, `[field]` and `[contact]`: what confines a fluid, and bodies that touch.

use lennard_core::Axis;
use lennard_forcefield::WallOptions;
use lennard_integrators::ContactOptions;
use serde::Serialize;

use crate::limits::LONGEST_SIDE;

/// The table `[contact]`, in the order of its keys as a scene writes them.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ContactTable {
    /// What happens where bodies touch.
    #[serde(flatten)]
    pub options: ContactOptions,
    /// Distance of two centres at which bodies touch, σ; times σ_ab for two species.
    pub diameter: f64,
}

lennard_core::options! {
    /// The keys of `[contact]` that all kinds have.
    pub(crate) struct ContactKeys {
        /// Distance of two centres at which bodies touch; for two species it is times their σ. At most half the shortest box side.
        diameter: f64 = 1.0, Between(0.01, 100.0), in "σ";
    }
}

/// A table `[[wall]]`: walls at both ends of an axis, in the order of its keys as a scene writes them.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct WallTable {
    /// The walls with their own keys.
    #[serde(flatten)]
    pub options: WallOptions,
    /// The axis of the normal.
    pub axis: Axis,
    /// Length of the box along the axis behind the planes, σ: the distance between the images of the fluid.
    pub thickness: f64,
}

lennard_core::options! {
    /// The keys of `[[wall]]` that all kinds have.
    pub(crate) struct WallKeys {
        /// The axis across which the walls stand.
        axis: Axis = Axis::Z, Names(Axis::names);
        /// Length of the box behind the planes, which keeps the fluid out of reach of its images; at least `r_cut` + 0.1.
        thickness: Option<f64> = None, else "`r_cut` + 1.0", Between(1e-6, LONGEST_SIDE), in "σ";
    }
}

lennard_core::options! {
    /// The keys of `[field]`.
    pub(crate) struct FieldKeys {
        /// Acceleration of every particle.
        acceleration: Vec<f64> = vec![0.0; 3], Words("three finite numbers [gx, gy, gz]; 0 along an axis without walls"), in "σ/τ²";
    }
}
