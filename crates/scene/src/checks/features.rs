//! What a scene has that does not go with everything: each feature, with the keys where it stands and its words.

use lennard_core::options::quoted;
use lennard_core::{Bonds, Integrator, IntegratorSpec};
use lennard_forcefield::{
    CutoffUnit, HitRule, Kernel, ListMode, PotentialOptions, Surface, TruncationKind,
};
use lennard_integrators::Response;
use lennard_integrators::{
    BarostatOptions, IntegratorEntry, build, integrators, spook, stormer_verlet, thermostats,
};
use lennard_observables::{ObservableSpec, Surroundings, observables as all_observables};

use crate::{Arrangement, Molecule, Scene, Stage, WallTable};

/// The integrators that fit, as a scene names them: `integrator.kind = "leapfrog", "velocity-verlet"`.
pub(crate) fn kinds_that(fit: impl Fn(&IntegratorEntry) -> bool) -> String {
    let all = lennard_integrators::integrators().iter();
    let names: Vec<&str> = all.filter(|entry| fit(entry)).map(|entry| entry.spec.name).collect();
    format!("integrator.kind = {}", quoted(&names))
}

/// The attraction of a Mie potential must fall at least as fast as r⁻⁶ for a planar tail.
const SLOWEST: u32 = 6;

/// A place where a scene has a feature.
pub(super) struct Part {
    /// The key, such as `stage.0.barostat`.
    pub key: String,
    /// The feature in words: `"rdf"`, or `walls and a field`.
    pub words: String,
    /// What would fit in its place, in words; empty for most features.
    pub fit: String,
}

/// A question to a scene: all places where it has the feature.
pub(super) type Feature = fn(&Scene) -> Vec<Part>;

fn part(key: impl Into<String>, words: impl Into<String>) -> Part {
    Part { key: key.into(), words: words.into(), fit: String::new() }
}

fn one(there: bool, key: &str, words: &str) -> Vec<Part> {
    there.then(|| part(key, words)).into_iter().collect()
}

/// A name as scenes write it.
fn in_quotes(name: &str) -> String {
    format!("{name:?}")
}

// ── the model ──

pub(super) fn molecules(scene: &Scene) -> Vec<Part> {
    one(scene.molecule.is_some(), "molecule", "`[molecule]`")
}

pub(super) fn atoms(scene: &Scene) -> Vec<Part> {
    one(scene.molecule.is_none(), "molecule", "no `[molecule]`")
}

/// Tables of species, one or more.
pub(super) fn species(scene: &Scene) -> Vec<Part> {
    one(scene.mixture.is_some(), "species", "`[[species]]`")
}

pub(super) fn no_species(scene: &Scene) -> Vec<Part> {
    one(scene.mixture.is_none(), "species", "no `[[species]]`")
}

/// The number of species, whatever it is.
pub(super) fn number_of_species(scene: &Scene) -> Vec<Part> {
    vec![part("species", format!("{} species", count_of_species(scene)))]
}

pub(super) fn several_species(scene: &Scene) -> Vec<Part> {
    let n = count_of_species(scene);
    one(n > 1, "species", &format!("{n} species"))
}

fn count_of_species(scene: &Scene) -> usize {
    scene.mixture.as_ref().map_or(1, |mixture| mixture.species.len())
}

pub(super) fn cutoffs_by_pair(scene: &Scene) -> Vec<Part> {
    let unit = scene.truncation.r_cut_in.filter(|unit| *unit != CutoffUnit::Sigma);
    let named = |unit: CutoffUnit| part("truncation.r_cut_in", in_quotes(unit.name()));
    unit.map(named).into_iter().collect()
}

/// Cutoffs that are written with a unit.
pub(super) fn cutoffs_with_units(scene: &Scene) -> Vec<Part> {
    let is_cutoff = |key: &str| {
        key.starts_with("truncation.") || key.starts_with("pair.") && key.ends_with(".r_cut")
    };
    let written = scene.source.quantities().iter().filter(|(key, _)| is_cutoff(key));
    written.map(|(key, (text, _))| part(key, in_quotes(text))).collect()
}

