//! Lennard-Jones/spline: a short-ranged Lennard-Jones potential with two continuous derivatives.

use super::{LennardJones, OwnEnd, Potential, PotentialSpec};
use crate::pair::{Pair, PairPotential, Shape, Side};
use crate::real::Real;

lennard_core::options! {
    /// Lennard-Jones/spline: U = 4·(r⁻¹² − r⁻⁶) up to its inflection point r_s = (26/7)^{1/6} σ, then
    /// a·(r − r_c)² + b·(r − r_c)³ up to r_c = (67/48)·r_s, where it ends; U, U′ and U″ are continuous at r_s.
    ///
    /// B. L. Holian and D. J. Evans, "Shear viscosities away from the melting line: A comparison of equilibrium and
    /// nonequilibrium molecular dynamics", J. Chem. Phys. 78 (1983) 5147.
    #[derive(Copy)]
    pub struct LjSpline {}
}

/// r_s² = (26/7)^{1/3}, σ²: the square of the inflection point of Lennard-Jones.
const JOINT2: f64 = 1.548_668_397_006_242;
/// a = −(24192/3211)/r_s², ε/σ².
const A: f64 = -4.864_890_082_711_485;
/// b = −(387072/61009)/r_s³, ε/σ³.
const B: f64 = -3.292_002_800_390_959;
/// Makes the smallest distance from the joint larger than 1, and stays finite in single precision.
const STEEP: f64 = 1e30;

/// (67/48)·(26/7)^{1/6} σ.
const END: f64 = 1.737_051_854_945_982;

impl Potential for LjSpline {
    const SPEC: PotentialSpec = PotentialSpec {
        name: "lj-spline",
        title: "Lennard-Jones/spline",
        summary: "Lennard-Jones up to its inflection point, then a cubic spline that ends smoothly at 1.737.",
        equation: "U = 4 (r^-12 - r^-6) for r <= r_s = (26/7)^(1/6), a (r - r_c)^2 + b (r - r_c)^3 for r <= r_c = 67/48 r_s, else 0; a = -24192/3211 r_s^-2, b = -387072/61009 r_s^-3",
        source: "B. L. Holian and D. J. Evans, Shear viscosities away from the melting line: A comparison of equilibrium and nonequilibrium molecular dynamics, J. Chem. Phys. 78 (1983) 5147",
        is_lennard_jones: false,
    };
    const END: Option<OwnEnd> = Some(OwnEnd { r: END, in_words: "1.737" });
    const EXAMPLES: &'static [Self] = &[Self {}];
    type Formula = Self;

    fn formula(&self) -> Self {
        *self
    }

    fn in_words(&self) -> String {
        "Lennard-Jones/spline, ending at 1.737 σ".to_owned()
    }
}

impl LjSpline {
    /// U, −U′/r and U″ beyond the joint, in the unit of Lennard-Jones.
    #[inline(always)]
    fn outside<R: Real>(r2: R, inv_r2: R) -> Pair<R> {
        let number = |value: f64| r2.splat(value);
        let r = r2.sqrt();
        let x = r - number(END);
        let (a, b) = (A / LennardJones::UNIT, B / LennardJones::UNIT);
        Pair {
            energy: x * x * x.mul_add(number(b), number(a)),
            // −U′/r, with 1/r = r/r².
            force: -(r * inv_r2) * (x * x.mul_add(number(3.0 * b), number(2.0 * a))),
            curvature: x.mul_add(number(6.0 * b), number(2.0 * a)),
        }
    }

    /// U, −U′/r and U″ on both sides of the joint.
    #[inline(always)]
    pub(crate) fn values<R: Real>(r2: R, inv_r2: R) -> Pair<R> {
        let number = |value: f64| r2.splat(value);
        let (of_lj, of_spline) = (LennardJones::values(inv_r2), Self::outside(r2, inv_r2));
        // Registers know no branch: the weight of the spline is 0 inside the joint and 1 outside, exactly.
        let outside = ((r2 - number(JOINT2)) * number(STEEP)).max(number(0.0)).min(number(1.0));
        let inside = number(1.0) - outside;
        let choose = |lj: R, spline: R| outside.mul_add(spline, inside * lj);
        Pair {
            energy: choose(of_lj.energy, of_spline.energy),
            force: choose(of_lj.force, of_spline.force),
            curvature: choose(of_lj.curvature, of_spline.curvature),
        }
    }
}

impl PairPotential for LjSpline {
    fn unit(&self) -> f64 {
        LennardJones::UNIT
    }

    fn joint2(&self) -> Option<f64> {
        Some(JOINT2)
    }

    fn on(&self, side: Side, r2: f64) -> Pair<f64> {
        match side {
            Side::Inside => LennardJones {}.on(side, r2),
            Side::Outside => Self::outside(r2, r2.recip()),
        }
    }

    fn shape(&self) -> Option<Shape> {
        Some(Shape::Spline)
    }

    fn tail_energy(&self, _r_cut: f64) -> f64 {
        0.0
    }

    fn tail_virial(&self, _r_cut: f64) -> f64 {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Model, PotentialOptions, TruncationKind, TruncationOptions};

    fn model() -> Model {
        let options = PotentialOptions::LjSpline(LjSpline {});
        Model::new(&options, &TruncationOptions::new(TruncationKind::Shift, 2.5)).unwrap()
    }

    /// ∫ f dr over [from, to] by Simpson's rule.
    fn integral(f: impl Fn(f64) -> f64, from: f64, to: f64) -> f64 {
        let steps = 20_000;
        let h = (to - from) / f64::from(steps);
        let weight = |k: i32| match k {
            0 => 1.0,
            k if k == steps => 1.0,
            k if k % 2 == 1 => 4.0,
            _ => 2.0,
        };
        (0..=steps).map(|k| h / 3.0 * weight(k) * f(from + h * f64::from(k))).sum()
    }

    #[test]
    fn the_second_virial_coefficient_is_the_known_one() {
        let model = model();
        let mayer = |r: f64| ((-model.eval(r * r).energy).exp() - 1.0) * r * r;
        // Below 0.3 σ the exponential is 0 to all digits. The joint is an end of both parts, since U‴ jumps there.
        let inside = integral(mayer, 0.3, JOINT2.sqrt());
        let outside = integral(mayer, JOINT2.sqrt(), END);
        let core = -0.3_f64.powi(3) / 3.0;
        let b2 = -2.0 * std::f64::consts::PI * (core + inside + outside);
        // Gauss-Legendre with 2400 points elsewhere: -2.93260552851; eight digits are known from others.
        assert!((b2 + 2.932_605_528_51).abs() < 1e-10, "{b2}");
    }

    #[test]
    fn two_derivatives_are_continuous_at_the_joint_and_one_at_the_end() {
        let model = model();
        let (below, above) =
            (model.eval(JOINT2 * (1.0 - 1e-15)), model.eval(JOINT2 * (1.0 + 1e-15)));
        for (a, b) in [
            (below.energy, above.energy),
            (below.force, above.force),
            (below.curvature, above.curvature),
        ] {
            assert!((a - b).abs() < 1e-12, "{a} {b}");
        }
        // Lennard-Jones has its inflection there.
        assert!(below.curvature.abs() < 1e-12);
        let end = model.eval(model.r_cut * model.r_cut);
        assert!(end.energy.abs() < 1e-28 && end.force.abs() < 1e-14);
        assert!((end.curvature - 2.0 * A).abs() < 1e-12);
    }
}
