//! A constant field: the same acceleration for every particle.

use lennard_core::exact::exact_sum_over;
use lennard_core::parallel::for_each_piece;
use lennard_core::{
    Configuration, DMat3, DVec3, Energetics, ForceError, ForceProperties, ForceTerm, Masses, Own,
    Part, Want, remembers_nothing,
};

/// A constant field, F_i = m_i·g with U = −Σ m_i·g·r_i, zero at the origin of the box; g in σ/τ² (ε/(m·σ)).
///
/// U is no function of the position in a periodic box: along an axis with g ≠ 0 walls must bound the particles. The field
/// changes the total momentum along its axes. Its virial is 0 here, since Σ r·F depends on the origin.
///
/// Source: L. D. Landau and E. M. Lifshitz, Mechanics, 3rd ed. (1976), section 5.
#[derive(Debug, Clone)]
pub struct ConstantField {
    acceleration: DVec3,
    masses: Masses,
    /// Which particles this process keeps, where ranks share them.
    own: Option<Own>,
}

remembers_nothing!(ConstantField);

impl ConstantField {
    /// The field that accelerates particles of these masses by g, σ/τ².
    #[must_use]
    pub fn new(acceleration: DVec3, masses: Masses) -> Self {
        Self { acceleration, masses, own: None }
    }

    /// Force on particle `i`, ε/σ: none on a held one.
    #[must_use]
    fn weight(&self, i: usize) -> DVec3 {
        self.masses.moving(i) * self.acceleration
    }

    fn energy_of(&self, i: usize, r: DVec3) -> f64 {
        -self.weight(i).dot(r)
    }
}

impl ForceTerm for ConstantField {
    lennard_core::evaluate_by_adding!();

    /// The field belongs to the near part.
    fn add(
        &mut self,
        at: Configuration<'_>,
        part: Part,
        want: Want,
        _scratch: &mut Vec<DVec3>,
        forces: &mut [DVec3],
    ) -> Result<Energetics, ForceError> {
        let (field, acts) = (&*self, part != Part::Far);
        if acts {
            for_each_piece(forces, |first, chunk| {
                for (i, f) in (first..).zip(chunk) {
                    *f += field.weight(i);
                }
            });
        }
        let energy_of = |i: usize| match acts {
            true => field.energy_of(i, at.positions[i]),
            false => 0.0,
        };
        let n = at.positions.len();
        let team = field.own.as_ref().and_then(Own::team);
        let energy = if want.energy { exact_sum_over(team, n, energy_of) } else { 0.0 };
        let each = || (0..n).map(|i| (energy_of(i), DMat3::ZERO)).collect();
        Ok(Energetics {
            per_particle: want.per_particle.then(each),
            ..Energetics::of(want, energy, DMat3::ZERO, 0.0)
        })
    }

    fn force_on(&self, particle: usize, _at: Configuration<'_>) -> DVec3 {
        self.weight(particle)
    }

    fn keep(&mut self, own: &Own) {
        if let Masses::Each(masses) = &self.masses {
            self.masses = Masses::Each(masses[own.numbers()].to_vec());
        }
        self.own = Some(own.clone());
    }

    fn properties(&self) -> ForceProperties {
        ForceProperties {
            splits: true,
            breaks_momentum: self.acceleration.to_array().map(|g| g != 0.0),
            ..ForceProperties::default()
        }
    }
}
