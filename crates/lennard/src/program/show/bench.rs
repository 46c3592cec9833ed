//! The table of a benchmark.

use std::path::Path;

use lennard_studies::bench::{BenchStudy, SkinStudy, kernel_table};
use lennard_studies::report::{Section, percent, significant};

/// What was measured.
pub fn bench(study: &BenchStudy, folder: &Path) -> Section {
    let limits: Vec<String> = study
        .kernels
        .iter()
        .filter(|k| k.threads == study.kernels[0].threads)
        .filter_map(|k| Some(format!("{} {} {:.0}", k.isa, k.precision, k.limit? * 1e-6)))
        .collect();
    let limits = (!limits.is_empty()).then(|| {
        format!(
            "the limit is the same arithmetic with everything in registers, measured here, million pairs/s per thread: {}",
            limits.join(", ")
        )
    });
    let skins = study.skin.iter().flat_map(skins);
    let doubts = study.doubts().into_iter().map(|doubt| format!("(?) {doubt}"));
    Section::new(&study.scene)
        .text(format!(
            "{} particles, density {:.4}, {}, {:.1} pairs per atom within the cutoff",
            study.atoms, study.density, study.model, study.pairs_per_atom
        ))
        .text(format!(
            "{} blocks of {} steps for each line, in shuffled order, all from one state at T = {:.3}",
            study.repeats, study.steps, study.temperature
        ))
        .texts(study.machine.iter().map(|(name, value)| format!("{name}: {value}")))
        .table(kernel_table(study, false))
        .text(
            "ns per atom: medians of whole steps, in brackets the range; best times of forces alone (the list given) and of one build, \
             which is paid once in many steps; processor time is for a step on one thread, and steadier than the clock where others are at work",
        )
        .texts(limits.into_iter().chain(skins).chain(doubts))
        .text(format!("page: {}", folder.join("report.html").display()))
}

fn skins(skin: &SkinStudy) -> [String; 2] {
    let scan: Vec<String> = skin
        .points
        .iter()
        .map(|p| format!("{:.3} σ {}", p.skin, significant(p.step_ns.median, 3)))
        .collect();
    [
        format!(
            "skin {:.3} σ, {} above the cheapest of the scan, {:.3} σ ({})",
            skin.chosen,
            percent(skin.excess),
            skin.cheapest,
            skin.with
        ),
        format!("ns per atom-step by skin: {}", scan.join(", ")),
    ]
}
