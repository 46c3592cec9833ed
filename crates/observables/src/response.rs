//! Response functions from the fluctuations of U, W, K and V: heat capacities, compressibilities, expansion, sound.

mod base;
mod ensembles;
mod influence;

use crate::{Average, BuildContext, Doubt, Ensemble, Estimate, Remark, ThermoSeries};

use crate::averages::{FEWEST_FLUCTUATIONS, of_fluctuations};

use base::COUNT;
pub use base::Curvature;
pub(crate) use base::Setting;

/// A response function: name, unit, and whether it needs Σ r²u″ where the volume is constant.
struct Response {
    name: &'static str,
    unit: &'static str,
    needs_curvature: bool,
}

const fn response(name: &'static str, unit: &'static str, needs_curvature: bool) -> Response {
    Response { name, unit, needs_curvature }
}

const COMPRESSIBILITY: &str = "isothermal_compressibility";
/// What has the bulk modulus 1/κ_T below a fraction bar where the volume is constant.
const OVER_BULK_MODULUS: [&str; 3] =
    [COMPRESSIBILITY, "heat_capacity_pressure", "thermal_expansion"];
/// The bulk modulus is so many of its errors from zero at least where its inverse has an error. The inverse is then hardly skewed:
/// 94 % of the values lie within two of their errors.
const FEWEST_ERRORS_FROM_ZERO: f64 = 5.0;

/// In the order of [`base::Values`]; c_v is the first.
const RESPONSES: [Response; COUNT] = [
    response("heat_capacity", "k_B per particle", false),
    response("heat_capacity_pressure", "k_B per particle", true),
    response("thermal_pressure_coefficient", "k_B/σ³", false),
    response(COMPRESSIBILITY, "σ³/ε", true),
    response("isentropic_compressibility", "σ³/ε", true),
    response("thermal_expansion", "k_B/ε", true),
    response("speed_of_sound", "σ/τ", true),
    response("joule_thomson_coefficient", "σ³/k_B", true),
    response("grueneisen_parameter", "", false),
    response("density_scaling_exponent", "", false),
    response("energy_virial_correlation", "", false),
];

/// The names of all response functions, c_v first.
pub fn response_functions() -> impl Iterator<Item = &'static str> {
    RESPONSES.iter().map(|response| response.name)
}

/// The averages that a run gives after `cut` rows; none where the ensemble gives none for these particles.
pub(crate) fn averages(
    setting: &Setting,
    rows: &ThermoSeries,
    cut: usize,
    context: &BuildContext,
) -> Vec<Average> {
    if !context.molecules.are_atoms() || rows.time.len() < cut + 2 {
        return Vec::new();
    }
    let parts = ensembles::parts(setting, rows, cut, context);
    let at_constant_volume = !matches!(setting.ensemble, Ensemble::Isobaric { .. });
    let missing = at_constant_volume && setting.curvature.is_none();
    let control = match setting.ensemble {
        Ensemble::Canonical => Some(rows.exchange(cut)),
        _ => None,
    };
    let values = influence::of(&parts, control.as_deref(), |means| {
        ensembles::base(setting, context, means).all()
    });
    let unstable = why_unstable(&values);
    let unresolved = if at_constant_volume { why_unresolved(&values) } else { None };
    RESPONSES
        .iter()
        .zip(values)
        // At constant volume c_v has a formula and an average of its own.
        .skip(usize::from(at_constant_volume))
        .filter(|(response, (estimate, _))| {
            !(missing && response.needs_curvature) && estimate.mean.is_finite()
        })
        .map(|(response, (estimate, influence))| {
            of_fluctuations(response.name, response.unit, estimate, &influence, FEWEST_FLUCTUATIONS)
                .doubted(unstable.clone().filter(|_| response.needs_curvature))
                .doubted(
                    (unresolved.clone()).filter(|_| OVER_BULK_MODULUS.contains(&response.name)),
                )
        })
        .collect()
}

/// Why quotients by the bulk modulus have no error; `None` where it is far from zero.
fn why_unresolved(values: &[(Estimate, Vec<f64>)]) -> Option<Doubt> {
    let of = RESPONSES.iter().position(|r| r.name == COMPRESSIBILITY)?;
    let kappa = &values[of].0;
    // To first order κ_T has the relative error of its inverse.
    let errors = (kappa.mean / kappa.standard_error).abs();
    (errors < FEWEST_ERRORS_FROM_ZERO).then(|| Doubt::TooShort {
        why: format!(
            "the bulk modulus 1/κ_T is {errors:.1} of its errors from zero, where its inverse needs {FEWEST_ERRORS_FROM_ZERO:.0}"
        ),
        longer: (FEWEST_ERRORS_FROM_ZERO / errors).powi(2),
    })
}

/// Why values that need the compressibility are none of a homogeneous fluid; `None` where it may be one.
///
/// κ_T < 0 means ∂P/∂ρ < 0: such a fluid separates.
fn why_unstable(values: &[(Estimate, Vec<f64>)]) -> Option<Doubt> {
    let of = RESPONSES.iter().position(|r| r.name == COMPRESSIBILITY)?;
    let kappa = values[of].0.mean;
    (kappa < 0.0).then(|| {
        Doubt::Incomplete(format!(
            "the isothermal compressibility is {kappa:.3}, and no stable phase has one below zero: the fluid separates, or the run is too short"
        ))
    })
}

/// What was assumed, and what is missing by name.
pub(crate) fn remark(setting: &Setting) -> Remark {
    let how = match setting.ensemble {
        Ensemble::Canonical => "from the fluctuations of U and W at constant temperature",
        Ensemble::Microcanonical => "from the fluctuations of K and W at constant energy",
        Ensemble::Isobaric { .. } => {
            "from the fluctuations of volume and enthalpy at constant pressure"
        }
    };
    let missing: Vec<&str> =
        RESPONSES.iter().filter(|r| r.needs_curvature).map(|r| r.name).collect();
    let how = match (setting.ensemble, setting.curvature) {
        (Ensemble::Isobaric { .. }, _) => how.to_owned(),
        (_, None) => format!(
            "{how}; not given, since Σ r²u″ does not follow from U and W alone: {}",
            missing.join(", ")
        ),
        (_, Some(curvature)) if curvature.of_truncated => {
            format!("{how}, with Σ r²u″ from U, W and the pairs at the cutoff")
        }
        _ => format!("{how}, with Σ r²u″ from U and W of the full potential"),
    };
    Remark::ResponseFunctions { how }
}

#[cfg(test)]
mod tests;
