//! A chart of speed against accuracy as a person reads it: the first section of its page.

use std::path::Path;

use lennard_studies::chart::{self, Chart};
use lennard_studies::report::{Block, Section, significant};

/// Where the scene's own settings stand, and what would do as well for less.
pub fn chart(chart: &Chart, folder: &Path) -> Section {
    let mut shown = chart::summary(chart);
    shown.title = format!(
        "{}: {} settings, {} particles, runs of {} τ",
        chart.scene,
        chart.points.len(),
        chart.atoms,
        significant(chart.plan.time, 3)
    );
    for block in &mut shown.blocks {
        if let Block::Table(table) = block {
            *table = table.clone().without(&["No."]);
        }
    }
    let failed = chart.points.iter().filter(|p| p.failure().is_some()).count();
    let failed = (failed > 0).then(|| format!("{failed} settings failed; the page says how"));
    shown
        .texts(failed.into_iter().chain(chart.remarks.iter().cloned()))
        .text(format!("page: {}", folder.join("report.html").display()))
}
