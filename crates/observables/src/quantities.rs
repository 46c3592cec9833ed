//! The quantities that a reader sees: one entry says everything about each, apart from its value.
//!
//! Run records, tables, pages, sweeps, state cards and the rules of two phases look here. A quantity without an entry, such as
//! one that a program of a user's own brings, has the words of its name and no reference.

use Beside::{
    Bath, BathOnHalfSteps, Conductivity, Density, FreezingHeight, HeatCapacity, KineticTemperature,
    LiquidDensity, Nothing, PotentialEnergy, Pressure, ResponseFunction, SelfDiffusion,
    SurfaceTension, VaporDensity, VaporPressure, Viscosity,
};
use Mark::{
    AcrossSurfaces, AtBath, AtVolume, Coexisting, OnePhase, Plain, SetByScaling, Summed,
    WholeSystem,
};
use Setting::{Fluid, Fronts, Slab, Walls};

/// What a quantity is held against.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Beside {
    /// Nothing.
    Nothing,
    /// The temperature of a bath that holds whole steps.
    Bath,
    /// The temperature of a bath that holds half steps.
    BathOnHalfSteps,
    /// U of an equation of state.
    PotentialEnergy,
    /// P of an equation of state, or of the barostat.
    Pressure,
    /// ρ of an equation of state at the pressure of the barostat.
    Density,
    /// c_v of an equation of state.
    HeatCapacity,
    /// A response function of an equation of state.
    ResponseFunction,
    /// The kinetic temperature of the same run.
    KineticTemperature,
    /// Tables of self-diffusion.
    SelfDiffusion,
    /// Tables of the shear viscosity.
    Viscosity,
    /// Tables of the thermal conductivity.
    Conductivity,
    /// The height of the first peak of S(k) at freezing.
    FreezingHeight,
    /// The density of the liquid at coexistence.
    LiquidDensity,
    /// The density of the vapor at coexistence.
    VaporDensity,
    /// The pressure at coexistence.
    VaporPressure,
    /// The tension of the surface between liquid and vapor.
    SurfaceTension,
}

/// A kind of run, by what its readers look for first.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Setting {
    /// One fluid.
    Fluid,
    /// Liquid and vapor side by side.
    Slab,
    /// A fluid between walls.
    Walls,
    /// A crystal beside its liquid.
    Fronts,
}

/// What else the program has to know of a quantity.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mark {
    /// It means nothing over two phases. Means of a species or of a pair of species, whose names go on, mean nothing either.
    OnePhase,
    /// It is of the fluid without its tail correction.
    Plain,
    /// In a fluid that has separated, it counts both phases and the surfaces between them.
    AcrossSurfaces,
    /// Velocity scaling sets it instead of sampling it.
    SetByScaling,
    /// It is a density of one of two coexisting phases, which share a figure.
    Coexisting,
    /// A sweep sums up its differences over all points.
    Summed,
    /// A state card leaves it out: the comparison holds it against the value for so many particles.
    WholeSystem,
    /// A state card shows it at the temperature of the bath, from which trial particles have their weights.
    AtBath,
    /// A state card shows it at constant volume alone.
    AtVolume,
}

/// A quantity, and everything that is said of it apart from its value.
#[derive(Debug, Clone, Copy)]
pub struct Quantity {
    /// Name in run records, tables of files and Python; the name of the same property in the literature.
    pub key: &'static str,
    /// Name in a sentence and in tables for people.
    pub words: &'static str,
    /// Letter in figures; empty where it has none.
    pub symbol: &'static str,
    /// Unit; empty for a plain number. Energies are per particle, or per molecule where there are some.
    pub unit: &'static str,
    /// What it is held against.
    pub beside: Beside,
    /// The quantity that it repeats up to a constant or a factor: checks of errors count only that one.
    pub repeats: Option<&'static str>,
    /// The property of an equation of state that it is a part of. It stands beside that property and judges nothing.
    pub part_of: Option<&'static str>,
    /// The kinds of runs whose readers look for it first.
    pub primary: &'static [Setting],
    /// What else the program has to know.
    pub marks: &'static [Mark],
}

