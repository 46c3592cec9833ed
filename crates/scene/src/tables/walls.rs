//! The tables `[[wall]]`, `[field]` and `[contact]`: what confines a fluid, and bodies that touch.

use lennard_core::Axis;
use lennard_forcefield::WallOptions;
use lennard_integrators::ContactOptions;

use crate::limits::LONGEST_SIDE;

/// The table `[contact]`.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactTable {
    /// Distance of two centres at which bodies touch, σ; times σ_ab for two species.
    pub diameter: f64,
    /// What happens then.
    pub options: ContactOptions,
}

lennard_core::options! {
    /// The keys of `[contact]` that all kinds have.
    pub(crate) struct ContactKeys {
        /// Distance of two centres at which bodies touch; for two species it is times their σ. At most half the shortest box side.
        diameter: f64 = 1.0, Between(0.01, 100.0), in "σ";
    }
}

impl From<&ContactTable> for ContactKeys {
    fn from(table: &ContactTable) -> Self {
        Self { diameter: table.diameter }
    }
}

/// A table `[[wall]]`: walls at both ends of an axis.
#[derive(Debug, Clone, PartialEq)]
pub struct WallTable {
    /// The axis of the normal.
    pub axis: Axis,
    /// Length of the box along the axis behind the planes, σ: the distance between the images of the fluid.
    pub thickness: f64,
    /// The walls with their own keys.
    pub options: WallOptions,
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

impl From<&WallTable> for WallKeys {
    fn from(table: &WallTable) -> Self {
        Self { axis: table.axis, thickness: Some(table.thickness) }
    }
}
