//! The tables and the page of a benchmark.

use crate::StudyError;
use crate::report::{Drawn, Given, Page, percent, significant, written};
use lennard_engine::stopwatch::Spread;
use lennard_observables::{Cell, RowsOf, Table};

use super::{BenchStudy, KernelResult, with_range};

/// The best time, in brackets the median of the repeats: `70.1 (74.3)`.
fn best(spread: Spread) -> String {
    format!("{} ({})", significant(spread.lowest, 3), significant(spread.median, 3))
}

/// Every number, as CSV.
pub(super) fn csv(study: &BenchStudy) -> Vec<Table> {
    let table = Table::rows_of("kernels", &study.kernels)
        .column("kernel", |k| &k.kernel)
        .column("isa", |k| &k.isa)
        .column("precision", |k| &k.precision)
        .column("threads", |k| k.threads);
    let table = spread(table, "speed [M atom-steps/s]", |k| k.speed);
    let table = spread(table, "step [ns/atom]", |k| k.step_ns);
    let table = spread(table, "forces [ns/atom]", |k| k.forces_ns);
    let table = spread(table, "totals [ns/atom]", |k| k.totals_ns)
        .column("build [ns/atom]", |k| k.build_ns.map(|s| s.median))
        .column("processor time [ns/atom-step]", |k| k.processor_ns.map(|s| s.median))
        .column("list share", |k| k.list_share.median)
        .column("steps per build", |k| k.steps_per_build)
        .column("lanes per pair", |k| k.lanes_per_pair)
        .column("limit [pairs/s]", |k| k.limit)
        .column("share of limit", |k| k.limit_share)
        .column("bytes per atom", |k| k.bytes_per_atom)
        .column("skin [σ]", |k| k.skin);
    let mut tables = vec![table.table()];
    tables.extend(study.skin.iter().map(|skin| {
        let table = Table::rows_of("skins", &skin.points).column("skin [σ]", |p| p.skin);
        let heading = format!("step, {} [ns/atom]", skin.clock);
        spread(table, &heading, |p| p.step_ns).table()
    }));
    tables
}

/// Three columns of a spread: median, lowest and highest.
fn spread<'a, T>(table: RowsOf<'a, T>, heading: &str, of: impl Fn(&T) -> Spread) -> RowsOf<'a, T> {
    table
        .column(heading, |item| of(item).median)
        .column("lowest", |item| of(item).lowest)
        .column("highest", |item| of(item).highest)
}

/// The words and the figures of the page.
const PAGE: &str = include_str!("page.toml");

/// The page.
///
/// # Errors
/// [`StudyError::Report`] where its text names what is not there.
pub(super) fn page(study: &BenchStudy) -> Result<Page, StudyError> {
    let command = format!("`{}`", study.command);
    Ok(Page {
        command: Some(study.command.clone()),
        provenance: study.machine.iter().cloned().chain([("command".into(), command)]).collect(),
        ..written(PAGE, &given(study))?
    })
}

/// What the names and the braces of the page stand for.
fn given(study: &BenchStudy) -> Given {
    let all = &study.kernels;
    let best = |of: &dyn Fn(&KernelResult) -> Spread| all.iter().map(|k| of(k).lowest).collect();
    let (forces, totals): (Vec<f64>, Vec<f64>) = (best(&|k| k.forces_ns), best(&|k| k.totals_ns));
    let drawn = csv(study)
        .swap_remove(0)
        .and("variant", all.iter().map(KernelResult::label))
        .and("file", all.iter().map(|k| k.label().replace(' ', "-")))
        .and("half range of speed", all.iter().map(|k| k.speed.half_range()))
        .and("half range of step", all.iter().map(|k| k.step_ns.half_range()))
        .and(
            "steps of a list",
            all.iter().map(|k| k.steps_per_build.map_or("all".into(), |n| format!("{n:.1}"))),
        )
        .and("best forces", forces)
        .and("best totals", totals)
        .and("best build", all.iter().map(|k| k.build_ns.map(|s| s.lowest)));
    let points = study.skin.iter().flat_map(|skin| &skin.points).collect::<Vec<_>>();
    let chosen = study.skin.as_ref().map_or(f64::NAN, |skin| skin.chosen);
    let skins = Table::rows_of("skins", &points)
        .column("skin", |p| p.skin)
        .column("step", |p| p.step_ns.median)
        .column("half range", |p| p.step_ns.half_range())
        .column("step of the chosen", |p| (p.skin == chosen).then_some(p.step_ns.median));
    let words = vec![
        ("scene", study.scene.clone()),
        ("atoms", study.atoms.to_string()),
        ("density", format!("{:.4}", study.density)),
        ("model", study.model.clone()),
        ("pairs", format!("{:.1}", study.pairs_per_atom)),
        ("temperature", format!("{:.3}", study.temperature)),
        ("steps", study.steps.to_string()),
        ("repeats", study.repeats.to_string()),
        (
            "skin",
            study.skin.as_ref().map_or("There is no list.".into(), |skin| {
                format!(
                    "The scene gets a skin of {:.3} σ. Of those tried {:.3} σ is the cheapest; the chosen one costs {} more ({}).",
                    skin.chosen,
                    skin.cheapest,
                    percent(skin.excess),
                    skin.with
                )
            }),
        ),
    ];
    let mut doubts = study.doubts();
    if doubts.is_empty() {
        doubts.push("nothing speaks against the figures".into());
    }
    let in_words = Table { name: "kernels in words".into(), ..kernels(study, true) };
    Given { tables: vec![drawn, skins.table(), in_words], words, lists: vec![("doubts", doubts)] }
}

/// The speed of each kernel; with the range of whole steps, and the median beside best times, where there is room.
#[must_use]
pub fn kernels(study: &BenchStudy, with_ranges: bool) -> Table {
    let caption = "Whole steps: median and range. Forces, the list given, and one build: best times and their median in brackets. The arithmetic limit is the same force with \
                   everything in registers, measured on this processor. Its share is the part of the force time that such arithmetic \
                   would take. Times are ns per atom.";
    let whole = |spread: Spread| match with_ranges {
        true => Cell::figures(with_range(spread)),
        false => Cell::rounded(spread.median, 3),
    };
    let part = |spread: Spread| match with_ranges {
        true => Cell::figures(best(spread)),
        false => Cell::rounded(spread.lowest, 3),
    };
    Table::rows_of("kernels", &study.kernels)
        .caption(caption)
        .column("Kernel", KernelResult::label)
        .column("Threads", |k| k.threads)
        .column("M atom-steps/s", |k| Cell::figures(k.marked_speed()))
        .column("Whole step", |k| whole(k.step_ns))
        .column("Processor time", |k| k.processor_ns.map(whole))
        .column("Forces alone", |k| part(k.forces_ns))
        .column("With totals", |k| part(k.totals_ns))
        .column("One list build", |k| k.build_ns.map(part))
        .column("Lists in a step", |k| Cell::figures(percent(k.list_share.median)))
        .column("Lanes per pair", |k| Cell::rounded(k.lanes_per_pair, 3))
        .column("Of the limit", |k| Cell::figures(k.marked_limit_share()))
        .column("Bytes per atom", |k| Cell::figures(format!("{:.0}", k.bytes_per_atom)))
        .table()
}
