//! The pictures of a benchmark.

use crate::report::{
    Axis, BarFigure, BarSeries, Figure, Guide, Look, Picture, Point, Series, Symbol,
};
use lennard_core::stopwatch::Spread;

use super::types::{BenchStudy, KernelResult, SkinStudy};

/// All pictures that the study has the numbers for.
pub(super) fn all(study: &BenchStudy) -> Vec<Picture> {
    let mut figures = Vec::new();
    if !study.kernels.is_empty() {
        figures.push(speeds(study));
        figures.push(parts(study));
    }
    figures.extend(study.skin.iter().map(|skin| skins(study, skin)));
    figures
}

fn skins(study: &BenchStudy, skin: &SkinStudy) -> Picture {
    let points = skin.points.iter().map(|p| Point {
        x: p.skin,
        y: p.step_ns.median,
        error: Some(p.step_ns.half_range()),
        ..Point::default()
    });
    let figure = Figure::new(
        "skins",
        "Cost against skin",
        Axis::linear("skin / σ"),
        Axis::linear("ns per atom-step"),
    )
    .guided(Guide::Vertical(skin.chosen, "chosen".into()))
    .with(Series::new(
        format!("whole step, {}", skin.clock),
        Look::Points(Symbol::Disc),
        0,
        points,
    ));
    let caption = format!(
        "Whole steps with other skins ({}); lines are half the range over {} repeats.",
        skin.with, study.repeats
    );
    Picture::new(figure, caption, "skins.csv")
}

fn bar(spread: Spread) -> Option<(f64, Option<f64>)> {
    Some((spread.median, Some(spread.half_range())))
}

/// Whole steps of every variant: a group for each kernel, a bar for each number of threads.
fn speeds(study: &BenchStudy) -> Picture {
    let groups = labels(study);
    let mut threads: Vec<usize> = study.kernels.iter().map(|k| k.threads).collect();
    threads.sort_unstable();
    threads.dedup();
    let series = threads.iter().enumerate().map(|(color, &threads)| BarSeries {
        name: crate::report::counted(threads, "thread"),
        color,
        values: groups.iter().map(|g| find(study, g, threads).and_then(|k| bar(k.speed))).collect(),
    });
    let figure = BarFigure {
        name: "speed".into(),
        title: format!("{}: {} atoms, whole steps", study.scene, study.atoms),
        axis: Axis::linear("million atom-steps a second"),
        series: series.collect(),
        groups,
    };
    let caption = format!(
        "Whole steps at constant energy, lists included: median of {} blocks of {} steps, lines are half the range.",
        study.repeats, study.steps
    );
    Picture::new(figure, caption, "kernels.csv")
}

/// The parts of a step on the fewest threads.
fn parts(study: &BenchStudy) -> Picture {
    let fewest = study.kernels.iter().map(|k| k.threads).min().unwrap_or(1);
    let groups = labels(study);
    let of = |part: &dyn Fn(&KernelResult) -> Option<Spread>| -> Vec<_> {
        let found = groups.iter().map(|g| find(study, g, fewest));
        found.map(|k| k.and_then(part).and_then(bar)).collect()
    };
    let series = [
        ("whole step", of(&|k| Some(k.step_ns))),
        ("whole step, processor time", of(&|k| k.processor_ns)),
        ("forces alone, the list given", of(&|k| Some(best(k.forces_ns)))),
        ("forces with energy, virial and Laplacian", of(&|k| Some(best(k.totals_ns)))),
        ("one list build", of(&|k| k.build_ns.map(best))),
    ];
    let series = series
        .into_iter()
        .enumerate()
        .filter(|(_, (_, values))| values.iter().any(Option::is_some));
    let figure = BarFigure {
        name: "parts".into(),
        title: format!("Parts of a step, {}", crate::report::counted(fewest, "thread")),
        axis: Axis::linear("ns per atom"),
        series: series
            .map(|(color, (name, values))| BarSeries { name: name.into(), color, values })
            .collect(),
        groups,
    };
    let steps_per_build = study.kernels.iter().find_map(|k| k.steps_per_build);
    let caption = format!(
        "Medians of whole steps with half their range, best times of parts alone. A list build is paid once in {} steps.",
        steps_per_build.map_or("all".into(), |s| format!("{s:.1}"))
    );
    Picture::new(figure, caption, "kernels.csv")
}

/// The best alone.
fn best(spread: Spread) -> Spread {
    Spread { median: spread.lowest, highest: spread.lowest, ..spread }
}

fn labels(study: &BenchStudy) -> Vec<String> {
    let mut labels: Vec<String> = Vec::new();
    for label in study.kernels.iter().map(KernelResult::label) {
        if !labels.contains(&label) {
            labels.push(label);
        }
    }
    labels
}

fn find<'a>(study: &'a BenchStudy, label: &str, threads: usize) -> Option<&'a KernelResult> {
    let mut all = study.kernels.iter();
    all.find(|k| k.threads == threads && k.label() == label)
}
