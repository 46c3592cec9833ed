//! The table `[crystal]`: a start with a crystal across z, and its liquid beside it.

use lennard_core::DVec3;
use lennard_literature::{ModelKind, equation_of_state_for, freezing_line};

use crate::error::SceneError;
use crate::phases::MissingDensity;
use crate::read::Reader;
use crate::reference::{DENSEST, MOST_ATOMS, MOST_ENTRIES, THINNEST};
use crate::{Lattice, Placement, Scene, Start};

/// The length of the crystal over its side, where the scene does not say.
const LENGTH_OF_SIDE: f64 = 2.0;
/// The part of the particles that starts as crystal, where the scene does not say.
const SHARE: f64 = 0.5;
/// The least length of both parts, σ: below it the two fronts of a part touch.
const SHORTEST_PART: f64 = 4.0;

/// A face-centred crystal from the lower end of z, and its liquid above it.
///
/// The cross-section is `cells` whole cells wide, without strain: its side is cells·(4/ρ_s)^{1/3}. The liquid has the other particles, at its
/// own density. There are two fronts, since the box is periodic.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HalfCrystal {
    /// Number of particles, in both phases together.
    pub n_atoms: usize,
    /// Cells across x and across y.
    pub cells: usize,
    /// Cells along z.
    pub layers: usize,
    /// Density of the crystal at the start, σ⁻³.
    pub crystal_density: f64,
    /// Density of the liquid at the start, σ⁻³.
    pub liquid_density: f64,
}

/// Particles of a cell of the face-centred cubic lattice.
fn per_cell() -> usize {
    Lattice::Fcc.basis().len()
}

impl HalfCrystal {
    /// How many particles start in the crystal.
    #[must_use]
    pub fn n_crystal(&self) -> usize {
        per_cell() * self.cells * self.cells * self.layers
    }

    /// The edge of a cell, σ.
    fn edge(&self) -> f64 {
        (per_cell() as f64 / self.crystal_density).cbrt()
    }

    /// The side of the cross-section, σ.
    #[must_use]
    pub fn side(&self) -> f64 {
        self.cells as f64 * self.edge()
    }

    /// The length of the crystal, σ.
    #[must_use]
    pub fn crystal_length(&self) -> f64 {
        self.layers as f64 * self.edge()
    }

    /// The length of the liquid, σ.
    #[must_use]
    pub fn liquid_length(&self) -> f64 {
        let n_liquid = self.n_atoms.saturating_sub(self.n_crystal()) as f64;
        n_liquid / (self.liquid_density * self.side().powi(2))
    }
}

lennard_core::options! {
    /// The keys of `[crystal]`.
    pub(crate) struct CrystalKeys {
        /// Face-centred cells across x and across y.
        cells: Option<usize> = None, else "as many as make the crystal about twice as long as wide", Whole(1, MOST_ENTRIES as i64);
        /// Face-centred cells along z.
        layers: Option<usize> = None, else "as many as take half of the particles", Whole(1, MOST_ATOMS);
        /// Density of the crystal at the start; its cross-section is without strain.
        crystal_density: Option<f64> = None, else "melting line of the model at `system.temperature`", Between(THINNEST, DENSEST), in "σ⁻³";
        /// Density of the liquid at the start.
        liquid_density: Option<f64> = None, else "freezing line of the model at `system.temperature`", Between(THINNEST, DENSEST), in "σ⁻³";
    }
}

impl From<&HalfCrystal> for CrystalKeys {
    fn from(start: &HalfCrystal) -> Self {
        Self {
            cells: Some(start.cells),
            layers: Some(start.layers),
            crystal_density: Some(start.crystal_density),
            liquid_density: Some(start.liquid_density),
        }
    }
}

