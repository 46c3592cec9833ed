//! What goes with what: one table of rows, and one loop.
//!
//! A row names two features that no scene has together, why, what was found, and the way out. In its texts, `{a}` and
//! `{b}` are the words of the two features. `{fit}` is what would fit in the place of the second feature, or of the first.

use super::features::*;
use crate::{Scene, SceneError};

struct Row {
    a: Feature,
    b: Feature,
    why: &'static str,
    found: &'static str,
    way_out: &'static str,
}

/// Makes the table from rows `feature / feature: why; found; way out`.
macro_rules! rows {
    ($($a:ident / $b:ident: $why:literal; $found:literal; $way_out:literal)*) => {
        &[$(Row { a: $a, b: $b, why: $why, found: $found, way_out: $way_out }),*]
    };
}

/// The rows, in the order in which they are looked at.
const ROWS: &[Row] = rows! {
    // Species.
    observables_of_one_species / several_species:
        "is for one species alone"; "{a} with {b}"; "a scene of one species"
    observables_of_other_mixtures / number_of_species:
        "is for another number of species"; "{a} with {b}"; "a scene with {fit} tables `[[species]]`"
    cutoffs_by_pair / no_species:
        "has no pairs of species to measure by"; "{a} without `[[species]]`";
        "a table `[[species]]` for each species, or no such key"
    cutoffs_with_units / cutoffs_by_pair:
        "is a length, and each pair measures its cutoff by its own size"; "{a} with truncation.r_cut_in = {b}";
        "a plain number, or truncation.r_cut_in = \"sigma\""
    molecules / species:
        "does not go with species"; "`[molecule]` and `[[species]]`";
        "atoms of several species, or molecules of one"
    walls_of_sites / several_species:
        "does not go with species"; "{a} and `[[species]]`";
        "\"hard\", \"thermal\" or \"soft\", which act on the centers of all particles: others have no σ and ε for each species"
    own_element / species:
        "does not go with species"; "{a} and `[[species]]`"; "`element` of each species"

    // Molecules.
    observables_of_atoms / molecules:
        "is for atoms alone"; "{a} with `[molecule]`"; "{fit}"
    observables_of_molecules / atoms:
        "is for molecules alone"; "{a} without `[molecule]`"; "{fit}"
    random_start / molecules:
        "does not go with molecules"; "\"random\"";
        "\"lattice\", or \"file\" with a file"
    walls_off_bonds / held_bonds:
        "moves single sites, off their bonds"; "{a} with {b}";
        "\"billiard\"; or a \"thermal\" wall, or a wall that only exerts a force"
    walls_in_drifts / bonds_of_spook:
        "does not go with molecules"; "{a}, which acts in drifts, and {b}";
        "a wall that only exerts a force: \"lennard-jones-9-3\", \"lennard-jones-10-4\", \"wca\", or \"soft\" with restitution = 1; or \"hard\" with response = \"contact\" and [contact] kind = \"spook\""
    barostats_in_steps / bonds_of_spook:
        "does not go with the bonds of SPOOK"; "{a}, whose step takes the place of the method that solves for them";
        "{fit}; or another way to hold bonds"
    barostats_in_steps / one_molecule:
        "needs more than one molecule"; "{a} with one molecule, whose centre has no degree of freedom";
        "{fit}; or more molecules"
    accuracy / bonds_of_spook:
        "does not go with bonds that are solved for in a step of their own"; "`[accuracy]` and {b}";
        "another way to hold bonds, or settings of your own"
    sweeps_over_bonds / contacts_of_spook:
        "counts sweeps over bonds alone"; "{a} with [contact] kind = \"spook\"";
        "0; `contact.sweeps` counts sweeps over bonds and contacts together"
    methods_without_bonds / bonds_of_spook:
        "does not go with the bonds of SPOOK"; "{a} with {b}"; "{fit}; or another way to hold bonds"
    methods_without_bonds / bonds_by_impulses:
        "has no drift that implicit springs or dashpots can act in"; "{a} with {b}";
        "{fit}; or bonds.scheme = \"explicit\" with bonds.damping = 0"
    methods_without_bonds / rigid_bonds:
        "has no form that holds rigid bonds"; "{a} with {b}"; "{fit}; or [bonds] method = \"spring\""

    // Baths and exchanges.
    observables_of_flux / measured_barostats:
        "follows a flux, which a changing box disturbs"; "{a} with a barostat in the measured stage {b}";
        "a stage with barostat and `measure = false`, then a measured one without barostat"
    observables_at_one_temperature / stages_without_temperature:
        "needs a temperature that is held"; "{a} in the measured stage {b}";
        "thermostat = one of {fit}, at one temperature"
    exchanges_under_baths / exchanges:
        "is at constant energy"; "an exchange with {a}";
        "a stage without thermostat; a stage before it may have one"
    exchanges / molecules:
        "is for atoms alone"; "an exchange and `[molecule]`"; "a scene of atoms"
    exchanges / several_species:
        "is between particles of one species"; "an exchange with {b}"; "a scene of one species"
    exchanges / confinement:
        "needs a periodic fluid"; "an exchange with {b}"; "a scene without walls and field"
    exchanges / method_of_other_steps:
        "needs a method that starts each step from the velocities"; "an exchange with integrator {b}"; "{fit}"

    // Accuracy.
    accuracy / surfaces:
        "is judged in a homogeneous fluid, and this one has surfaces"; "{b}";
        "a scene without surfaces, or settings written by hand and no `accuracy`"
    accuracy / zero_temperature:
        "has no state to be judged at"; "system.temperature = {b}"; "a temperature above 0"
    accuracy_of_energy / method_without_energy:
        "contradicts `integrator.kind`: {b} keeps no energy at any dt"; "integrator.kind = \"{b}\"";
        "a symplectic method (see `lennard list integrators`), or no `accuracy`"
    accuracy / confinement:
        "is judged in a homogeneous fluid"; "a fluid with {b}";
        "a scene without walls and field, or settings written by hand"
    accuracy / contacts:
        "does not go with contacts"; "`[accuracy]` and `[contact]`";
        "settings of your own: the predictions of errors are for fluids without contacts"

    // Walls, fields and held particles.
    observables_of_walls / no_walls:
        "measures walls, and the scene has none"; "{a}"; "a scene with `[[wall]]`"
    observables_of_periodic_fluids / confinement:
        "assumes a homogeneous fluid"; "{a}"; "a scene without walls and field"
    barostats / confinement:
        "needs a homogeneous fluid"; "a barostat with {b}";
        "a scene without walls and field, or a fixed box"
    tail / confinement:
        "assumes a homogeneous fluid"; "{a}, with {b}"; "false with walls, a field or held particles"
    tail / surfaces:
        "assumes a homogeneous fluid, and this one has surfaces"; "{a}, with {b}";
        "\"planar\" with kind \"cut\", or false"
    vacuum / any_walls:
        "does not go with walls"; "{a}"; "0: the walls make the box longer by their `thickness`"
    random_start / any_walls:
        "does not go with walls"; "{a}, whose relaxation knows no walls"; "\"lattice\""
    planes_of_contacts / no_contacts_of_spook:
        "is for planes that contacts of SPOOK solve for"; "{a} {b}";
        "[contact] kind = \"spook\", or response = \"billiard\""
    walls_hit_after_kicks / methods_without_flights_after_kicks:
        "is hit in drifts of a kind that the method does not make"; "{a} with {b}";
        "{fit}, or a wall that only exerts a force"
    walls_hit_in_flight / methods_without_flights:
        "is hit in drifts of a kind that the method does not make"; "{a} with {b}";
        "{fit}, or a wall that only exerts a force"
    walls_with_dashpots / methods_without_flights:
        "has a dashpot, which acts in drifts that the method does not make"; "{a} with {b}";
        "{fit}, or a wall that only exerts a force"
    walls_hit_on_parabolas / several_particles:
        "is for one particle in a constant field alone"; "{a} with other particles";
        "\"billiard\", or `system.n_atoms` = 1"

    // Two phases at the start.
    slab / molecules:
        "does not go with `[molecule]`"; "{a} and `[molecule]`"; "a slab of atoms in a periodic box"
    slab / confinement:
        "does not go with {b}"; "{a} and {b}"; "a slab of atoms in a periodic box"
    half_crystal / molecules:
        "does not go with `[molecule]`"; "{a} and `[molecule]`"; "atoms of one species in a periodic box"
    half_crystal / species:
        "does not go with several species"; "{a} and several species"; "atoms of one species in a periodic box"
    half_crystal / accuracy:
        "does not go with `[accuracy]`"; "{a} and `[accuracy]`"; "atoms of one species in a periodic box"
    half_crystal / contacts:
        "does not go with contacts"; "{a} and contacts"; "atoms of one species in a periodic box"
    half_crystal / confinement:
        "does not go with {b}"; "{a} and {b}"; "atoms of one species in a periodic box"

    // Contacts.
    spook_alone / contacts:
        "has nothing to solve for"; "{a} with [contact] kind = {b}";
        "[contact] kind = \"spook\", or another integrator"
    contacts_with_impacts / methods_without_flights:
        "acts by impacts in drifts, which the method does not make"; "{a} with {b}";
        "{fit}, or soft contacts with restitution = 1"
    contacts_of_spook / methods_without_contacts:
        "acts by impulses in the step of SPOOK, which the method does not make"; "{a} with {b}";
        "{fit}, or soft contacts with restitution = 1"
    contacts_with_dashpots / methods_without_flights:
        "below 1 acts by a dashpot in drifts, which the method does not make"; "{a} with {b}";
        "{fit}, or soft contacts with restitution = 1"
    contacts_with_impacts / bonds_in_steps:
        "acts by impacts in drifts, where the bonds are held too"; "{a} with {b}";
        "soft contacts with restitution = 1, or bonds that are explicit springs"
    contacts_with_dashpots / bonds_in_steps:
        "below 1 acts by a dashpot in drifts, where the bonds are held too"; "{a} with {b}";
        "soft contacts with restitution = 1, or bonds that are explicit springs"
    barostats / contacts_in_flight:
        "needs a virial of all forces"; "a barostat beside {b}";
        "soft contacts with restitution = 1, or a fixed box"
    walls_off_lines / contacts_with_impacts:
        "does not go with hard contacts"; "{a}, whose hits are not where a straight flight meets the plane";
        "\"hard\" with response \"billiard\", \"thermal\", or a wall that only exerts a force"
    walls_in_drifts / contacts_of_spook:
        "does not go with contacts of SPOOK"; "{a}, which acts in drifts";
        "\"hard\" with response = \"contact\", or a wall that only exerts a force"

    // A planar tail.
    planar_tail / truncations_with_an_end:
        "goes with the plain cutoff alone"; "\"planar\" with kind \"{b}\"";
        "kind \"cut\", or no tail correction"
    planar_tail / potentials_without_planar_tail:
        "is not derived for this potential"; "\"planar\" with {b}";
        "Lennard-Jones, or Mie with an attraction of r⁻⁶ or steeper"
    planar_tail / molecules:
        "is not derived for this fluid"; "\"planar\" with molecules"; "atoms of one species in a periodic box"
    planar_tail / species:
        "is not derived for this fluid"; "\"planar\" with several species"; "atoms of one species in a periodic box"
    planar_tail / accuracy:
        "is not derived for this fluid"; "\"planar\" with `[accuracy]`"; "atoms of one species in a periodic box"
    planar_tail / contacts:
        "is not derived for this fluid"; "\"planar\" with contacts"; "atoms of one species in a periodic box"
    planar_tail / confinement:
        "is not derived for this fluid"; "\"planar\" with {b}"; "atoms of one species in a periodic box"
    planar_tail / barostats:
        "needs a box that does not change"; "\"planar\" with a barostat"; "constant volume"
    planar_tail / observables_of_heat:
        "gives no energy of single particles"; "\"planar\" with observable {b}"; "other observables"
    planar_tail / full_box:
        "needs flat surfaces across z"; "\"planar\" and {b}";
        "true in a homogeneous fluid, or a start with `start.vacuum`, or start.kind = \"slab\" or \"file\""
};

