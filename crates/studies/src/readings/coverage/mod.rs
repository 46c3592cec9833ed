//! Whether the printed errors cover: how often the long-run mean lies within them, over many seeds.

mod judge;

use std::collections::BTreeSet;
use std::fmt::Write as _;

use judge::{Covered, Row, Sample, Sums, by_quantity, by_state, repeats};
use lennard_observables::{Cell, Table, Verdict};
use serde_json::{Value, json};

use super::blocks::Blocks;
use crate::lists::grouped;
use crate::report::Section;
use crate::sweep::Setting;
use crate::sweep::StudyPoints;

/// From this density on a homogeneous fluid is a liquid, whose longest runs may not be too short, σ⁻³.
const LEAST_DENSITY_OF_LIQUIDS: f64 = 0.7;

/// From so many steps on every quantity of a liquid must have an error.
const ENOUGH_STEPS: u64 = 200_000;

/// Tables by quantity and by state, and the cells that fail.
pub(super) fn read(study: &StudyPoints<'_>) -> Blocks {
    let samples = samples(study);
    let judged = judge::all(&samples);
    if judged.iter().all(|one| one.given == 0) {
        return Blocks::default();
    }
    let lengths: BTreeSet<u64> = samples.iter().map(|sample| sample.cell.steps).collect();
    let lengths: Vec<u64> = lengths.into_iter().collect();
    let summary = Summary::new(judged, &lengths);
    let [quantities, states] = summary.tables();
    let groups = summary.groups_in_words();
    let told = match groups.is_empty() {
        true => "No group is outside its bars.",
        false => "Groups outside their bars, the farthest first:",
    };
    let section = Section::new("Coverage of the printed errors")
        .table(quantities.clone())
        .table(states.clone())
        .text(told)
        .list(groups.clone())
        .text(summary.cells_in_words())
        .list(summary.listed_in_words());
    let mut sentences = vec![told.to_owned()];
    sentences.extend(groups);
    sentences.push(summary.cells_in_words());
    let blocks = Blocks {
        lead: "Runs of one state differ in their seeds alone.".to_owned(),
        sections: vec![section],
        terminal: vec![quantities.clone(), states.clone()],
        tables: vec![quantities, states, summary.cells()],
        sentences,
        failure: summary.failure(),
        ..Blocks::default()
    };
    blocks.with_entry("coverage", &summary.json())
}

/// The finished runs, by what they share but for their seed.
fn samples<'a>(study: &StudyPoints<'a>) -> Vec<Sample<'a>> {
    let runs = study.sweep.points.iter().zip(study.swept).filter_map(|(point, swept)| {
        let averages = &swept.record.as_ref()?.averages;
        averages.contains_key(judge::CONSERVED).then_some((point, averages))
    });
    let by_cell = runs.map(|(point, averages)| {
        let is_liquid = point.density >= LEAST_DENSITY_OF_LIQUIDS
            && point.scene.surfaces().is_none()
            && point.scene.half_crystal().is_none();
        let cell = judge::Cell {
            state: state_of(&point.settings),
            steps: point.scene.measured_steps(),
            is_at_constant_energy: lennard_engine::held_temperature(&point.scene).is_none(),
            is_long_enough: is_liquid && point.scene.measured_steps() >= ENOUGH_STEPS,
        };
        (cell, averages)
    });
    grouped(by_cell).into_iter().map(|(cell, runs)| Sample { cell, runs }).collect()
}

/// What a study chose but for the length of the runs, in words.
fn state_of(settings: &[Setting]) -> String {
    let chosen = settings.iter().filter(|setting| !setting.key.ends_with(".steps"));
    let in_words: Vec<String> = chosen.map(|setting| setting.value.to_string()).collect();
    match in_words.is_empty() {
        true => "the state".to_owned(),
        false => in_words.join(", "),
    }
}

/// Cells in the list; the record has all.
const SHOWN: usize = 60;

/// A cell is beyond chance where even one among all cells would be this improbable.
const BEYOND_CHANCE: f64 = 1e-3;

/// Probability that a cell with right errors is listed.
/// Three tails count 0.05 % each: two of the share within one error, one of the share within two.
/// The two tails of χ² count 0.1 % each.
const LISTED_BY_CHANCE: f64 = 3.5e-3;

