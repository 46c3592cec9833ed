//! The mean-square displacement and the diffusion coefficient.

mod diffusion;
mod levels;
mod paths;

use crate::{
    BuildContext, Findings, Frames, Observable, ObservableError, ObservableSpec, Remark, Table,
    recipe,
};
use lennard_core::{DVec3, View, persist};

use crate::averages::tell_discarded;
use crate::blocks::BlockedSums;
use crate::error::{positive, within};
use crate::linear_regime::{LagCurve, LinearFit};
use crate::over_lags::OverLags;
use crate::seen_box::SeenBox;
use crate::time_origins::Origins;
use crate::tracked::{DEFAULT_TRACKED, Members, Tracked};

use levels::Levels;
use paths::Paths;

pub use diffusion::{CORRECTED, UNCORRECTED};

const SPEC: ObservableSpec = ObservableSpec {
    name: "msd",
    summary: "mean-square displacement over many time origins, diffusion coefficient with finite-size correction",
    equation: "msd(t) = ⟨|r(t₀+t) − r(t₀)|²⟩ → 6Dt + const; D₀ = D + 2.837297 T/(6πηL)",
    source: "D. Frenkel and B. Smit, Understanding Molecular Simulation, 2nd ed. (2002), section 4.4; \
             I.-C. Yeh and G. Hummer, J. Phys. Chem. B 108, 15873 (2004), equation 12",
    dynamic: true,
    frames: Frames::Paths,
    alone: None,
    ..ObservableSpec::PLAIN
};

/// ξ of the periodic cube's Ewald sum, in the correction of Yeh and Hummer.
pub const YEH_HUMMER_XI: f64 = 2.837_297;

lennard_core::options! {
    /// Options of [`MeanSquareDisplacement`].
    pub struct MsdOptions {
        /// Longest lag.
        longest_lag: f64 = 100.0, Between(1e-9, 1e9), in "τ";
        /// Shortest lag of the straight-line fit for the diffusion coefficient.
        fit_from: Option<f64> = None, else "where the slope stops changing", Between(1e-9, 1e9), in "τ";
        /// Longest lag of the fit.
        fit_to: Option<f64> = None, else "a twentieth of the run", Between(1e-9, 1e9), in "τ";
        /// Shear viscosity for the finite-size correction of Yeh and Hummer.
        viscosity: Option<f64> = None, else "the reference table's, where it has one near", Between(1e-9, 1e9), in "ε τ/σ³";
        /// Number of particles followed, evenly chosen.
        particles: usize = DEFAULT_TRACKED, Whole(1, 10_000_000);
    }
}

recipe!(MsdOptions, |options, context| MeanSquareDisplacement::new(options, context)?);

/// The mean-square displacement ⟨|Δr(t)|²⟩ in σ² of unwrapped positions relative to the centre of mass.
///
/// Every sample is a time origin for lags of up to 16 samples. Level ℓ keeps the last 16 positions of every
/// 2^ℓ-th sample, and serves lags of 8·2^ℓ to 16·2^ℓ samples. Memory and work therefore grow with the
/// logarithm of the longest lag. Positions are never averaged: each lag is exact.
///
/// The diffusion coefficient D = slope/6 comes from a straight line with free intercept over the lags where
/// the slope no longer changes. Its error comes from the same fit to successive blocks of the run. The
/// motion of the centre of mass is taken out. It is nothing at zero momentum. With a heat bath that kicks
/// the whole system, taking it out lowers D by 1/N. In a mixture each species has its own D, with the same term for finite size.
///
/// In a box that changes, a displacement is the sum of L̄·Δ(r/L) between samples: what the box moves is no diffusion.
#[derive(Debug, Clone, PartialEq)]
pub struct MeanSquareDisplacement {
    options: MsdOptions,
    context: BuildContext,
    tracked: Tracked,
    seen: SeenBox,
    paths: Paths,
    displacements: OverLags<Levels>,
    /// Sum of the temperatures of all samples.
    temperatures: f64,
}

