//! The choice of loop and list: from the scene, never from a clock.

use std::sync::Arc;

use lennard_core::PeriodicBox;
use lennard_core::number::short;
use lennard_neighbor::skin::{SkinInputs, cheapest_skin};
use serde::Serialize;

use crate::error::{ForceFieldError, LARGEST_N};
use crate::interaction::{NearPart, NoRows, Pairwise};
use crate::listed::Loop;
use crate::options::{ForceFieldOptions, Kernel, ListMode, Precision};
use crate::pair::{Laws, Mixture, Model, as_one_fluid};
use crate::simd::Level;

/// Up to this many particles, all pairs cost no more than a list.
///
/// At 32 particles a step takes 5.0 µs by all pairs and 2.2 µs by a list. At 108 particles it takes 94 and 7 µs
/// (supercritical fluid, one thread; benches/NOTES.md).
const DIRECT_UP_TO: usize = 16;
/// A list with a thinner skin than this, σ, is built again at almost every step.
const USELESS_SKIN: f64 = 0.05;
/// Up to this many particles, all pairs are better than a list with a useless skin.
const DIRECT_OVER_USELESS_SKIN: usize = 32;
/// The share of half the box side by which r_cut must stay below it, for loops that need one nearest image.
///
/// At exactly half the side, two images of one particle are equally near.
pub const TIE_MARGIN: f64 = 1e-9;
/// Cost of a list build over cost of a force loop in double precision.
///
/// It is about 3 where nothing else uses the caches. Steps cost the same with any value from there to this one, which
/// keeps builds below a fifth of a step (`benches/NOTES.md`).
const BUILD_OVER_FORCE: f64 = 5.0;
/// The same ratio for cluster lists in mixed precision.
///
/// A neighbor of one member is listed for all four, near or not. A loop over these lists therefore grows less with the
/// skin than the model says. Steps take no longer with skins a quarter thicker, and 2 to 8 % less in large systems.
const BUILD_OVER_CLUSTER_FORCE: f64 = 6.5;
/// Fewer particles per thread than this cost more in waiting than they save.
const ATOMS_PER_THREAD: usize = 400;

/// The conditions that forces are planned for: box, particles, and the motion that the list must last through.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Conditions<'a> {
    /// The periodic box.
    pub cell: PeriodicBox,
    /// Number of particles.
    pub n_atoms: usize,
    /// The highest temperature of the run, ε/k_B.
    pub temperature: f64,
    /// The time step, τ.
    pub dt: f64,
    /// The species of the particles, where there are several.
    pub mixture: Option<&'a Mixture>,
}

/// The search for pairs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Search {
    /// None: the scene has no pair potential.
    Nothing,
    /// All pairs, by the serial reference loop.
    Reference,
    /// All pairs.
    Direct,
    /// A Verlet list over a cell grid.
    Verlet,
}

/// The decisions, for `plan` and for the run record.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ForcePlan {
    /// The model in words.
    pub model: String,
    /// The search for pairs.
    pub search: Search,
    /// The reason in words.
    pub reason: String,
    /// The cutoff in force, σ.
    pub r_cut: f64,
    /// The skin, σ; 0 where there is no list.
    pub skin: f64,
    /// The list radius r_cut + skin, σ; the cutoff where there is no list.
    pub r_list: f64,
    /// The loop: `reference`, `direct`, `rows`, `cluster` or `canonical`.
    pub kernel: &'static str,
    /// The instruction set of the loop: `avx512`, `avx2` or `portable`.
    pub isa: &'static str,
    /// The precision of pairs: `double` or `mixed`.
    pub precision: Precision,
    /// What a user must know of it: mixed precision was asked for, and the box is too wide.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub remark: Option<String>,
    /// Threads worth using for this many particles.
    pub recommended_threads: usize,
}

/// The number of threads worth using for `n_atoms` particles, at most `available`.
///
/// A pure function of its arguments; the bits of a run do not depend on it.
#[must_use]
pub fn recommended_threads(n_atoms: usize, available: usize) -> usize {
    (n_atoms / ATOMS_PER_THREAD).clamp(1, available.max(1))
}

