//! Sensible settings around the settings of a scene.

use lennard_forcefield::{ListMode, Precision, TruncationKind};
use lennard_integrators::{IntegratorOptions, OscillatorModel, integrators};

use super::types::Size;
use crate::lab::Workbench;
use crate::settings::{Settings, truncation_is_free};
use crate::stability::groups::stands_for_itself;
use crate::sweep::LeftOut;

/// Settings to be tried, and those that were left out.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Grid {
    /// To be tried; the settings of the scene stand first.
    pub settings: Vec<Settings>,
    /// Left out: what no scene may ask for, and what stands for something that is there.
    pub left_out: Vec<LeftOut>,
}

/// Cutoffs beside the cutoff of the scene, σ.
const CUTOFFS: [f64; 5] = [2.0, 2.5, 3.0, 4.0, 5.0];
/// Cutoffs of the quick grid, σ.
const QUICK_CUTOFFS: [f64; 2] = [2.5, 4.0];
/// Larger cutoffs, σ, are not tried: neighbors grow with the cube.
const LARGEST_CUTOFF: f64 = 6.0;
/// Times of this many steps of the scene are whole numbers of steps of most of the grid: there trajectories are compared.
pub(super) const COMMON_STEPS: f64 = 48.0;
/// Steps as multiples of the scene's, for methods of second order.
const FACTORS: [f64; 6] = [0.5, 1.0, 2.0, 3.0, 4.0, 6.0];
/// For methods that bear longer steps.
const LONG_FACTORS: [f64; 6] = [1.0, 2.0, 4.0, 6.0, 8.0, 12.0];
/// Factors of the quick grid.
const QUICK_FACTORS: [f64; 3] = [0.5, 2.0, 4.0];
/// Methods beside the method of the scene: they differ in order and in cost.
const METHODS: [&str; 4] = ["velocity-verlet", "respa", "pefrl", "blanes-moan"];

/// Every truncation, with and without tail.
const TRUNCATIONS: [(TruncationKind, bool); 5] = [
    (TruncationKind::Cut, true),
    (TruncationKind::Cut, false),
    (TruncationKind::Shift, false),
    (TruncationKind::ForceShift, false),
    (TruncationKind::Switch, false),
];

/// The settings around the settings of the workbench's scene. What does not fit the scene is left out, with the reason.
pub fn grid(bench: &Workbench, size: Size) -> Grid {
    let mut maker = Maker { bench, grid: Grid::default() };
    maker.of_settings(&Settings::of(bench.scene()), size);
    maker.grid
}

struct Maker<'a> {
    bench: &'a Workbench,
    grid: Grid,
}

