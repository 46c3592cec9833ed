//! The tables and the page of a benchmark.

use crate::report::{Page, Section, percent, significant};
use lennard_core::stopwatch::Spread;
use lennard_core::{Cell, RowsOf, Table};

use super::figures;
use super::types::{BenchStudy, KernelResult, with_range};

/// The best time, in brackets the median of the repeats: `70.1 (74.3)`.
fn best(spread: Spread) -> String {
    format!("{} ({})", significant(spread.lowest, 3), significant(spread.median, 3))
}

/// Every number, as CSV.
pub(super) fn csv(study: &BenchStudy) -> Vec<Table> {
    let mut tables = Vec::new();
    if !study.kernels.is_empty() {
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
        tables.push(table.table());
    }
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

/// The page.
pub(super) fn page(study: &BenchStudy) -> Page {
    let mut sections = vec![Section::new("Pictures").figures(figures::all(study))];
    let doubts = study.doubts();
    if !doubts.is_empty() {
        let section =
            Section::new("Doubts").text("Figures with a question mark are to be doubted.");
        sections.push(section.list(doubts));
    }
    if !study.kernels.is_empty() {
        sections.push(Section::new("Kernels").table(kernels(study, true)));
    }
    if let Some(skin) = &study.skin {
        sections.push(Section::new("Skin").text(format!(
            "The scene gets a skin of {:.3} σ. Of those tried {:.3} σ is the cheapest; the chosen one costs {} more ({}).",
            skin.chosen,
            skin.cheapest,
            percent(skin.excess),
            skin.with
        )));
    }
    Page {
        title: format!("{}: how fast", study.scene),
        lead: format!(
            "{} atoms at ρ = {:.4}, {}, {:.1} pairs per atom within the cutoff, T = {:.3}. Every block of {} steps starts from the same \
             state; the order of the blocks is shuffled in each of {} repeats. Times belong to this machine at that hour: only \
             ratios carry over.",
            study.atoms,
            study.density,
            study.model,
            study.pairs_per_atom,
            study.temperature,
            study.steps,
            study.repeats
        ),
        command: Some(study.command.clone()),
        sections,
        provenance: study
            .machine
            .iter()
            .cloned()
            .chain([("command".to_owned(), format!("`{}`", study.command))])
            .collect(),
    }
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