impl Reader<'_> {
    /// The start of `n_atoms` particles at a temperature (ε/k_B); the freezing line of `model` gives densities that are not written.
    pub fn half_crystal(
        &self,
        n_atoms: usize,
        temperature: f64,
        model: Option<ModelKind>,
    ) -> Result<HalfCrystal, SceneError> {
        let table: CrystalKeys = self.plain("crystal")?;
        let [crystal_density, liquid_density] = match (table.crystal_density, table.liquid_density)
        {
            (Some(crystal), Some(liquid)) => [crystal, liquid],
            (crystal, liquid) => {
                let keys = ["crystal_density", "liquid_density"];
                let missing = MissingDensity::of("crystal", keys, [crystal, liquid]);
                let [c, l] = self.on_freezing_line(temperature, model, &missing)?;
                [crystal.unwrap_or(c), liquid.unwrap_or(l)]
            }
        };
        let in_crystal = SHARE * n_atoms as f64;
        let cells = table.cells.unwrap_or_else(|| {
            let cells = (in_crystal / (per_cell() as f64 * LENGTH_OF_SIDE)).cbrt();
            (cells.round() as usize).max(1)
        });
        let of_layer = (per_cell() * cells * cells) as f64;
        let layers = (in_crystal / of_layer).round() as usize;
        let start = HalfCrystal {
            n_atoms,
            cells,
            layers: table.layers.unwrap_or(layers.max(1)),
            crystal_density,
            liquid_density,
        };
        let parts = [start.crystal_length(), start.liquid_length()];
        if parts.iter().any(|length| *length < SHORTEST_PART) {
            return Err(self
                .source
                .refuse("crystal.layers", "leaves no room for two phases")
                .found(format!(
                    "{} cells along z with {} particles of {n_atoms}: {:.2} σ of crystal, {:.2} σ of liquid",
                    start.layers,
                    start.n_crystal().min(n_atoms),
                    parts[0],
                    parts[1]
                ))
                .allowed(format!(
                    "at least {SHORTEST_PART} σ of both: other `layers` or `cells`, or more `n_atoms`"
                )));
        }
        Ok(start)
    }

    /// The densities of crystal and liquid side by side in the literature.
    fn on_freezing_line(
        &self,
        temperature: f64,
        model: Option<ModelKind>,
        MissingDensity { key, allowed }: &MissingDensity,
    ) -> Result<[f64; 2], SceneError> {
        let missing = |found: String, allowed: String| {
            let refused = self.source.refuse(key, "is missing");
            refused.found(found).allowed(allowed)
        };
        let line = freezing_line();
        let equation = model.and_then(|model| equation_of_state_for(model).ok());
        if !equation.is_some_and(|e| e.has_freezing_line()) {
            return Err(missing(
                "nothing, and no freezing line is known for this potential".to_owned(),
                allowed.clone(),
            ));
        }
        let on_line = line.melting_density(temperature).zip(line.freezing_density(temperature));
        on_line.map(|(c, l)| [c, l]).ok_or_else(|| {
            missing(
                format!("nothing, at temperature {temperature}"),
                format!(
                    "a temperature above the triple point, {} ({}), or {allowed}",
                    line.t_triple, line.name
                ),
            )
        })
    }
}

impl Scene {
    /// The start as a crystal beside its liquid, where it is one.
    #[must_use]
    pub fn half_crystal(&self) -> Option<&HalfCrystal> {
        match &self.system.start {
            Start::HalfCrystal(start) => Some(start),
            _ => None,
        }
    }

    /// Why the particles are no homogeneous fluid, in words: what confines them, or a crystal beside the liquid. `None` where the scene names
    /// nothing of the kind.
    #[must_use]
    pub fn not_homogeneous(&self) -> Option<String> {
        let confined = self.confined_by();
        let confined = confined.map(|with| format!("the fluid has {with}"));
        let crystal = self.half_crystal();
        confined.or_else(|| crystal.map(|_| "a crystal beside its liquid".to_owned()))
    }

    /// The box, with the part that the crystal fills.
    pub(crate) fn crystal_placement(&self, start: &HalfCrystal) -> Result<Placement, SceneError> {
        let side = start.side();
        let crystal = DVec3::new(side, side, start.crystal_length());
        let sides = crystal + DVec3::new(0.0, 0.0, start.liquid_length());
        Ok(Placement {
            cell: self.box_of_phases("crystal", sides)?,
            corner: DVec3::ZERO,
            filled: crystal,
            cells: Some([start.cells, start.cells, start.layers]),
        })
    }
}
