//! Sweeps and comparisons for people.

use std::collections::BTreeSet;
use std::path::Path;

use lennard_observables::Remark;
use lennard_scene::Scene;
use lennard_studies::compare::{self, ComparedRun};
use lennard_studies::report::{Section, counted, particles};
use lennard_studies::run_page;
use lennard_studies::sweep::{Sweep, SweepRecord, workers};

/// What is about to run, with the points that are no single stable phase. Two phases that the start puts side by side are
/// meant, and are judged by saturation.
pub fn sweep_header(sweep: &Sweep, threads: usize, folder: &Path) -> Section {
    let points = sweep.points.len();
    let is_meant = |scene: &Scene| scene.surfaces().is_some() || scene.half_crystal().is_some();
    let unstable = sweep.points.iter().filter(|p| !is_meant(&p.scene)).filter_map(|point| {
        let state = point.planned();
        let said = format!("{}: {}; it is run and not judged", point.name, state.words);
        (!state.is_single_stable_phase()).then_some(said)
    });
    Section::new(&*sweep.name)
        .text(format!(
            "{}, {} at a time, output in {}",
            counted(points, "point"),
            workers(points, threads),
            folder.display()
        ))
        .texts(unstable)
}

/// The tables of a sweep, and what they say.
pub fn sweep(record: &SweepRecord, folder: &Path) -> Section {
    let mut section = Section::new("");
    for table in &record.found.terminal {
        section = section.text("").table(table.clone());
    }
    // Which points are no single phase stands in the table.
    let compared = record.points.iter().filter_map(|p| p.compared.as_ref());
    let remarks = compared.flat_map(|c| &c.remarks);
    let remarks: BTreeSet<String> = remarks
        .filter(|remark| !matches!(remark, Remark::NotJudged { .. }))
        .map(Remark::to_string)
        .collect();
    let kept = record.points.iter().filter(|p| p.kept).count();
    let kept = (kept > 0)
        .then(|| format!("{kept} points had been finished before and were not run again"));
    section
        .texts(&record.found.sentences)
        .texts(remarks.iter().map(|remark| format!("note: {remark}")))
        .texts(kept)
        .text("")
        .text(format!("page: {}", folder.join("report.html").display()))
}

/// One run beside the literature.
pub fn compared(run: &ComparedRun, verbose: bool) -> Section {
    let of_particles = particles(run.atoms as usize, run.molecules as usize);
    let section = Section::new(&run.run).text(format!(
        "{of_particles}, {} measured steps, {}: {}",
        run.measured_steps,
        run.state.in_numbers(),
        run.state.words
    ));
    state_card(quantities(section, run, verbose), run, verbose).text("")
}

/// Every measured property beside every equation, and what follows.
/// Its sentence has the verdicts, for which the table has room with `verbose` alone.
pub(super) fn state_card(section: Section, run: &ComparedRun, verbose: bool) -> Section {
    let without: &[&str] = if verbose { &[] } else { &["Verdict"] };
    match &run.card {
        Some(card) => {
            section.table(compare::card_table(card).without(without)).text(&card.sentence)
        }
        None => section,
    }
}

/// The primary quantities of a run with their verdicts, as its page has them first. With `verbose` these are all quantities, and
/// each has the parts of its verdict.
pub(super) fn quantities(section: Section, run: &ComparedRun, verbose: bool) -> Section {
    let hidden = run.rows.iter().filter(|r| !r.primary && !verbose).count();
    let more =
        (hidden > 0).then(|| format!("{hidden} more quantities, sources and notes: --verbose"));
    run_page::quantities(section, run, verbose).texts(more)
}
