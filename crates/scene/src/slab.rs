//! The table `[slab]`: a start with liquid in the middle of the box and vapor on both sides.

use lennard_core::DVec3;
use lennard_core::number::short;
use lennard_literature::{ModelKind, TwoPhaseSource};

use crate::error::SceneError;
use crate::phases::MissingDensity;
use crate::read::Reader;
use crate::reference::{DENSEST, LONGEST_SIDE, SHORTEST_SIDE, THINNEST};
use crate::{Placement, Scene, Start};

/// The length of the box over the thickness of the slab, where the scene does not say.
const LENGTH_OF_THICKNESS: f64 = 3.0;
/// The thickness over the side of the slab, where the scene does not say.
const THICKNESS_OF_SIDE: f64 = 1.5;

/// A slab of liquid across z between two parts of vapor.
///
/// The cross-section is a square. Its side follows from the number of particles:
/// A = N/(ρ_l·d + ρ_v·(L_z − d)).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Slab {
    /// Number of particles, in both phases together.
    pub n_atoms: usize,
    /// Density of the liquid at the start, σ⁻³.
    pub liquid_density: f64,
    /// Density of the vapor at the start, σ⁻³.
    pub vapor_density: f64,
    /// Thickness d of the liquid, σ.
    pub thickness: f64,
    /// Length L_z of the box, σ.
    pub length: f64,
}

impl Slab {
    /// The least length of the vapor between the two surfaces, σ.
    pub const LEAST_VAPOR: f64 = 4.0;

    /// The area of the cross-section, σ².
    #[must_use]
    pub fn area(&self) -> f64 {
        let per_area = self.liquid_density * self.thickness
            + self.vapor_density * (self.length - self.thickness);
        self.n_atoms as f64 / per_area
    }

    /// How many of the particles start as vapor.
    #[must_use]
    pub fn n_vapor(&self) -> usize {
        let volume = self.area() * (self.length - self.thickness);
        ((self.vapor_density * volume).round() as usize).min(self.n_atoms)
    }

    /// The sides of the box, σ.
    fn sides(&self) -> DVec3 {
        let side = self.area().sqrt();
        DVec3::new(side, side, self.length)
    }
}

lennard_core::options! {
    /// The keys of `[slab]`.
    pub(crate) struct SlabKeys {
        /// Density of the liquid at the start.
        liquid_density: Option<f64> = None, else "saturation of the model at `system.temperature`", Between(THINNEST, DENSEST), in "σ⁻³";
        /// Density of the vapor at the start.
        vapor_density: Option<f64> = None, else "saturation of the model at `system.temperature`", Between(THINNEST, DENSEST), in "σ⁻³";
        /// Thickness of the liquid across z; 12 σ or more for the densities and the tension of bulk phases.
        thickness: Option<f64> = None, else "1.5 times the side of the cross-section, or a third of `length`", Between(SHORTEST_SIDE, LONGEST_SIDE), in "σ";
        /// Length of the box along z.
        length: Option<f64> = None, else "3 times `thickness`", Between(SHORTEST_SIDE, LONGEST_SIDE), in "σ";
    }
}

impl From<&Slab> for SlabKeys {
    fn from(slab: &Slab) -> Self {
        Self {
            liquid_density: Some(slab.liquid_density),
            vapor_density: Some(slab.vapor_density),
            thickness: Some(slab.thickness),
            length: Some(slab.length),
        }
    }
}

