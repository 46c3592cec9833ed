//! Checks of the repository itself.

mod circles;
#[cfg(test)]
mod documents;
mod features;
mod finding;
mod layers;
mod methods;
mod readme;
mod sentences;
mod sizes;
mod test_binaries;
mod tracked;

use std::error::Error;

use crate::workspace::Workspace;
use finding::Finding;
pub use readme::{commands, lennard_commands};

/// Runs every check.
pub fn all(workspace: &Workspace) -> Result<Vec<Finding>, Box<dyn Error>> {
    let mut findings = vec![("crates depend as designed", layers::faults(&workspace.packages))];
    findings.push((
        "README.md and docs name what exists",
        // A document that cannot be read is a fault like others: the rest is still checked.
        readme::faults_in_documents(workspace).unwrap_or_else(|error| vec![error.to_string()]),
    ));
    findings.push(("one test binary per crate", test_binaries::faults(&workspace.packages)));
    findings.push(("each library is compiled once", features::faults(workspace)?));
    findings.push(("no circles of files", circles::faults(workspace)?));
    findings.push(("files fit a sitting", sizes::faults(workspace)?));
    findings.push(("methods are named in one file and one line", methods::faults(workspace)?));
    findings.push(("sentences are short and have nouns", sentences::faults(workspace)?));
    findings.extend(tracked::findings(workspace)?);
    Ok(findings)
}
