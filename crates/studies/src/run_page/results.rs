//! What a run found: its table and the lines below it. A terminal prints them, and the page begins with them.

use crate::compare::{self, ComparedRun, Row, quantity_words};
use crate::report::{Block, Section, in_words, particles};

/// Adds the primary quantities of a run with their verdicts, what they say together, and the lines below them. With `verbose`
/// these are all quantities, and each has the parts of its verdict.
#[must_use]
pub fn quantities(section: Section, run: &ComparedRun, verbose: bool) -> Section {
    let rows: Vec<&Row> = run.rows.iter().collect();
    let shown: Vec<&Row> = rows.iter().copied().filter(|row| row.primary || verbose).collect();
    let table = compare::table(&shown, !verbose, |row| {
        let is_said = is_in_headline(run, row) || row.verdict.is_judged() || has_note(run, row);
        match is_said && !verbose {
            true => row.verdict.words().to_owned(),
            false => row.verdict_words(),
        }
    });
    let physical = compare::physical(run);
    let section = section
        .table(table)
        .texts(run.units.as_ref().map(in_words))
        .with_all(physical.map(|table| vec![Block::Table(table)]))
        .heading(&run.headline);
    let words = |row: &Row, text: &str| format!("{}: {text}", quantity_words(&row.quantity));
    let primary = || rows.iter().filter(|r| r.primary && !verbose);
    let reasons = primary().filter(|row| has_note(run, row)).map(|row| words(row, &row.reason));
    let of_one = if run.molecules == run.atoms { "particle" } else { "molecule" };
    let judges =
        |equation: &&String| rows.iter().any(|r| r.verdict.is_judged() && r.source == **equation);
    let of_particles = particles(run.atoms as usize, run.molecules as usize);
    let reference = run.equation.as_ref().filter(judges).map(|equation| {
        format!("reference: {equation}, at {}, for {of_particles}", run.state.in_numbers())
    });
    let section = section
        .texts(reasons)
        .text(format!("U and P are of: {}; energies are per {of_one}", run.model))
        .texts(reference);
    if verbose {
        let notes = rows.iter().filter_map(|r| {
            let notes = [&r.source, &r.tolerance_words, &r.remark].map(String::as_str);
            let notes: Vec<&str> = notes.into_iter().filter(|t| !t.is_empty()).collect();
            (!notes.is_empty()).then(|| words(r, &notes.join("; ")))
        });
        return section.texts(notes).texts(run.remarks.iter().map(|r| format!("note: {r}")));
    }
    section.texts(primary().filter_map(|row| Some(words(row, &row.range_words()?))))
}

/// The table of a fluid with its lines beside it, as a page begins: its lead has the headline. Nothing of a few bodies.
pub(super) fn beside_the_table(fluid: Option<&ComparedRun>) -> Section {
    let Some(run) = fluid else {
        return Section::new("");
    };
    let state = format!("state: {} at {}", run.state.words, run.state.in_numbers());
    let (mut tables, mut lines) = (Vec::new(), vec![state]);
    for block in quantities(Section::new(""), run, false).blocks {
        match block {
            Block::Text(line) => lines.push(line),
            Block::Heading(_) => {}
            block => tables.push(block),
        }
    }
    lines.push("reduced units: ε = σ = m = k_B = 1".to_owned());
    Section::new("").with_all(Some(tables)).list(lines)
}

/// Whether the headline says the reason of a row: most rows share it.
fn is_in_headline(run: &ComparedRun, row: &Row) -> bool {
    run.shared_reason.as_ref() == Some(&row.reason)
}

/// Whether the reason of a row stands below the table: it would fill several lines of a cell.
fn has_note(run: &ComparedRun, row: &Row) -> bool {
    row.has_long_reason() && !is_in_headline(run, row)
}
