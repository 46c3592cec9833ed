//! Checks of the repository itself.

mod circles;
mod features;
mod layers;
mod methods;
mod sentences;
mod sizes;
mod test_binaries;
mod tracked;

use std::error::Error;

use crate::workspace::Workspace;

/// Runs every check, and prints what each finds.
pub fn check(workspace: &Workspace) -> Result<(), Box<dyn Error>> {
    let mut found = vec![
        ("crates depend as designed", layers::faults(&workspace.packages)),
        ("one test binary per crate", test_binaries::faults(&workspace.packages)),
        ("each library is compiled once", features::faults(workspace)?),
        ("no circles of files", circles::faults(workspace)?),
        ("files fit a sitting", sizes::faults(workspace)?),
        ("methods are named in one file and one line", methods::faults(workspace)?),
        ("sentences are short and have nouns", sentences::faults(workspace)?),
    ];
    found.extend(tracked::findings(workspace)?);
    for (check, faults) in &found {
        println!("{check}: {}", if faults.is_empty() { "fine" } else { "" });
        faults.iter().for_each(|fault| println!("  {fault}"));
    }
    match found.iter().filter(|(_, faults)| !faults.is_empty()).count() {
        0 => Ok(()),
        count => Err(format!("{count} checks found faults").into()),
    }
}
