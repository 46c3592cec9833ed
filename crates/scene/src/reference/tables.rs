//! The list of tables of a scene file: one line each, with the keys that it declares and the methods that it names.

use lennard_core::options::{Allowed, KeySpec, Keys, Options};
use lennard_forcefield::{
    CombiningOptions, KernelOptions, NeighborOptions, PotentialOptions, TruncationOptions,
    WallOptions,
};
use lennard_integrators::ContactOptions;
use lennard_integrators::{
    BarostatOptions, BondOptions, ExchangeOptions, IntegratorOptions, ThermostatOptions,
};
use lennard_observables::ObservableOptions;

use crate::methods::{self, Method};
use crate::tables::output::{Checkpoint, Output};
use crate::tables::species::{PairKeys, SpeciesKeys};
use crate::tables::stages::{
    BarostatKeys, IntegratorKeys, ObservableKeys, PressureRamp, StageKeys, TemperatureRamp,
};
use crate::tables::start::{StartKeys, SystemKeys};
use crate::tables::units::UnitKeys;
use crate::tables::walls::{ContactKeys, FieldKeys, WallKeys};
use crate::{Accuracy, MoleculeOptions, Name};

/// One key of a scene file.
#[derive(Debug, Clone)]
pub struct KeyDoc {
    /// Its table: `system`, `stage`, `stage.thermostat`; empty for a key outside all tables.
    pub table: &'static str,
    /// The method that the key belongs to, where it belongs to one alone (`soft-sphere`).
    pub method: Option<&'static str>,
    /// The key.
    pub key: &'static str,
    /// What it may hold.
    pub allowed: Allowed,
    /// The value where it is not written, in words.
    pub default: String,
    /// Its unit, empty for a plain number or a name.
    pub unit: &'static str,
    /// What it means.
    pub meaning: &'static str,
}

lennard_core::options! {
    /// The keys outside all tables.
    pub(crate) struct TopKeys {
        /// Name of the scene; the output folder is called after it.
        name: Option<String> = None, else "the file's name without `.toml`", Words(Name::ALLOWED);
    }
}

/// A table of a scene file.
#[derive(Debug, Clone, Copy)]
pub struct TableDoc {
    /// Its name; empty for the keys outside all tables.
    pub table: &'static str,
    /// What it is for.
    pub meaning: &'static str,
    /// How it is written.
    pub(crate) form: Form,
    /// The keys that it has whatever its method.
    keys: Keys,
    /// The key that names its method; `None` for a table without methods.
    pub(crate) tag: Option<Tag>,
}

/// How a table is written.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Form {
    /// At the top of the file.
    Top,
    /// Once, as `[table]`.
    Once,
    /// Any number of times, as `[[table]]`.
    Many,
    /// As the value of a key, in these words.
    Within(&'static str),
}

/// The key that names the method of a table.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Tag {
    /// The key.
    pub key: &'static str,
    /// The names of the methods.
    names: fn() -> Vec<&'static str>,
    /// The keys of each method.
    methods: fn() -> Vec<(&'static str, Keys)>,
    usual: Usual,
    meaning: &'static str,
}

/// The method of a table that names none.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Usual {
    /// The method with this name.
    Name(&'static str),
    /// No method, in words.
    Words(&'static str),
}

impl Usual {
    /// Every table must name its method.
    const NEEDED: Self = Self::Words("needed");
}

impl Tag {
    /// The method of a table that names none, where there is one.
    pub fn usual(&self) -> Option<&'static str> {
        match self.usual {
            Usual::Name(name) => Some(name),
            Usual::Words(_) => None,
        }
    }
}

impl TableDoc {
    /// How the table is written: `[system]`, `[[stage]]`, or in words.
    #[must_use]
    pub fn heading(&self) -> String {
        match self.form {
            Form::Top => "Outside all tables".to_owned(),
            Form::Once => format!("`[{}]`", self.table),
            Form::Many => format!("`[[{}]]`", self.table),
            Form::Within(words) => words.to_owned(),
        }
    }

    /// Every key of the table: the name of its method, the keys that all methods have, and the keys of each method.
    pub(super) fn keys(&self) -> Vec<KeyDoc> {
        let document = |method, key: &KeySpec| KeyDoc {
            table: self.table,
            method,
            key: key.key,
            allowed: key.allowed,
            default: (key.default)(),
            unit: key.unit,
            meaning: key.meaning,
        };
        let mut all = Vec::new();
        all.extend(self.tag.map(|tag| KeyDoc {
            table: self.table,
            method: None,
            key: tag.key,
            allowed: Allowed::Names(tag.names),
            default: match tag.usual {
                Usual::Name(name) => format!("`\"{name}\"`"),
                Usual::Words(words) => words.to_owned(),
            },
            unit: "",
            meaning: tag.meaning,
        }));
        all.extend(self.keys.iter().map(|key| document(None, key)));
        for (method, own) in self.tag.map_or(Vec::new(), |tag| (tag.methods)()) {
            all.extend(own.iter().map(|key| document(Some(method), key)));
        }
        all
    }
}

