//! Names that are nearly right, and words of other programs (`words.toml`).

use std::sync::LazyLock;

use serde::Deserialize;

/// The known name nearest to a mistyped one, where it is near enough to be meant.
#[must_use]
pub fn nearest<'a>(found: &str, known: impl Iterator<Item = &'a str>) -> Option<String> {
    /// Similarity from which a name counts as meant: `n_atom`, `temprature` and `rfd` pass, names that
    /// have nothing in common do not.
    const NEAR_ENOUGH: f64 = 0.75;
    /// One slip in three letters (`rfd`) is as near as that.
    const SLIPS_WEIGH: f64 = NEAR_ENOUGH * 1.5;
    let found = found.to_lowercase().replace('-', "_");
    known
        .map(|name| {
            let plain = name.to_lowercase().replace('-', "_");
            let slips = |known| strsim::normalized_damerau_levenshtein(&found, known);
            let whole = strsim::jaro_winkler(&found, &plain).max(SLIPS_WEIGH * slips(&plain));
            // `densty` may mean `crystal_density`.
            let last = plain.rsplit('_').next().unwrap_or_default();
            (whole.max(slips(last)), name)
        })
        .filter(|(similarity, _)| *similarity >= NEAR_ENOUGH)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, name)| name.to_owned())
}

/// A word of other programs: what stands for it here, or why nothing does.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Word {
    /// The table or the key whose value it may be; `None` where it means the same anywhere.
    place: Option<String>,
    words: Vec<String>,
    why: String,
}

#[derive(Deserialize)]
struct Words {
    word: Vec<Word>,
}

/// The words of `words.toml`.
static WORDS: LazyLock<Vec<Word>> = LazyLock::new(|| {
    let list = toml::from_str::<Words>(include_str!("../words.toml"));
    list.expect("a list of words").word
});

/// What a word of other programs stands for, where it stands for the value or the name of a key.
pub(crate) fn left_out(key: &str, word: &str) -> Option<&'static str> {
    let found = word.to_lowercase().replace(['-', ' '], "_");
    let of_place = |place: &str| key.split('.').any(|part| part == place);
    let here = WORDS.iter().filter(|word| word.place.as_deref().is_some_and(of_place));
    let anywhere = WORDS.iter().filter(|word| word.place.is_none());
    let mut all = here.chain(anywhere).filter(|word| word.words.contains(&found));
    all.next().map(|word| word.why.as_str())
}

/// What a word of other programs stands for, where a key or a table has its name.
pub(crate) fn no_key(word: &str) -> Option<&'static str> {
    left_out("", word)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slips_of_the_pen_are_recognised_and_other_words_are_not() {
        let known = ["n_atoms", "temperature", "seed", "density", "rdf", "msd", "velocity-verlet"];
        let meant = |found| nearest(found, known.into_iter());
        assert_eq!(meant("n_atom").as_deref(), Some("n_atoms"));
        assert_eq!(meant("temprature").as_deref(), Some("temperature"));
        assert_eq!(meant("N-Atoms").as_deref(), Some("n_atoms"));
        assert_eq!(meant("rfd").as_deref(), Some("rdf"));
        assert_eq!(meant("velocity_verlet").as_deref(), Some("velocity-verlet"));
        assert_eq!(meant("atms").as_deref(), Some("n_atoms"));
        let rule = |name| left_out("mixing.rule", name).unwrap_or_default();
        let method = |name| left_out("integrator.kind", name).unwrap_or_default();
        assert!(method("Verlet").contains("velocity-verlet"));
        let potential = |name| left_out("potential.kind", name).unwrap_or_default();
        assert!(potential("LJ/cut").contains("lennard-jones"));
        assert!(potential("Morse").contains("table"));
        assert!(method("RK4").contains("drifts"));
        assert!(rule("sixthpower").contains("waldman-hagler"));
        assert!(rule("Lorentz").contains("lorentz-berthelot"));
        assert!(rule("kong").contains("explicit"));
        let start = |name| left_out("start.kind", name).unwrap_or_default();
        assert!(start("hcp").contains("fcc") && start("none").contains("random"));
        let words = ["nvt", "npt", "nve", "hcp", "rho", "dump", "none", "lj", "thermo", "cutoff"];
        for word in words {
            for key in [
                "",
                "start.lattice",
                "truncation.kind",
                "output.format",
                "observable.0.kind",
                "stage.0.barostat",
            ] {
                assert!(left_out(key, word).is_some(), "{word} as {key}");
            }
        }
        for other in ["", "x", "pressure", "wavelet", "фыва"] {
            assert_eq!(meant(other), None, "{other}");
        }
    }
}