/// A feature that one process alone runs.
struct Alone {
    a: Feature,
    why: &'static str,
    found: &'static str,
    way_out: &'static str,
}

/// Makes the table from rows `feature: why; found; way out`.
macro_rules! alone {
    ($($a:ident: $why:literal; $found:literal; $way_out:literal)*) => {
        &[$(Alone { a: $a, why: $why, found: $found, way_out: $way_out }),*]
    };
}

/// What several ranks do not run, in the order in which it is looked at.
const ALONE: &[Alone] = alone! {
    molecules: "bonds join particles that ranks keep apart"; "{a}"; "one process, or a scene of atoms"
    contacts: "a flight meets bodies of all ranks"; "[contact] kind = {a}"; "one process, or a scene without contacts"
    walls_in_drifts: "hits count one after another"; "{a}"; "one process, or a wall that only exerts a force"
    held: "a held particle takes up momentum"; "{a}"; "one process, or a scene without held particles"
    exchanges: "it seeks particles in the whole box"; "{a}"; "one process, or a scene without exchanges"
    methods_alone: "its steps look at all particles at once"; "{a}"; "one process, or {fit}"
    observables_alone: "it {fit}"; "{a}"; "one process, or a scene without this observable"
    direct_sums: "each force would need all particles"; "{a}"; "one process, or \"verlet\" or \"auto\""
    reference_sums: "each force would need all particles"; "{a}"; "one process, or \"auto\""
    no_pair_forces: "there is nothing to share"; "{a}"; "one process, or a potential"
};

