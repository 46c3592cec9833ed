//! The equation of Pohl and co-workers for Mie (n, 6) fluids, the Lennard-Jones fluid among them.

use std::sync::LazyLock;

use serde::Deserialize;

use crate::critical::critical_point;
use crate::equation::{EquationOfState, EquationSpec, Range};
use crate::fluid_state::CriticalPoint;
use crate::freezing::freezing_line;
use crate::jet::Jet;
use crate::made::Made;
use crate::terms::Terms;

#[derive(Debug, Deserialize)]
struct File {
    key: String,
    name: String,
    citation: String,
    status: String,
    range: Range,
    /// The smallest and the largest repulsive exponent.
    exponents: [f64; 2],
    t_reducing: [f64; 3],
    rho_reducing: [f64; 2],
    #[serde(flatten)]
    terms: Terms<[Vec<f64>; 2]>,
}

static FILE: LazyLock<File> = LazyLock::new(|| {
    serde_json::from_str(include_str!("../data/pohl-2023.json"))
        .expect("the shipped coefficients of Pohl 2023 are well formed: a test reads them")
});

/// The exponent of the Lennard-Jones potential.
const LENNARD_JONES: f64 = 12.0;

/// The equation of state at one repulsive exponent n:
///
/// a_res/T = Σ N τᵗ δᵈ + Σ N τᵗ δᵈ exp(−δˡ) + Σ N τᵗ δᵈ exp(−η(δ − ε)² − β(τ − γ)²), N = N₁ + N₂/n,
///
/// τ = T_red/T, δ = ρ/ρ_red, T_red = 0.668 + 6.84/n + 145/n³, ρ_red = 0.2516 + 0.049·log₁₀ n.
#[derive(Debug)]
pub struct Pohl {
    spec: EquationSpec,
    exponent: f64,
    t_red: f64,
    rho_red: f64,
    terms: Terms,
}

impl Pohl {
    fn new(n: f64) -> Self {
        let file = &*FILE;
        let [t0, t1, t3] = file.t_reducing;
        let [r0, r1] = file.rho_reducing;
        let t_red = t0 + t1 / n + t3 / n.powi(3);
        let rho_red = r0 + r1 * n.log10();
        let reducing = CriticalPoint { temperature: t_red, density: rho_red };
        let model = if n == LENNARD_JONES {
            "full Lennard-Jones potential".to_owned()
        } else {
            format!("full Mie potential with exponents {n} and 6")
        };
        let mut equation = Self {
            spec: EquationSpec {
                key: file.key.clone(),
                name: file.name.clone(),
                model,
                citation: file.citation.clone(),
                doi: String::new(),
                status: file.status.clone(),
                superseded: None,
                range: file.range.clone(),
                uncertainty: None,
                critical: reducing,
            },
            exponent: n,
            t_red,
            rho_red,
            terms: file.terms.with_amplitudes(|[first, second]| {
                let both = first.iter().zip(second);
                both.map(|(a, b)| a + b / n).collect()
            }),
        };
        equation.spec.critical = critical_point(&|rho, t| equation.at(rho, t), reducing);
        equation
    }
}

impl EquationOfState for Pohl {
    fn spec(&self) -> &EquationSpec {
        &self.spec
    }

    fn residual(&self, beta: Jet, rho: Jet) -> Jet {
        self.terms.at(beta * self.t_red, rho * (1.0 / self.rho_red))
    }

    /// Known for the exponent 12.
    fn freezing_density(&self, temperature: f64) -> Option<f64> {
        (self.exponent == LENNARD_JONES)
            .then(|| freezing_line().freezing_density(temperature))
            .flatten()
    }
}

/// Pohl 2023 for the full Mie potential with the exponents n and 6; `None` outside 11 ≤ n ≤ 13.
///
/// Each exponent makes one equation, which stays for the rest of the program.
#[must_use]
pub fn pohl_2023(repulsive_exponent: f64) -> Option<&'static Pohl> {
    static MADE: Made<1, Pohl> = Made::new();
    let [smallest, largest] = FILE.exponents;
    (smallest..=largest)
        .contains(&repulsive_exponent)
        .then(|| MADE.for_parameters([repulsive_exponent], || Pohl::new(repulsive_exponent)))
}
