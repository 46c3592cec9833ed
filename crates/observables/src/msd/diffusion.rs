//! Diffusion coefficients from the slope of the mean-square displacement.

use std::f64::consts::PI;

use crate::{Doubt, Findings};
use lennard_core::number::short;

use super::{MeanSquareDisplacement, YEH_HUMMER_XI};
use crate::averages::{of_blocks, with_choice};
use crate::blocks::BlockedSums;
use crate::linear_regime::{LagCurve, LinearFit, fit_linear_regime};
use crate::tracked::Members;

/// Relative difference of two sides below which a box counts as a cube.
const CUBE_TOLERANCE: f64 = 1e-9;

/// Name of D of an infinite system: with the correction for the finite box.
pub const CORRECTED: &str = "diffusion_coefficient_corrected";
/// Name of D of the box as it is.
pub const UNCORRECTED: &str = "diffusion_coefficient_uncorrected";

/// The unit of every coefficient.
const UNIT: &str = "σ²/τ";

impl MeanSquareDisplacement {
    /// The straight line of a curve; `None` where the run is too short.
    pub(super) fn fit(&self, curve: &LagCurve, displacements: &BlockedSums) -> Option<LinearFit> {
        let lags = self.reached_lags(displacements).into_iter();
        let quantities: Vec<usize> = lags.map(|(_, k)| k).collect();
        let blocks = |end: usize| displacements.complete_rows(&quantities[..end]);
        fit_linear_regime(curve, blocks, self.options.fit_from, self.options.fit_to)
    }

    fn is_cubic(&self) -> bool {
        let sides = self.seen.sides();
        (sides.max_element() - sides.min_element()) / sides.max_element() < CUBE_TOLERANCE
    }

    /// What finite size takes away from D in a periodic cube, 2.837297 T/(6πηL), in σ²/τ.
    pub(super) fn finite_size_correction(&self, viscosity: f64) -> f64 {
        let temperature = self.temperatures / self.samples() as f64;
        YEH_HUMMER_XI * temperature / (6.0 * PI * viscosity * self.seen.sides().x)
    }

    /// The correction for finite size that D gets; `None` where it gets none.
    fn correction(&self) -> Option<f64> {
        let viscosity = self.options.viscosity.filter(|_| self.is_cubic())?;
        Some(self.finite_size_correction(viscosity))
    }

    /// Adds the diffusion coefficient of a fit.
    pub(super) fn report(&self, fit: Option<&LinearFit>, suffix: &str, findings: &mut Findings) {
        let Some(fit) = fit else {
            findings.remark(format!(
                "no diffusion coefficient{}: too few samples for a fit",
                suffix.replace('_', " of ")
            ));
            return;
        };
        let blocks: Vec<f64> = fit.block_slopes.iter().map(|s| s / 6.0).collect();
        let mut add = |name: &str, value: f64| {
            let name = format!("{name}{suffix}");
            let average = of_blocks(&name, UNIT, value, &blocks, fit.overlap);
            let average = with_choice(average, fit.change / 6.0);
            findings.averages.push(average.doubted(unsettled(fit)));
        };
        let uncorrected = fit.slope / 6.0;
        add(UNCORRECTED, uncorrected);
        let remark = match (self.options.viscosity, self.correction()) {
            (Some(viscosity), Some(correction)) => {
                add(CORRECTED, uncorrected + correction);
                format!(
                    "{CORRECTED}{suffix} is corrected for finite size after Yeh and Hummer: +{correction:.6} σ²/τ with viscosity {} ε τ/σ³, whose own error is not counted",
                    short(viscosity)
                )
            }
            (Some(_), None) => format!(
                "{UNCORRECTED}{suffix} is not corrected for finite size: the correction is known for cubic boxes only"
            ),
            (None, _) => format!(
                "{UNCORRECTED}{suffix} is not corrected for finite size: no viscosity is given"
            ),
        };
        findings.remark(remark);
        findings.remark(format!(
            "{UNCORRECTED}{suffix} is a sixth of the slope of the mean-square displacement between {:.3} and {:.3} τ",
            fit.from, fit.to
        ));
    }

    /// Adds x_b·D_a + x_a·D_b of a mixture of two species: the mutual diffusion coefficient where velocities of different
    /// particles are not correlated (L. S. Darken, Trans. AIME 175, 184 (1948)).
    pub(super) fn report_darken(
        &self,
        [(a, fit_a), (b, fit_b)]: [(&Members, &LinearFit); 2],
        findings: &mut Findings,
    ) {
        let fraction = |of: &Members| self.context.species.fraction(of.number);
        let (x_a, x_b) = (fraction(a), fraction(b));
        let mixed = |of_a: f64, of_b: f64| (x_b * of_a + x_a * of_b) / 6.0;
        // Both curves are of the same samples: their blocks are the same stretches of the run.
        let pairs = fit_a.block_slopes.iter().zip(&fit_b.block_slopes);
        let blocks: Vec<f64> = pairs.map(|(a, b)| mixed(*a, *b)).collect();
        let value = mixed(fit_a.slope, fit_b.slope) + self.correction().unwrap_or(0.0);
        let overlap = fit_a.overlap.max(fit_b.overlap);
        let average = of_blocks("mutual_diffusion_darken", UNIT, value, &blocks, overlap);
        let change = mixed(fit_a.change.abs(), fit_b.change.abs());
        let doubt = unsettled(fit_a).or_else(|| unsettled(fit_b));
        findings.averages.push(with_choice(average, change).doubted(doubt));
        findings.remark(format!(
            "mutual_diffusion_darken is x{b}·D{a} + x{a}·D{b}, as if velocities of different particles were not correlated",
            a = a.suffix,
            b = b.suffix
        ));
    }
}

fn unsettled(fit: &LinearFit) -> Option<Doubt> {
    (!fit.settled).then(|| {
        Doubt::Incomplete(
            "the slope of the mean-square displacement still changes at the longest lags".into(),
        )
    })
}
