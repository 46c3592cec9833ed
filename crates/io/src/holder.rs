//! Who holds a folder: a process, its machine, and the start of that machine.

use std::fmt;
use std::fs;
use std::path::Path;

/// A process, as a claim file names it: number, machine and start of the machine, each on its line.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Holder {
    process: u32,
    /// Name of the machine; empty where it is not known.
    machine: String,
    /// Changes whenever the machine starts; empty where it is not known.
    start: String,
}

impl Holder {
    /// This process.
    pub(crate) fn here() -> Self {
        Self {
            process: std::process::id(),
            machine: said_by("/proc/sys/kernel/hostname"),
            start: said_by("/proc/sys/kernel/random/boot_id"),
        }
    }

    /// The process that a claim file names.
    pub(crate) fn parse(text: &str) -> Option<Self> {
        let mut lines = text.lines().map(str::trim);
        let process = lines.next()?.parse().ok()?;
        let mut next = || lines.next().unwrap_or_default().to_owned();
        Some(Self { process, machine: next(), start: next() })
    }

    /// The content of a claim file.
    pub(crate) fn text(&self) -> String {
        format!("{}\n{}\n{}\n", self.process, self.machine, self.start)
    }

    /// Whether it belongs to this machine since its last start, where all locks are seen. Without a start it does.
    pub(crate) fn is_here(&self) -> bool {
        self.start.is_empty() || self.start == Self::here().start
    }

    /// Whether a process of this number lives on this machine, as far as the system tells.
    pub(crate) fn has_process(&self) -> bool {
        Path::new("/proc").join(self.process.to_string()).exists()
    }
}

impl fmt::Display for Holder {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "process {}", self.process)?;
        if !self.is_here() && !self.machine.is_empty() {
            write!(f, " on {}", self.machine)?;
        }
        Ok(())
    }
}

/// What a file of the system says, where there is one.
fn said_by(file: &str) -> String {
    fs::read_to_string(file).map(|text| text.trim().to_owned()).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_holder_is_read_back_and_another_machine_is_named() {
        let here = Holder::here();
        assert_eq!(Holder::parse(&here.text()), Some(here.clone()));
        assert!(here.is_here() && here.has_process());
        assert_eq!(here.to_string(), format!("process {}", std::process::id()));
        let there = Holder::parse("17\nnode-7\nx\n").unwrap();
        assert!(!there.is_here());
        assert_eq!(there.to_string(), "process 17 on node-7");
        // A claim of an earlier version names no machine.
        assert!(Holder::parse("17\n").unwrap().is_here());
        assert_eq!(Holder::parse("who\n"), None);
    }
}
