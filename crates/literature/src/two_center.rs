//! Equations of state of two-center Lennard-Jones fluids: rigid dumbbells of two equal sites.

use std::sync::LazyLock;

use serde::Deserialize;

use crate::critical::critical_point;
use crate::equation::{EquationOfState, EquationSpec, OwnUncertainty, Range};
use crate::fluid_state::CriticalPoint;
use crate::jet::Jet;
use crate::made::Made;

/// The shortest and the longest bond, σ, for which the equations were compared with simulations here or by their authors'
/// users.
pub const BOND_LENGTHS: std::ops::RangeInclusive<f64> = 0.1..=1.0;
/// The lowest and the highest temperature of the comparisons, in units of the critical one.
const TEMPERATURES: [f64; 2] = [0.6, 2.5];
/// The highest pressure, ε/σ³: above all states of the comparisons.
const HIGHEST_PRESSURE: f64 = 12.0;

/// Two fits may agree by chance at one state: no uncertainty is smaller than this, ε and ε/σ³.
const SMALLEST_UNCERTAINTY: f64 = 0.02;

/// Coefficients of one equation, as its authors number them.
#[derive(Debug, Clone, Deserialize)]
struct Coefficients {
    key: String,
    name: String,
    citation: String,
    doi: String,
    /// Of the reducing density.
    rho: [f64; 4],
    /// Of the reducing temperature.
    t: [f64; 4],
    c: Vec<f64>,
    m: Vec<f64>,
    n: Vec<i32>,
    o: Vec<f64>,
    q: Vec<i32>,
}

#[derive(Debug, Deserialize)]
struct File {
    status: String,
    /// Of the non-sphericity α(L).
    alpha: [f64; 4],
    /// Of the packing fraction over the density.
    eta: [f64; 4],
    /// How the hard core shrinks with temperature.
    hard: [f64; 2],
    equations: [Coefficients; 2],
}

static FILE: LazyLock<File> = LazyLock::new(|| {
    serde_json::from_str(include_str!("../data/two-center-lennard-jones.json"))
        .expect("the shipped coefficients of two-center fluids are well formed: a test reads them")
});

/// The equation of state at one bond length L:
///
/// a_res/T = (α² − 1)·ln(1 − η) + ((α² + 3α)·η − 3α·η²)/(1 − η)² + Σ c·τ^m·δⁿ·α^o·exp(−δ^q),
///
/// τ = T/T_red(L), δ = ρ/ρ_red(L), η = ρ·(η/ρ)(L)/(a + (1 − a)·τ^g); the exponential stands where q > 0.
///
/// Densities count molecules, and energies are per molecule. The critical point is the one of the equation itself, which lies
/// two to three per cent above simulations.
#[derive(Debug)]
pub struct TwoCenter {
    spec: EquationSpec,
    coefficients: &'static Coefficients,
    bond_length: f64,
    alpha: f64,
    eta_over_rho: f64,
    t_red: f64,
    rho_red: f64,
}

impl TwoCenter {
    fn new(coefficients: &'static Coefficients, bond_length: f64) -> Self {
        let file = &*FILE;
        let l = bond_length;
        let [a0, a1, a2, a3] = file.alpha;
        let [e0, e1, e2, e3] = file.eta;
        let [r0, r1, r2, r3] = coefficients.rho;
        let [t0, t1, t2, t3] = coefficients.t;
        let t_red = ((t0 + t1 * l) / (1.0 + t2 * l + t3 * l * l)).sqrt();
        let rho_red = (r0 + r1 * l) / (1.0 + r2 * l + r3 * l * l);
        let reducing = CriticalPoint { temperature: t_red, density: rho_red };
        let mut equation = Self {
            spec: EquationSpec {
                key: coefficients.key.clone(),
                name: coefficients.name.clone(),
                model: format!("rigid dumbbells with bonds of {l} σ, full Lennard-Jones potential between sites"),
                citation: coefficients.citation.clone(),
                doi: coefficients.doi.clone(),
                status: file.status.clone(),
                superseded: None,
                range: Range {
                    t_min: TEMPERATURES[0] * t_red,
                    t_max: TEMPERATURES[1] * t_red,
                    p_max: HIGHEST_PRESSURE,
                    rho_max: None,
                    status: "the authors' own limits were not read: held to the states at which it was compared".to_owned(),
                },
                // It depends on the state.
                uncertainty: None,
                critical: reducing,
            },
            coefficients,
            bond_length: l,
            alpha: a0 + a1 * l.powi(2) + a2 * l.powf(3.5) + a3 * l.powi(4),
            eta_over_rho: e0 + e1 * l.powi(2) + e2 * l.powf(2.5) + e3 * l.powi(4),
            t_red,
            rho_red,
        };
        equation.spec.critical = critical_point(&|rho, t| equation.at(rho, t), reducing);
        equation
    }
}

impl EquationOfState for TwoCenter {
    fn spec(&self) -> &EquationSpec {
        &self.spec
    }

    fn residual(&self, beta: Jet, rho: Jet) -> Jet {
        let tau = beta.powi(-1) * (1.0 / self.t_red);
        let [a, g] = FILE.hard;
        let shrunk = tau.powf(g) * (1.0 - a) + a;
        let eta = rho * self.eta_over_rho / shrunk;
        let free = Jet::constant(1.0) - eta;
        let alpha = self.alpha;
        let numerator = eta * (alpha * alpha + 3.0 * alpha) - eta.powi(2) * (3.0 * alpha);
        let mut sum = free.ln() * (alpha * alpha - 1.0) + numerator / free.powi(2);
        let delta = rho * (1.0 / self.rho_red);
        let Coefficients { c, m, n, o, q, .. } = self.coefficients;
        for i in 0..c.len() {
            let mut term = tau.powf(m[i]) * delta.powi(n[i]) * (c[i] * alpha.powf(o[i]));
            if q[i] > 0 {
                term = term * (-delta.powi(q[i])).exp();
            }
            sum += term;
        }
        sum
    }

    /// The freezing line of dumbbells is not known here.
    fn freezing_density(&self, _temperature: f64) -> Option<f64> {
        None
    }

    /// The difference of the two equations at the state, and at least 0.02 ε and 0.02 ε/σ³.
    fn uncertainty(&self, rho: f64, temperature: f64) -> Option<OwnUncertainty> {
        let [one, other] = two_center(self.bond_length)?.map(|e| e.at(rho, temperature));
        let off = |a: f64, b: f64| (a - b).abs().max(SMALLEST_UNCERTAINTY);
        Some(OwnUncertainty {
            potential_energy: off(one.potential_energy, other.potential_energy),
            pressure: off(one.pressure, other.pressure),
            status: "the difference of two equations at this state".to_owned(),
        })
    }

    /// A rigid dumbbell has five degrees of freedom.
    fn kinetic_heat_capacity(&self) -> f64 {
        2.5
    }

    /// Two sites of unit mass.
    fn mass(&self) -> f64 {
        2.0
    }
}

/// The two equations at a bond length, σ: Lísal 2004 and Mecke 1997; `None` outside [`BOND_LENGTHS`].
///
/// Each bond length makes one pair, which stays for the rest of the program.
#[must_use]
pub fn two_center(bond_length: f64) -> Option<[&'static TwoCenter; 2]> {
    static MADE: Made<1, [TwoCenter; 2]> = Made::new();
    BOND_LENGTHS.contains(&bond_length).then(|| {
        let pair = MADE.for_parameters([bond_length], || {
            FILE.equations.each_ref().map(|coefficients| TwoCenter::new(coefficients, bond_length))
        });
        pair.each_ref()
    })
}
