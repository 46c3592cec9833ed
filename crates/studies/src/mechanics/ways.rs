//! The ways to hold bonds that the study compares: every method of the list, and some with other options.

use lennard_integrators::BondOptions;
use lennard_integrators::bonds::{relaxation, spook, spring};

/// A way to hold bonds.
#[derive(Debug, Clone)]
pub(crate) struct Way {
    /// Name in legends.
    pub(crate) name: String,
    pub(crate) bonds: BondOptions,
}

/// Springs by the implicit midpoint rule: name and stiffness, ε/σ².
pub(crate) const MIDPOINT: [(&str, f64); 3] =
    [("midpoint, k = 1000", 1e3), ("midpoint, k = 16000", 1.6e4), ("midpoint, k = 64000", 6.4e4)];

/// Relaxation until a tolerance, along the old bond.
pub(crate) fn relaxed(tolerance: f64) -> BondOptions {
    BondOptions::Relaxation(relaxation::Options {
        tolerance: Some(tolerance),
        ..Default::default()
    })
}

/// Projection along the new bond, which dissipates.
pub(crate) fn projected() -> BondOptions {
    BondOptions::Relaxation(relaxation::Options {
        tolerance: Some(1e-13),
        direction: relaxation::Direction::New,
        ..Default::default()
    })
}

/// SPOOK with a damping time of so many steps and no compliance.
pub(crate) fn damped(steps: f64) -> BondOptions {
    BondOptions::Spook(spook::Options { damping_steps: steps, ..Default::default() })
}

/// Springs of a stiffness, ε/σ².
pub(crate) fn springs(stiffness: f64) -> BondOptions {
    springs_by(spring::Scheme::Explicit, stiffness)
}

/// Springs of a stiffness in ε/σ² by a scheme.
fn springs_by(scheme: spring::Scheme, stiffness: f64) -> BondOptions {
    BondOptions::Spring(spring::Options { stiffness, scheme, ..Default::default() })
}

/// Every way: the methods of the list with their default options, and variants.
pub(crate) fn ways() -> Vec<Way> {
    let of_the_list =
        BondOptions::all().into_iter().map(|bonds| Way { name: bonds.name().to_owned(), bonds });
    let variant = |name: &str, bonds| Way { name: name.to_owned(), bonds };
    of_the_list
        .chain([
            variant("relaxation, 10⁻³", relaxed(1e-3)),
            variant("relaxation, 10⁻⁵", relaxed(1e-5)),
            variant("relaxation, new direction", projected()),
            variant("spook, τ = h/2", damped(0.5)),
            variant("spook, τ = 4h", damped(4.0)),
            variant("spring, k = 1000", springs(1e3)),
            variant("spring, k = 64000", springs(6.4e4)),
        ])
        .chain(MIDPOINT.map(|(name, k)| variant(name, springs_by(spring::Scheme::Midpoint, k))))
        .collect()
}