pub(super) fn own_element(scene: &Scene) -> Vec<Part> {
    one(scene.source.wrote("output.element"), "output.element", "`element` in `[output]`")
}

pub(super) fn accuracy(scene: &Scene) -> Vec<Part> {
    one(scene.accuracy.is_some(), "accuracy", "`[accuracy]`")
}

/// An accuracy, under the key that asks for a conserved energy where it does.
pub(super) fn accuracy_of_energy(scene: &Scene) -> Vec<Part> {
    let drift = scene.accuracy.and_then(|accuracy| accuracy.drift);
    let key = if drift.is_some() { "accuracy.drift" } else { "accuracy" };
    one(scene.accuracy.is_some(), key, "`[accuracy]`")
}

pub(super) fn zero_temperature(scene: &Scene) -> Vec<Part> {
    let temperature = scene.system.temperature;
    one(temperature <= 0.0, "system.temperature", &temperature.to_string())
}

pub(super) fn tail(scene: &Scene) -> Vec<Part> {
    let words = match scene.source.wrote("truncation.tail_correction") {
        true => "true",
        false => "true, the default with kind \"cut\"",
    };
    one(scene.truncation.tail_correction, "truncation.tail_correction", words)
}

pub(super) fn planar_tail(scene: &Scene) -> Vec<Part> {
    one(scene.planar_tail, "truncation.tail_correction", "\"planar\"")
}

pub(super) fn truncations_with_an_end(scene: &Scene) -> Vec<Part> {
    let kind = scene.truncation.kind;
    one(kind != TruncationKind::Cut, "truncation.kind", kind.spec().name)
}

pub(super) fn potentials_without_planar_tail(scene: &Scene) -> Vec<Part> {
    let falls = match scene.potential {
        PotentialOptions::LennardJones(_) => true,
        PotentialOptions::Mie(mie) => mie.attractive >= SLOWEST,
        _ => false,
    };
    one(!falls, "potential.kind", scene.potential.spec().title)
}

// ── the start and what confines it ──

pub(super) fn confinement(scene: &Scene) -> Vec<Part> {
    let first = scene.confining().next().map(|(key, _)| key);
    first.zip(scene.confined_by()).map(|(key, words)| part(key, words)).into_iter().collect()
}

pub(super) fn surfaces(scene: &Scene) -> Vec<Part> {
    let key = if scene.slab().is_some() { "start.kind" } else { "start.vacuum" };
    scene.surfaces().map(|words| part(key, words)).into_iter().collect()
}

pub(super) fn slab(scene: &Scene) -> Vec<Part> {
    one(scene.slab().is_some(), "start.kind", "a slab")
}

pub(super) fn half_crystal(scene: &Scene) -> Vec<Part> {
    one(scene.half_crystal().is_some(), "start.kind", "a crystal beside its liquid")
}

pub(super) fn full_box(scene: &Scene) -> Vec<Part> {
    let is_full =
        matches!(scene.system.start, Arrangement::Lattice { .. }) && scene.surfaces().is_none();
    one(is_full, "system", "a start that fills its box")
}

pub(super) fn random_start(scene: &Scene) -> Vec<Part> {
    let is_random = matches!(scene.system.start, Arrangement::Lattice { lattice: None, .. });
    one(is_random, "start.kind", "\"random\"")
}

pub(super) fn vacuum(scene: &Scene) -> Vec<Part> {
    match scene.system.start {
        Arrangement::Lattice { vacuum, .. } => {
            one(vacuum > 0.0, "start.vacuum", &vacuum.to_string())
        }
        _ => Vec::new(),
    }
}

pub(super) fn several_particles(scene: &Scene) -> Vec<Part> {
    one(scene.system.start.count() != Some(1), "system", "other particles")
}

