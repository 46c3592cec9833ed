//! How many tests passed, read from what the test runners print.

use std::ops::AddAssign;

/// Numbers of tests.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Counts {
    /// How many passed.
    pub passed: u64,
    /// How many failed, errors included.
    pub failed: u64,
    /// How many were skipped or ignored.
    pub skipped: u64,
}

impl AddAssign for Counts {
    fn add_assign(&mut self, o: Self) {
        self.passed += o.passed;
        self.failed += o.failed;
        self.skipped += o.skipped;
    }
}

/// Whose output it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// `cargo test`: one line a test binary, `test result: ok. 3 passed; 0 failed; 1 ignored; …`.
    CargoTest,
    /// `pytest`: one line at the end, `3 passed, 1 failed, 2 skipped, 5 deselected in 0.12s`.
    Pytest,
}

impl Format {
    /// What a line of output adds to the counts.
    #[must_use]
    pub fn counts_in(self, line: &str) -> Option<Counts> {
        let list = match self {
            Self::CargoTest => line.strip_prefix("test result: ")?.split_once(". ")?.1,
            Self::Pytest => {
                let line = line.trim_matches(|c: char| c == '=' || c.is_whitespace());
                let (list, time) = line.rsplit_once(" in ")?;
                // `0.12s`, or `63.10s (0:01:03)`.
                time.starts_with(|c: char| c.is_ascii_digit()).then_some(list)?
            }
        };
        let mut counts = Counts::default();
        let mut any = false;
        for entry in list.split([';', ',']) {
            let mut words = entry.split_whitespace();
            let (Some(number), Some(what)) = (words.next(), words.next()) else {
                continue;
            };
            let Ok(number) = number.parse::<u64>() else {
                continue;
            };
            match what {
                "passed" => counts.passed += number,
                "failed" | "error" | "errors" => counts.failed += number,
                "ignored" | "skipped" | "xfailed" | "xpassed" => counts.skipped += number,
                "deselected" | "measured" | "filtered" | "warning" | "warnings" => {}
                _ => continue,
            }
            any = true;
        }
        any.then_some(counts)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn counts(passed: u64, failed: u64, skipped: u64) -> Option<Counts> {
        Some(Counts { passed, failed, skipped })
    }

    #[test]
    fn cargo_test_is_counted_by_its_result_lines() {
        let read = |line| Format::CargoTest.counts_in(line);
        let line = "test result: FAILED. 10 passed; 2 failed; 1 ignored; 0 measured; 4 filtered out; finished in 0.07s";
        assert_eq!(read(line), counts(10, 2, 1));
        assert_eq!(read("test energy_is_conserved ... ok"), None);
        assert_eq!(read("running 3 tests"), None);
    }

    #[test]
    fn pytest_is_counted_by_its_last_line() {
        let read = |line| Format::Pytest.counts_in(line);
        assert_eq!(
            read(
                "2 failed, 30 passed, 1 skipped, 12 deselected, 3 warnings, 1 error in 63.10s (0:01:03)"
            ),
            counts(30, 3, 1)
        );
        assert_eq!(read("===== 5 passed in 1.02s ====="), counts(5, 0, 0));
        assert_eq!(read("no tests ran in 0.01s"), None);
        assert_eq!(read("FAILED test_x.py::test_y - assert 3 passed"), None);
        assert_eq!(read("a word in another sentence"), None);
    }
}