/// What the judged cells add up to.
pub struct Summary {
    lengths: Vec<u64>,
    judged: Vec<Covered>,
    quantities: Vec<Row>,
    states: Vec<Row>,
}

impl Summary {
    /// Adds up.
    pub fn new(judged: Vec<Covered>, lengths: &[u64]) -> Self {
        Self {
            quantities: by_quantity(&judged, lengths),
            states: by_state(&judged, lengths),
            lengths: lengths.to_vec(),
            judged,
        }
    }

    /// Cells outside the range that chance leaves, the least probable first.
    fn listed(&self) -> Vec<(&Covered, f64)> {
        let mut listed: Vec<_> =
            (self.judged.iter()).filter_map(|one| Some((one, one.worst()?))).collect();
        listed.sort_by(|a, b| a.1.total_cmp(&b.1).then(b.0.given.cmp(&a.0.given)));
        listed
    }

    /// Whether a fault of this probability stays improbable among all cells.
    fn beyond_chance(&self, probability: f64) -> bool {
        probability * (self.judged.len() as f64) < BEYOND_CHANCE
    }

    /// Groups outside their bars, the farthest first: name, length and sums.
    fn failed_groups(&self) -> Vec<(&str, u64, &Sums)> {
        let mut failed = Vec::new();
        for row in self.quantities.iter().chain(&self.states) {
            for (sums, &length) in row.sums.iter().zip(&self.lengths) {
                if sums.verdict() == Verdict::Differs {
                    failed.push((sums.far(), row.name.as_str(), length, sums));
                }
            }
        }
        failed.sort_by(|a, b| b.0.total_cmp(&a.0));
        failed.into_iter().map(|(_, n, l, s)| (n, l, s)).collect()
    }

    /// Groups and cells that fail: groups outside their bars and cells beyond chance.
    fn failures(&self) -> (usize, usize) {
        let cells = self.listed().iter().filter(|(_, p)| self.beyond_chance(*p)).count();
        (self.failed_groups().len(), cells)
    }

    /// Each quantity over all states, and each state over all quantities.
    pub fn tables(&self) -> [Table; 2] {
        let caption = "Each entry: share of the seeds within one / two printed errors of the long-run mean (68 / 95 % where errors are right), scatter of the seeds in \
                       printed errors (1 where they are right; median over the cells), number of printed errors, and runs without one. ✗: within one error less than 60 or \
                       more than 76 %, or within two less than 92 %; ~: the same, but chance may do it with so few numbers.";
        let table = |name: &str, heading: &str, rows: &[Row]| {
            let mut table = Table::rows_of(name, rows).caption(caption);
            table = table.column(heading, |row| row.name.as_str());
            for (k, length) in self.lengths.iter().enumerate() {
                let heading = format!("{length} steps");
                table = table.column(&heading, |row| Cell::figures(entry(&row.sums[k])));
            }
            table.table()
        };
        [
            table("coverage_quantities", "quantity, all states", &self.quantities),
            table("coverage_states", "state, all quantities", &self.states),
        ]
    }

    /// Every cell with its numbers.
    pub(crate) fn cells(&self) -> Table {
        Table::rows_of("coverage_cells", &self.judged)
            .column("state", |one| one.cell.state.as_str())
            .column("steps", |one| one.cell.steps)
            .column("quantity", |one| one.quantity.as_str())
            .column("given", |one| one.given)
            .column("without", |one| one.without.values().sum::<usize>())
            .column("within one error", |one| one.within[0])
            .column("within two errors", |one| one.within[1])
            .column("distance", |one| one.distance)
            .column("scatter", Covered::scatter)
            .column("chi_squared", |one| one.chi_squared)
            .column("degrees_of_freedom", |one| one.degrees_of_freedom)
            .column("faults", |one| {
                one.faults.iter().map(|f| f.what.as_str()).collect::<Vec<_>>().join("; ")
            })
            .table()
    }

    /// Why the errors do not cover, where they do not.
    pub fn failure(&self) -> Option<String> {
        let (groups, cells) = self.failures();
        (groups + cells > 0).then(|| {
            format!("{groups} groups are outside their bars and {cells} cells are beyond chance: see coverage_cells.csv")
        })
    }