impl Quantity {
    const fn beside(self, beside: Beside) -> Self {
        Self { beside, ..self }
    }

    const fn repeats(self, other: &'static str) -> Self {
        Self { repeats: Some(other), ..self }
    }

    const fn part_of(self, property: &'static str) -> Self {
        Self { part_of: Some(property), ..self }
    }

    const fn primary(self, primary: &'static [Setting]) -> Self {
        Self { primary, ..self }
    }

    const fn marks(self, marks: &'static [Mark]) -> Self {
        Self { marks, ..self }
    }

    /// Whether it has this mark.
    #[must_use]
    pub fn is(&self, mark: Mark) -> bool {
        self.marks.contains(&mark)
    }

    /// Words and symbol: `pressure P`.
    #[must_use]
    pub fn name(&self) -> String {
        let has_symbol = self.symbol.is_empty() || self.words.ends_with(self.symbol);
        if has_symbol { self.words.to_owned() } else { format!("{} {}", self.words, self.symbol) }
    }

    /// The label of an axis: `P / (ε/σ³)`.
    #[must_use]
    pub fn axis(&self) -> String {
        let symbol = if self.symbol.is_empty() { self.words } else { self.symbol };
        axis(symbol, self.unit)
    }
}

/// The label of an axis: a symbol or words, and the unit, in brackets where it holds a stroke.
#[must_use]
pub fn axis(what: &str, unit: &str) -> String {
    match unit {
        "" => what.to_owned(),
        unit if unit.contains('/') => format!("{what} / ({unit})"),
        unit => format!("{what} / {unit}"),
    }
}

const fn quantity(
    key: &'static str,
    words: &'static str,
    symbol: &'static str,
    unit: &'static str,
) -> Quantity {
    let (beside, repeats, part_of) = (Nothing, None, None);
    Quantity { key, words, symbol, unit, beside, repeats, part_of, primary: &[], marks: &[] }
}

const fn response(
    key: &'static str,
    words: &'static str,
    symbol: &'static str,
    unit: &'static str,
) -> Quantity {
    quantity(key, words, symbol, unit).beside(ResponseFunction).marks(&[OnePhase])
}

