//! The model that a scene simulates: in words, and as the literature knows models.

use lennard_core::{Bonds, Molecules};
use lennard_forcefield::{PotentialOptions, SpeciesPair, TruncationKind, TruncationOptions};
use lennard_literature::{
    Described, Kept, KobAndersen, ModelKind, OneFluid, equation_of_state_for, viscosity_near,
};

use crate::{Molecule, MoleculeKind, Scene};

/// The model that a scene simulates, as far as the choice of a reference goes.
#[must_use]
pub fn model_kind(scene: &Scene) -> ModelKind {
    if scene.program.have_forces() {
        return ModelKind::Other { potential: "a fluid with forces of a program" };
    }
    if scene.contact.is_some() {
        return ModelKind::Other { potential: "bodies that touch" };
    }
    let Some(r_cut) = scene.cutoff_of_one_fluid() else {
        return mixture_kind(scene);
    };
    let molecules = scene.molecules();
    if !molecules.are_atoms() {
        let is_two_center = molecules.are_rigid()
            && molecules.bonds().len() == 1
            && scene.potential.spec().is_lennard_jones
            && scene.truncation.kind == TruncationKind::Cut
            && scene.truncation.tail_correction;
        return match is_two_center {
            true => ModelKind::TwoCenter { bond_length: molecules.bonds()[0].length, r_cut },
            false => ModelKind::Other {
                potential: "molecules other than rigid Lennard-Jones dumbbells with tail correction",
            },
        };
    }
    of_atoms(&scene.potential, &scene.truncation, r_cut, scene.planar_tail)
}

/// The model of atoms of one species with a cutoff, σ, and perhaps a planar tail.
pub(crate) fn of_atoms(
    potential: &PotentialOptions,
    truncation: &TruncationOptions,
    r_cut: f64,
    planar_tail: bool,
) -> ModelKind {
    let has_tail = truncation.tail_correction || planar_tail;
    let spec = potential.spec();
    if let PotentialOptions::Mie(mie) = *potential
        && truncation.kind == TruncationKind::Cut
        && has_tail
    {
        let (repulsive, attractive) = (f64::from(mie.repulsive), f64::from(mie.attractive));
        let potential = lennard_literature::Mie { repulsive, attractive };
        return match potential == lennard_literature::Mie::LENNARD_JONES {
            true => ModelKind::CutWithTail { r_cut },
            false => ModelKind::Mie { repulsive, attractive, r_cut },
        };
    }
    if !spec.is_lennard_jones {
        return ModelKind::Other { potential: spec.title };
    }
    match truncation.kind {
        TruncationKind::Cut if has_tail => ModelKind::CutWithTail { r_cut },
        TruncationKind::Cut => ModelKind::CutWithoutTail { r_cut },
        TruncationKind::Shift => ModelKind::Shifted { r_cut },
        TruncationKind::ForceShift => ModelKind::ForceShifted { r_cut },
        TruncationKind::Switch => ModelKind::Switched { r_cut },
        // No reference knows another truncation.
        other => ModelKind::Other { potential: other.spec().summary },
    }
}

/// Whether the scene has the pairs, the truncation and the masses of Kob and Andersen.
fn is_kob_andersen(scene: &Scene) -> bool {
    let species = scene.mixture.as_ref().map_or(&[][..], |m| &m.species);
    let is_theirs = |[a, b]: [usize; 2]| {
        let pair = scene.species_pair(a, b);
        let [sigma, epsilon] = KobAndersen::pair(a, b);
        (pair.sigma, pair.epsilon) == (sigma, epsilon) && pair.r_cut == KobAndersen::CUTOFF * sigma
    };
    scene.potential.spec().is_lennard_jones
        && scene.truncation.kind == TruncationKind::Shift
        && species.len() == 2
        && species.iter().all(|s| s.mass == 1.0)
        && scene.species_pairs().all(is_theirs)
}