pub(super) fn one_molecule(scene: &Scene) -> Vec<Part> {
    let sites = scene.molecule.as_ref().map(|molecule| molecule.topology.sites());
    one(sites.is_some() && scene.n_particles() == sites, "molecule", "one molecule")
}

pub(super) fn held(scene: &Scene) -> Vec<Part> {
    one(!scene.system.held.is_empty(), "system.held", "held particles")
}

pub(super) fn direct_sums(scene: &Scene) -> Vec<Part> {
    one(scene.neighbor.mode == ListMode::Direct, "neighbor.mode", "\"direct\"")
}

pub(super) fn reference_sums(scene: &Scene) -> Vec<Part> {
    one(scene.kernel.kernel == Kernel::Reference, "kernel.kernel", "\"reference\"")
}

pub(super) fn no_pair_forces(scene: &Scene) -> Vec<Part> {
    one(scene.longest_cutoff() == 0.0, "potential.kind", "particles without pair forces")
}

// ── bonds ──

fn bonds(scene: &Scene, which: impl Fn(&Molecule) -> bool) -> Vec<Part> {
    let key = if scene.source.wrote("bonds") { "bonds" } else { "molecule" };
    let molecule = scene.molecule.as_ref().filter(|molecule| which(molecule));
    let words = |m: &Molecule| part(key, format!("[bonds] method = {:?}", m.bonds.name()));
    molecule.map(words).into_iter().collect()
}

fn is_of_spook(molecule: &Molecule) -> bool {
    molecule.bonds.spec().integrator.is_some()
}

/// Bonds that are no forces: each step holds them.
pub(super) fn bonds_in_steps(scene: &Scene) -> Vec<Part> {
    bonds(scene, |molecule| molecule.bonds.bonds() != Bonds::Springs)
}

pub(super) fn bonds_of_spook(scene: &Scene) -> Vec<Part> {
    bonds(scene, is_of_spook)
}

/// Bonds that steps of any method but SPOOK hold.
pub(super) fn held_bonds(scene: &Scene) -> Vec<Part> {
    bonds(scene, |m| m.bonds.bonds() != Bonds::Springs && !is_of_spook(m))
}

pub(super) fn bonds_by_impulses(scene: &Scene) -> Vec<Part> {
    bonds(scene, |m| m.bonds.bonds() == Bonds::Impulses && !is_of_spook(m))
}

pub(super) fn rigid_bonds(scene: &Scene) -> Vec<Part> {
    bonds(scene, |m| m.bonds.bonds() == Bonds::Rigid && !is_of_spook(m))
}

pub(super) fn sweeps_over_bonds(scene: &Scene) -> Vec<Part> {
    let sweeps = scene.molecule.as_ref().map_or(0, |molecule| molecule.bonds.sweeps_alone());
    one(sweeps > 0, "bonds.sweeps", &sweeps.to_string())
}

/// Methods of stages that do not hold the bonds of the scene, with those that do.
pub(super) fn methods_without_bonds(scene: &Scene) -> Vec<Part> {
    let Some(molecule) = &scene.molecule else {
        return Vec::new();
    };
    let suits =
        |spec: &IntegratorSpec| match (molecule.bonds.spec().integrator, molecule.bonds.bonds()) {
            (Some(name), _) => spec.name == name,
            (None, Bonds::Springs) => true,
            (None, Bonds::Rigid) => spec.holds_rigid_bonds,
            // A method on positions alone forgets the velocities that impulses leave.
            (None, Bonds::Impulses) => {
                spec.holds_rigid_bonds && spec.name != stormer_verlet::SPEC.name
            }
        };
    let own = scene.integrator.method.spec();
    let unsuited = |(i, stage): (usize, &Stage)| {
        let spec = scene.method_of(stage).spec();
        if suits(spec) {
            return None;
        }
        let by_bath = spec.name != own.name;
        let key = match by_bath {
            true => format!("stage.{i}.thermostat"),
            false => "integrator.kind".to_owned(),
        };
        let fit = match by_bath && suits(own) {
            // The bath stands in the place of a method that holds them: another bath lets it.
            true => {
                let baths = thermostats().iter().filter(|bath| bath.keeps_motion);
                format!("thermostat = one of {}", names(baths.map(|bath| bath.name)))
            }
            false => {
                let methods = integrators().iter().filter(|entry| suits(entry.spec));
                format!("[integrator] kind = {}", names(methods.map(|entry| entry.spec.name)))
            }
        };
        Some(Part { fit, ..part(key, in_quotes(spec.name)) })
    };
    scene.stages.iter().enumerate().filter_map(unsuited).collect()
}