impl MeanSquareDisplacement {
    /// Nothing seen yet.
    ///
    /// # Errors
    /// [`ObservableError`] where a time is not positive, the fit is empty, or no particle is followed.
    pub fn new(options: &MsdOptions, context: &BuildContext) -> Result<Self, ObservableError> {
        positive("longest_lag", Some(options.longest_lag))?;
        positive("fit_from", options.fit_from)?;
        positive("fit_to", options.fit_to)?;
        positive("viscosity", options.viscosity)?;
        within("particles", options.particles, 1..=usize::MAX)?;
        if let (Some(from), Some(to)) = (options.fit_from, options.fit_to)
            && from >= to
        {
            return Err(ObservableError::new(
                "fit_from",
                from,
                format!("less than `fit_to`, which is {to}"),
            ));
        }
        let longest = options.longest_lag / context.sample_interval();
        let tracked = Tracked::new(&context.own, options.particles);
        let (levels, of_species) =
            (Levels::new(longest, &tracked.own), tracked.by_species(&context.species));
        Ok(Self {
            options: options.clone(),
            context: context.clone(),
            seen: SeenBox::new(&context.cell),
            paths: Paths::new(&context.cell, &tracked.own),
            displacements: OverLags::new("displacements", 1, levels, &tracked.own, of_species),
            tracked,
            temperatures: 0.0,
        })
    }

    fn samples(&self) -> u64 {
        self.displacements.origins.samples()
    }

    /// The lags that were reached.
    fn reached_lags(&self, displacements: &BlockedSums) -> Vec<(u64, usize)> {
        let lags = self.displacements.origins.in_samples();
        lags.filter(|(_, k)| displacements.total(*k).1 > 0).collect()
    }

    /// Mean-square displacement at each lag that was reached.
    fn curve(&self, displacements: &BlockedSums) -> LagCurve {
        let lags = self.reached_lags(displacements);
        let interval = self.context.sample_interval();
        LagCurve {
            times: lags.iter().map(|(lag, _)| *lag as f64 * interval).collect(),
            values: lags.iter().filter_map(|(_, k)| displacements.mean(*k)).collect(),
            errors: lags.iter().map(|(_, k)| displacements.standard_error(*k)).collect(),
            duration: displacements.samples().saturating_sub(1) as f64 * interval,
        }
    }
}

impl Observable for MeanSquareDisplacement {
    fn spec(&self) -> &'static ObservableSpec {
        &SPEC
    }

    fn sample(&mut self, view: &View<'_>) {
        self.seen.see(view.cell());
        let mut now = self.tracked.relative_to_centre_of_mass(view.system, &view.state.positions);
        self.paths.follow(view.cell(), &mut now, self.displacements.origins.last());
        self.displacements.sample(&now, [|a: DVec3, b: DVec3| (a - b).length_squared()]);
        self.temperatures += view.temperature();
    }

    /// A displacement belongs to the sample at which it ends. Where a part is discarded, some displacements still begin in
    /// that part, by less than the longest lag of the fit.
    fn finish(&self, discarded: f64) -> Findings {
        let displacements = self.displacements.after(discarded);
        let mut findings = Findings::default();
        let curve = self.curve(&displacements);
        let fit = self.fit(&curve, &displacements);
        self.report(fit.as_ref(), "", &mut findings);
        let of_species =
            self.displacements.of_species(discarded).map(|(species, displacements)| {
                let curve = self.curve(&displacements);
                (species, self.fit(&curve, &displacements), curve)
            });
        let of_species: Vec<(&Members, Option<LinearFit>, LagCurve)> = of_species.collect();
        for (species, fit, _) in &of_species {
            self.report(fit.as_ref(), &species.suffix, &mut findings);
        }
        if let [(a, Some(fit_a), _), (b, Some(fit_b), _)] = &of_species[..] {
            self.report_darken([(a, fit_a), (b, fit_b)], &mut findings);
        }
        tell_discarded(&mut findings, self.samples() - displacements.samples());
        let notes = self.tracked.remark().into_iter().chain(self.paths.remark());
        findings.remarks.extend(notes.map(Remark::from));
        let diffusion = curve.times.iter().zip(&curve.values).map(|(t, m)| m / (6.0 * t)).collect();
        let line = fit.map(|fit| fit.line(&curve.times));
        let table = Table::new(
            "msd",
            "mean-square displacement relative to the centre of mass against lag",
        )
        .with("time", "τ", curve.times)
        .with("msd", "σ²", curve.values)
        .with("standard_error", "σ²", curve.errors)
        .with("msd_over_6t", "σ²/τ", diffusion);
        let with = |table: Table, (species, _, curve): (&Members, _, LagCurve)| {
            let name = |of: &str| species.named(of);
            table.with(name("msd"), "σ²", curve.values).with(
                name("standard_error"),
                "σ²",
                curve.errors,
            )
        };
        let table = of_species.into_iter().fold(table, with);
        // What the line is fitted to: empty at lags outside its range.
        findings.tables.push(match line {
            Some(line) => table.with("fit", "σ²", line),
            None => table,
        });
        findings
    }
}

persist!(MeanSquareDisplacement {
    ..displacements,
    temperatures,
    seen as "box",
    paths,
    fixed options, context, tracked
});

#[cfg(test)]
mod tests;
