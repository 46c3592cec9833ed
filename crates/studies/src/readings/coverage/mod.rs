//! Whether the printed errors cover: how often the long-run mean lies within them, over many seeds.

mod groups;
mod judge;
mod summary;

use std::collections::BTreeSet;

use super::blocks::Blocks;
use super::study::StudyPoints;
use crate::lists::grouped;
use crate::report::Section;
use crate::sweep::{Point, Setting};
use judge::{Cell, Sample};
use summary::Summary;

/// From this density on a homogeneous fluid is a liquid, whose longest runs may not be too short, σ⁻³.
const LEAST_DENSITY_OF_LIQUIDS: f64 = 0.7;

/// From so many steps on every quantity of a liquid must have an error.
const ENOUGH_STEPS: u64 = 200_000;

/// Tables by quantity and by state, and the cells that fail.
pub(super) fn read(study: &StudyPoints<'_>) -> Blocks {
    let samples = samples(study);
    let judged = judge::all(&samples);
    if judged.iter().all(|one| one.given == 0) {
        return Blocks::default();
    }
    let lengths: BTreeSet<u64> = samples.iter().map(|sample| sample.cell.steps).collect();
    let lengths: Vec<u64> = lengths.into_iter().collect();
    let summary = Summary::new(judged, &lengths);
    let [quantities, states] = summary.tables();
    let groups = summary.groups_in_words();
    let told = match groups.is_empty() {
        true => "No group is outside its bars.",
        false => "Groups outside their bars, the farthest first:",
    };
    let section = Section::new("Coverage of the printed errors")
        .table(quantities.clone())
        .table(states.clone())
        .text(told)
        .list(groups.clone())
        .text(summary.cells_in_words())
        .list(summary.listed_in_words());
    let mut sentences = vec![told.to_owned()];
    sentences.extend(groups);
    sentences.push(summary.cells_in_words());
    let blocks = Blocks {
        lead: "Runs of one state differ in their seeds alone.".to_owned(),
        sections: vec![section],
        terminal: vec![quantities.clone(), states.clone()],
        tables: vec![quantities, states, summary.cells()],
        sentences,
        failure: summary.failure(),
        ..Blocks::default()
    };
    blocks.with_entry("coverage", &summary.json())
}

/// The finished runs, by what they share but for their seed.
fn samples<'a>(study: &StudyPoints<'a>) -> Vec<Sample<'a>> {
    let runs = study.sweep.points.iter().zip(study.swept).filter_map(|(point, swept)| {
        let averages = &swept.record.as_ref()?.averages;
        averages.contains_key(judge::CONSERVED).then_some((point, averages))
    });
    let by_cell = runs.map(|(point, averages)| {
        let is_liquid = point.density >= LEAST_DENSITY_OF_LIQUIDS
            && point.scene.surfaces().is_none()
            && point.scene.half_crystal().is_none();
        let cell = Cell {
            state: state_of(&point.settings),
            steps: measured_steps(point),
            is_at_constant_energy: lennard_engine::held_temperature(&point.scene).is_none(),
            is_long_enough: is_liquid && measured_steps(point) >= ENOUGH_STEPS,
        };
        (cell, averages)
    });
    grouped(by_cell).into_iter().map(|(cell, runs)| Sample { cell, runs }).collect()
}

fn measured_steps(point: &Point) -> u64 {
    point.scene.stages.iter().filter(|stage| stage.measure).map(|stage| stage.steps).sum()
}

/// What a study chose but for the length of the runs, in words.
fn state_of(settings: &[Setting]) -> String {
    let chosen = settings.iter().filter(|setting| !setting.key.ends_with(".steps"));
    let in_words: Vec<String> = chosen.map(|setting| setting.value.to_string()).collect();
    match in_words.is_empty() {
        true => "the state".to_owned(),
        false => in_words.join(", "),
    }
}
