//! An input script under way.

/// The commands so far, and what is to be known of them.
#[derive(Default)]
pub(super) struct Script {
    /// The commands and comments.
    pub(super) text: String,
    /// What is not the same in LAMMPS, one sentence each.
    pub(super) remarks: Vec<String>,
}

impl Script {
    /// A command with its arguments.
    pub(super) fn command(&mut self, name: &str, arguments: impl AsRef<str>) {
        self.text += format!("{name:<15} {}", arguments.as_ref()).trim_end();
        self.text.push('\n');
    }

    /// A line that LAMMPS passes over.
    pub(super) fn comment(&mut self, words: impl AsRef<str>) {
        self.text += format!("# {}", words.as_ref()).trim_end();
        self.text.push('\n');
    }

    /// A blank line.
    pub(super) fn gap(&mut self) {
        self.text.push('\n');
    }

    /// Something that is not the same in LAMMPS: a comment here, and a remark for the user.
    pub(super) fn remark(&mut self, words: impl Into<String>) {
        let words = words.into();
        self.comment(format!("Not the same: {words}"));
        if !self.remarks.contains(&words) {
            self.remarks.push(words);
        }
    }
}