fn names(names: impl Iterator<Item = &'static str>) -> String {
    quoted(&names.collect::<Vec<_>>())
}

// ── stages and methods ──

fn stages(scene: &Scene, key: &str, words: impl Fn(&Stage) -> Option<String>) -> Vec<Part> {
    let stages = scene.stages.iter().enumerate();
    let part = |(i, stage)| Some(part(format!("stage.{i}.{key}"), words(stage)?));
    stages.filter_map(part).collect()
}

pub(super) fn barostats(scene: &Scene) -> Vec<Part> {
    stages(scene, "barostat", |stage| Some(in_quotes(stage.barostat.as_ref()?.options.name())))
}

/// Barostats whose step takes the place of the method.
pub(super) fn barostats_in_steps(scene: &Scene) -> Vec<Part> {
    let outside = all_barostats_but(|barostat| barostat.is_inside_step());
    let inside = stages(scene, "barostat", |stage| {
        let options = &stage.barostat.as_ref()?.options;
        options.is_inside_step().then(|| in_quotes(options.name()))
    });
    inside.into_iter().map(|part| Part { fit: outside.clone(), ..part }).collect()
}

fn all_barostats_but(which: fn(&BarostatOptions) -> bool) -> String {
    let all = BarostatOptions::all();
    names(all.iter().filter(|options| !which(options)).map(BarostatOptions::name))
}

/// Barostats of measured stages, by the name of the stage.
pub(super) fn measured_barostats(scene: &Scene) -> Vec<Part> {
    let measured = |stage: &Stage| stage.measure && stage.barostat.is_some();
    stages(scene, "barostat", |stage| measured(stage).then(|| in_quotes(&stage.name)))
}

pub(super) fn exchanges(scene: &Scene) -> Vec<Part> {
    stages(scene, "exchange", |stage| stage.exchange.as_ref().map(|_| "an exchange".to_owned()))
}

/// Exchanges beside the thermostat of their stage.
pub(super) fn exchanges_under_baths(scene: &Scene) -> Vec<Part> {
    stages(scene, "exchange", |stage| {
        let bath = stage.exchange.as_ref().and(stage.thermostat.as_ref())?;
        Some(format!("thermostat {:?}", bath.name()))
    })
}

/// Measured stages that hold no temperature, or not one alone, with the baths that do.
pub(super) fn stages_without_temperature(scene: &Scene) -> Vec<Part> {
    let free = stages(scene, "thermostat", |stage| {
        let found = match &stage.thermostat {
            _ if !stage.measure || stage.holds_one_temperature() => return None,
            None => "without thermostat".to_owned(),
            Some(_) if stage.temperature_from.is_some() => {
                "with a ramp of the temperature".to_owned()
            }
            Some(bath) => format!("with thermostat {:?}", bath.name()),
        };
        Some(format!("{:?} {found}", stage.name))
    });
    let fit = names(thermostats().iter().filter(|t| t.canonical).map(|t| t.name));
    free.into_iter().map(|part| Part { fit: fit.clone(), ..part }).collect()
}

