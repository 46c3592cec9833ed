//! The reference tables that come along, each with where it is from and how it was read.
//!
//! Nothing here is quoted from memory: a number that was not read in its source or in a copy of it is left out. The
//! printed table of Verlet's paper of 1967 was not to be had, and none of its numbers is here.

use serde::{Deserialize, Serialize};

/// How the numbers of a table were obtained.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Status {
    /// Read from the original, or from the authors' own data file.
    Verified,
    /// Read from someone else's copy or quotation.
    Secondary,
}

impl Status {
    /// In words.
    #[must_use]
    pub fn describe(self) -> &'static str {
        match self {
            Self::Verified => "read from the original or the authors' own data",
            Self::Secondary => "read where others quote it",
        }
    }
}

/// A table of reference values.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct ReferenceTable {
    /// Its name.
    pub name: &'static str,
    /// What it holds, for which potential.
    pub summary: &'static str,
    /// Authors, title, year.
    pub source: &'static str,
    /// The DOI of the paper or the data; `None` where there is none, or each row has its own.
    pub doi: Option<&'static str>,
    /// How it was read; where a table mixes both, the weaker one, and each row says its own.
    pub status: Status,
    /// Under which terms it comes along.
    pub licence: &'static str,
    /// The table as CSV, with `#` lines that say what the columns are.
    #[serde(skip)]
    pub csv: &'static str,
}

const MIT_CHAPARRO: &str = "MIT, copyright Gustavo Chaparro and Erich A. Müller";
const CHAPARRO: &str =
    "G. Chaparro, E. A. Müller, J. Phys. Chem. B (2023), database of the authors";
const CHAPARRO_DOI: &str = "10.1021/acs.jpcb.3c06813";
const NIST: &str = "work of the US Government, NIST open licence";
const FACTS: &str = "single values, quoted as facts";

static TABLES: [ReferenceTable; 9] = [
    ReferenceTable {
        name: "shear-viscosity",
        summary: "Shear viscosity of the full potential, with standard deviations.",
        source: CHAPARRO,
        doi: Some(CHAPARRO_DOI),
        status: Status::Verified,
        licence: MIT_CHAPARRO,
        csv: include_str!("../data/chaparro-mueller-2023/shear_viscosity.csv"),
    },
    ReferenceTable {
        name: "self-diffusion",
        summary: "Self-diffusion coefficient of the full potential, with standard deviations; a finite-size correction is not mentioned there.",
        source: CHAPARRO,
        doi: Some(CHAPARRO_DOI),
        status: Status::Verified,
        licence: MIT_CHAPARRO,
        csv: include_str!("../data/chaparro-mueller-2023/self_diffusion.csv"),
    },
    ReferenceTable {
        name: "thermal-conductivity",
        summary: "Thermal conductivity of the full potential, with standard deviations.",
        source: CHAPARRO,
        doi: Some(CHAPARRO_DOI),
        status: Status::Verified,
        licence: MIT_CHAPARRO,
        csv: include_str!("../data/chaparro-mueller-2023/thermal_conductivity.csv"),
    },
    ReferenceTable {
        name: "transport-other",
        summary: "Viscosity and self-diffusion of the full potential near the triple point.",
        source: "K. Meier, A. Laesecke, S. Kabelac, Transport coefficients of the Lennard-Jones model fluid, J. Chem. Phys. 121, 3671 and 9526 (2004)",
        doi: Some("10.1063/1.1770695"),
        status: Status::Secondary,
        licence: FACTS,
        csv: include_str!("../data/transport-other.csv"),
    },
    ReferenceTable {
        name: "monte-carlo-energies",
        summary: "Potential energy of the full potential by Monte Carlo, 500 particles.",
        source: "H. W. Hatch (NIST), dormms data set, commit ef8a117, by FEASST v0.25.1",
        doi: None,
        status: Status::Verified,
        licence: NIST,
        csv: include_str!("../data/nist-dormms-monte-carlo.csv"),
    },
    ReferenceTable {
        name: "coexistence",
        summary: "Liquid and vapor of the full potential in equilibrium, by transition-matrix Monte Carlo.",
        source: "NIST Standard Reference Simulation Website, from NIST's FEASST repository",
        doi: Some("10.18434/T4M88Q"),
        status: Status::Verified,
        licence: NIST,
        csv: include_str!("../data/nist-coexistence.csv"),
    },
    ReferenceTable {
        name: "interfaces",
        summary: "Surface tension, coexisting densities and vapor pressure of the potential truncated at 2.5 σ and shifted.",
        source: "J. Vrabec, G. K. Kedia, G. Fuchs, H. Hasse, Comprehensive study of the vapour-liquid coexistence of the truncated and shifted Lennard-Jones fluid including planar and spherical interface properties (2006)",
        doi: Some("10.1080/00268970600556774"),
        status: Status::Secondary,
        licence: FACTS,
        csv: include_str!("../data/vrabec-2006-interfaces.csv"),
    },
    ReferenceTable {
        name: "critical-and-triple-points",
        summary: "Critical and triple points of the full potential and of two truncated ones.",
        source: "several papers, each named with its DOI in its row",
        doi: None,
        status: Status::Secondary,
        licence: FACTS,
        csv: include_str!("../data/critical-and-triple-points.csv"),
    },
    ReferenceTable {
        name: "kob-andersen",
        summary: "Energy, virial, pressure, fluctuations, structure and diffusion of the Kob-Andersen mixture and its neighbors, cut and shifted at 2.5 σ_ab.",
        source: "U. R. Pedersen, T. B. Schrøder, J. C. Dyre, Phys. Rev. Lett. 120, 165501 (2018), data of the authors; runs that the gamdpy repository has",
        doi: Some("10.5281/zenodo.10047547"),
        status: Status::Verified,
        licence: FACTS,
        csv: include_str!("../data/kob-andersen.csv"),
    },
];

/// All tables that come along.
#[must_use]
pub fn reference_tables() -> &'static [ReferenceTable] {
    &TABLES
}

/// The table of a name.
#[must_use]
pub fn reference_table(name: &str) -> Option<&'static ReferenceTable> {
    TABLES.iter().find(|t| t.name == name)
}

/// The rows of a table that comes along.
pub(crate) fn rows<T: for<'a> Deserialize<'a>>(name: &str) -> Vec<T> {
    let text = reference_table(name).map_or("", |table| table.csv);
    csv::ReaderBuilder::new()
        .comment(Some(b'#'))
        .from_reader(text.as_bytes())
        .deserialize()
        .collect::<Result<_, _>>()
        .expect("the shipped tables are well formed: a test reads them")
}
