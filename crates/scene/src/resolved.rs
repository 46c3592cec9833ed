//! A scene written out again, with every default in its place.

use lennard_contacts::ContactOptions;
use lennard_core::DVec3;
use lennard_forcefield::{
    CombiningOptions, KernelOptions, NeighborOptions, PotentialOptions, WallOptions,
};
use lennard_integrators::{
    BarostatOptions, BondOptions, ExchangeOptions, IntegratorOptions, ThermostatOptions,
};
use lennard_io::TrajectoryFormat;
use lennard_observables::ObservableOptions;
use serde::Serialize;

use crate::molecule::MoleculeOptions;
use crate::planar::ResolvedTruncation;
use crate::resolved_system::ResolvedSystem;
use crate::slab::SlabTable;
use crate::{Accuracy, Amount, MixtureTables, ProgramParts, Scene, WallTable};

#[derive(Serialize)]
struct Resolved<'a> {
    name: &'a str,
    system: ResolvedSystem,
    #[serde(skip_serializing_if = "Option::is_none")]
    slab: Option<SlabTable>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    species: Vec<Species<'a>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    mixing: Option<&'a CombiningOptions>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pair: Vec<Pair<'a>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    molecule: Option<&'a MoleculeOptions>,
    #[serde(skip_serializing_if = "Option::is_none")]
    bonds: Option<&'a BondOptions>,
    #[serde(skip_serializing_if = "Option::is_none")]
    accuracy: Option<&'a Accuracy>,
    potential: &'a PotentialOptions,
    truncation: ResolvedTruncation<'a>,
    neighbor: &'a NeighborOptions,
    kernel: &'a KernelOptions,
    integrator: Integrator<'a>,
    #[serde(skip_serializing_if = "Option::is_none")]
    field: Option<Field>,
    #[serde(skip_serializing_if = "Option::is_none")]
    contact: Option<Contact<'a>>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    wall: Vec<Wall<'a>>,
    stage: Vec<Stage<'a>>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    observable: Vec<Observable<'a>>,
    output: Output<'a>,
    checkpoint: Checkpoint,
    #[serde(skip_serializing_if = "ProgramParts::is_empty")]
    program: &'a ProgramParts,
}

#[derive(Serialize)]
struct Species<'a> {
    name: &'a str,
    #[serde(skip_serializing_if = "Option::is_none")]
    fraction: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    count: Option<usize>,
    sigma: f64,
    epsilon: f64,
    mass: f64,
    element: &'a str,
}

#[derive(Serialize)]
struct Pair<'a> {
    a: &'a str,
    b: &'a str,
    #[serde(skip_serializing_if = "Option::is_none")]
    sigma: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    epsilon: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    k: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    l: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    r_cut: Option<f64>,
}

#[derive(Serialize)]
struct Integrator<'a> {
    #[serde(flatten)]
    method: &'a IntegratorOptions,
    dt: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    r_split: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    split_width: Option<f64>,
}

#[derive(Serialize)]
struct Field {
    acceleration: [f64; 3],
}

#[derive(Serialize)]
struct Contact<'a> {
    #[serde(flatten)]
    options: &'a ContactOptions,
    diameter: f64,
}

#[derive(Serialize)]
struct Wall<'a> {
    #[serde(flatten)]
    options: &'a WallOptions,
    axis: &'static str,
    thickness: f64,
}

#[derive(Serialize)]
struct Stage<'a> {
    name: &'a str,
    steps: u64,
    #[serde(skip_serializing_if = "Option::is_none")]
    temperature: Option<Ramp>,
    #[serde(skip_serializing_if = "Option::is_none")]
    dt: Option<f64>,
    measure: bool,
    thermostat: Thermostat<'a>,
    #[serde(skip_serializing_if = "Option::is_none")]
    barostat: Option<Barostat<'a>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    exchange: Option<&'a ExchangeOptions>,
}

#[derive(Serialize)]
struct Barostat<'a> {
    pressure: Ramp,
    #[serde(flatten)]
    options: &'a BarostatOptions,
}

#[derive(Serialize)]
#[serde(untagged)]
enum Ramp {
    Constant(f64),
    Linear { from: f64, to: f64 },
}

impl Ramp {
    fn new(from: Option<f64>, to: f64) -> Self {
        from.map_or(Self::Constant(to), |from| Self::Linear { from, to })
    }
}

#[derive(Serialize)]
#[serde(untagged)]
enum Thermostat<'a> {
    Without(&'static str),
    With(&'a ThermostatOptions),
}

#[derive(Serialize)]
struct Observable<'a> {
    #[serde(flatten)]
    options: &'a ObservableOptions,
    every: u64,
}

#[derive(Serialize)]
struct Output<'a> {
    trajectory_every: u64,
    format: TrajectoryFormat,
    #[serde(skip_serializing_if = "Option::is_none")]
    precision: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    ase: Option<bool>,
    thermo_every: u64,
    #[serde(skip_serializing_if = "Option::is_none")]
    element: Option<&'a str>,
    velocities: bool,
    forces: bool,
    unwrapped: bool,
    length_scale: f64,
}

#[derive(Serialize)]
struct Checkpoint {
    every_steps: u64,
    every_seconds: f64,
}