/// The decisions as [`crate::provider`] needs them.
#[derive(Debug)]
pub(crate) struct Decision {
    /// The whole force.
    pub whole: Pairwise,
    /// The near part, where the force is split.
    pub near: Option<Pairwise>,
    pub level: Level,
    /// The loop that a list serves, where there is one.
    pub listed: Loop,
    pub plan: ForcePlan,
}

pub(crate) fn decide(
    o: &ForceFieldOptions,
    c: &Conditions<'_>,
) -> Result<Decision, ForceFieldError> {
    let (model, laws) = interaction(o, c.mixture)?;
    if c.n_atoms == 0 {
        return Err(ForceFieldError::NoParticles);
    }
    if c.n_atoms > LARGEST_N {
        return Err(ForceFieldError::TooManyParticles(c.n_atoms));
    }
    if let Some(found) = c.mixture.map(Mixture::n_atoms).filter(|n| *n != c.n_atoms) {
        return Err(ForceFieldError::OtherParticles { found, n_atoms: c.n_atoms });
    }
    let r_cut = model.r_cut;
    let largest = c.cell.largest_cutoff();
    if r_cut > largest {
        return Err(ForceFieldError::CutoffOverHalfBox { r_cut, largest });
    }
    let wanted = o.kernel.isa;
    let level = Level::choose(wanted).ok_or(ForceFieldError::IsaNotAvailable(wanted.name()))?;
    // Beyond the smallest cutoff, the near part of a pair would end with a jump.
    if r_cut > 0.0 {
        check_split(o, laws.as_ref().map_or(r_cut, |laws| laws.cutoffs().fold(r_cut, f64::min)))?;
    }
    let tie = largest - r_cut < TIE_MARGIN * largest;
    let widest = c.cell.lengths().max_element();
    let is_mixed = o.kernel.precision == Precision::Mixed;
    let in_double = is_mixed.then(|| only_in_double(widest, level)).flatten();
    let mut listed = match o.kernel.precision {
        _ if o.canonical || tie => Loop::Canonical,
        Precision::Mixed if in_double.is_none() => Loop::Cluster,
        Precision::Double | Precision::Mixed => Loop::Rows,
    };
    let has_laws = laws.is_some();
    let laws = laws.map(Arc::new);
    let mut whole = Pairwise::new(model, laws.clone(), None);
    let mut near = o.split.map(|split| Pairwise::new(model, laws, Some(NearPart::new(&split))));
    let (mut search, mut skin, mut reason) = choose_search(o, c, r_cut, listed)?;
    if search == Search::Verlet && listed != Loop::Canonical {
        match in_lanes(&whole, near.as_ref()) {
            Ok(loops) => (whole, near) = loops,
            Err(without) => {
                listed = Loop::Canonical;
                (search, skin, reason) = choose_search(o, c, r_cut, listed)?;
                reason.push_str(&format!("; {without}"));
            }
        }
    }
    let canonical = search != Search::Verlet || listed == Loop::Canonical;
    let precision = match (search, listed) {
        (Search::Verlet, Loop::Cluster) => Precision::Mixed,
        _ => Precision::Double,
    };
    let remark = in_double;
    let kernel = match (search, listed) {
        (Search::Nothing, _) => "none",
        (Search::Reference, _) => "reference",
        (Search::Direct, _) => "direct",
        (Search::Verlet, Loop::Canonical) => "canonical",
        (Search::Verlet, Loop::Rows) => "rows",
        (Search::Verlet, Loop::Cluster) => "cluster",
    };
    let isa = if canonical { Level::Portable } else { level };
    if let Some(remark) = &remark {
        reason.push_str(&format!("; {remark}"));
    } else if is_mixed && precision == Precision::Double {
        reason.push_str("; this loop is always in double precision");
    }
    match c.mixture {
        Some(mixture) if has_laws => {
            let species = mixture.species();
            reason.push_str(&format!("; a table has the pairs of {species} species"));
        }
        Some(_) => reason.push_str("; all species are alike and need no table of pairs"),
        None => {}
    }
    let plan = ForcePlan {
        model: crate::pair::model_name(o),
        search,
        reason,
        r_cut,
        skin,
        r_list: r_cut + skin,
        kernel,
        isa: isa.name(),
        precision,
        remark,
        recommended_threads: recommended_threads(c.n_atoms, usize::MAX),
    };
    Ok(Decision { whole, near, level, listed, plan })
}

