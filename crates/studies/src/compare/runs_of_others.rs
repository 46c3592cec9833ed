//! A run of the mixture of Kob and Andersen beside the runs of others.

use lennard_literature::{
    KobAndersenQuantity, KobAndersenRow, ModelKind, kob_andersen_at, kob_andersen_states,
};
use lennard_observables::{UNCORRECTED, YEH_HUMMER_XI};

use super::verdict::Tolerance;
use super::{Row, RunFolder};

/// Standard errors within which a run agrees with a run of another program, beside the tolerance of the table.
const ERRORS: f64 = 4.0;
/// What the correction for the size of the box leaves of a diffusion coefficient, as a share of it.
const SIZE_CORRECTION: f64 = 0.03;

/// The rows of the table `kob-andersen` at the state of a run; none for other models and other states.
pub(super) struct RunsOfOthers<'a> {
    run: &'a RunFolder,
    is_kob_andersen: bool,
    rows: Vec<&'static KobAndersenRow>,
}

impl<'a> RunsOfOthers<'a> {
    /// What stands beside a run of this model. The temperature is the one that the bath of the measured stages holds.
    pub(super) fn beside(run: &'a RunFolder, model: ModelKind) -> Self {
        let is_kob_andersen = model == ModelKind::KobAndersen;
        let held = lennard_engine::held_temperature(&run.scene);
        let state = held.zip(run.record.species.first()).filter(|_| is_kob_andersen);
        let rows = state.map_or(Vec::new(), |(bath, a)| {
            let fraction = a.count as f64 / run.record.atoms as f64;
            let mut rows = kob_andersen_at(run.density, bath.temperature, fraction);
            // A run tells the first peak of g_BB, and theirs is the second.
            rows.retain(|row| row.quantity != KobAndersenQuantity::PeakBB);
            rows
        });
        Self { run, is_kob_andersen, rows }
    }

    /// Whether there is anything.
    pub(super) fn are_there(&self) -> bool {
        !self.rows.is_empty()
    }

    /// What is to be said where there is nothing.
    pub(super) fn remark(&self) -> Option<String> {
        (self.is_kob_andersen && !self.are_there()).then(|| {
            format!(
                "the table `kob-andersen` has other states than this run: {}, each with a bath that holds T",
                kob_andersen_states()
            )
        })
    }

    /// The names of the quantities that have a reference.
    pub(super) fn names(&self) -> impl Iterator<Item = String> + '_ {
        self.rows.iter().map(|row| self.name(row.quantity))
    }

    /// Name in the run record of what a row of the table measures.
    fn name(&self, quantity: KobAndersenQuantity) -> String {
        use KobAndersenQuantity as Q;
        let species = |a: usize| &self.run.record.species[a].name;
        match quantity {
            Q::PotentialEnergy => "potential_energy".into(),
            Q::Virial | Q::Pressure => "pressure".into(),
            Q::EnergyVariance => "heat_capacity".into(),
            Q::DensityScaling => "density_scaling_exponent".into(),
            Q::PeakAA => format!("rdf_first_peak_{0}_{0}", species(0)),
            Q::PeakAB => format!("rdf_first_peak_{}_{}", species(0), species(1)),
            Q::PeakBB => format!("rdf_highest_peak_{0}_{0}", species(1)),
            Q::DiffusionA => format!("{UNCORRECTED}_{}", species(0)),
            Q::DiffusionB => format!("{UNCORRECTED}_{}", species(1)),
        }
    }

    /// The reference of a quantity of the run record; `None` where it has none.
    pub(super) fn of(&self, quantity: &str) -> Option<&'static KobAndersenRow> {
        // The pressure itself stands after the virial in the table, and is the better number.
        let mut from_behind = self.rows.iter().rev();
        from_behind.find(|row| self.name(row.quantity) == quantity).copied()
    }

    /// A quantity beside its reference.
    pub(super) fn hold(&self, row: Row, reference: &KobAndersenRow) -> Row {
        use KobAndersenQuantity as Q;
        let KobAndersenRow { temperature, rho, .. } = *reference;
        let (value, tolerance) = (reference.value, reference.tolerance);
        let (value, tolerance) = match reference.quantity {
            Q::Virial => (rho * (temperature + value), rho * tolerance),
            Q::EnergyVariance => {
                let square = temperature * temperature;
                (1.5 + value / square, tolerance / square)
            }
            Q::DiffusionA | Q::DiffusionB => return self.diffusion(row, reference),
            _ => (value, tolerance),
        };
        let allowed = Tolerance::new(ERRORS, tolerance, 0.0);
        row.against(value, None, allowed, &source(reference)).noted(size_words(reference))
    }

    /// D in a periodic box is smaller than in an infinite one by ξT/(6πηL) (I.-C. Yeh and G. Hummer, J. Phys. Chem. B 108,
    /// 15873 (2004)). The reference is carried to the box of the run with the viscosity of the run.
    fn diffusion(&self, row: Row, reference: &KobAndersenRow) -> Row {
        let Some(viscosity) =
            self.run.average("shear_viscosity").filter(|v| v.is_sound()).filter(|_| row.is_sound())
        else {
            let why = "D of another box: the viscosity of this run would tell how it differs";
            return row.without_reference(why);
        };
        let Some(particles) = reference.particles else {
            return row;
        };
        let side = |n: f64| (n / reference.rho).cbrt();
        let factor = YEH_HUMMER_XI * reference.temperature
            / (6.0 * std::f64::consts::PI * viscosity.estimate.mean);
        let (theirs, own) = (side(f64::from(particles)), self.run.shortest_side);
        let shift = factor * (1.0 / theirs - 1.0 / own);
        let allowed = Tolerance::new(ERRORS, reference.tolerance, SIZE_CORRECTION);
        row.against(reference.value + shift, None, allowed, &source(reference)).noted(format!(
            "{}, carried to the box of this run by {}",
            size_words(reference),
            crate::report::signed(shift, 2)
        ))
    }
}

fn source(row: &KobAndersenRow) -> String {
    format!("{} (table `kob-andersen`)", row.source)
}

fn size_words(row: &KobAndersenRow) -> String {
    row.particles.map_or(String::new(), |n| format!("a run of {n} particles"))
}
