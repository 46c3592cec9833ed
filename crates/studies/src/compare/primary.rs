//! The quantities that readers look for first.

use super::RunFolder;

/// The quantities that readers look for first, in the order of a table.
const PRIMARY: [&str; 13] = [
    "potential_energy",
    "pressure",
    "density",
    "enthalpy",
    "heat_capacity",
    "configurational_temperature",
    "diffusion_coefficient",
    "shear_viscosity",
    "thermal_conductivity",
    "viscosity_by_exchange",
    "thermal_conductivity_by_exchange",
    "structure_factor_first_peak",
    "coordination_number",
];

/// The quantities that readers look for where vapor and liquid stand side by side.
const PRIMARY_OF_A_SLAB: [&str; 8] = [
    "liquid_density",
    "vapor_density",
    "vapor_pressure",
    "surface_tension",
    "potential_energy",
    "pressure_zz",
    "surface_tension_z",
    "configurational_temperature",
];

/// The quantities that readers look for between walls.
const PRIMARY_BETWEEN_WALLS: [&str; 7] = [
    "potential_energy",
    "wall_pressure_x_lower",
    "wall_pressure_x_upper",
    "wall_pressure_y_lower",
    "wall_pressure_y_upper",
    "wall_pressure_z_lower",
    "wall_pressure_z_upper",
];

/// The quantities that readers look for where a crystal stands beside its liquid.
const PRIMARY_OF_A_FRONT: [&str; 5] =
    ["front_velocity", "solid_share", "potential_energy", "pressure", "density"];

/// What belongs first in the table of a run, besides its temperature.
pub(super) fn of(run: &RunFolder) -> &'static [&'static str] {
    if run.has_two_phases() {
        &PRIMARY_OF_A_SLAB
    } else if !run.scene.walls.is_empty() {
        &PRIMARY_BETWEEN_WALLS
    } else if run.scene.half_crystal().is_some() {
        &PRIMARY_OF_A_FRONT
    } else {
        &PRIMARY
    }
}
