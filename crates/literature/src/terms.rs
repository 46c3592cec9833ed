//! Sums of terms in the reduced inverse temperature τ and the reduced density δ, as many equations of state have them.

use serde::Deserialize;

use crate::jet::Jet;

/// Polynomial terms n τᵗ δᵈ.
#[derive(Debug, Clone, Deserialize)]
pub(crate) struct Polynomial<N = Vec<f64>> {
    pub n: N,
    pub t: Vec<f64>,
    pub d: Vec<i32>,
}

/// Terms n τᵗ δᵈ exp(−δˡ).
#[derive(Debug, Clone, Deserialize)]
pub(crate) struct Exponential<N = Vec<f64>> {
    pub n: N,
    pub t: Vec<f64>,
    pub d: Vec<i32>,
    pub l: Vec<i32>,
}

/// Terms n τᵗ δᵈ exp(−η(δ − ε)² − β(τ − γ)²).
#[derive(Debug, Clone, Deserialize)]
pub(crate) struct Gaussian<N = Vec<f64>> {
    pub n: N,
    pub t: Vec<f64>,
    pub d: Vec<i32>,
    pub eta: Vec<f64>,
    pub beta: Vec<f64>,
    pub gamma: Vec<f64>,
    pub epsilon: Vec<f64>,
}

/// α = Σ n τᵗ δᵈ + Σ n τᵗ δᵈ exp(−δˡ) + Σ n τᵗ δᵈ exp(−η(δ − ε)² − β(τ − γ)²). The amplitudes n are numbers, or what
/// numbers are made of.
#[derive(Debug, Clone, Deserialize)]
pub(crate) struct Terms<N = Vec<f64>> {
    pub poly: Polynomial<N>,
    pub exp: Exponential<N>,
    pub gauss: Gaussian<N>,
}

impl Terms {
    /// The sum at τ and δ.
    pub(crate) fn at(&self, tau: Jet, delta: Jet) -> Jet {
        let term = |n: f64, t: f64, d: i32| tau.powf(t) * delta.powi(d) * n;
        let mut sum = Jet::constant(0.0);
        let p = &self.poly;
        for ((n, t), d) in p.n.iter().zip(&p.t).zip(&p.d) {
            sum += term(*n, *t, *d);
        }
        let e = &self.exp;
        for (((n, t), d), l) in e.n.iter().zip(&e.t).zip(&e.d).zip(&e.l) {
            sum += term(*n, *t, *d) * (-delta.powi(*l)).exp();
        }
        let g = &self.gauss;
        for i in 0..g.n.len() {
            let exponent = (delta - g.epsilon[i]).powi(2) * -g.eta[i]
                + (tau - g.gamma[i]).powi(2) * -g.beta[i];
            sum += term(g.n[i], g.t[i], g.d[i]) * exponent.exp();
        }
        sum
    }
}

impl<N> Terms<N> {
    /// The same terms with other amplitudes.
    pub(crate) fn with_amplitudes(&self, amplitude: impl Fn(&N) -> Vec<f64>) -> Terms {
        let (p, e, g) = (&self.poly, &self.exp, &self.gauss);
        Terms {
            poly: Polynomial { n: amplitude(&p.n), t: p.t.clone(), d: p.d.clone() },
            exp: Exponential { n: amplitude(&e.n), t: e.t.clone(), d: e.d.clone(), l: e.l.clone() },
            gauss: Gaussian {
                n: amplitude(&g.n),
                t: g.t.clone(),
                d: g.d.clone(),
                eta: g.eta.clone(),
                beta: g.beta.clone(),
                gamma: g.gamma.clone(),
                epsilon: g.epsilon.clone(),
            },
        }
    }
}
