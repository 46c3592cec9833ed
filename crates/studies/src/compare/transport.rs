//! Transport coefficients beside tabulated ones, and beside themselves by another road.

use lennard_literature::{ModelKind, TransportProperty, transport_near};
use lennard_observables::{CORRECTED, UNCORRECTED, YEH_HUMMER_XI};

use super::rows::Compared;
use super::verdict::Tolerance;
use super::{Row, RunFolder, StateOfMatter};

const TRANSPORT: Tolerance = Tolerance::new(2.0, 0.0, 0.03);

impl Compared<'_> {
    /// A coefficient beside the tabulated state nearest to the run. The tables are for the full potential.
    pub(super) fn beside_table(&self, row: Row, property: TransportProperty) -> Row {
        if self.no_reference.is_some() {
            return self.or_why_none(row);
        }
        let full_potential =
            matches!(self.model, ModelKind::CutWithTail { .. } | ModelKind::CutWithoutTail { .. });
        let near = transport_near(property, self.state.density, self.state.temperature);
        match near.filter(|_| full_potential) {
            Some(value) => row
                .against(value.value, value.uncertainty, TRANSPORT, &value.source)
                .noted(value.state_words()),
            None if full_potential => row.without_reference("no tabulated state is near"),
            None => row.without_reference("the tables are for the full Lennard-Jones potential"),
        }
    }

    pub(super) fn diffusion(&self, row: Row) -> Row {
        let run = self.run;
        let is_corrected = row.quantity == CORRECTED;
        if !is_corrected && run.average(CORRECTED).is_some() {
            return row;
        }
        let measured = row.measured;
        let plain = run.average(UNCORRECTED).filter(|_| is_corrected);
        let row = match plain {
            Some(plain) => row.noted(format!(
                "corrected for finite size after Yeh and Hummer by +{:.4}, {:.4} before",
                measured - plain.estimate.mean,
                plain.estimate.mean
            )),
            None => row.noted("not corrected for finite size"),
        };
        let row = self.beside_table(row, TransportProperty::SelfDiffusion);
        if row.reference.is_none() {
            return row;
        }
        // A source that does not say whether it corrected for finite size lies between the two.
        let between = match plain {
            Some(plain) => Some((plain.estimate.mean, measured)),
            None => own_correction(run, self.state).map(|added| (measured, measured + added)),
        };
        match between {
            Some((low, high)) => {
                let row = row.between(low, high);
                let words = row.range_words().unwrap_or_default();
                row.noted(words)
            }
            None => row,
        }
    }
}

/// The finite-size correction ξT/(6πηL) of D in a cubic box, with the viscosity of the run itself, in σ²/τ
/// (I.-C. Yeh and G. Hummer, J. Phys. Chem. B 108, 15873 (2004), equation 12); `None` where the run has no viscosity
/// or the box is no cube.
fn own_correction(run: &RunFolder, state: &StateOfMatter) -> Option<f64> {
    let side = run.shortest_side;
    let volume = run.volume();
    // Roundings of the cube of a length.
    let is_cube = (side.powi(3) / volume - 1.0).abs() < 1e-9;
    let viscosity = run.average("shear_viscosity")?.estimate.mean;
    is_cube.then(|| {
        YEH_HUMMER_XI * state.temperature / (6.0 * std::f64::consts::PI * viscosity * side)
    })
}