    /// Groups outside their bars, the farthest first.
    pub(crate) fn groups_in_words(&self) -> Vec<String> {
        let failed = self.failed_groups();
        let is_news = |(name, length, _): &&(&str, u64, &Sums)| {
            let original = repeats(name);
            !failed.iter().any(|f| Some(f.0) == original && f.1 == *length)
        };
        let told = failed.iter().filter(is_news);
        told.map(|(name, length, sums)| format!("{name}, {length} steps: {}", entry(sums)))
            .collect()
    }

    /// How many cells are outside the range of right errors, in a sentence.
    pub(crate) fn cells_in_words(&self) -> String {
        let (all, (_, beyond)) = (self.judged.len(), self.failures());
        format!(
            "{} of {all} cells are outside the range of right errors; chance lists about {:.0}. {beyond} are beyond chance (!).",
            self.listed().len(),
            all as f64 * LISTED_BY_CHANCE,
        )
    }

    /// Cells outside the range of right errors, the least probable first.
    pub(crate) fn listed_in_words(&self) -> Vec<String> {
        let listed = self.listed();
        let news: Vec<&(&Covered, f64)> = (listed.iter())
            .filter(|(one, _)| {
                let original = repeats(&one.quantity);
                let same =
                    |o: &Covered| o.cell == one.cell && Some(o.quantity.as_str()) == original;
                !listed.iter().any(|(other, _)| same(other))
            })
            .collect();
        let in_words = |(one, probability): &&(&Covered, f64)| {
            let mark = if self.beyond_chance(*probability) { "!" } else { "" };
            let what: Vec<&str> = one.faults.iter().map(|fault| fault.what.as_str()).collect();
            format!(
                "{mark}{}, {} steps, {}: {}; {} numbers{}, distance {:+.2}, {}",
                one.cell.state,
                one.cell.steps,
                one.quantity,
                what.join(", "),
                one.given,
                one.scatter().map_or(String::new(), |r| format!(", scatter {r:.2}")),
                one.distance,
                chance(*probability),
            )
        };
        let mut lines: Vec<String> = news.iter().take(SHOWN).map(in_words).collect();
        if news.len() > SHOWN {
            lines.push(format!("and {} more, in coverage_cells.csv", news.len() - SHOWN));
        }
        lines
    }

    /// Both tables as numbers.
    pub(crate) fn json(&self) -> Value {
        let sums = |(sums, length): (&Sums, &u64)| {
            json!({
                "steps": length, "given": sums.given, "without": sums.without, "within": sums.within,
                "scatter": sums.scatter(), "fails": sums.verdict() == Verdict::Differs,
            })
        };
        let row = |row: &Row| {
            let by_length: Vec<Value> = row.sums.iter().zip(&self.lengths).map(sums).collect();
            json!({"name": row.name, "lengths": by_length})
        };
        let rows = |rows: &[Row]| -> Vec<Value> { rows.iter().map(row).collect() };
        json!({"quantities": rows(&self.quantities), "states": rows(&self.states)})
    }
}

/// A probability, where it is large enough to mean anything.
fn chance(probability: f64) -> String {
    const LEAST: f64 = 1e-20;
    if probability < LEAST {
        format!("probability below {LEAST:.0e}")
    } else {
        format!("probability {probability:.0e}")
    }
}

fn entry(sums: &Sums) -> String {
    if sums.given + sums.without == 0 {
        return "–".to_owned();
    }
    let mut text = String::new();
    if sums.given > 0 {
        let mark = match sums.verdict() {
            Verdict::TooCoarse => "~ ",
            Verdict::Differs => "✗ ",
            _ => "",
        };
        let _ = write!(text, "{mark}{:.0} / {:.0} %", 100.0 * sums.share(0), 100.0 * sums.share(1));
        if let Some(ratio) = sums.scatter() {
            let _ = write!(text, ", {ratio:.2}");
        }
        let _ = write!(text, ", {}", sums.given);
    }
    if sums.without > 0 {
        let _ = write!(text, " ({} none)", sums.without);
    }
    text
}