fn methods(scene: &Scene, suits: impl Fn(&Integrator) -> bool) -> Vec<Part> {
    let fit = kinds_that(|entry| suits(&entry.build()));
    let methods = scene.stages.iter().map(|stage| scene.method_of(stage));
    let unsuited = methods.filter(|method| !suits(method));
    let part = |method: Integrator| part("integrator.kind", in_quotes(method.spec().name));
    unsuited.map(|method| Part { fit: fit.clone(), ..part(method) }).collect()
}

/// Methods whose drifts are no flights from hit to hit.
pub(super) fn methods_without_flights(scene: &Scene) -> Vec<Part> {
    methods(scene, Integrator::takes_hard_walls)
}

/// Methods without such flights, or with other steps than kick-drift-kick.
pub(super) fn methods_without_flights_after_kicks(scene: &Scene) -> Vec<Part> {
    methods(scene, |method| method.takes_hard_walls() && method.spec().is_kick_drift_kick)
}

pub(super) fn methods_without_contacts(scene: &Scene) -> Vec<Part> {
    methods(scene, Integrator::solves_contacts)
}

/// Methods whose steps ranks do not take, with those that they do.
pub(super) fn methods_alone(scene: &Scene) -> Vec<Part> {
    methods(scene, |method| method.spec().on_ranks)
}

/// The method of the scene, where its steps are no kick-drift-kick.
pub(super) fn method_of_other_steps(scene: &Scene) -> Vec<Part> {
    let spec = build(&scene.integrator.method).spec();
    let found = one(!spec.is_kick_drift_kick, "integrator.kind", &in_quotes(spec.name));
    let fit = || kinds_that(|entry| entry.spec.is_kick_drift_kick);
    found.into_iter().map(|part| Part { fit: fit(), ..part }).collect()
}

pub(super) fn method_without_energy(scene: &Scene) -> Vec<Part> {
    let method = scene.integrator.method.spec();
    one(!method.symplectic, "integrator.kind", method.name)
}

/// SPOOK where it has neither bonds nor its own contacts to solve for.
pub(super) fn spook_alone(scene: &Scene) -> Vec<Part> {
    let solves = build(&scene.integrator.method).solves_contacts();
    let alone = solves && !scene.solves_contacts() && scene.molecule.is_none();
    one(alone, "integrator.kind", &in_quotes(spook::SPEC.name))
}

// ── observables ──

fn observables(scene: &Scene, which: impl Fn(&ObservableSpec) -> bool) -> Vec<Part> {
    let all = scene.observables.iter().map(|table| table.options.spec()).enumerate();
    let found = all.filter(|(_, spec)| which(spec));
    found.map(|(i, spec)| part(format!("observable.{i}.kind"), in_quotes(spec.name))).collect()
}

/// Observables that are not for a scene with molecules, or without, and those that are.
fn observables_not_for(scene: &Scene, is_molecular: bool) -> Vec<Part> {
    let fit = all_observables().iter().filter(|spec| spec.suits.includes(is_molecular));
    let fit = names(fit.map(|spec| spec.name));
    let unsuited = observables(scene, |spec| !spec.suits.includes(is_molecular));
    unsuited.into_iter().map(|part| Part { fit: fit.clone(), ..part }).collect()
}

pub(super) fn observables_of_atoms(scene: &Scene) -> Vec<Part> {
    observables_not_for(scene, true)
}

pub(super) fn observables_of_molecules(scene: &Scene) -> Vec<Part> {
    observables_not_for(scene, false)
}

pub(super) fn observables_of_one_species(scene: &Scene) -> Vec<Part> {
    observables(scene, |spec| !spec.suits.includes_mixtures())
}

/// Observables of another number of species than the scene has, with the number that each needs.
pub(super) fn observables_of_other_mixtures(scene: &Scene) -> Vec<Part> {
    let n = count_of_species(scene);
    let all = scene.observables.iter().map(|table| table.options.spec());
    let unfit = all.filter(|spec| !(spec.species[0]..=spec.species[1]).contains(&n));
    let found = observables(scene, |spec| !(spec.species[0]..=spec.species[1]).contains(&n));
    let with_need =
        |(part, spec): (Part, &ObservableSpec)| Part { fit: spec.species[0].to_string(), ..part };
    found.into_iter().zip(unfit).map(with_need).collect()
}