/// The kind of a mixture: one that the one-fluid theory describes, or another.
fn mixture_kind(scene: &Scene) -> ModelKind {
    if is_kob_andersen(scene) {
        return ModelKind::KobAndersen;
    }
    let other = |potential| ModelKind::Other { potential };
    let full = scene.potential.spec().is_lennard_jones
        && scene.truncation.kind == TruncationKind::Cut
        && scene.truncation.tail_correction;
    if !full {
        return other("mixtures other than Lennard-Jones with tail correction");
    }
    let Some(fractions) = scene.fractions() else {
        return other("mixtures whose composition stands in a file");
    };
    let pair = |a, b| scene.species_pair(a, b);
    let of_pairs = |of: &dyn Fn(SpeciesPair) -> f64| {
        let values = scene.species_pairs().map(|[a, b]| of(pair(a, b)));
        values.fold([f64::INFINITY, 0.0], |[least, most], x| [x.min(least), x.max(most)])
    };
    let masses = scene.mixture.iter().flat_map(|m| &m.species).map(|s| s.mass);
    let mean_mass = masses.zip(&fractions).map(|(m, x)| m * x).sum();
    let [smallest, largest] = of_pairs(&|p| p.sigma);
    ModelKind::Mixture {
        fluid: OneFluid::of(&fractions, |a, b| {
            let SpeciesPair { sigma, epsilon, .. } = pair(a, b);
            [sigma, epsilon]
        })
        .with_mass(mean_mass),
        size_ratio: largest / smallest,
        r_cut: of_pairs(&|p| p.r_cut / p.sigma)[0],
    }
}

impl Scene {
    /// The model and the equation of state that describes it.
    ///
    /// # Errors
    /// Why there is none.
    pub fn equation_of_state(&self) -> Result<Described, String> {
        let model = model_kind(self);
        match (self.not_homogeneous(), equation_of_state_for(model)) {
            (None, Ok(equation)) => Ok((model, equation)),
            (None, Err(none)) => Err(none.to_string()),
            (Some(why), _) => Err(format!("not compared with any equation of state: {why}")),
        }
    }

    /// What the box of the measured stages keeps beside its particles and its volume; `None` at constant pressure.
    #[must_use]
    pub fn kept(&self) -> Option<Kept> {
        let mut measured = self.measured_stages();
        if measured.clone().any(|stage| stage.barostat.is_some()) {
            return None;
        }
        let with_bath = measured.any(|stage| stage.thermostat.is_some());
        Some(if with_bath { Kept::Temperature } else { Kept::Energy })
    }

    /// The viscosity of the reference table near the measured state at a density, σ⁻³; `None` where the model is not
    /// Lennard-Jones or no entry is near.
    #[must_use]
    pub fn viscosity_near(&self, density: f64) -> Option<f64> {
        let is_another_fluid = matches!(
            model_kind(self),
            ModelKind::Other { .. }
                | ModelKind::Mie { .. }
                | ModelKind::TwoCenter { .. }
                | ModelKind::Mixture { .. }
                | ModelKind::KobAndersen
        );
        if is_another_fluid || self.confined_by().is_some() {
            return None;
        }
        let temperature = self.measured_stages().next_back()?.temperature;
        viscosity_near(density, temperature).map(|v| v.value)
    }

    /// The model in words: potential, truncation, and molecules where there are some.
    #[must_use]
    pub fn model_name(&self) -> String {
        let mut named = self.named_model();
        if let Some(contacts) = self.contacts_in_words() {
            named = format!("{named}; {contacts}");
        }
        match self.program.have_forces() {
            true => format!("{named}; with forces of a program"),
            false => named,
        }
    }

    /// The model as far as the scene itself names it.
    fn named_model(&self) -> String {
        let mut pairs = lennard_forcefield::model_name(&self.force_field());
        if self.planar_tail {
            pairs = pairs.replace("without tail correction", "with planar tail correction");
        }
        if let Some(species) = self.species_in_words() {
            return format!("{pairs}; {species}");
        }
        let Some(molecule) = &self.molecule else {
            return pairs;
        };
        let Molecule { options, bonds, topology } = molecule;
        let sites = options.sites;
        let kind = match options.kind {
            MoleculeKind::Dumbbell => "dumbbells".to_owned(),
            MoleculeKind::Chain => format!("chains of {sites} sites"),
            MoleculeKind::Sites => {
                format!("molecules of {sites} sites and {} bonds", topology.bonds().len())
            }
        };
        let lengths = topology.bonds().iter().map(|bond| bond.length);
        let shortest = lengths.clone().fold(f64::INFINITY, f64::min);
        let longest = lengths.fold(0.0, f64::max);
        let length = match shortest == longest {
            true => format!("{shortest} σ"),
            false => format!("{shortest} to {longest} σ"),
        };
        let held = match bonds.bonds() {
            Bonds::Rigid => format!("rigid bonds of {length}, {}", bonds.name()),
            Bonds::Springs | Bonds::Impulses => format!("bonds of {length}, {}", bonds.name()),
        };
        format!("{pairs}; {kind} with {held}")
    }

    /// The molecules of the scene; atoms where it has none.
    #[must_use]
    pub fn molecules(&self) -> Molecules {
        self.molecule.as_ref().map_or(Molecules::ATOMS, Molecule::molecules)
    }
}
