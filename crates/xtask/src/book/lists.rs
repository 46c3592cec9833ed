//! Pages that the program writes about itself.

use std::error::Error;
use std::fmt::Write as _;

use serde_json::Value;

use crate::ledger::commands as commands_of;
use crate::workspace::Workspace;

/// The lists of `lennard list` with their headings.
const LISTS: [(&str, &str); 15] = [
    ("observables", "Observables"),
    ("integrators", "Integrators"),
    ("thermostats", "Thermostats"),
    ("barostats", "Barostats"),
    ("exchanges", "Exchanges of velocities"),
    ("potentials", "Potentials"),
    ("truncations", "Truncations"),
    ("combining-rules", "Rules for unlike species"),
    ("walls", "Walls"),
    ("contacts", "Contacts"),
    ("bonds", "Ways to hold bonds"),
    ("equations-of-state", "Equations of state"),
    ("formats", "Formats of trajectories"),
    ("reference-tables", "Reference tables"),
    ("scenes", "Scenes that come with the program"),
];

/// Every command with its help.
pub fn commands(workspace: &Workspace) -> Result<String, Box<dyn Error>> {
    let mut page =
        String::from("# Commands\n\nThis page is what `lennard COMMAND --help` prints.\n");
    let commands = commands_of(workspace).map_err(|error| error as Box<dyn Error>)?;
    for name in commands.keys().filter(|name| *name != "help") {
        let words: Vec<&str> = name.split(' ').chain(["--help"]).collect();
        let help = said(workspace, &words)?;
        let _ = write!(page, "\n## lennard {name}\n\n```text\n{}\n```\n", help.trim_end());
    }
    Ok(page)
}

/// Every method with its equations and its source.
pub fn methods(workspace: &Workspace) -> Result<String, Box<dyn Error>> {
    let mut page = String::from(
        "# Methods and observables\n\nThis page is what `lennard list LIST --verbose` prints. Each name is a name in scene files.\n",
    );
    for (list, heading) in LISTS {
        let entries: Value = serde_json::from_str(&said(workspace, &["list", list, "--json"])?)?;
        let _ = write!(page, "\n## {heading}\n");
        for entry in entries["entries"].as_array().ok_or("a list is no list")? {
            let text = |key: &str| entry[key].as_str().unwrap_or_default();
            let _ = write!(page, "\n### {}\n\n{}\n\n", text("name"), text("summary"));
            if let Some(equation) = entry["equation"].as_str() {
                let _ = write!(page, "```text\n{equation}\n```\n\n");
            }
            for (name, value) in entry["properties"].as_object().into_iter().flatten() {
                let value = value.as_str().map_or_else(|| value.to_string(), str::to_owned);
                let _ = writeln!(page, "- {name}: {value}");
            }
            let _ = writeln!(page, "- source: {}", text("source"));
        }
    }
    Ok(page)
}

fn said(workspace: &Workspace, arguments: &[&str]) -> Result<String, Box<dyn Error>> {
    let output = workspace.command(workspace.binary()).args(arguments).output()?;
    if !output.status.success() {
        return Err(format!("`lennard {}` failed", arguments.join(" ")).into());
    }
    Ok(String::from_utf8(output.stdout)?)
}