impl Maker<'_> {
    fn of_settings(&mut self, base: &Settings, size: Size) {
        self.take(base);
        self.usual(base);
        match size {
            Size::Quick => self.quick(base),
            Size::Default => self.default(base),
            Size::Full => self.full(base),
        }
        self.methods_left_out(size);
        if !truncation_is_free(self.bench.scene()) {
            self.leave_out("other truncations and cutoffs", "this potential ends by itself");
        }
    }

    fn leave_out(&mut self, what: impl Into<String>, why: impl Into<String>) {
        let left = LeftOut { what: what.into(), why: why.into() };
        if !self.grid.left_out.contains(&left) {
            self.grid.left_out.push(left);
        }
    }

    /// Takes settings that can run and are not there yet.
    fn take(&mut self, settings: &Settings) {
        if self.grid.settings.contains(settings) {
            return;
        }
        if settings.list == ListMode::Direct && settings.precision == Precision::Mixed {
            self.leave_out(
                "mixed precision over all pairs",
                "sums over all pairs are always in double precision",
            );
            return;
        }
        if settings.precision == Precision::Mixed
            && matches!(settings.integrator, IntegratorOptions::BitReversibleVerlet(_))
        {
            self.leave_out(
                "mixed precision with `bit-reversible-verlet`",
                "its forces are always in double precision",
            );
            return;
        }
        match self.bench.check(settings) {
            Ok(()) => self.grid.settings.push(settings.clone()),
            Err(crate::StudyError::Settings { label, reason }) => {
                let line = reason.lines().next().unwrap_or_default().trim();
                // The file is the same for all of them.
                let is_of_file = line.starts_with(self.bench.scene().source.file());
                let why = line.split_once(": ").filter(|_| is_of_file).map_or(line, |(_, why)| why);
                self.leave_out(label, why);
            }
            Err(other) => self.leave_out(settings.label(), other.to_string()),
        }
    }

    /// The usual settings, with a step as near to the usual step as the common times allow.
    fn usual(&mut self, base: &Settings) {
        let largest = self.bench.start().cell.largest_cutoff();
        let Some(usual) = base.usual(largest) else {
            return;
        };
        if truncation_is_free(self.bench.scene()) && !base.are_usual() {
            let common = COMMON_STEPS * base.dt;
            let steps = (common / usual.dt).round().max(1.0);
            self.take(&Settings { dt: common / steps, ..usual });
        }
    }

    fn methods(&self, names: &[&str]) -> Vec<IntegratorOptions> {
        let own = &self.bench.scene().integrator.method;
        let mut methods = vec![own.clone()];
        for entry in integrators() {
            if names.contains(&entry.spec.name) && entry.spec.name != own.name() {
                methods.push(entry.default_options.clone());
            }
        }
        if self.bath_takes_the_place_of_the_method() {
            methods.truncate(1);
        }
        methods
    }

    fn bath_takes_the_place_of_the_method(&self) -> bool {
        matches!(
            self.bench.measured_stage().thermostat,
            Some(lennard_integrators::ThermostatOptions::Langevin(_))
        )
    }

    /// The cutoffs of the list and the scene's own, and half the box where that is not far.
    fn cutoffs(&mut self, list: &[f64]) -> Vec<f64> {
        let own = self.bench.scene().truncation.r_cut;
        let half = self.bench.start().cell.largest_cutoff();
        if !truncation_is_free(self.bench.scene()) {
            return vec![own];
        }
        let mut cutoffs = vec![own];
        for r_cut in list {
            // Two cutoffs within a twentieth say the same.
            if cutoffs.iter().any(|c: &f64| (c - r_cut).abs() < 0.05 * c) {
                continue;
            }
            if *r_cut > half {
                self.leave_out(
                    format!("cutoffs of {r_cut} σ and more"),
                    format!("half the shortest side of the box is {half:.3} σ"),
                );
                break;
            }
            cutoffs.push(*r_cut);
        }
        let largest = (half * 20.0).floor() / 20.0;
        let longest = cutoffs.iter().copied().fold(0.0, f64::max);
        if list.len() > 2 && largest <= LARGEST_CUTOFF && largest > 1.1 * longest {
            cutoffs.push(largest);
        }
        cutoffs.sort_by(f64::total_cmp);
        cutoffs
    }

    fn truncations(&mut self, base: &Settings, cutoffs: &[f64]) -> Vec<Settings> {
        let cutoffs = self.cutoffs(cutoffs);
        if !truncation_is_free(self.bench.scene()) {
            return vec![base.clone()];
        }
        let of = |(kind, tail): &(TruncationKind, bool)| {
            let at = |r_cut: &f64| base.with_truncation(*kind, *r_cut, *tail);
            cutoffs.iter().map(at).collect::<Vec<_>>()
        };
        let mut all: Vec<Settings> = TRUNCATIONS.iter().flat_map(of).collect();
        // The scene's own may begin its switch elsewhere.
        all.retain(|s| {
            s.truncation.kind != base.truncation.kind
                || s.truncation.r_cut != base.truncation.r_cut
                || s.truncation.tail_correction != base.truncation.tail_correction
        });
        all.insert(0, base.clone());
        all
    }

    fn steps(&mut self, base: &Settings, factors: &[f64], long: &[f64]) {
        let bears_more = base.integrator.spec().stability_limit.unwrap_or(0.0) > 2.5;
        for factor in if bears_more { long } else { factors } {
            self.take(&Settings { dt: base.dt * factor, ..base.clone() });
        }
    }

    fn quick(&mut self, base: &Settings) {
        self.steps(base, &QUICK_FACTORS, &QUICK_FACTORS);
        for method in self.methods(&["velocity-verlet", "blanes-moan"]) {
            let with = base.with_integrator(method);
            self.steps(&with, &QUICK_FACTORS[1..], &QUICK_FACTORS[1..]);
        }
        for settings in self.truncations(base, &QUICK_CUTOFFS) {
            self.take(&settings);
        }
        self.take(&Settings { precision: Precision::Mixed, ..base.clone() });
        self.lists(base);
    }

    fn default(&mut self, base: &Settings) {
        let mut models = vec![base.clone()];
        if truncation_is_free(self.bench.scene()) {
            // Where energy and force end smoothly, the errors of the step are seen alone.
            let r_cut = base.truncation.r_cut;
            models.push(base.with_truncation(TruncationKind::Switch, r_cut, false));
        }
        for method in self.methods(&METHODS) {
            for model in &models {
                let with = model.with_integrator(method.clone());
                self.steps(&with, &FACTORS, &LONG_FACTORS);
            }
        }
        for settings in self.truncations(base, &CUTOFFS) {
            self.take(&settings);
            self.take(&Settings { precision: Precision::Mixed, ..settings.clone() });
            if settings.truncation.tail_correction {
                // What a longer step saves may pay for a longer cutoff.
                let longer = Settings { dt: 2.0 * base.dt, ..settings.clone() };
                self.take(&longer);
                self.take(&Settings { precision: Precision::Mixed, ..longer });
            }
        }
        self.lists(base);
    }

    fn full(&mut self, base: &Settings) {
        let names: Vec<&str> = integrators().iter().map(|e| e.spec.name).collect();
        let names: Vec<&str> = names.into_iter().filter(|name| stands_for_itself(name)).collect();
        for model in self.truncations(base, &CUTOFFS) {
            for method in self.methods(&names) {
                if why_no_fluid(method.name()).is_some() {
                    continue;
                }
                for precision in [Precision::Double, Precision::Mixed] {
                    for list in [base.list, ListMode::Direct] {
                        let skin = base.skin.filter(|_| list != ListMode::Direct);
                        let with = Settings {
                            precision,
                            list,
                            skin,
                            ..model.with_integrator(method.clone())
                        };
                        self.steps(&with, &FACTORS, &LONG_FACTORS);
                    }
                }
            }
        }
        self.lists(base);
    }

    /// All pairs, and lists with half and twice the skin that is chosen.
    fn lists(&mut self, base: &Settings) {
        self.take(&Settings {
            list: ListMode::Direct,
            skin: None,
            precision: Precision::Double,
            ..base.clone()
        });
        for skin in [0.15, 0.6] {
            self.take(&Settings { list: ListMode::Verlet, skin: Some(skin), ..base.clone() });
        }
    }

    fn methods_left_out(&mut self, size: Size) {
        if self.bath_takes_the_place_of_the_method() {
            self.leave_out(
                "other methods",
                "the Langevin bath of the measured stage is a method of its own",
            );
            return;
        }
        for entry in integrators() {
            let name = entry.spec.name;
            if self.grid.settings.iter().any(|s| s.integrator.name() == name) {
                continue;
            }
            let why = match why_no_fluid(name) {
                Some(why) => why,
                None if !stands_for_itself(name) => {
                    "it makes the same trajectory as `velocity-verlet`, but for rounding".into()
                }
                None if size == Size::Full => continue,
                None => "the whole grid (`--full`) has it".into(),
            };
            self.leave_out(format!("`{name}`"), why);
        }
    }
}

/// Why a method cannot run a fluid, where it cannot.
fn why_no_fluid(name: &str) -> Option<String> {
    let entry = integrators().iter().find(|e| e.spec.name == name)?;
    match entry.oscillator {
        OscillatorModel::ExactSolution => Some("no exact solution of a fluid is known".into()),
        OscillatorModel::Constraint => Some("without constraints it is `symplectic-euler`".into()),
        OscillatorModel::Force => None,
    }
}

#[cfg(test)]
mod tests;