/// The one truncated potential, or all potentials of a mixture beside a model with its formula and its largest cutoff.
pub(crate) fn interaction(
    o: &ForceFieldOptions,
    mixture: Option<&Mixture>,
) -> Result<(Model, Option<Laws>), ForceFieldError> {
    let Some(mixture) = mixture else {
        return Ok((Model::new(&o.potential, &o.truncation)?, None));
    };
    if let Some(truncation) = as_one_fluid(&o.truncation, mixture) {
        return Ok((Model::new(&o.potential, &truncation)?, None));
    }
    let laws = Laws::new(&o.potential, &o.truncation, mixture)?;
    let form = laws.of_pairs[0][0].form;
    let model = Model { form, r_cut: laws.cutoffs().fold(0.0, f64::max), energy_at_cutoff: 0.0 };
    Ok((model, Some(laws)))
}

/// Why pairs are in double precision where mixed precision was asked for.
fn only_in_double(widest: f64, level: Level) -> Option<String> {
    if widest > Loop::Cluster.widest() {
        return Some(format!(
            "mixed precision resolves positions up to {:.0} σ a side: pairs in this longer box are in double precision",
            Loop::Cluster.widest()
        ));
    }
    (level == Level::Portable).then(|| {
        "mixed precision needs AVX2 or AVX-512: pairs are in double precision, which takes half the time without them"
            .to_owned()
    })
}

/// The whole force and its near part with loops in lanes, or why there are none.
fn in_lanes(
    whole: &Pairwise,
    near: Option<&Pairwise>,
) -> Result<(Pairwise, Option<Pairwise>), String> {
    let loops = |pairwise: &Pairwise, of: &str| {
        pairwise.clone().with_loops().map_err(|NoRows { r }| {
            format!(
                "rows of the {of} cannot hold 1e-10 of U at r = {r:.4} σ: the formula itself is summed, in double precision without lanes"
            )
        })
    };
    let near = near.map(|near| loops(near, "near force")).transpose()?;
    Ok((loops(whole, "force")?, near))
}

fn check_split(o: &ForceFieldOptions, r_cut: f64) -> Result<(), ForceFieldError> {
    let Some(split) = o.split else { return Ok(()) };
    if !(split.r_split > 0.0 && split.r_split < r_cut) {
        return Err(ForceFieldError::BadSplit { found: split.r_split, r_cut });
    }
    if !(split.width > 0.0 && split.width <= split.r_split) {
        return Err(ForceFieldError::BadSplitWidth(split.width));
    }
    Ok(())
}

