//! Potential and truncation as pair styles.

use lennard_forcefield::{PotentialOptions, SpeciesPair, TruncationKind};
use lennard_scene::Scene;

use super::script::Script;
use lennard_engine::EngineError;

/// Where the WCA potential ends, in σ_ab: 2^(1/6).
const END_OF_WCA: f64 = 1.122_462_048_309_373;

/// A pair style with what `pair_modify` says beside it.
struct Style {
    name: &'static str,
    /// Whether energies are shifted to end at zero; `None` for a style that does so by itself.
    shift: Option<bool>,
    /// Coefficients behind ε and σ.
    exponents: Option<[u32; 2]>,
    /// The cutoff of a pair.
    cutoff: fn(&SpeciesPair) -> f64,
}

/// Writes the pair style and the coefficients of each pair of species.
pub(super) fn write(script: &mut Script, scene: &Scene) -> Result<(), EngineError> {
    let style = style(scene)?;
    let pairs: Vec<([usize; 2], SpeciesPair)> =
        scene.species_pairs().map(|[a, b]| ([a, b], scene.species_pair(a, b))).collect();
    let longest = pairs.iter().map(|(_, pair)| (style.cutoff)(pair));
    let longest = longest.fold(0.0, f64::max);
    script.command("pair_style", format!("{} {longest:?}", style.name));
    if let Some(shift) = style.shift {
        let word = |on| if on { "yes" } else { "no" };
        // LAMMPS refuses both; a potential that ends by itself has no tail.
        let tail = word(scene.truncation.tail_correction && !shift);
        script.command("pair_modify", format!("shift {} tail {tail}", word(shift)));
    }
    for ([a, b], pair) in pairs {
        let exponents = style.exponents.map(|[n, m]| format!(" {n} {m}"));
        let arguments = format!(
            "{} {} {:?} {:?}{} {:?}",
            a + 1,
            b + 1,
            pair.epsilon,
            pair.sigma,
            exponents.unwrap_or_default(),
            (style.cutoff)(&pair)
        );
        script.command("pair_coeff", arguments);
    }
    Ok(())
}

fn style(scene: &Scene) -> Result<Style, EngineError> {
    let own = |pair: &SpeciesPair| pair.r_cut;
    let shift = match scene.truncation.kind {
        TruncationKind::Cut => Some(false),
        TruncationKind::Shift => Some(true),
        _ => None,
    };
    let style = match (&scene.potential, shift) {
        (PotentialOptions::LennardJones(_), Some(_)) => {
            Style { name: "lj/cut", shift, exponents: None, cutoff: own }
        }
        (PotentialOptions::Mie(mie), Some(_)) => Style {
            name: "mie/cut",
            shift,
            exponents: Some([mie.repulsive, mie.attractive]),
            cutoff: own,
        },
        (PotentialOptions::LennardJones(_), None)
            if scene.truncation.kind == TruncationKind::ForceShift =>
        {
            Style { name: "lj/smooth/linear", shift: None, exponents: None, cutoff: own }
        }
        (PotentialOptions::Wca(_), _) => Style {
            name: "lj/cut",
            shift: Some(true),
            exponents: None,
            cutoff: |pair| END_OF_WCA * pair.sigma,
        },
        (PotentialOptions::LennardJones(_) | PotentialOptions::Mie(_), None) => {
            let kind = scene.truncation.kind.name();
            let potential = scene.potential.spec().name;
            let found =
                format!("{kind:?} of the potential {potential:?}, which LAMMPS does not have");
            let allowed = "\"cut\" or \"shift\"; for \"lennard-jones\" also \"force-shift\"";
            return Err(scene.source.invalid("truncation.kind", found, allowed).into());
        }
        (other, _) => {
            let found = format!("{:?}, in an export to LAMMPS", other.spec().name);
            let allowed = "\"lennard-jones\", \"mie\" or \"wca\"";
            return Err(scene.source.invalid("potential.kind", found, allowed).into());
        }
    };
    Ok(style)
}