/// All quantities, in the order of a table.
pub const QUANTITIES: &[Quantity] = &[
    quantity("temperature", "T, whole steps", "T", "ε/k_B").beside(Bath).marks(&[SetByScaling]),
    quantity("temperature_half_steps", "T, half steps", "T", "ε/k_B")
        .beside(BathOnHalfSteps)
        .marks(&[SetByScaling])
        .repeats("temperature"),
    quantity("liquid_density", "liquid density", "ρ_l", "σ⁻³")
        .beside(LiquidDensity)
        .primary(&[Slab])
        .marks(&[Coexisting]),
    quantity("vapor_density", "vapor density", "ρ_v", "σ⁻³")
        .beside(VaporDensity)
        .primary(&[Slab])
        .marks(&[Coexisting]),
    quantity("vapor_pressure", "vapor pressure", "p_s", "ε/σ³")
        .beside(VaporPressure)
        .primary(&[Slab]),
    quantity("surface_tension", "surface tension", "γ", "ε/σ²")
        .beside(SurfaceTension)
        .primary(&[Slab]),
    quantity("front_velocity", "front velocity", "v", "σ/τ").primary(&[Fronts]),
    quantity("solid_share", "solid share", "", "").primary(&[Fronts]),
    quantity("potential_energy", "potential energy", "U/N", "ε")
        .beside(PotentialEnergy)
        .primary(&[Fluid, Slab, Walls, Fronts])
        .marks(&[Summed, AtVolume]),
    quantity("potential_energy_without_tail", "potential energy without tail", "U/N", "ε")
        .marks(&[Plain])
        .repeats("potential_energy"),
    quantity("pressure", "pressure", "P", "ε/σ³")
        .beside(Pressure)
        .primary(&[Fluid, Fronts])
        .marks(&[Summed, AtVolume, AcrossSurfaces]),
    quantity("pressure_without_tail", "pressure without tail", "P", "ε/σ³")
        .marks(&[Plain, AcrossSurfaces])
        .repeats("pressure"),
    quantity("density", "density", "ρ", "σ⁻³").beside(Density).primary(&[Fluid, Fronts]),
    quantity("volume", "volume", "V", "σ³"),
    quantity("enthalpy", "enthalpy", "H/N", "ε").primary(&[Fluid]).marks(&[WholeSystem]),
    quantity("kinetic_energy", "kinetic energy", "K/N", "ε")
        .marks(&[SetByScaling])
        .repeats("temperature"),
    quantity("total_energy", "total energy", "E/N", "ε").marks(&[WholeSystem]),
    quantity("conserved_energy", "conserved energy", "(E − heat)/N", "ε"),
    quantity("heat_capacity", "heat capacity", "c_v", "k_B")
        .beside(HeatCapacity)
        .primary(&[Fluid])
        .marks(&[Summed, OnePhase]),
    quantity("pressure_zz", "pressure zz", "P_zz", "ε/σ³").beside(VaporPressure).primary(&[Slab]),
    quantity("surface_tension_z", "surface tension z", "γ_z", "ε/σ²")
        .beside(SurfaceTension)
        .primary(&[Slab]),
    quantity("configurational_temperature", "configurational temperature", "T_conf", "ε/k_B")
        .beside(KineticTemperature)
        .primary(&[Fluid, Slab])
        .marks(&[Summed]),
    response("heat_capacity_pressure", "heat capacity c_p", "c_p", "k_B"),
    response("thermal_pressure_coefficient", "thermal pressure coefficient", "γ_V", "k_B/σ³"),
    response("isothermal_compressibility", "isothermal compressibility", "κ_T", "σ³/ε"),
    response("isentropic_compressibility", "isentropic compressibility", "κ_S", "σ³/ε"),
    response("thermal_expansion", "thermal expansion", "α_P", "k_B/ε"),
    response("speed_of_sound", "speed of sound", "w", "σ/τ"),
    response("joule_thomson_coefficient", "Joule–Thomson coefficient", "μ_JT", "σ³/k_B"),
    response("grueneisen_parameter", "Grüneisen parameter", "Γ", ""),
    response("density_scaling_exponent", "density-scaling exponent", "γ", ""),
    response("energy_virial_correlation", "correlation of energy and virial", "R", "")
        .beside(Nothing),
    quantity("diffusion_coefficient_corrected", "diffusion coefficient, corrected", "D", "σ²/τ")
        .beside(SelfDiffusion)
        .primary(&[Fluid])
        .repeats("diffusion_coefficient_uncorrected"),
    quantity(
        "diffusion_coefficient_uncorrected",
        "diffusion coefficient, uncorrected",
        "D",
        "σ²/τ",
    )
    .beside(SelfDiffusion)
    .primary(&[Fluid]),
    quantity(
        "diffusion_coefficient_green_kubo",
        "diffusion coefficient, Green–Kubo, uncorrected",
        "D",
        "σ²/τ",
    ),
    quantity("einstein_frequency", "Einstein frequency", "Ω_E", "τ⁻¹")
        .primary(&[Fluid])
        .marks(&[OnePhase]),
    quantity("shear_viscosity", "shear viscosity", "η", "ετ/σ³")
        .beside(Viscosity)
        .primary(&[Fluid]),
    quantity("thermal_conductivity", "thermal conductivity", "λ", "k_B/(στ)")
        .beside(Conductivity)
        .primary(&[Fluid]),
    quantity("viscosity_by_exchange", "viscosity by exchange", "η", "ετ/σ³")
        .beside(Viscosity)
        .primary(&[Fluid]),
    quantity(
        "thermal_conductivity_by_exchange",
        "thermal conductivity by exchange",
        "λ",
        "k_B/(στ)",
    )
    .beside(Conductivity)
    .primary(&[Fluid]),
    quantity("structure_factor_first_peak", "first peak of S(k)", "S(k)", "")
        .beside(FreezingHeight)
        .primary(&[Fluid]),
    quantity("rdf_first_peak", "first peak of g(r)", "g(r)", "").marks(&[OnePhase]),
    quantity("coordination_number", "coordination number", "n", "")
        .primary(&[Fluid])
        .marks(&[OnePhase]),
    quantity("two_body_entropy", "two-body entropy", "s₂", "k_B")
        .part_of("residual_entropy")
        .marks(&[OnePhase]),
    quantity("residual_entropy", "residual entropy", "s_res", "k_B"),
    quantity("residual_helmholtz_energy", "residual Helmholtz energy", "a_res", "ε"),
    quantity("compressibility_factor", "compressibility factor", "Z", ""),
    quantity("structure_factor_zero", "structure factor", "S(0)", ""),
    quantity("residual_chemical_potential", "residual chemical potential", "μ_res", "ε")
        .marks(&[OnePhase, AtBath]),
    quantity("kirkwood_buff", "Kirkwood–Buff integral", "G", "σ³").marks(&[OnePhase]),
    quantity("thermodynamic_factor", "thermodynamic factor", "Γ", "").marks(&[OnePhase]),
    quantity("wall_pressure_x_lower", "wall pressure x lower", "P", "ε/σ³").primary(&[Walls]),
    quantity("wall_pressure_x_upper", "wall pressure x upper", "P", "ε/σ³").primary(&[Walls]),
    quantity("wall_pressure_y_lower", "wall pressure y lower", "P", "ε/σ³").primary(&[Walls]),
    quantity("wall_pressure_y_upper", "wall pressure y upper", "P", "ε/σ³").primary(&[Walls]),
    quantity("wall_pressure_z_lower", "wall pressure z lower", "P", "ε/σ³").primary(&[Walls]),
    quantity("wall_pressure_z_upper", "wall pressure z upper", "P", "ε/σ³").primary(&[Walls]),
];

