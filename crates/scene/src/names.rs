//! Names that are nearly right, and names of what is not there yet.

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
struct LeftOut {
    words: &'static [&'static str],
    why: &'static str,
}

/// Words that mean the same wherever they stand.
const ANYWHERE: &[LeftOut] = &[
    LeftOut {
        words: &["triclinic", "tilt", "angles", "cell_vectors"],
        why: "triclinic boxes are not available yet",
    },
    LeftOut {
        words: &["constraint", "constraints"],
        why: "constraints other than the bonds of `[molecule]` are not available yet",
    },
    LeftOut {
        words: &["charge", "charges", "coulomb", "ewald", "pme"],
        why: "electric charges are not available yet",
    },
    LeftOut {
        words: &["barostat", "pressure_control", "pressure_coupling", "npt"],
        why: "a barostat belongs to a stage, as `barostat = { kind, pressure }`",
    },
    LeftOut {
        words: &["thermostat", "temperature_control", "nvt"],
        why: "a thermostat belongs to a stage, as `thermostat = \"bussi\"` beside `temperature`",
    },
    LeftOut {
        words: &["nve", "microcanonical"],
        why: "a stage without `thermostat` and `barostat` runs at constant energy",
    },
    LeftOut {
        words: &["ensemble"],
        why: "a stage runs at constant energy; `thermostat` makes it NVT, and `barostat` beside that NPT",
    },
    LeftOut {
        words: &["hcp", "hexagonal", "diamond"],
        why: "take `lattice = \"fcc\"`, which is as dense as hcp",
    },
    LeftOut { words: &["rho", "number_density"], why: "its name here is `density`, in `[system]`" },
    LeftOut {
        words: &["dump", "nstxout", "dcdfreq"],
        why: "`trajectory_every` in `[output]` asks for frames",
    },
    LeftOut {
        words: &["thermo", "thermo_style", "nstenergy", "nstlog"],
        why: "`thermo_every` in `[output]` asks for rows of T, U and P; every run has their means",
    },
    LeftOut {
        words: &["cutoff", "cut_off", "rcut", "rc", "rvdw"],
        why: "its name here is `r_cut`, in `[truncation]`",
    },
    LeftOut {
        words: &["lj", "lj/cut", "pair_style", "pair_coeff"],
        why: "`[potential]` with `kind = \"lennard-jones\"`, the default, and `[truncation]` have it",
    },
    LeftOut { words: &["timestep", "time_step"], why: "its name here is `dt`, in `[integrator]`" },
    LeftOut {
        words: &["nsteps", "n_steps", "run"],
        why: "its name here is `steps`, in `[[stage]]`",
    },
    LeftOut { words: &["none", "off"], why: "what is not wanted is left out of the scene" },
];

const LATTICES_LEFT_OUT: &[LeftOut] = &[LeftOut {
    words: &["none", "file"],
    why: "take `random`, or in its place `positions` or the file of a `configuration`",
}];

const TRUNCATIONS_LEFT_OUT: &[LeftOut] = &[
    LeftOut {
        words: &["none", "full"],
        why: "take `cut` with its tail correction, which stands for the full potential",
    },
    LeftOut {
        words: &["cutoff", "truncated", "plain"],
        why: "its name here is `cut`, and the distance is `r_cut`",
    },
];

const LISTS_LEFT_OUT: &[LeftOut] =
    &[LeftOut { words: &["none", "off", "all_pairs"], why: "its name here is `direct`" }];

const FORMATS_LEFT_OUT: &[LeftOut] = &[
    LeftOut { words: &["none", "off"], why: "without `trajectory_every` there is no trajectory" },
    LeftOut {
        words: &["dump", "lammpstrj", "lammps", "atom"],
        why: "its name here is `lammps-dump`",
    },
];

const THERMOSTATS_LEFT_OUT: &[LeftOut] = &[
    LeftOut {
        words: &["andersen"],
        why: "it samples as `langevin` does, and disturbs the motion as much: take `langevin`",
    },
    LeftOut {
        words: &["berendsen", "weak_coupling"],
        why: "it samples no known ensemble: take `bussi`, which is as quick and canonical",
    },
    LeftOut {
        words: &["isokinetic", "gaussian", "velocity_scaling"],
        why: "it fixes the kinetic energy: take `bussi` to sample, `rescale` to equilibrate",
    },
    LeftOut {
        words: &["csvr", "v_rescale", "stochastic_velocity_rescaling"],
        why: "its name here is `bussi`",
    },
    LeftOut {
        words: &["nhc", "nose", "nose_hoover_chain", "nose_hoover_chains"],
        why: "its name here is `nose-hoover`",
    },
];

const INTEGRATORS_LEFT_OUT: &[LeftOut] = &[
    LeftOut {
        words: &["verlet", "vv", "md", "nve", "none"],
        why: "take `velocity-verlet`, or `stormer-verlet` for the form in positions alone",
    },
    LeftOut {
        words: &["runge_kutta", "rk4", "gear"],
        why: "its energy drifts: take `velocity-verlet`, or `blanes-moan` where steps must be exact",
    },
];