/// Chooses the search for pairs, the skin of a list for this loop, and gives the reason. No pair is nearer than a cutoff of 0.
fn choose_search(
    o: &ForceFieldOptions,
    c: &Conditions<'_>,
    r_cut: f64,
    listed: Loop,
) -> Result<(Search, f64, String), ForceFieldError> {
    let n = c.n_atoms;
    let largest_skin = c.cell.largest_cutoff() - r_cut;
    if let Some(skin) = o.neighbor.skin {
        if !(skin.is_finite() && skin >= 0.0) {
            return Err(ForceFieldError::BadSkin(skin));
        }
        if o.neighbor.mode == ListMode::Direct {
            return Err(ForceFieldError::SkinWithoutList(skin));
        }
        if skin > largest_skin {
            return Err(ForceFieldError::SkinTooLarge { skin, largest: largest_skin });
        }
    }
    if r_cut == 0.0 {
        return Ok((Search::Nothing, 0.0, "no pair potential: there is nothing to search".into()));
    }
    if o.kernel.kernel == Kernel::Reference {
        return Ok((Search::Reference, 0.0, "the reference loop was asked for".into()));
    }
    let widest = c.cell.lengths().max_element();
    if widest > listed.widest() {
        let reason = format!("folded into a box of {widest:e} σ, positions lose their digits");
        return Ok((Search::Reference, 0.0, reason));
    }
    let cheapest = cheapest_skin(&SkinInputs {
        n_atoms: n,
        density: n as f64 / c.cell.volume(),
        temperature: c.temperature,
        dt: c.dt,
        r_cut,
        build_over_force: match listed {
            Loop::Cluster => BUILD_OVER_CLUSTER_FORCE,
            Loop::Rows | Loop::Canonical => BUILD_OVER_FORCE,
        },
    });
    let chosen = cheapest.min(largest_skin);
    match (o.neighbor.mode, o.neighbor.skin) {
        (ListMode::Direct, _) => {
            Ok((Search::Direct, 0.0, "the scene asks for a direct sum".into()))
        }
        (_, Some(skin)) => {
            Ok((Search::Verlet, skin, format!("the scene fixes a skin of {} σ", short(skin))))
        }
        (ListMode::Verlet, None) => {
            Ok((Search::Verlet, chosen, "the scene asks for a Verlet list".into()))
        }
        (ListMode::Auto, None) if n <= DIRECT_UP_TO => {
            Ok((Search::Direct, 0.0, format!("{n} particles are so few that no list pays")))
        }
        (ListMode::Auto, None) if chosen < USELESS_SKIN && n <= DIRECT_OVER_USELESS_SKIN => Ok((
            Search::Direct,
            0.0,
            format!("half the box leaves only {largest_skin:.3} σ of skin beyond r_cut"),
        )),
        (ListMode::Auto, None) => {
            let limit = if chosen < cheapest { ", held to half the box" } else { "" };
            Ok((
                Search::Verlet,
                chosen,
                format!("skin from density, temperature, dt and precision by a cost model{limit}"),
            ))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{KernelOptions, NeighborOptions};
    use lennard_core::PeriodicBox;

    fn decided(precision: Precision, change: impl Fn(&mut ForceFieldOptions)) -> ForcePlan {
        let mut options = ForceFieldOptions {
            kernel: KernelOptions { precision, ..KernelOptions::default() },
            ..ForceFieldOptions::default()
        };
        change(&mut options);
        let conditions = Conditions {
            cell: PeriodicBox::cubic_for_density(32_000, 0.8442).unwrap(),
            n_atoms: 32_000,
            temperature: 0.72,
            dt: 0.005,
            mixture: None,
        };
        decide(&options, &conditions).unwrap().plan
    }

    #[test]
    fn cluster_lists_have_a_thicker_skin_and_every_other_list_the_same() {
        let rows = decided(Precision::Double, |_| ());
        let cluster = decided(Precision::Mixed, |_| ());
        assert_eq!((rows.kernel, cluster.kernel), ("rows", "cluster"));
        let ratio = cluster.skin / rows.skin;
        assert!((1.1..1.2).contains(&ratio), "{ratio}");
        for precision in [Precision::Double, Precision::Mixed] {
            let canonical = decided(precision, |options| options.canonical = true);
            assert_eq!((canonical.kernel, canonical.skin), ("canonical", rows.skin));
            assert_eq!(canonical.precision, Precision::Double);
        }
    }

    #[test]
    fn without_a_list_pairs_are_in_double_precision() {
        let direct = |options: &mut ForceFieldOptions| {
            options.neighbor = NeighborOptions { mode: ListMode::Direct, skin: None };
        };
        let plan = decided(Precision::Mixed, direct);
        assert_eq!((plan.kernel, plan.skin), ("direct", 0.0));
        assert_eq!((plan.precision, plan.isa), (Precision::Double, "portable"));
    }
}