/// The entry of a quantity; `None` where it has none.
#[must_use]
pub fn quantity_of(key: &str) -> Option<&'static Quantity> {
    QUANTITIES.iter().find(|quantity| quantity.key == key)
}

/// A quantity in words for a table.
#[must_use]
pub fn quantity_words(key: &str) -> String {
    quantity_of(key).map_or_else(|| key.replace('_', " "), |quantity| quantity.words.to_owned())
}

/// A quantity in words with its symbol.
#[must_use]
pub fn quantity_name(key: &str) -> String {
    quantity_of(key).map_or_else(|| quantity_words(key), Quantity::name)
}

/// The unit of a quantity; empty for a plain number and for a quantity without an entry.
#[must_use]
pub fn quantity_unit(key: &str) -> &'static str {
    quantity_of(key).map_or("", |quantity| quantity.unit)
}

/// Whether a mean has a mark.
#[must_use]
pub fn has_mark(key: &str, mark: Mark) -> bool {
    quantity_of(key).is_some_and(|quantity| quantity.is(mark))
}

/// Whether a mean means nothing over two phases: a quantity with that mark, or the same of a species or a pair of species.
#[must_use]
pub fn is_of_one_phase(key: &str) -> bool {
    QUANTITIES.iter().any(|quantity| quantity.is(OnePhase) && key.starts_with(quantity.key))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_key_has_one_entry() {
        for (at, one) in QUANTITIES.iter().enumerate() {
            assert!(QUANTITIES[..at].iter().all(|other| other.key != one.key), "{}", one.key);
            assert!(!one.words.is_empty());
        }
        assert_eq!(quantity_words("bond_length"), "bond length");
    }

    #[test]
    fn what_belongs_to_one_phase_is_known_by_its_name() {
        for name in [
            "heat_capacity",
            "speed_of_sound",
            "two_body_entropy",
            "rdf_first_peak_A_B",
            "coordination_number",
        ] {
            assert!(is_of_one_phase(name), "{name}");
        }
        for name in ["pressure", "liquid_density", "surface_tension", "ln_z"] {
            assert!(!is_of_one_phase(name), "{name}");
        }
    }
}
