//! The table of a benchmark.

use std::path::Path;

use lennard_report::significant;
use lennard_studies::bench::{BenchStudy, FeatureStudy, SkinStudy, with_range};

use super::table;

fn percent(share: f64) -> String {
    format!("{:.1} %", 100.0 * share)
}

/// What was measured.
pub fn bench(study: &BenchStudy, folder: &Path) {
    println!("{}", console::style(&study.scene).bold());
    println!(
        "  {} particles, density {:.4}, {}, {:.1} pairs an atom within the cutoff",
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
    let heading = [
        "kernel",
        "threads",
        "M atom-steps/s",
        "whole step",
        "processor time",
        "forces alone",
        "with totals",
        "one list build",
        "lists in a step",
        "lanes a pair",
        "of the limit",
        "bytes an atom",
    ];
    let mut t = table(&heading, 1..12);
    for k in &study.kernels {
        t.add_row([
            format!("{} {}", k.isa, k.precision),
            k.threads.to_string(),
            k.marked_speed(),
            significant(k.step_ns.median, 3),
            k.processor_ns
                .map_or("–".into(), |s| significant(s.median, 3)),
            significant(k.forces_ns.lowest, 3),
            significant(k.totals_ns.lowest, 3),
            k.build_ns.map_or("–".into(), |s| significant(s.lowest, 3)),
            percent(k.list_share.median),
            significant(k.lanes_per_pair, 3),
            k.marked_limit_share(),
            format!("{:.0}", k.bytes_per_atom),
        ]);
    }
    println!("{t}");
    println!(
        "  ns an atom: medians of whole steps, in brackets the range; best times of forces alone (the list given) and of one build, which is\n  \
         paid once in many steps; processor time is that of a step on one thread, steadier than the clock where others are at work"
    );
    let limits: Vec<String> = study
        .kernels
        .iter()
        .filter(|k| k.threads == study.kernels[0].threads)
        .filter_map(|k| Some(format!("{} {} {:.0}", k.isa, k.precision, k.limit? * 1e-6)))
        .collect();
    if !limits.is_empty() {
        println!(
            "  the limit is the same arithmetic with everything in registers, measured here, million pairs/s a thread: {}",
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
    let mut t = table(
        &[
            "feature",
            "how often",
            "adds to a step",
            "range",
            "ns per atom-step",
        ],
        2..5,
    );
    for f in &found.features {
        t.add_row([
            f.name.clone(),
            f.how.clone(),
            percent(f.share.median),
            format!(
                "{} to {}",
                percent(f.share.lowest),
                percent(f.share.highest)
            ),
            significant(f.ns, 3),
        ]);
    }
    println!("{t}");
    println!(
        "  {} of {}",
        found.clock,
        lennard_report::counted(found.threads, "thread")
    );
    for left in &found.left_out {
        println!("  left out: {left}");
    }
}