/// Makes the list from lines `"table" form, keys Declared, methods Options, "key" = usual, "meaning of the key"`. A table without
/// shared keys, or without methods, leaves the part out. Doc comments say what a table is for.
macro_rules! tables {
    ($(
        $(#[doc = $meaning:literal])+
        $table:literal $form:expr
            $(, keys $keys:ty)? $(, methods $methods:ty, $tag:literal = $usual:expr, $about:literal)?;
    )*) => {
        &[$(TableDoc {
            table: $table,
            meaning: concat!($($meaning),+).trim_ascii(),
            form: $form,
            keys: tables!(@or &[] $(, <$keys as Options>::KEYS)?),
            tag: tables!(@or None $(, Some(Tag {
                key: $tag,
                names: methods::names::<$methods>,
                methods: <$methods as Method>::keys,
                usual: $usual,
                meaning: $about,
            }))?),
        },)*]
    };
    (@or $usual:expr) => { $usual };
    (@or $usual:expr, $instead:expr) => { $instead };
}

/// All tables, in the order of the reference.
pub(super) static TABLES: &[TableDoc] = tables! {
    /// At the top of the file.
    "" Form::Top, keys TopKeys;
    /// The substance that quantities with units are of. Beside it, every key that has a unit takes a text such as `"94 K"`,
    /// `"1.374 g/cm3"`, `"10 fs"` or `"40 bar"`; plain numbers stay reduced. Results have both units.
    "units" Form::Once, keys UnitKeys;
    /// How many particles there are and in which box: `n_atoms` with `density` or `box`.
    "system" Form::Once, keys SystemKeys;
    /// Where the particles stand at the start. `slab` is liquid across z with vapor on both sides, and `half-crystal` a crystal across z
    /// beside its liquid. Their keys have defaults, and their box follows from `n_atoms`. The others stand in the box of `[system]`;
    /// `positions` and `file` have a number of particles of their own.
    "start" Form::Once,
        methods StartKeys, "kind" = Usual::Name("lattice"), "How they stand.";
    /// A species of a mixture, at most eight. Without such a table all particles have σ = ε = m = 1. On a lattice the species are mixed
    /// at random, from the seed.
    "species" Form::Many, keys SpeciesKeys;
    /// σ and ε of unlike species. A scene with two species or more must have it.
    "mixing" Form::Once,
        methods CombiningOptions, "rule" = Usual::Words("needed with two species or more"), "Rule for σ and ε of unlike species.";
    /// What one pair of species has in place of the combining rule and of `truncation.r_cut`; each pair at most once.
    "pair" Form::Many, keys PairKeys;
    /// What molecules the particles are bonded to. Without it they are atoms. Densities then count molecules, and energies are per
    /// molecule.
    "molecule" Form::Once, keys MoleculeOptions;
    /// How the bonds of molecules are held.
    "bonds" Form::Once,
        methods BondOptions, "method" = Usual::Name("direct"), "How bonds are held.";
    /// How wrong the results may be. What is not written of `truncation.kind`, `truncation.r_cut`, `truncation.tail_correction`,
    /// `integrator.dt`, `kernel.precision`, `neighbor.mode` and `neighbor.skin` is then chosen by `lennard tune` and kept in a lock
    /// file. At least one of:
    "accuracy" Form::Once, keys Accuracy;
    /// The pair potential.
    "potential" Form::Once,
        methods PotentialOptions, "kind" = Usual::Name("lennard-jones"), "The pair potential U(r).";
    /// How the potential ends.
    "truncation" Form::Once, keys TruncationOptions;
    /// How neighbors are found. Nothing here changes the physics.
    "neighbor" Form::Once, keys NeighborOptions;
    /// Which force loop runs.
    "kernel" Form::Once, keys KernelOptions;
    /// The method that advances time.
    "integrator" Form::Once, keys IntegratorKeys,
        methods IntegratorOptions, "kind" = Usual::Name("velocity-verlet"), "The method.";
    /// Walls at both ends of an axis, at most one pair per axis. The fluid is not periodic along this axis: `density` and `box`
    /// describe the filled part, and the box is longer by the thickness of the walls.
    "wall" Form::Many, keys WallKeys,
        methods WallOptions, "kind" = Usual::NEEDED, "What the walls do to particles.";
    /// Contacts: particles are spheres that push each other apart, or bounce. They add to the pair potential; `potential.kind = "none"`
    /// leaves them alone.
    "contact" Form::Once, keys ContactKeys,
        methods ContactOptions, "kind" = Usual::Name("soft"), "What happens where two bodies touch.";
    /// A constant field, such as gravity.
    "field" Form::Once, keys FieldKeys;
    /// What happens one after the other; at least one. Without a thermostat a stage runs at constant energy.
    "stage" Form::Many, keys StageKeys;
    /// The heat bath with its own keys; a name alone (`thermostat = "bussi"`) takes their defaults.
    "stage.thermostat" Form::Within("`thermostat = { … }` of a stage"),
        methods ThermostatOptions, "kind" = Usual::NEEDED, "The thermostat.";
    /// The pressure bath with its own keys. It needs a thermostat that samples the canonical ensemble.
    "stage.barostat" Form::Within("`barostat = { … }` of a stage"), keys BarostatKeys,
        methods BarostatOptions, "kind" = Usual::NEEDED, "The barostat.";
    /// An exchange of velocities between the first and the middle slab of the box, at constant energy; a name alone
    /// (`exchange = "heat"`) takes the defaults.
    "stage.exchange" Form::Within("`exchange = { … }` of a stage"), keys ExchangeOptions;
    /// A ramp: the temperature of the thermostat changes linearly with the steps.
    "stage.temperature" Form::Within("`temperature = { from, to }` of a stage"), keys TemperatureRamp;
    /// A ramp: the pressure changes linearly with the steps.
    "stage.barostat.pressure" Form::Within("`pressure = { from, to }` of a barostat"), keys PressureRamp;
    /// What is measured in the measured stages, besides the thermodynamics that every run measures. Each kind at most once.
    "observable" Form::Many, keys ObservableKeys,
        methods ObservableOptions, "kind" = Usual::NEEDED, "The observable.";
    /// What is written to the output folder.
    "output" Form::Once, keys Output;
    /// When the whole state is saved.
    "checkpoint" Form::Once, keys Checkpoint;
};
