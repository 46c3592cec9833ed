//! What the study of stability measured.

use serde::Serialize;

use super::fluid::FluidStudy;
use super::{amplification, discretisation, displacement, groups, infinite, orders, variable_step};
use crate::StudyOptions;
use crate::claims::Claim;

/// Everything found on the oscillator.
#[derive(Debug, Clone, Serialize)]
pub struct OscillatorStudy {
    /// Methods that are the same map stand together.
    pub groups: Vec<groups::Group>,
    /// Amplification, phase and limits of each method.
    pub methods: Vec<amplification::MethodMap>,
    /// Displacement and energy at each finite stiffness.
    pub cases: Vec<displacement::Case>,
    /// k = ∞ and the way there.
    pub infinite: infinite::Infinite,
    /// The discretisation error on ẍ = w²x.
    pub growth: Vec<discretisation::GrowthError>,
    /// The three rules for a changing step.
    pub step_rules: Vec<variable_step::StepRuleRun>,
    /// The share of changes of its step that SPOOK refuses.
    pub refused_changes: f64,
    /// Orders.
    pub orders: orders::Orders,
}

/// Everything found.
#[derive(Debug, Clone, Serialize)]
pub struct StabilityStudy {
    /// Name and version of the schema.
    pub schema: &'static str,
    /// What was asked for.
    pub options: StudyOptions,
    /// The oscillator.
    pub oscillator: OscillatorStudy,
    /// The fluid.
    pub fluid: FluidStudy,
    /// What is claimed, by whom, and whether it holds.
    pub claims: Vec<Claim>,
}
