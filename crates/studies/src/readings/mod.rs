//! What is read from the points of a study: each reading is one file with one function, and one entry here.

mod agreement;
mod arrhenius;
mod blocks;
mod coexistence;
mod coverage;
mod ensemble;
mod melting;
mod points;
mod properties;

pub use crate::sweep::StudyPoints;
pub use blocks::Blocks;
pub(crate) use blocks::{OPEN, SHARED_SECTIONS};

/// A way to read the points of a study.
#[derive(Debug)]
pub struct Reading {
    /// Its name in a study file.
    pub name: &'static str,
    /// What it shows, and of what.
    pub about: &'static str,
    /// Keys that must change from point to point, each with the fewest values.
    pub needs: &'static [(&'static str, usize)],
    /// The files that it writes beside the page.
    pub files: &'static [&'static str],
    /// Whether it is made where a study names no reading and the points have what it shows.
    pub is_usual: bool,
    /// Reads the points; nothing where they have not got what it shows.
    pub read: fn(&StudyPoints<'_>) -> Blocks,
}

/// Every reading, in the order of a page.
pub const READINGS: [Reading; 8] = [
    Reading {
        name: "isotherms",
        about: "pressure against density, for each temperature with three densities or more",
        needs: &[("density", 3)],
        files: &["pressure.svg"],
        is_usual: true,
        read: properties::isotherms,
    },
    Reading {
        name: "coexistence",
        about: "vapor and liquid against temperature with their critical point, of slabs at two temperatures or more",
        needs: &[("temperature", 2)],
        files: &["coexistence.svg", "vapor_pressure.svg", "surface_tension.svg"],
        is_usual: true,
        read: coexistence::read,
    },
    Reading {
        name: "arrhenius",
        about: "diffusion against the inverse temperature with its activation energy, at three temperatures or more",
        needs: &[("temperature", 3)],
        files: &["arrhenius.svg"],
        is_usual: true,
        read: arrhenius::read,
    },
    Reading {
        name: "melting",
        about: "the temperature at which neither phase grows, of crystals beside their liquid at two temperatures or more",
        needs: &[("temperature", 2)],
        files: &["melting.svg"],
        is_usual: true,
        read: melting::read,
    },
    Reading {
        name: "literature",
        about: "all points together beside the equations of state",
        needs: &[],
        files: &["equations.csv", "beside_equations.csv"],
        is_usual: true,
        read: agreement::read,
    },
    Reading {
        name: "table",
        about: "every point with its results, and each result against the key with the most values",
        needs: &[],
        files: &[],
        is_usual: true,
        read: points::read,
    },
    Reading {
        name: "ensemble",
        about: "what barostats and thermostats sample of the volume, at which pace and cost",
        needs: &[],
        files: &["ensemble.csv", "compressibility.svg", "pace.svg"],
        is_usual: false,
        read: ensemble::read,
    },
    Reading {
        name: "coverage",
        about: "how often the long-run mean lies within the printed errors, of five seeds or more",
        needs: &[("seed", 5)],
        files: &["coverage_quantities.csv", "coverage_states.csv", "coverage_cells.csv"],
        is_usual: false,
        read: coverage::read,
    },
];

/// The readings of these names; those that are usual where there are no names.
pub(crate) fn chosen(names: &[String]) -> Vec<&'static Reading> {
    let is_chosen = |reading: &&Reading| match names.is_empty() {
        true => reading.is_usual,
        false => names.iter().any(|name| name == reading.name),
    };
    READINGS.iter().filter(is_chosen).collect()
}