/// Refuses the first feature that one process alone runs.
pub(super) fn check_for_ranks(scene: &Scene) -> Result<(), SceneError> {
    for row in ALONE {
        if let Some(a) = (row.a)(scene).first() {
            let told = |text: &str| text.replace("{a}", &a.words).replace("{fit}", &a.fit);
            let why = format!("is for one process alone: {}", told(row.why));
            let refused = scene.refuse(&a.key, why);
            return Err(refused.found(told(row.found)).allowed(told(row.way_out)));
        }
    }
    Ok(())
}

/// Refuses the first two features that do not go with each other.
pub(super) fn check(scene: &Scene) -> Result<(), SceneError> {
    for row in ROWS {
        if let (Some(a), Some(b)) = ((row.a)(scene).first(), (row.b)(scene).first()) {
            let fit = if b.fit.is_empty() { &a.fit } else { &b.fit };
            let told = |text: &str| {
                text.replace("{a}", &a.words).replace("{b}", &b.words).replace("{fit}", fit)
            };
            // A default stands on no line: the other feature does.
            let source = &scene.source;
            let keys = if source.wrote(&a.key) { [&a.key, &b.key] } else { [&b.key, &a.key] };
            let place = keys.into_iter().find_map(|key| source.place(key));
            return Err(source
                .refuse(&a.key, told(row.why))
                .at(place.cloned())
                .found(told(row.found))
                .allowed(told(row.way_out)));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_row_refuses_a_scene_of_the_bad_ones() {
        let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../inputs/bad.toml");
        let bad: toml::Table = std::fs::read_to_string(file).unwrap().parse().unwrap();
        let cases = bad["case"].as_array().unwrap();
        let expected: Vec<&str> = cases.iter().filter_map(|c| c["expected"].as_str()).collect();
        for Row { why, found, way_out, .. } in ROWS {
            let pieces = [why, found, way_out].map(|text| {
                let open = text.replace("{fit}", "{a}").replace("{b}", "{a}");
                open.split("{a}").map(str::to_owned).collect::<Vec<_>>()
            });
            let tells = |text: &&&str| pieces.iter().flatten().all(|piece| text.contains(piece));
            assert!(expected.iter().any(|text| tells(&text)), "no case: {why}; {found}; {way_out}");
        }
    }
}