pub(super) fn observables_of_walls(scene: &Scene) -> Vec<Part> {
    observables(scene, |spec| spec.surroundings == Surroundings::Walls)
}

pub(super) fn observables_of_periodic_fluids(scene: &Scene) -> Vec<Part> {
    observables(scene, |spec| spec.surroundings == Surroundings::Periodic)
}

pub(super) fn observables_at_one_temperature(scene: &Scene) -> Vec<Part> {
    observables(scene, |spec| spec.needs_temperature)
}

pub(super) fn observables_of_flux(scene: &Scene) -> Vec<Part> {
    observables(scene, |spec| !spec.follows_changing_box)
}

/// Observables that one process alone can sample, each with the reason.
pub(super) fn observables_alone(scene: &Scene) -> Vec<Part> {
    let all = scene.observables.iter().map(|table| table.options.spec());
    let reasons = all.filter_map(|spec| spec.alone);
    let found = observables(scene, |spec| spec.alone.is_some());
    found.into_iter().zip(reasons).map(|(part, why)| Part { fit: why.into(), ..part }).collect()
}

pub(super) fn observables_of_heat(scene: &Scene) -> Vec<Part> {
    observables(scene, |spec| spec.name == "thermal-conductivity")
}

// ── walls ──

fn wall_parts(
    scene: &Scene,
    key: &str,
    words: impl Fn(&WallTable) -> Option<&'static str>,
) -> Vec<Part> {
    let walls = scene.walls.iter().enumerate();
    let part = |(i, table)| Some(part(format!("wall.{i}.{key}"), in_quotes(words(table)?)));
    walls.filter_map(part).collect()
}

fn walls(scene: &Scene, which: impl Fn(&Surface) -> bool) -> Vec<Part> {
    wall_parts(scene, "kind", |table| {
        which(&scene.surface(table)).then_some(table.options.spec().name)
    })
}

pub(super) fn any_walls(scene: &Scene) -> Vec<Part> {
    one(!scene.walls.is_empty(), "wall", "walls")
}

pub(super) fn no_walls(scene: &Scene) -> Vec<Part> {
    one(scene.walls.is_empty(), "wall", "no walls")
}

/// Walls that act as sites do, with a σ and an ε of their own: they are neither hit nor springs.
pub(super) fn walls_of_sites(scene: &Scene) -> Vec<Part> {
    walls(scene, |surface| match surface {
        Surface::Hit(_) => false,
        Surface::Exerts(wall) => wall.contact.is_none(),
    })
}

/// Walls that are hit, or have a dashpot, but for planes that contacts of SPOOK solve for.
pub(super) fn walls_in_drifts(scene: &Scene) -> Vec<Part> {
    let solved = |rule| rule == Some(HitRule::ByContacts) && scene.solves_contacts();
    walls(scene, |surface| {
        (surface.rule().is_some() || surface.dashpot().is_some()) && !solved(surface.rule())
    })
}

/// Walls that are hit elsewhere than on lines, or have a dashpot.
pub(super) fn walls_off_lines(scene: &Scene) -> Vec<Part> {
    walls(scene, |surface| {
        surface.rule().is_some_and(|rule| rule != HitRule::OnLines) || surface.dashpot().is_some()
    })
}

/// Walls that are hit in the flights of a method.
pub(super) fn walls_hit_in_flight(scene: &Scene) -> Vec<Part> {
    let in_flight = |rule| !scene.solves_contacts() && rule != HitRule::ByContacts;
    walls(scene, |surface| surface.rule().is_some_and(in_flight))
}

