//! Two flat interfaces between a slab of liquid and its vapor.

mod fit;

use std::f64::consts::TAU;

use crate::{
    Average, BuildContext, Doubt, Findings, Frames, Observable, ObservableSpec, Remark,
    Surroundings, Table, recipe, statistics,
};
use lennard_core::{Axis, DVec3, Own, View, Want, persist};

use crate::averages::{changes, of_blocks, tell_discarded};
use crate::blocks::BlockedSums;
use crate::pressure_tensor::PressureTensor;
use crate::seen_box::SeenBox;
use crate::series::{Series, columns};

const SPEC: ObservableSpec = ObservableSpec {
    name: "interface",
    summary: "a slab of liquid beside its vapor: both densities, vapor pressure, surface tension, and the density across it",
    equation: "gamma = L_z/2 <P_N - P_T>, p_s = <P_N>; rho(z) = (rho_l + rho_v)/2 - (rho_l - rho_v)/2 tanh[2(|z| - z_0)/D]",
    source: "J. P. R. B. Walton, D. J. Tildesley, J. S. Rowlinson and J. R. Henderson, Mol. Phys. 48, 1357 (1983); \
             least thickness: S. Werth, S. V. Lishchuk, M. Horsch and H. Hasse, Physica A 392, 2359 (2013)",
    suits: crate::Suits::Atoms,
    surroundings: Surroundings::Periodic,
    frames: Frames::Velocities,
    alone: None,
    ..ObservableSpec::PLAIN
};

/// Rows kept before neighbors are averaged in pairs.
const MOST_ROWS: usize = 1 << 16;
/// A contrast ρ_l − ρ_v below this part of the mean density is no slab: a fluid in one phase fluctuates so.
const LEAST_CONTRAST: f64 = 0.5;
/// The rise of a hyperbolic tangent from 10 % to 90 %, in units of D: artanh(0.8).
const TEN_TO_NINETY: f64 = 1.098_612_288_668_109_8;
/// Slabs thinner than this have a liquid that is less dense than bulk liquid, and a lower tension, σ.
const THIN: f64 = 12.0;
/// Across a shorter side the tension depends on the side, σ.
const NARROW: f64 = 8.0;
/// The part of the box farthest from the middle of the slab whose density is followed through time.
const OUTER_PART: f64 = 1.0 / 3.0;
/// The mean that a run with a slab has, and no other run.
pub const LIQUID_DENSITY: &str = "liquid_density";
/// Vapor of less than so many widths D between two surfaces is not bulk vapor.
const LEAST_VAPOR: f64 = 3.0;

lennard_core::options! {
    /// Options of [`Interface`].
    pub struct InterfaceOptions {
        /// Axis across which the surfaces lie.
        axis: Axis = Axis::Z, Names(Axis::names);
        /// Number of layers of equal width over the whole box.
        bins: usize = 200, Whole(20, 10_000);
    }
}

recipe!(InterfaceOptions, |options, context| Interface::new(options, context));

columns! {
    struct Rows { time, normal, tangential, tension, outer }
}

/// The density across a slab about its own middle, and what follows from it.
///
/// It gives ρ_l and ρ_v in σ⁻³, the 10–90 thickness of an interface in σ, p_s = P_N in ε/σ³ and the surface tension γ in ε/σ².
/// The middle of a sample is the circular mean of all places, z_c = L/2π·arg Σ exp(2πi·z/L). It needs no force that holds the slab.
/// Densities and widths come from a fit of two hyperbolic tangents to the mean profile. Their errors come from a jackknife
/// over blocks of the run. P_N is the normal component of the pressure tensor, the same in both phases. p_s and γ belong to the
/// truncation and the tail of the run. A plain cutoff without tail has the interface of the shifted potential.
#[derive(Debug, Clone, PartialEq)]
pub struct Interface {
    axis: Axis,
    n_atoms: usize,
    seen: SeenBox,
    counts: BlockedSums,
    series: Series<Rows>,
}

impl Interface {
    /// Nothing seen yet.
    #[must_use]
    pub fn new(options: &InterfaceOptions, context: &BuildContext) -> Self {
        Self {
            axis: options.axis,
            n_atoms: context.n_atoms,
            seen: SeenBox::new(&context.cell),
            counts: BlockedSums::new(options.bins),
            series: Series::new(Rows::default(), MOST_ROWS),
        }
    }

