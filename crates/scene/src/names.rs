//! Names that are nearly right, and names of what is not there yet.

/// The known name nearest to a mistyped one, where it is near enough to be meant.
pub(crate) fn nearest<'a>(found: &str, known: impl Iterator<Item = &'a str>) -> Option<String> {
    /// Similarity from which a name counts as meant: `n_atom`, `temprature` and `rfd` pass, names that
    /// have nothing in common do not.
    const NEAR_ENOUGH: f64 = 0.75;
    /// One slip in three letters (`rfd`) is as near as that.
    const SLIPS_WEIGH: f64 = NEAR_ENOUGH * 1.5;
    let found = found.to_lowercase().replace('-', "_");
    known
        .map(|name| {
            let plain = name.to_lowercase().replace('-', "_");
            let slips = SLIPS_WEIGH * strsim::normalized_damerau_levenshtein(&found, &plain);
            (strsim::jaro_winkler(&found, &plain).max(slips), name)
        })
        .filter(|(similarity, _)| *similarity >= NEAR_ENOUGH)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, name)| name.to_owned())
}

/// A feature that people look for and that is not there yet: words that name it, and what to call it.
struct Planned {
    words: &'static [&'static str],
    feature: &'static str,
}

const PLANNED: &[Planned] = &[
    Planned {
        words: &[
            "barostat",
            "pressure_control",
            "npt",
            "parrinello_rahman",
            "berendsen_barostat",
        ],
        feature: "barostats are",
    },
    Planned {
        words: &[
            "species",
            "mixture",
            "mixing",
            "component",
            "components",
            "mixing_rule",
        ],
        feature: "mixtures of several species are",
    },
    Planned {
        words: &["triclinic", "tilt", "angles", "cell_vectors"],
        feature: "triclinic boxes are",
    },
    Planned {
        words: &["constraint", "constraints"],
        feature: "constraints other than the bonds of `[molecule]` are",
    },
    Planned {
        words: &["charge", "charges", "coulomb", "ewald", "pme"],
        feature: "electric charges are",
    },
];

/// What a name stands for that is not there yet: "barostats are not available yet".
pub(crate) fn not_yet(name: &str) -> Option<String> {
    let name = name.to_lowercase().replace('-', "_");
    PLANNED
        .iter()
        .find(|planned| planned.words.contains(&name.as_str()))
        .map(|planned| format!("{} not available yet", planned.feature))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slips_of_the_pen_are_recognised_and_other_words_are_not() {
        let known = [
            "n_atoms",
            "temperature",
            "seed",
            "density",
            "rdf",
            "msd",
            "velocity-verlet",
        ];
        let meant = |found| nearest(found, known.into_iter());
        assert_eq!(meant("n_atom").as_deref(), Some("n_atoms"));
        assert_eq!(meant("temprature").as_deref(), Some("temperature"));
        assert_eq!(meant("N-Atoms").as_deref(), Some("n_atoms"));
        assert_eq!(meant("rfd").as_deref(), Some("rdf"));
        assert_eq!(meant("velocity_verlet").as_deref(), Some("velocity-verlet"));
        for other in ["", "x", "pressure", "wavelet", "фыва"] {
            assert_eq!(meant(other), None, "{other}");
        }
    }
}
