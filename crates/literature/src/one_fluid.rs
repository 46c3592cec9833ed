//! The van der Waals one-fluid theory of Lennard-Jones mixtures.

use crate::equation::{EquationOfState, EquationSpec, OwnUncertainty, Range};
use crate::fluid_state::CriticalPoint;
use crate::jet::Jet;
use crate::made::Made;
use crate::model::thol_2016;

/// The largest ratio of two σ for which the band of the theory is stated.
pub const LARGEST_SIZE_RATIO: f64 = 1.1;
/// The band in U, as a share of |u|.
const BAND_ENERGY: f64 = 0.01;
/// The band in P, as a share of ρT.
const BAND_PRESSURE: f64 = 0.03;

/// The one fluid that stands for a mixture: σ_x and ε_x.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OneFluid {
    /// σ_x, in σ of the scene.
    pub sigma: f64,
    /// ε_x, in ε of the scene.
    pub epsilon: f64,
    /// The mean mass of a particle, m. It enters the speed of sound alone.
    pub mass: f64,
}

impl OneFluid {
    /// The one fluid of a mixture with these mole fractions, where `pair(a, b)` gives σ_ab and ε_ab:
    ///
    /// σ_x³ = Σ x_a·x_b·σ_ab³, ε_x·σ_x³ = Σ x_a·x_b·ε_ab·σ_ab³, over ordered pairs. The mass is 1.
    ///
    /// T. W. Leland, J. S. Rowlinson and G. A. Sather, Trans. Faraday Soc. 64 (1968) 1447.
    #[must_use]
    pub fn of(fractions: &[f64], pair: impl Fn(usize, usize) -> [f64; 2]) -> Self {
        let (mut volume, mut energy) = (0.0, 0.0);
        for (a, x_a) in fractions.iter().enumerate() {
            for (b, x_b) in fractions.iter().enumerate() {
                let [sigma, epsilon] = pair(a, b);
                let share = x_a * x_b * sigma.powi(3);
                volume += share;
                energy += share * epsilon;
            }
        }
        Self { sigma: volume.cbrt(), epsilon: energy / volume, mass: 1.0 }
    }

    /// The same with another mean mass of a particle, m.
    #[must_use]
    pub fn with_mass(self, mass: f64) -> Self {
        Self { mass, ..self }
    }
}

/// Thol 2016 for the one fluid of a mixture: with T* = T/ε_x and ρ* = ρ·σ_x³, u = ε_x·u* and p = p*·ε_x/σ_x³.
#[derive(Debug)]
pub struct OneFluidEquation {
    spec: EquationSpec,
    fluid: OneFluid,
}

impl OneFluidEquation {
    fn new(fluid: OneFluid) -> Self {
        let pure = thol_2016().spec();
        let (epsilon, volume) = (fluid.epsilon, fluid.sigma.powi(3));
        let range = &pure.range;
        Self {
            spec: EquationSpec {
                key: "van-der-waals-one-fluid".to_owned(),
                name: "van der Waals one-fluid theory with Thol 2016".to_owned(),
                model: format!(
                    "a theory of mixtures: one fluid with σ = {:.4} and ε = {epsilon:.4}; band 1 % of U, 3 % of ρT in P",
                    fluid.sigma
                ),
                citation: format!(
                    "T. W. Leland, J. S. Rowlinson, G. A. Sather, Trans. Faraday Soc. 64, 1447 (1968); {}",
                    pure.citation
                ),
                doi: String::new(),
                status: "a theory, with a band for sizes that differ by less than 10 %".to_owned(),
                superseded: None,
                range: Range {
                    t_min: range.t_min * epsilon,
                    t_max: range.t_max * epsilon,
                    p_max: range.p_max * epsilon / volume,
                    rho_max: range.rho_max.map(|most| most / volume),
                    status: range.status.clone(),
                },
                // It depends on the state.
                uncertainty: None,
                critical: CriticalPoint {
                    temperature: pure.critical.temperature * epsilon,
                    density: pure.critical.density / volume,
                },
            },
            fluid,
        }
    }
}

impl EquationOfState for OneFluidEquation {
    fn spec(&self) -> &EquationSpec {
        &self.spec
    }

    fn residual(&self, beta: Jet, rho: Jet) -> Jet {
        let OneFluid { sigma, epsilon, .. } = self.fluid;
        thol_2016().residual(beta * epsilon, rho * sigma.powi(3))
    }

    fn mass(&self) -> f64 {
        self.fluid.mass
    }

    /// The theory is one of fluids.
    fn freezing_density(&self, _temperature: f64) -> Option<f64> {
        None
    }

    /// One per cent of U, and three per cent of ρT in P.
    fn uncertainty(&self, rho: f64, temperature: f64) -> Option<OwnUncertainty> {
        Some(OwnUncertainty {
            potential_energy: BAND_ENERGY * self.potential_energy(rho, temperature).abs(),
            pressure: BAND_PRESSURE * rho * temperature,
            status: "the band of the theory".to_owned(),
        })
    }
}

/// The one-fluid theory of a mixture; each one fluid is made once and stays for the rest of the program.
#[must_use]
pub fn one_fluid(fluid: OneFluid) -> &'static OneFluidEquation {
    static MADE: Made<3, OneFluidEquation> = Made::new();
    MADE.for_parameters([fluid.sigma, fluid.epsilon, fluid.mass], || OneFluidEquation::new(fluid))
}
