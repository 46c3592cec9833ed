//! Names of parts that belong to a stage.

use lennard_scene::Stage;

/// The name of a stage's heat bath in the plan.
pub fn bath_name(stage: &Stage, thermostat: &str) -> String {
    format!("thermostat {thermostat} of {}", stage.name)
}

/// The name of a stage's barostat in the plan.
pub fn barostat_name(stage: &Stage, barostat: &str) -> String {
    format!("barostat {barostat} of {}", stage.name)
}