impl Scene {
    /// The scene as TOML with every default written out, but not what an accuracy leaves to be chosen;
    /// reading it gives an equal scene.
    ///
    /// # Panics
    /// Where a number does not fit TOML, which no scene that was read from a file holds.
    #[must_use]
    pub fn resolved_toml(&self) -> String {
        let body = if self.free.is_empty() {
            toml::to_string(&self.resolved())
        } else {
            toml::to_string(&self.resolved_table())
        };
        let body = body.expect("every value of a scene fits TOML");
        format!("# The scene as it was run, with every default written out.\n\n{body}")
    }

    /// The scene as a table, without what an accuracy leaves to be chosen.
    ///
    /// # Panics
    /// As [`Scene::resolved_toml`].
    pub(crate) fn resolved_table(&self) -> toml::Table {
        let mut all =
            toml::Table::try_from(self.resolved()).expect("every value of a scene fits TOML");
        for free in &self.free {
            if let Some((table, key)) = free.split_once('.')
                && let Some(toml::Value::Table(table)) = all.get_mut(table)
            {
                table.remove(key);
            }
        }
        all
    }

    fn resolved(&self) -> Resolved<'_> {
        let format = self.output.format.spec();
        Resolved {
            name: &self.name,
            system: self.resolved_system(),
            slab: self.slab().map(SlabTable::from),
            species: self.mixture.as_ref().map_or(Vec::new(), resolved_species),
            mixing: self.mixture.as_ref().and_then(|m| m.rule.as_ref()),
            pair: self.mixture.as_ref().map_or(Vec::new(), resolved_pairs),
            molecule: self.molecule.as_ref().map(|m| &m.options),
            bonds: self.molecule.as_ref().map(|m| &m.bonds),
            accuracy: self.accuracy.as_ref(),
            potential: &self.potential,
            truncation: ResolvedTruncation::of(self),
            neighbor: &self.neighbor,
            kernel: &self.kernel,
            integrator: Integrator {
                method: &self.integrator.method,
                dt: self.integrator.dt,
                r_split: self.integrator.split.map(|split| split.r_split),
                split_width: self.integrator.split.map(|split| split.width),
            },
            field: self.confining_field(),
            contact: self.contact.as_ref().map(|table| Contact {
                options: &table.options,
                diameter: table.diameter,
            }),
            wall: self.walls.iter().map(resolved_wall).collect(),
            stage: self.stages.iter().map(resolved_stage).collect(),
            observable: self
                .observables
                .iter()
                .map(|table| Observable {
                    options: &table.options,
                    every: table.every,
                })
                .collect(),
            output: Output {
                trajectory_every: self.output.trajectory_every.unwrap_or(0),
                format: self.output.format,
                precision: format.limits.map(|_| self.output.precision),
                ase: format.holds_ase.then_some(self.output.ase),
                thermo_every: self.output.thermo_every,
                element: self.mixture.is_none().then_some(&self.output.element),
                velocities: self.output.velocities,
                forces: self.output.forces,
                unwrapped: self.output.unwrapped,
                length_scale: self.output.length_scale,
            },
            checkpoint: Checkpoint {
                every_steps: self.checkpoint.every_steps.unwrap_or(0),
                every_seconds: self.checkpoint.every_seconds.unwrap_or(0.0),
            },
            program: &self.program,
        }
    }

    fn confining_field(&self) -> Option<Field> {
        (self.acceleration != DVec3::ZERO).then(|| Field {
            acceleration: self.acceleration.to_array(),
        })
    }
}

fn resolved_species(mixture: &MixtureTables) -> Vec<Species<'_>> {
    let species = mixture.species.iter().map(|s| Species {
        name: &s.name,
        fraction: match s.amount {
            Amount::Fraction(x) => Some(x),
            Amount::Count(_) | Amount::OfFile => None,
        },
        count: match s.amount {
            Amount::Count(n) => Some(n),
            Amount::Fraction(_) | Amount::OfFile => None,
        },
        sigma: s.sigma,
        epsilon: s.epsilon,
        mass: s.mass,
        element: &s.element,
    });
    species.collect()
}

fn resolved_pairs(mixture: &MixtureTables) -> Vec<Pair<'_>> {
    let name = |a: usize| mixture.species[a].name.as_str();
    let pairs = mixture.pairs.iter().map(|p| Pair {
        a: name(p.species[0]),
        b: name(p.species[1]),
        sigma: p.sigma,
        epsilon: p.epsilon,
        k: p.k,
        l: p.l,
        r_cut: p.r_cut,
    });
    pairs.collect()
}

fn resolved_wall(table: &WallTable) -> Wall<'_> {
    Wall {
        options: &table.options,
        axis: table.axis.name(),
        thickness: table.thickness,
    }
}

fn resolved_stage(stage: &crate::Stage) -> Stage<'_> {
    let thermostat = match &stage.thermostat {
        None => Thermostat::Without("none"),
        Some(options) => Thermostat::With(options),
    };
    Stage {
        name: &stage.name,
        steps: stage.steps,
        temperature: stage
            .thermostat
            .as_ref()
            .map(|_| Ramp::new(stage.temperature_from, stage.temperature)),
        dt: stage.dt,
        measure: stage.measure,
        thermostat,
        barostat: stage.barostat.as_ref().map(|control| Barostat {
            pressure: Ramp::new(control.pressure_from, control.pressure),
            options: &control.options,
        }),
        exchange: stage.exchange.as_ref(),
    }
}
