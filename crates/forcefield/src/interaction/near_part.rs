//! The near part of a split force, for multiple time steps. The far part is what it leaves of the whole.

use crate::options::SplitOptions;
use crate::pair::{Form, LawOfRows, Pair, Side, Smoothstep};

/// Panels of an integral over the distances where the near part ends.
const PANELS: u32 = 16;
/// Points and weights of Gauss's rule of five points, on [−1, 1].
const GAUSS: [(f64, f64); 5] = [
    (-0.906_179_845_938_664, 0.236_926_885_056_189_1),
    (-0.538_469_310_105_683_1, 0.478_628_670_499_366_5),
    (0.0, 0.568_888_888_888_888_9),
    (0.538_469_310_105_683_1, 0.478_628_670_499_366_5),
    (0.906_179_845_938_664, 0.236_926_885_056_189_1),
];

/// The near part: the force times w(r²), which falls from 1 to 0.
///
/// The force is split, not the potential. The near part alone has an energy for loops only; near and far part together have the energy
/// of the whole.
#[derive(Clone, Copy, Debug)]
pub struct NearPart {
    step: Smoothstep,
    /// Where w is 0, σ.
    end: f64,
}

impl NearPart {
    /// The near part of a split.
    pub fn new(split: &SplitOptions) -> Self {
        Self {
            step: Smoothstep::new(split.r_split - split.width, split.r_split),
            end: split.r_split,
        }
    }

    /// The distance at which the near part ends, σ.
    pub fn end(&self) -> f64 {
        self.end
    }

    /// The values of a pair at r² = `r2` σ² times w.
    pub fn of(&self, pair: Pair<f64>, r2: f64) -> Pair<f64> {
        if r2 >= self.end * self.end {
            return Pair { energy: 0.0, force: 0.0, curvature: 0.0 };
        }
        let side = Side::of(r2, Some(self.step.begin2()));
        pair.in_epsilon(self.step.quintic(side, r2).value)
    }

    /// The potential whose force is the near part of a form with its cutoff, for rows: in units of a pair whose σ is `sigma` σ.
    pub fn law<'a>(&self, form: &'a Form, r_cut: f64, sigma: f64) -> LawOfRows<'a> {
        let step = self.step.in_lengths(sigma);
        let end2 = (self.end / sigma).powi(2);
        let begin2 = step.begin2();
        let force = move |s: f64| step.quintic(Side::Outside, s).value * form.eval(s).force;
        let energy = move |s: f64| 0.5 * integral(force, s, end2);
        let shift = energy(begin2) - form.eval(begin2).energy;
        let on = move |side: Side, s: f64| {
            let pair = form.eval(s);
            if side == Side::Inside {
                return Pair { energy: pair.energy + shift, ..pair };
            }
            let w = step.quintic(side, s);
            Pair {
                energy: energy(s),
                force: w.value * pair.force,
                // U″ = −f − 2s·df/ds with f = −U′/r.
                curvature: w.value * pair.curvature - 2.0 * s * w.first * pair.force,
            }
        };
        LawOfRows {
            joint2: Some(begin2),
            begin2: form.formula.begin2(),
            end2,
            r_cut2: r_cut * r_cut,
            tolerance: form.formula.tolerance(),
            on: Box::new(on),
        }
    }
}

/// ∫ f ds over [from, to].
fn integral(f: impl Fn(f64) -> f64, from: f64, to: f64) -> f64 {
    let half = 0.5 * (to - from) / f64::from(PANELS);
    let panel = |k: u32| {
        let middle = from + half * f64::from(2 * k + 1);
        GAUSS.map(|(x, weight)| weight * f(middle + half * x)).iter().sum::<f64>()
    };
    half * (0..PANELS).map(panel).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn integrals_hold_ten_digits() {
        let found = integral(|s| s.powi(-7), 1.0, 3.0);
        let wanted = (1.0 - 3.0_f64.powi(-6)) / 6.0;
        assert!((found / wanted - 1.0).abs() < 1e-10, "{found} {wanted}");
    }
}