impl Reader<'_> {
    /// The slab of `n_atoms` particles at a temperature (ε/k_B); the literature of `model` gives densities that are not written.
    pub fn slab(
        &self,
        n_atoms: usize,
        temperature: f64,
        model: Option<ModelKind>,
    ) -> Result<Slab, SceneError> {
        let table: SlabKeys = self.plain("slab")?;
        let [liquid_density, vapor_density] = match (table.liquid_density, table.vapor_density) {
            (Some(liquid), Some(vapor)) => [liquid, vapor],
            (liquid, vapor) => {
                let keys = ["liquid_density", "vapor_density"];
                let missing = MissingDensity::of("slab", keys, [liquid, vapor]);
                let [l, v] = self.coexisting(temperature, model, &missing)?;
                [liquid.unwrap_or(l), vapor.unwrap_or(v)]
            }
        };
        if vapor_density >= liquid_density {
            return Err(self
                .source
                .refuse("slab.vapor_density", "is not below the density of the liquid")
                .found(vapor_density)
                .allowed(format!("below {liquid_density} σ⁻³")));
        }
        let per_volume = liquid_density + (LENGTH_OF_THICKNESS - 1.0) * vapor_density;
        let side = (n_atoms as f64 / (THICKNESS_OF_SIDE * per_volume)).cbrt();
        let (thickness, length) = match (table.thickness, table.length) {
            (Some(thickness), Some(length)) => (thickness, length),
            (Some(thickness), None) => (thickness, LENGTH_OF_THICKNESS * thickness),
            (None, Some(length)) => (length / LENGTH_OF_THICKNESS, length),
            (None, None) => {
                let thickness = THICKNESS_OF_SIDE * side;
                (thickness, LENGTH_OF_THICKNESS * thickness)
            }
        };
        if thickness + Slab::LEAST_VAPOR > length {
            return Err(self
                .source
                .refuse("slab.thickness", "leaves no room for vapor")
                .found(thickness)
                .allowed(format!(
                    "{} σ below the length of the box, {} σ",
                    Slab::LEAST_VAPOR,
                    short(length)
                )));
        }
        Ok(Slab { n_atoms, liquid_density, vapor_density, thickness, length })
    }

    /// The densities of liquid and vapor in the literature.
    fn coexisting(
        &self,
        temperature: f64,
        model: Option<ModelKind>,
        MissingDensity { key, allowed }: &MissingDensity,
    ) -> Result<[f64; 2], SceneError> {
        let missing = |found: String| {
            let refused = self.source.refuse(key, "is missing");
            refused.found(found).allowed(allowed.clone())
        };
        let Some(model) = model else {
            return Err(missing("nothing, and no literature for a slab of several species".into()));
        };
        let source =
            TwoPhaseSource::of(model).map_err(|none| missing(format!("nothing, and {none}")))?;
        let phases = source.at(temperature).ok_or_else(|| {
            self.source
                .refuse("system.temperature", "has no liquid beside its vapor")
                .found(temperature)
                .allowed(format!(
                    "below the critical temperature {} ({}) and not far below the triple point, or {allowed}",
                    source.critical().temperature,
                    source.name()
                ))
        })?;
        let s = phases.saturation;
        Ok([s.liquid_density, s.vapor_density])
    }
}

impl Scene {
    /// The start as a slab, where it is one.
    #[must_use]
    pub fn slab(&self) -> Option<&Slab> {
        match &self.system.start {
            Start::Slab(slab) => Some(slab),
            Start::Lattice { .. }
            | Start::HalfCrystal(_)
            | Start::Listed { .. }
            | Start::Configuration { .. } => None,
        }
    }

    /// What makes surfaces across z at the start, in words; `None` for a fluid that fills its box, and for a start from a file.
    #[must_use]
    pub fn surfaces(&self) -> Option<String> {
        match &self.system.start {
            Start::Lattice { vacuum, .. } if *vacuum > 0.0 => {
                Some(format!("system.vacuum = {vacuum}"))
            }
            Start::Slab(_) => Some("`[slab]`".to_owned()),
            Start::Lattice { .. }
            | Start::HalfCrystal(_)
            | Start::Listed { .. }
            | Start::Configuration { .. } => None,
        }
    }

    /// The key that makes surfaces.
    pub(crate) fn key_of_surfaces(&self) -> &'static str {
        match self.system.start {
            Start::Slab(_) => "slab",
            Start::Lattice { .. }
            | Start::HalfCrystal(_)
            | Start::Listed { .. }
            | Start::Configuration { .. } => "system.vacuum",
        }
    }

    /// The box of a slab, with the part that the liquid fills.
    pub(crate) fn slab_placement(&self, slab: &Slab) -> Result<Placement, SceneError> {
        let sides = slab.sides();
        Ok(Placement {
            cell: self.box_of_phases("slab", sides)?,
            corner: DVec3::new(0.0, 0.0, 0.5 * (slab.length - slab.thickness)),
            filled: DVec3::new(sides.x, sides.y, slab.thickness),
            cells: None,
        })
    }
}
