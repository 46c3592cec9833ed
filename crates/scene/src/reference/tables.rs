//! Every table of a scene file, with what it is for.

/// A table of a scene file.
#[derive(Debug, Clone, Copy)]
pub struct TableDoc {
    /// Its name; empty for the keys outside all tables.
    pub table: &'static str,
    /// How it is written.
    pub heading: &'static str,
    /// What it is for.
    pub meaning: &'static str,
}

/// All tables, in the order of the reference.
pub(super) static TABLES: &[TableDoc] = &[
    TableDoc {
        table: "",
        heading: "Outside all tables",
        meaning: "At the top of the file.",
    },
    TableDoc {
        table: "system",
        heading: "`[system]`",
        meaning: "Where the particles start: on a lattice or at random (`n_atoms` with `density` or `box`). \
                  The other ways are `positions` in a `box`, and a `configuration` file.",
    },
    TableDoc {
        table: "slab",
        heading: "`[slab]`",
        meaning: "A start with a slab of liquid across z, and vapor on both sides. The cross-section is a square, and its side follows from \
                  `n_atoms`. An empty table takes every default.",
    },
    TableDoc {
        table: "species",
        heading: "`[[species]]`",
        meaning: "A species of a mixture, at most eight. Without such a table all particles have σ = ε = m = 1. \
                  On a lattice the species are mixed at random, from the seed.",
    },
    TableDoc {
        table: "mixing",
        heading: "`[mixing]`",
        meaning: "σ and ε of unlike species. A scene with two species or more must have it.",
    },
    TableDoc {
        table: "pair",
        heading: "`[[pair]]`",
        meaning: "What one pair of species has in place of the combining rule and of `truncation.r_cut`; each pair at most once.",
    },
    TableDoc {
        table: "molecule",
        heading: "`[molecule]`",
        meaning: "What molecules the particles are bonded to. Without it they are atoms. Densities then count molecules, and \
                  energies are per molecule.",
    },
    TableDoc {
        table: "bonds",
        heading: "`[bonds]`",
        meaning: "How the bonds of molecules are held.",
    },
    TableDoc {
        table: "accuracy",
        heading: "`[accuracy]`",
        meaning: "How wrong the results may be. What is not written of `truncation.kind`, `truncation.r_cut`, \
                  `truncation.tail_correction`, `integrator.dt`, `kernel.precision`, `neighbor.mode` and `neighbor.skin` \
                  is then chosen by `lennard tune` and kept in a lock file. At least one of:",
    },
    TableDoc {
        table: "potential",
        heading: "`[potential]`",
        meaning: "The pair potential.",
    },
    TableDoc {
        table: "truncation",
        heading: "`[truncation]`",
        meaning: "How the potential ends.",
    },
    TableDoc {
        table: "neighbor",
        heading: "`[neighbor]`",
        meaning: "How neighbors are found. Nothing here changes the physics.",
    },
    TableDoc {
        table: "kernel",
        heading: "`[kernel]`",
        meaning: "Which force loop runs.",
    },
    TableDoc {
        table: "integrator",
        heading: "`[integrator]`",
        meaning: "The method that advances time.",
    },
    TableDoc {
        table: "wall",
        heading: "`[[wall]]`",
        meaning: "Walls at both ends of an axis, at most one pair per axis. The fluid is not periodic along this axis: \
                  `density` and `box` describe the filled part, and the box is longer by the thickness of the walls.",
    },
    TableDoc {
        table: "contact",
        heading: "`[contact]`",
        meaning: "Contacts: particles are spheres that push each other apart, or bounce. They add to the pair potential; \
                  `potential.kind = \"none\"` leaves them alone.",
    },
    TableDoc {
        table: "field",
        heading: "`[field]`",
        meaning: "A constant field, such as gravity.",
    },
    TableDoc {
        table: "stage",
        heading: "`[[stage]]`",
        meaning: "What happens one after the other; at least one. Without a thermostat a stage runs at constant energy.",
    },
    TableDoc {
        table: "stage.thermostat",
        heading: "`thermostat = { … }` of a stage",
        meaning: "The heat bath with its own keys; a name alone (`thermostat = \"bussi\"`) takes their defaults.",
    },
    TableDoc {
        table: "stage.barostat",
        heading: "`barostat = { … }` of a stage",
        meaning: "The pressure bath with its own keys. It needs a thermostat that samples the canonical ensemble.",
    },
    TableDoc {
        table: "stage.exchange",
        heading: "`exchange = { … }` of a stage",
        meaning: "An exchange of velocities between the first and the middle slab of the box, at constant energy; a name alone \
                  (`exchange = \"heat\"`) takes the defaults.",
    },
    TableDoc {
        table: "stage.temperature",
        heading: "`temperature = { from, to }` of a stage",
        meaning: "A ramp: the temperature of the thermostat changes linearly with the steps.",
    },
    TableDoc {
        table: "stage.barostat.pressure",
        heading: "`pressure = { from, to }` of a barostat",
        meaning: "A ramp: the pressure changes linearly with the steps.",
    },
    TableDoc {
        table: "observable",
        heading: "`[[observable]]`",
        meaning: "What is measured in the measured stages, besides the thermodynamics that every run measures. \
                  Each kind at most once.",
    },
    TableDoc {
        table: "output",
        heading: "`[output]`",
        meaning: "What is written to the output folder.",
    },
    TableDoc {
        table: "checkpoint",
        heading: "`[checkpoint]`",
        meaning: "When the whole state is saved.",
    },
];
