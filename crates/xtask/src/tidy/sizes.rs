//! Files that fit a sitting.

use std::error::Error;

use crate::workspace::Workspace;

/// The most lines of a source file; tests may take more.
const MOST_LINES: usize = 800;

/// Every source file that is too long.
pub fn faults(workspace: &Workspace) -> Result<Vec<String>, Box<dyn Error>> {
    let mut faults = Vec::new();
    for name in workspace.tracked(&["*.rs"])? {
        let is_test = name.contains("/tests/") || name.ends_with("/tests.rs");
        // A file that is deleted and still tracked has no lines.
        let Ok(text) = std::fs::read_to_string(workspace.root.join(&name)) else {
            continue;
        };
        faults.extend((!is_test).then(|| fault(&name, &text)).flatten());
    }
    Ok(faults)
}

fn fault(name: &str, text: &str) -> Option<String> {
    let lines = text.lines().count();
    (lines > MOST_LINES).then(|| format!("{name} has {lines} lines: at most {MOST_LINES}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_too_long_one_line_beyond_the_limit() {
        assert_eq!(fault("a.rs", &"x\n".repeat(MOST_LINES)), None);
        assert!(fault("a.rs", &"x\n".repeat(MOST_LINES + 1)).is_some());
    }
}
