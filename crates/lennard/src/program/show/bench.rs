//! The table of a benchmark.

use std::path::Path;

use lennard_studies::bench::{
    BenchStudy, FeatureStudy, SkinStudy, feature_table, kernel_table, with_range,
};
use lennard_studies::report::{percent, significant};

use super::table;
use crate::program::out;

/// What was measured.
pub fn bench(study: &BenchStudy, folder: &Path) {
    out::heading(&study.scene);
    println!(
        "  {} particles, density {:.4}, {}, {:.1} pairs per atom within the cutoff",
        study.atoms, study.density, study.model, study.pairs_per_atom
    );
    println!(
        "  {} blocks of {} steps for each line, in shuffled order, all from one state at T = {:.3}",
        study.repeats, study.steps, study.temperature
    );
    for (name, value) in &study.machine {
        println!("  {name}: {value}");
    }
    if !study.kernels.is_empty() {
        kernels(study);
    }
    if let Some(skin) = &study.skin {
        skins(skin);
    }
    if let Some(found) = &study.features {
        features(found);
    }
    for doubt in study.doubts() {
        println!("  (?) {doubt}");
    }
    println!("  page: {}", folder.join("report.html").display());
}

fn kernels(study: &BenchStudy) {
    println!("{}", table(&kernel_table(study, false)));
    println!(
        "  ns per atom: medians of whole steps, in brackets the range; best times of forces alone (the list given) and of one build, which is\n  \
         paid once in many steps; processor time is for a step on one thread, and steadier than the clock where others are at work"
    );
    let limits: Vec<String> = study
        .kernels
        .iter()
        .filter(|k| k.threads == study.kernels[0].threads)
        .filter_map(|k| Some(format!("{} {} {:.0}", k.isa, k.precision, k.limit? * 1e-6)))
        .collect();
    if !limits.is_empty() {
        println!(
            "  the limit is the same arithmetic with everything in registers, measured here, million pairs/s per thread: {}",
            limits.join(", ")
        );
    }
}

fn skins(skin: &SkinStudy) {
    let scan: Vec<String> = skin
        .points
        .iter()
        .map(|p| format!("{:.3} σ {}", p.skin, significant(p.step_ns.median, 3)))
        .collect();
    println!(
        "  skin {:.3} σ, {} above the cheapest of the scan, {:.3} σ ({})",
        skin.chosen,
        percent(skin.excess),
        skin.cheapest,
        skin.with
    );
    println!("  ns per atom-step by skin: {}", scan.join(", "));
}

fn features(found: &FeatureStudy) {
    println!(
        "  force provider and integrator by hand {} ns per atom-step, the engine with every feature off {} ns: {} more ({} to {})",
        with_range(found.bare_ns),
        with_range(found.off_ns),
        percent(found.engine_share.median),
        percent(found.engine_share.lowest),
        percent(found.engine_share.highest)
    );
    println!("{}", table(&feature_table(found)));
    println!("  {} of {}", found.clock, lennard_studies::report::counted(found.threads, "thread"));
    for left in &found.left_out {
        println!("  left out: {left}");
    }
}