    /// Counts particles in layers about the middle of the slab, which comes to lie in the middle of the box. Gives their number in
    /// the outer part of the box.
    fn count(&mut self, own: &Own, positions: &[DVec3], length: f64) -> usize {
        let axis = self.axis.index();
        let turn = TAU / length;
        let turns: Vec<(f64, f64)> = positions.iter().map(|r| (turn * r[axis]).sin_cos()).collect();
        let mut sums = [0.0; 2];
        own.in_turn(&mut sums, |sums| {
            for (sin, cos) in &turns {
                sums[0] += sin;
                sums[1] += cos;
            }
        });
        let [sin, cos] = sums;
        let middle = f64::atan2(sin, cos) / TAU;
        let bins = self.counts.width();
        let (mut counts, mut outer) = (vec![0; bins], 0);
        for r in positions {
            let part = (r[axis] / length - middle + 0.5).rem_euclid(1.0);
            outer += usize::from((part - 0.5).abs() > 0.5 * (1.0 - OUTER_PART));
            counts[((part * bins as f64) as usize).min(bins - 1)] += 1;
        }
        own.add_up(&mut counts);
        self.counts.add_sample(counts.into_iter().map(|count| count as f64));
        own.count(outer)
    }

    /// What a fit of each block's complement says of one number of the slab.
    fn of_fit(
        &self,
        counts: &BlockedSums,
        name: &str,
        unit: &str,
        number: impl Fn(&fit::Slab) -> f64,
    ) -> Option<Average> {
        let (per_count, length) = (self.per_count(), self.length());
        let density = |means: &[f64]| -> Vec<f64> { means.iter().map(|n| n * per_count).collect() };
        let all: Option<Vec<f64>> = (0..counts.width()).map(|k| counts.mean(k)).collect();
        let whole = fitted(&density(&all?), length)?;
        let (value, pseudo) = counts.jackknife(|means| {
            let slab = fit::Slab::fit(&density(means), length, whole)?;
            Some(number(&slab))
        })?;
        Some(of_blocks(name, unit, value, &pseudo, 0.0))
    }

    /// What speaks against all numbers where the outer third of the box still gains or loses particles after `cut` rows. That third is
    /// vapor, unless the slab fills more than two thirds. U and P of the whole box hardly show it: a few particles of a thousand change places.
    fn doubt_of_outer_part(&self, cut: usize) -> Option<Doubt> {
        let outer = &self.series.rows().outer;
        let trend = statistics::trend(&outer[cut.min(outer.len())..], statistics::bar(cut))?;
        Some(Doubt::NotInEquilibrium(changes(
            "the density far from the middle of the slab",
            &trend,
        )))
    }

    /// The length of the box across the surfaces, σ.
    fn length(&self) -> f64 {
        self.seen.sides()[self.axis.index()]
    }

    /// Density of one particle in a layer, σ⁻³.
    fn per_count(&self) -> f64 {
        self.counts.width() as f64 / self.seen.volume()
    }

    fn mean_density(&self) -> f64 {
        self.n_atoms as f64 / self.seen.volume()
    }

    /// The profile with its fit, where there is one.
    fn profile(&self, counts: &BlockedSums, slab: Option<&fit::Slab>) -> Table {
        let (bins, length) = (counts.width(), self.length());
        let place = |k: usize| (k as f64 + 0.5) * length / bins as f64;
        let name = self.axis.name();
        let column = |of: &dyn Fn(usize) -> f64| -> Vec<f64> { (0..bins).map(of).collect() };
        let [densities, errors] = counts.curve(0..bins, self.per_count());
        let table = Table::new(
            "interface_profile",
            format!("number density across {name}, counted from the middle of the slab, with standard errors from blocks of the run"),
        )
        .with(name, "σ", column(&|k| place(k) - 0.5 * length))
        .with("density", "σ⁻³", densities)
        .with("standard_error", "σ⁻³", errors);
        match slab {
            Some(slab) => table.with("fit", "σ⁻³", column(&|k| slab.at(place(k)))),
            None => table,
        }
    }

    /// What makes the numbers differ from bulk phases.
    fn remarks(&self, slab: &fit::Slab) -> Vec<String> {
        let (thickness, vapor) = (slab.thickness(), self.length() - slab.thickness());
        let sides = self.seen.sides();
        let across = Axis::ALL.into_iter().filter(|axis| *axis != self.axis);
        let side = across.map(|axis| sides[axis.index()]).fold(f64::INFINITY, f64::min);
        let mut remarks = vec![format!(
            "interface: the width of an interface grows with the cross-section, here {side:.1} σ; the numbers are of the \
             truncation that was run"
        )];
        if thickness < THIN {
            remarks.push(format!(
                "interface: the slab is thin, {thickness:.1} σ; below {THIN} σ its density and its surface tension are lower than \
                 in bulk"
            ));
        }
        if vapor < LEAST_VAPOR * slab.width() {
            remarks.push(format!(
                "interface: only {vapor:.1} σ of vapor lie between the surfaces, which are {:.1} σ wide; take a longer box",
                slab.width()
            ));
        }
        if side < NARROW {
            remarks.push(format!(
                "interface: the cross-section is narrow, {side:.1} σ; below {NARROW} σ the surface tension depends on it"
            ));
        }
        remarks
    }
}

