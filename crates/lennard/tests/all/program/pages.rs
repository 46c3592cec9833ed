//! The page of a run: what it says first, and nothing of what the run has not got.

use super::numbers::words_of;
use crate::program::common::*;

/// A gas at constant energy with no observable but the thermodynamic ones.
const PLAIN: &str = r#"
system = { n_atoms = 108, density = 0.3, temperature = 2.0, seed = 3 }
integrator = { dt = 0.004 }
stage = [
    { name = "equilibrate", steps = 400, measure = false },
    { name = "production", steps = 2000 },
]
"#;

/// The page and what the terminal printed.
fn run(scene: &str) -> (String, String) {
    let place = Place::with(&[("scene.toml", scene)]);
    let said = place.succeed("run scene.toml --out out");
    (place.read("out/report.html"), said)
}

#[test]
fn a_run_begins_with_a_sentence_and_the_table_of_the_terminal_and_ends_with_what_is_folded() {
    let (page, said) = run(&format!("{PLAIN}\n[[observable]]\nkind = \"rdf\"\n"));
    let body = page.split_once("<body>").unwrap().1;
    let (before, rest) = body.split_once("<table").unwrap();
    // A heading and one paragraph stand above the table, so that it begins within the first 300 pixels.
    let texts = ["<h1>", "<p", "<h2", "<h3", "<ul", "<svg", "<nav", "<details"];
    assert_eq!(texts.map(|tag| before.matches(tag).count()), [1, 1, 0, 0, 0, 0, 0, 0], "{before}");
    // The rows of the terminal, in their order, and its headline.
    let table = rest.split_once("</table>").unwrap().0;
    let rows = table.split("<tr><td").skip(1).map(|row| words_of(&format!("<td{row}")));
    let rows: Vec<String> =
        rows.filter_map(|row| Some(row.split_whitespace().next()?.to_owned())).collect();
    assert!(rows.len() >= 4, "{table}");
    let mut lines = said.lines().filter(|line| line.starts_with('│'));
    for first in &rows {
        assert!(lines.any(|line| line.contains(first.as_str())), "{first} in\n{said}");
    }
    let lead = words_of(before.split_once("class=\"lead\"").map(|(_, lead)| lead).unwrap());
    let lead: Vec<&str> = lead.split_whitespace().skip(1).take(4).collect();
    assert!(said.contains(&lead.join(" ")), "{lead:?} in\n{said}");
    // Pictures in time, then structure and state, then all else, folded.
    let parts = [
        "<title>Potential energy<",
        "<title>Pressure<",
        "<title>T, whole steps<",
        "<title>Radial",
        "<title>The particles",
        "<title>Phase diagram, temperature",
        "<details>",
    ];
    let places = parts.map(|part| page.find(part).unwrap_or_else(|| panic!("{part}")));
    assert!(places.is_sorted(), "{places:?}");
    let folded = page.split_once("<details>").unwrap().1;
    assert!(!folded.contains("<section") && folded.matches("<h2>").count() > 4);
    // What lies before the means is grey.
    let energy =
        page.split("<title>Potential energy<").nth(1).unwrap().split("</svg>").next().unwrap();
    assert!(energy.contains("averages begin") && energy.matches("<rect").count() == 2, "{energy}");
}

#[test]
fn a_page_says_nothing_of_what_the_run_has_not_got() {
    let (page, _) = run(PLAIN);
    let words = words_of(&page).to_lowercase();
    let absent = "displacement, radial, shell, structure factor, stress, interface, slab, \
        velocity autocorrelation, transport, no trajectory, frames, not asked, no equation, barostat, \
        thermostat, species, bond, walls, c_v agrees, slow box";
    for absent in absent.split(", ") {
        assert!(!words.contains(absent), "`{absent}` in {words}");
    }
    // What it has is there.
    contains(&words, &["potential energy", "phase diagram", "where the time went"]);
    contains(&words, &["the same bits again"]);
}
