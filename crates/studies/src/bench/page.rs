//! The tables and the page of a benchmark.

use lennard_core::stopwatch::Spread;
use lennard_report::{Block, Cell, Page, PageTable, Section, significant};

use super::{BenchStudy, with_range};
use crate::StudyError;
use crate::files::{Captioned, TextTable, exact, exact_or_empty};

/// The best time, in brackets the median of the repeats: `70.1 (74.3)`.
fn best(spread: Spread) -> String {
    format!(
        "{} ({})",
        significant(spread.lowest, 3),
        significant(spread.median, 3)
    )
}

fn percent(share: f64) -> String {
    format!("{:.1} %", 100.0 * share)
}

/// Every number, as CSV.
pub(super) fn csv(study: &BenchStudy) -> Vec<TextTable> {
    let three = |s: Spread| [exact(s.median), exact(s.lowest), exact(s.highest)];
    let mut tables = Vec::new();
    if !study.kernels.is_empty() {
        let mut table = TextTable::new(
            "kernels",
            &[
                "kernel",
                "isa",
                "precision",
                "threads",
                "speed [M atom-steps/s]",
                "lowest",
                "highest",
                "step [ns/atom]",
                "lowest",
                "highest",
                "forces [ns/atom]",
                "lowest",
                "highest",
                "totals [ns/atom]",
                "lowest",
                "highest",
                "build [ns/atom]",
                "processor time [ns/atom-step]",
                "list share",
                "steps per build",
                "lanes per pair",
                "limit [pairs/s]",
                "share of limit",
                "bytes per atom",
                "skin [σ]",
            ],
        );
        for k in &study.kernels {
            let words = [
                k.kernel.clone(),
                k.isa.clone(),
                k.precision.clone(),
                k.threads.to_string(),
            ];
            let spreads = [k.speed, k.step_ns, k.forces_ns, k.totals_ns]
                .into_iter()
                .flat_map(three);
            let rest = [
                exact_or_empty(k.build_ns.map(|s| s.median)),
                exact_or_empty(k.processor_ns.map(|s| s.median)),
                exact(k.list_share.median),
                exact_or_empty(k.steps_per_build),
                exact(k.lanes_per_pair),
                exact_or_empty(k.limit),
                exact_or_empty(k.limit_share),
                exact(k.bytes_per_atom),
                exact(k.skin),
            ];
            table.push(words.into_iter().chain(spreads).chain(rest));
        }
        tables.push(table);
    }
    if let Some(skin) = &study.skin {
        let mut table = TextTable::new(
            "skins",
            &["skin [σ]", "step [ns/atom]", "lowest", "highest"],
        );
        for p in &skin.points {
            table.push([exact(p.skin)].into_iter().chain(three(p.step_ns)));
        }
        tables.push(table);
    }
    if let Some(found) = &study.features {
        let mut table = TextTable::new(
            "features",
            &[
                "feature",
                "how often",
                "share of a step",
                "lowest",
                "highest",
                "ns/atom-step",
            ],
        );
        for f in &found.features {
            let words = [f.name.clone(), f.how.clone()];
            table.push(words.into_iter().chain(three(f.share)).chain([exact(f.ns)]));
        }
        tables.push(table);
    }
    tables
}

/// The page.
pub(super) fn page(study: &BenchStudy, figures: &[Captioned]) -> Result<Page, StudyError> {
    let figures = figures.iter().map(|f| f.on_page(&study.command));
    let figures = figures.collect::<Result<_, _>>()?;
    let mut sections = vec![Section::new("Pictures").with(Block::Figures(figures))];
    let doubts = study.doubts();
    if !doubts.is_empty() {
        let section =
            Section::new("Doubts").text("Figures with a question mark are to be doubted.");
        sections.push(section.with(Block::List(doubts)));
    }
    if !study.kernels.is_empty() {
        sections.push(Section::new("Kernels").with(Block::Table(kernels(study))));
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
    if let Some(found) = &study.features {
        let section = Section::new("Features").text(format!(
            "Force provider and integrator called by hand take {} ns an atom and step, the engine with every feature off {} ns: {} more \
             (from {} to {}).",
            with_range(found.bare_ns),
            with_range(found.off_ns),
            percent(found.engine_share.median),
            percent(found.engine_share.lowest),
            percent(found.engine_share.highest)
        ));
        let rows = found.features.iter().map(|f| {
            vec![
                Cell::text(f.name.clone()),
                Cell::text(f.how.clone()),
                Cell::number(percent(f.share.median)),
                Cell::number(format!(
                    "{} – {}",
                    percent(f.share.lowest),
                    percent(f.share.highest)
                )),
                Cell::number(significant(f.ns, 3)),
            ]
        });
        let table = PageTable {
            caption: "What each adds to a step in which everything is off.".into(),
            command: Some(study.command.clone()),
            header: [
                "Feature",
                "How often",
                "Of a step",
                "Range",
                "ns per atom-step",
            ]
            .map(str::to_owned)
            .to_vec(),
            rows: rows.collect(),
        };
        sections.push(
            section
                .with(Block::Table(table))
                .with(Block::List(found.left_out.clone())),
        );
    }
    Ok(Page {
        title: format!("{}: how fast", study.scene),
        lead: format!(
            "{} atoms at ρ = {:.4}, {}, {:.1} pairs an atom within the cutoff, T = {:.3}. Every block of {} steps starts from the same \
             state; the order of the blocks is shuffled in each of {} repeats. Times are those of this machine at that hour: only \
             ratios carry over.",
            study.atoms,
            study.density,
            study.model,
            study.pairs_per_atom,
            study.temperature,
            study.steps,
            study.repeats
        ),
        sections,
        provenance: study
            .machine
            .iter()
            .cloned()
            .chain([("command".to_owned(), format!("`{}`", study.command))])
            .collect(),
    })
}

fn kernels(study: &BenchStudy) -> PageTable {
    let rows = study.kernels.iter().map(|k| {
        vec![
            Cell::text(k.label()),
            Cell::number(k.threads.to_string()),
            Cell::number(k.marked_speed()),
            Cell::number(with_range(k.step_ns)),
            Cell::number(k.processor_ns.map_or("–".into(), with_range)),
            Cell::number(best(k.forces_ns)),
            Cell::number(best(k.totals_ns)),
            Cell::number(k.build_ns.map_or("–".into(), best)),
            Cell::number(percent(k.list_share.median)),
            Cell::number(significant(k.lanes_per_pair, 3)),
            Cell::number(k.marked_limit_share()),
            Cell::number(format!("{:.0}", k.bytes_per_atom)),
        ]
    });
    PageTable {
        caption: "Whole steps: median and range. Forces, the list given, and one build: best times and their median in brackets. The arithmetic limit is the same force with \
                  everything in registers, measured on this processor: its share is the part of the force time that such arithmetic \
                  would take."
            .into(),
        command: Some(study.command.clone()),
        header: [
            "Kernel",
            "Threads",
            "M atom-steps/s",
            "Step / ns an atom",
            "The same, processor time",
            "Forces",
            "With totals",
            "One build",
            "Lists in a step",
            "Lanes a pair",
            "Of the limit",
            "Bytes an atom",
        ]
        .map(str::to_owned)
        .to_vec(),
        rows: rows.collect(),
    }
}