/// Walls that are hit in steps of kick-drift-kick alone.
pub(super) fn walls_hit_after_kicks(scene: &Scene) -> Vec<Part> {
    let after_kicks = |rule: HitRule| !scene.solves_contacts() && rule.needs_kick_drift_kick();
    walls(scene, |surface| surface.rule().is_some_and(after_kicks))
}

pub(super) fn walls_with_dashpots(scene: &Scene) -> Vec<Part> {
    walls(scene, |surface| {
        !scene.solves_contacts() && surface.rule().is_none() && surface.dashpot().is_some()
    })
}

/// Walls that are hit by such a rule, by the name of their response.
fn responses(scene: &Scene, which: impl Fn(HitRule) -> bool) -> Vec<Part> {
    wall_parts(scene, "response", |table| {
        Some(match scene.surface(table).rule().filter(|rule| which(*rule))? {
            HitRule::OnLines => "billiard",
            HitRule::OnParabolas => "event",
            HitRule::Mirrored { .. } => "mirror",
            HitRule::Projected => "project",
            HitRule::ByContacts => "contact",
        })
    })
}

/// Walls whose hits move single sites.
pub(super) fn walls_off_bonds(scene: &Scene) -> Vec<Part> {
    responses(scene, |rule| rule == HitRule::OnParabolas || rule.is_at_end())
}

pub(super) fn walls_hit_on_parabolas(scene: &Scene) -> Vec<Part> {
    responses(scene, |rule| rule == HitRule::OnParabolas && !scene.solves_contacts())
}

/// Planes that contacts of SPOOK are to solve for.
pub(super) fn planes_of_contacts(scene: &Scene) -> Vec<Part> {
    responses(scene, |rule| rule == HitRule::ByContacts)
}

// ── contacts ──

pub(super) fn contacts(scene: &Scene) -> Vec<Part> {
    let kind = scene.contact.as_ref().map(|table| table.options.spec().name);
    kind.map(|kind| part("contact", in_quotes(kind))).into_iter().collect()
}

/// Whatever stands in the place of contacts of SPOOK.
pub(super) fn no_contacts_of_spook(scene: &Scene) -> Vec<Part> {
    let words = match &scene.contact {
        _ if scene.solves_contacts() => return Vec::new(),
        Some(table) => format!("with [contact] kind = {:?}", table.options.spec().name),
        None => "without `[contact]`".to_owned(),
    };
    vec![part("contact", words)]
}

fn contacts_that(scene: &Scene, key: &str, act: impl Fn(Response) -> bool) -> Vec<Part> {
    let table = scene.contact.as_ref().filter(|table| act(table.options.response()));
    let kind = table.map(|table| in_quotes(table.options.spec().name));
    kind.map(|kind| part(key, kind)).into_iter().collect()
}

pub(super) fn contacts_with_impacts(scene: &Scene) -> Vec<Part> {
    contacts_that(scene, "contact.kind", |act| matches!(act, Response::Impact { .. }))
}

pub(super) fn contacts_of_spook(scene: &Scene) -> Vec<Part> {
    contacts_that(scene, "contact.kind", |act| matches!(act, Response::Unilateral(_)))
}

pub(super) fn contacts_with_dashpots(scene: &Scene) -> Vec<Part> {
    contacts_that(scene, "contact.restitution", |act| {
        matches!(act, Response::Spring(_)) && act.acts_in_flight()
    })
}

/// Contacts whose impulses are in no virial, in words.
pub(super) fn contacts_in_flight(scene: &Scene) -> Vec<Part> {
    let of = |parts: Vec<Part>, words: &str| one(!parts.is_empty(), "contact", words);
    [
        of(contacts_with_impacts(scene), "contacts with impacts"),
        of(contacts_of_spook(scene), "contacts of SPOOK"),
        of(contacts_with_dashpots(scene), "contacts with a dashpot"),
    ]
    .into_iter()
    .flatten()
    .collect()
}