const POTENTIALS_LEFT_OUT: &[LeftOut] = &[
    LeftOut { words: &["lj", "lj/cut", "lj126", "12_6"], why: "its name here is `lennard-jones`" },
    LeftOut {
        words: &["morse", "buckingham", "yukawa", "exp_6"],
        why: "take `table`, with U and F at a list of distances",
    },
];

const BONDS_LEFT_OUT: &[LeftOut] = &[
    LeftOut {
        words: &["shake", "gauss_seidel"],
        why: "its name here is `relaxation`; `direct` solves the same equations exactly",
    },
    LeftOut {
        words: &["rattle", "newton", "ilves", "m_shake"],
        why: "its name here is `direct`, whose velocity stage is part of `velocity-verlet`",
    },
    LeftOut {
        words: &["lincs", "p_lincs", "plincs", "ccma"],
        why: "it expands an inverse in a series: take `direct`, which solves exactly for molecules of up to 64 sites",
    },
    LeftOut {
        words: &["settle"],
        why: "take `direct`, which solves triangles by formulas too: kind = \"sites\" with three bonds",
    },
    LeftOut {
        words: &["harmonic", "fene", "springs", "elastic"],
        why: "take `spring`, U = ½k(|d| − r)²",
    },
    LeftOut { words: &["rigid", "constraint", "constraints"], why: "take `direct`" },
];

const BAROSTATS_LEFT_OUT: &[LeftOut] = &[
    LeftOut {
        words: &["berendsen", "weak_coupling"],
        why: "it samples no known ensemble: take `stochastic-cell-rescaling`, which is as quick and exact",
    },
    LeftOut {
        words: &["parrinello_rahman"],
        why: "boxes here stay orthorhombic: take `stochastic-cell-rescaling` with `coupling = \"xy-z\"`",
    },
    LeftOut {
        words: &["monte_carlo", "mc"],
        why: "it does not use the virial: take `stochastic-cell-rescaling`, whose moves have a Metropolis test too",
    },
    LeftOut {
        words: &["langevin_piston", "andersen", "nose_hoover", "mttk", "martyna_tobias_klein"],
        why: "take `mtk`, or `stochastic-cell-rescaling`",
    },
    LeftOut {
        words: &["c_rescale", "crescale", "scr", "bernetti_bussi"],
        why: "its name here is `stochastic-cell-rescaling`",
    },
];

const CONTACTS_LEFT_OUT: &[LeftOut] = &[
    LeftOut {
        words: &["unilateral", "lcp", "complementarity", "constraint"],
        why: "its name here is `spook`",
    },
    LeftOut {
        words: &["penalty", "spring", "linear", "hertz", "hooke"],
        why: "its name here is `soft`, with `law = \"linear\"` or `\"hertz\"`",
    },
    LeftOut {
        words: &["event", "elastic", "inelastic", "billiard", "impact"],
        why: "its name here is `hard`, with a `restitution`",
    },
];

const MIXING_LEFT_OUT: &[LeftOut] = &[
    LeftOut {
        words: &["arithmetic", "lorentz", "berthelot", "lb"],
        why: "its name here is `lorentz-berthelot`",
    },
    LeftOut { words: &["sixthpower", "sixth_power"], why: "its name here is `waldman-hagler`" },
    LeftOut { words: &["good_hope", "jorgensen", "opls"], why: "its name here is `geometric`" },
    LeftOut {
        words: &["kong", "tang_toennies", "hogervorst", "custom", "manual"],
        why: "take `explicit`, with σ and ε of each pair in a table `[[pair]]`",
    },
];

/// What a word of other programs stands for, where it stands for the value or the name of a key.
pub(crate) fn left_out(key: &str, word: &str) -> Option<&'static str> {
    let list = if key.contains("integrator") {
        INTEGRATORS_LEFT_OUT
    } else if key.starts_with("potential") {
        POTENTIALS_LEFT_OUT
    } else if key.contains("thermostat") {
        THERMOSTATS_LEFT_OUT
    } else if key.contains("barostat") {
        BAROSTATS_LEFT_OUT
    } else if key.starts_with("bonds") {
        BONDS_LEFT_OUT
    } else if key.starts_with("contact") {
        CONTACTS_LEFT_OUT
    } else if key.starts_with("mixing") {
        MIXING_LEFT_OUT
    } else if key.contains("lattice") {
        LATTICES_LEFT_OUT
    } else if key.starts_with("truncation") {
        TRUNCATIONS_LEFT_OUT
    } else if key.starts_with("neighbor") {
        LISTS_LEFT_OUT
    } else if key.starts_with("output") {
        FORMATS_LEFT_OUT
    } else {
        &[]
    };
    let word = word.to_lowercase().replace(['-', ' '], "_");
    let mut all = list.iter().chain(ANYWHERE);
    let found = all.find(|one| one.words.contains(&word.as_str()));
    found.map(|one| one.why)
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
        let lattice = |name| left_out("system.lattice", name).unwrap_or_default();
        assert!(lattice("hcp").contains("fcc") && lattice("none").contains("random"));
        let words = ["nvt", "npt", "nve", "hcp", "rho", "dump", "none", "lj", "thermo", "cutoff"];
        for word in words {
            for key in [
                "",
                "system.lattice",
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
