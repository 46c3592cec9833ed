//! The page of a sweep, from the blocks of its readings.

use lennard_observables::Remark;

use crate::lists::grouped;
use crate::report::{Block, Page, Section};

use super::{SweepRecord, SweptPoint};
use crate::readings::{OPEN, SHARED_SECTIONS};

/// The page of a sweep.
pub(super) fn page(record: &SweepRecord, command: &str) -> Page {
    let finished = record.points.iter().filter(|p| p.compared.is_some()).count();
    let mut sections = together(&record.found.sections);
    let left_out = record.left_out.iter().map(|l| format!("{}: {}", l.what, l.why));
    sections.push(Section::new("Remarks").list(remarks(&record.points)).folded());
    sections.push(Section::new("Left out").list(left_out.collect()).folded());
    sections.retain(|section| !section.blocks.is_empty());
    // A study without a picture of its own shows its properties.
    let has_picture = |section: &Section| !section.folded && section.pictures().next().is_some();
    if !sections.iter().any(has_picture)
        && let Some(at) = sections.iter().position(|s| s.pictures().next().is_some())
    {
        let first = Section { folded: false, ..sections.remove(at) };
        sections.insert(0, first);
    }
    Page {
        title: format!("Sweep {}", record.name),
        lead: format!(
            "{finished} of {} points are finished. {}",
            record.points.len(),
            record.found.lead
        ),
        command: None,
        sections,
        provenance: vec![
            ("command".into(), format!("`{command}`")),
            ("version".into(), record.version.into()),
            ("processor".into(), record.cpu.clone()),
            ("threads for all points together".into(), record.threads.to_string()),
        ],
    }
}

/// The blocks of sections with one title in one section, those that readings share first. Figures stand side by side.
fn together(sections: &[Section]) -> Vec<Section> {
    let mut all: Vec<Section> = SHARED_SECTIONS.map(Section::new).into();
    all.iter_mut().skip(OPEN).for_each(|section| section.folded = true);
    for section in sections {
        let at = all.iter().position(|s| s.title == section.title).unwrap_or_else(|| {
            all.push(Section::new(section.title.clone()));
            all.len() - 1
        });
        for block in &section.blocks {
            match (all[at].blocks.last_mut(), block) {
                (Some(Block::Figures(side_by_side)), Block::Figures(more)) => {
                    side_by_side.extend(more.iter().cloned());
                }
                (_, block) => all[at].blocks.push(block.clone()),
            }
        }
    }
    all
}

/// Remarks of all points, each once, with how many points they belong to.
fn remarks(points: &[SweptPoint]) -> Vec<String> {
    let compared = points.iter().filter_map(|p| p.compared.as_ref());
    let counted = grouped(compared.flat_map(|c| &c.remarks).map(|remark| (remark, ())));
    let in_words = |(remark, found): (&Remark, Vec<()>)| match found.len() {
        1 => remark.to_string(),
        n => format!("{remark} ({n} points)"),
    };
    let failed =
        points.iter().filter_map(|p| Some(format!("{}: {}", p.name, p.failure.as_ref()?.reason)));
    counted.into_iter().map(in_words).chain(failed).collect()
}
