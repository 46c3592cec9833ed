//! The commands of README.md, of the page of formats and of the tutorials, run as a reader runs them.
//!
//! Every block that begins with ```` ```sh ```` is run, one document in one new folder, with `lennard` on the path. A block whose
//! line before is a comment `<!-- not run: … -->` is left out. A block ```` ```toml title="NAME" ```` is written to the file NAME.
//!
//! A block ```` ```rust title="FILE" ```` shows a part of that example of the library, line by line.
//!
//! A ```` ```text ```` block behind commands shows what they print. Each row of its table with a ± must be in the output.
//! Quantity and verdict are the same there, and the means agree within five of both standard errors. A verdict of
//! *too coarse to tell* is open: on another processor the run may give a smaller error, and tell.

use std::error::Error;
use std::fs;
use std::path::Path;
use std::process::Command;

use rayon::iter::{IntoParallelRefIterator, ParallelIterator};

use crate::counts::Counts;
use crate::workspace::Workspace;

/// Where the examples of the library are.
const EXAMPLES: &str = "crates/lennard/examples";

const DOCUMENTS: [&str; 3] = ["README.md", "docs/formats.md", "docs/tutorials/*.md"];

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

/// Runs every document, several at a time.
pub fn run(workspace: &Workspace) -> Result<Counts, Box<dyn Error>> {
    let names = workspace.tracked(&DOCUMENTS)?;
    let outcomes: Vec<_> = names
        .par_iter()
        .map(|name| document(workspace, name).map_err(|fault| fault.to_string()))
        .collect();
    let mut counts = Counts::default();
    for (name, outcome) in names.iter().zip(outcomes) {
        match outcome {
            Ok(()) => {
                counts.passed += 1;
                println!("{name}: fine");
            }
            Err(fault) => {
                counts.failed += 1;
                println!("{name}, {fault}");
            }
        }
    }
    Ok(counts)
}

/// Runs one document in a new folder of its own.
fn document(workspace: &Workspace, name: &str) -> Result<(), Box<dyn Error>> {
    let text = fs::read_to_string(workspace.root.join(name))?;
    let folder = workspace.target.join("sessions").join(name.replace(['/', '.'], "-"));
    if folder.exists() {
        fs::remove_dir_all(&folder)?;
    }
    fs::create_dir_all(&folder)?;
    follow(workspace, &folder, &steps(&text))
}

fn follow(workspace: &Workspace, folder: &Path, steps: &[Step]) -> Result<(), Box<dyn Error>> {
    let binary = workspace.binary();
    let programs = binary.parent().unwrap_or(&workspace.root);
    let mut path = programs.as_os_str().to_owned();
    path.push(":");
    path.push(std::env::var_os("PATH").unwrap_or_default());
    let mut printed = String::new();
    for step in steps {
        match step {
            Step::File(name, text) => fs::write(folder.join(name), text)?,
            Step::Run(line, commands) => {
                let output = Command::new("bash")
                    .args(["-e", "-c", commands])
                    .current_dir(folder)
                    .env("PATH", &path)
                    .output()?;
                printed = String::from_utf8_lossy(&output.stdout).into_owned();
                if !output.status.success() {
                    let said = String::from_utf8_lossy(&output.stderr).into_owned();
                    return Err(format!("line {line}: the commands failed: {said}").into());
                }
            }
            Step::Shown(shown) => {
                if let Some(fault) = differs(shown, &printed) {
                    return Err(fault.into());
                }
            }
            Step::Excerpt(name, shown) => {
                let example = workspace.root.join(EXAMPLES).join(name);
                let text = fs::read_to_string(&example)
                    .map_err(|e| format!("{}: {e}", example.display()))?;
                if !text.contains(shown.as_str()) {
                    return Err(format!("{name} does not have this part:\n{shown}").into());
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
            match (kind, titled("toml"), titled("rust")) {
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

/// The rows with a ± of a table.
fn rows(text: &str) -> Vec<Measured> {
    text.lines().filter(|line| line.starts_with('│')).filter_map(row).collect()
}

fn row(line: &str) -> Option<Measured> {
    let cells: Vec<&str> = line
        .trim_matches(['│', ' '])
        .split("  ")
        .map(str::trim)
        .filter(|cell| !cell.is_empty())
        .collect();
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

#[cfg(test)]
mod tests {
    use super::*;

    const SHOWN: &str =
        "│ pressure, ε/σ³   1.003 ± 0.023   0.99718   +0.0056   ± 0.028   agrees  │\n";

    #[test]
    fn blocks_of_a_document_are_files_commands_and_what_they_print() {
        let text = "# A\n\n```sh\nlennard run x\n```\n\nIt prints:\n\n```text\nout\n```\n\n\
            ```toml title=\"x.toml\"\na = 1\n```\n\n```rust title=\"x.rs\"\nfn x() {}\n```\n\n<!-- not run: it installs -->\n```sh\nfalse\n```\n";
        assert_eq!(
            steps(text),
            [
                Step::Run(3, "lennard run x\n".into()),
                Step::Shown("out\n".into()),
                Step::File("x.toml".into(), "a = 1\n".into()),
                Step::Excerpt("x.rs".into(), "fn x() {}\n".into()),
            ]
        );
    }

    #[test]
    fn a_shown_mean_may_differ_by_its_error_and_a_verdict_not_at_all() {
        assert_eq!(differs(SHOWN, SHOWN), None);
        assert_eq!(differs(SHOWN, &SHOWN.replace("1.003", "1.05")), None);
        assert!(differs(SHOWN, &SHOWN.replace("1.003", "1.503")).is_some());
        assert!(differs(SHOWN, &SHOWN.replace("agrees", "differs")).is_some());
        assert_eq!(differs(SHOWN, &SHOWN.replace("agrees", "too coarse to tell")), None);
        let wide = SHOWN.replace("pressure, ε/σ³", "pressure,");
        assert_eq!(differs(&wide, SHOWN), None);
        assert!(differs(SHOWN, "").unwrap().contains("pressure"));
        assert_eq!(differs("no table\n", ""), None);
    }
}
