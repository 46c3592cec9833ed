//! What barostats and thermostats sample of a fluid at one pressure, at which pace and cost.

use lennard_engine::measured_stage;
use lennard_io::RunRecord;
use lennard_observables::{Cell, Table};

use super::blocks::{Blocks, PICTURES};
use super::points::verdicts;
use crate::report::{Section, pictures};
use crate::sweep::StudyPoints;
use crate::sweep::{Point, SweptPoint};

/// What every right choice samples alike.
const SHOWN: [&str; 3] = ["pressure", "density", "isothermal_compressibility"];
/// The figures of the table, by the names of its columns.
const FIGURES: &str = include_str!("ensemble.toml");

/// Independent volumes from which on a pace is told.
const FEWEST: f64 = 10.0;

/// A point beside its run.
type Run<'a> = (&'a Point, &'a SweptPoint);

/// The table of the choices, with two figures.
pub(super) fn read(study: &StudyPoints<'_>) -> Blocks {
    let held = |(point, _): &Run<'_>| measured_stage(&point.scene).barostat.is_some();
    let runs: Vec<Run<'_>> = study.sweep.points.iter().zip(study.swept).filter(held).collect();
    if !runs.iter().any(|(_, swept)| swept.record.is_some()) {
        return Blocks::default();
    }
    let table = table(&runs);
    let figures = pictures(FIGURES, &|_| Some(table.clone()), &[]);
    // The choice names its barostat.
    let shown = table.clone().without(&["Barostat"]);
    let section = Section::new(PICTURES).figures(figures.unwrap_or_default()).table(shown.clone());
    Blocks {
        lead: "A right choice has the pressure, the density and the compressibility of all others. They differ in cost and pace.".into(),
        sections: vec![section],
        terminal: vec![shown.without(&["Accepted", "ρ − equation"])],
        tables: vec![table],
        sentences: vec!["V is independent so many times in a τ; var V = T·V·κ_T".into()],
        ..Blocks::default()
    }
}

fn table(runs: &[Run<'_>]) -> Table {
    let row = |(_, swept): &Run<'_>, quantity: usize| swept.row(SHOWN[quantity]).cloned();
    Table::rows_of("ensemble", runs)
        .caption(
            "Digits in brackets are one standard error in the last digits. V is independent so many times in a τ, and var V is T·V·κ_T.",
        )
        .column("Choice", |(point, _)| label(point))
        .column("Barostat", |(point, _)| {
            measured_stage(&point.scene).barostat.as_ref().map(|b| b.options.name())
        })
        .column("Cost [(µs/τ)]", |run| Cell::rounded(cost(run), 3))
        .column("Accepted", |(_, swept)| Cell::rounded(accepted(swept.record.as_ref()), 2))
        .measured("P − P₀ [(ε/σ³)]", |run| row(run, 0)?.off())
        .measured("ρ [σ⁻³]", |run| row(run, 1).map(|r| r.mean()))
        .measured("ρ − equation", |run| row(run, 1)?.off())
        .measured("κ_T ÷ equation", |run| {
            let row = row(run, 2)?;
            let reference = row.reference?;
            Some((row.measured / reference, row.standard_error / reference))
        })
        .column("V per τ", |run| Cell::rounded(pace(run), 2))
        .measured("Drift [10⁻⁶ ε/τ]", |(_, swept)| {
            let found = swept.record.as_ref()?.conservation;
            let (slope, error) =
                (found.energy_drift_per_atom_per_tau, found.energy_drift_standard_error);
            Some((1e6 * slope, 1e6 * error))
        })
        .column("Verdicts", |(_, swept)| verdicts(swept, &SHOWN))
        .table()
}

/// What the study chose, in words.
fn label(point: &Point) -> String {
    let words = point.settings.iter().map(|setting| {
        let key = setting.key.rsplit('.').next().unwrap_or_default();
        match setting.value.to_string() {
            value if value.starts_with(|c: char| c.is_ascii_digit()) => format!("{key} {value}"),
            value => value,
        }
    });
    words.collect::<Vec<_>>().join(", ")
}

/// Wall time of the run for each particle and τ, with all that it observes and writes, µs.
fn cost((point, swept): &Run<'_>) -> Option<f64> {
    let dt = point.scene.stage_dt(measured_stage(&point.scene));
    swept.record.as_ref().map(|_| 1e-3 * swept.ns_per_atom_step / dt)
}

/// Accepted share of the proposed changes of the box.
fn accepted(record: Option<&RunRecord>) -> Option<f64> {
    let barostat = record?.barostat.as_ref()?;
    Some(barostat.accepted? as f64 / barostat.proposed.filter(|n| *n > 0)? as f64)
}

/// Independent volumes in a τ, of a run that is long enough to tell.
fn pace((point, swept): &Run<'_>) -> Option<f64> {
    let volume = swept.record.as_ref()?.averages.get("volume")?.estimate;
    (volume.n_effective >= FEWEST).then(|| volume.n_effective / point.scene.measured_time())
}