/// The fit to a profile with its liquid in the middle; `None` where there is no slab.
fn fitted(density: &[f64], length: f64) -> Option<fit::Slab> {
    let guess = fit::Slab::guess(density, length)?;
    let slab = fit::Slab::fit(density, length, guess)?;
    let mean = density.iter().sum::<f64>() / density.len() as f64;
    (slab.contrast > LEAST_CONTRAST * mean).then_some(slab)
}

impl Observable for Interface {
    fn spec(&self) -> &'static ObservableSpec {
        &SPEC
    }

    fn want(&self) -> Want {
        Want::VIRIAL_TENSOR
    }

    /// # Panics
    /// Where the state lacks what [`Observable::want`] asks for: that is a bug of the caller.
    fn sample(&mut self, view: &View<'_>) {
        let pressure =
            PressureTensor::of(view).expect("the force evaluation gives what the observable wants");
        let tail = view.tail.unwrap_or_default().pressure;
        let cell = view.cell();
        self.seen.see(cell);
        let length = cell.lengths()[self.axis.index()];
        let outer = self.count(view.system.own(), &view.state.positions, length);
        let diagonal =
            [pressure.x_axis.x + tail, pressure.y_axis.y + tail, pressure.z_axis.z + tail];
        let normal = diagonal[self.axis.index()];
        let tangential = 0.5 * (diagonal.iter().sum::<f64>() - normal);
        self.series.push(&[
            view.state.time,
            normal,
            tangential,
            0.5 * length * (normal - tangential),
            outer as f64 / (OUTER_PART * cell.volume()),
        ]);
    }

    fn finish(&self, discarded: f64) -> Findings {
        let counts = self.counts.after(discarded);
        let all: Option<Vec<f64>> = (0..counts.width()).map(|k| counts.mean(k)).collect();
        let density = all.map(|all| all.iter().map(|n| n * self.per_count()).collect::<Vec<_>>());
        let slab = density.and_then(|density| fitted(&density, self.length()));
        let mut findings =
            Findings { tables: vec![self.profile(&counts, slab.as_ref())], ..Findings::default() };
        let Some(slab) = slab else {
            findings.remark(format!(
                "interface: no slab. The profile about its middle has no two surfaces across {}, at a mean density of {:.4} σ⁻³; \
                 no coexisting densities, vapor pressure or surface tension",
                self.axis.name(),
                self.mean_density()
            ));
            return findings;
        };
        type Number = fn(&fit::Slab) -> f64;
        let numbers: [(&str, &str, Number); 4] = [
            (LIQUID_DENSITY, "σ⁻³", fit::Slab::liquid),
            ("vapor_density", "σ⁻³", |slab| slab.vapor),
            ("interface_thickness", "σ", |slab| TEN_TO_NINETY * slab.width()),
            ("slab_thickness", "σ", fit::Slab::thickness),
        ];
        findings.averages = numbers
            .into_iter()
            .filter_map(|(name, unit, number)| self.of_fit(&counts, name, unit, number))
            .collect();
        tell_discarded(&mut findings, self.counts.samples() - counts.samples());
        let rows = self.series.rows();
        let cut = (discarded * rows.time.len() as f64).ceil() as usize;
        for (name, unit, column) in
            [("vapor_pressure", "ε/σ³", &rows.normal), ("surface_tension", "ε/σ²", &rows.tension)]
        {
            findings.averages.push(self.series.average(name, unit, column, cut));
        }
        let doubt = self.doubt_of_outer_part(cut);
        findings.averages =
            findings.averages.into_iter().map(|average| average.doubted(doubt.clone())).collect();
        let columns = [
            ("normal", "ε/σ³", &rows.normal),
            ("tangential", "ε/σ³", &rows.tangential),
            ("tension", "ε/σ²", &rows.tension),
            ("outer_density", "σ⁻³", &rows.outer),
        ];
        let what = "normal and tangential pressure, surface tension, and the density of the third of the box farthest from the middle of the slab,";
        findings.tables.push(self.series.table("interface", what, columns));
        findings.remarks = self.remarks(&slab).into_iter().map(Remark::from).collect();
        findings
    }
}

persist!(Interface { counts, series, seen as "box", fixed axis, n_atoms });

#[cfg(test)]
mod tests;
