//! What a source claims, what theory says, what was measured, and the verdict that follows.

use lennard_report::{Cell, PageTable, Tone, significant};
use serde::Serialize;

/// What a claim demands of the measured number.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Demand {
    /// It is larger than this.
    Above(f64),
    /// It is smaller than this.
    Below(f64),
    /// It is this number within a tolerance.
    Near {
        /// The number.
        value: f64,
        /// The largest difference allowed.
        within: f64,
    },
}

impl Demand {
    /// Whether a number meets it; not-a-number meets nothing.
    #[must_use]
    pub fn met_by(self, measured: f64) -> bool {
        match self {
            Self::Above(bound) => measured > bound,
            Self::Below(bound) => measured < bound,
            Self::Near { value, within } => (measured - value).abs() <= within,
        }
    }

    fn in_words(self) -> String {
        match self {
            Self::Above(bound) => format!("> {}", significant(bound, 3)),
            Self::Below(bound) => format!("< {}", significant(bound, 3)),
            Self::Near { value, within } => {
                format!("{} ± {}", significant(value, 6), significant(within, 1))
            }
        }
    }
}

/// Whether a claim holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// The measurement meets the claim.
    Holds,
    /// It does not.
    DoesNotHold,
}

/// One claim beside its measurement.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Claim {
    /// Who says it.
    pub source: &'static str,
    /// What is said.
    pub statement: String,
    /// The number that decides.
    pub quantity: String,
    /// What the claim demands of that number.
    pub demand: Demand,
    /// What theory gives for it, where it gives a number.
    pub theory: Option<f64>,
    /// What was measured.
    pub measured: f64,
    /// The largest difference between theory and measurement that its cause explains.
    pub tolerance: f64,
    /// Where that tolerance comes from.
    pub tolerance_reason: &'static str,
    /// Whether theory and measurement agree within the tolerance.
    pub theory_agrees: bool,
    /// Whether the claim holds, by the measurement.
    pub verdict: Verdict,
}

impl Claim {
    /// A claim judged by a measured number.
    #[must_use]
    pub fn judge(
        source: &'static str,
        statement: impl Into<String>,
        quantity: impl Into<String>,
        demand: Demand,
        measured: f64,
    ) -> Self {
        Self {
            source,
            statement: statement.into(),
            quantity: quantity.into(),
            demand,
            theory: None,
            measured,
            tolerance: 0.0,
            tolerance_reason: "",
            theory_agrees: true,
            verdict: if demand.met_by(measured) {
                Verdict::Holds
            } else {
                Verdict::DoesNotHold
            },
        }
    }

    /// With what theory gives, and how far the measurement may be from it.
    #[must_use]
    pub fn with_theory(self, theory: f64, tolerance: f64, tolerance_reason: &'static str) -> Self {
        Self {
            theory: Some(theory),
            tolerance,
            tolerance_reason,
            theory_agrees: (self.measured - theory).abs() <= tolerance,
            ..self
        }
    }
}

/// The claims as a table of a page.
#[must_use]
pub fn table(claims: &[Claim], caption: impl Into<String>, command: &str) -> PageTable {
    let rows = claims
        .iter()
        .map(|c| {
            let (word, tone) = match c.verdict {
                Verdict::Holds => ("holds", Tone::Good),
                Verdict::DoesNotHold => ("does not hold", Tone::Bad),
            };
            let theory = match c.theory {
                None => Cell::text("–"),
                Some(t) if c.theory_agrees => Cell::number(significant(t, 8)),
                Some(t) => Cell::toned(format!("{} (differs)", significant(t, 8)), Tone::Bad),
            };
            vec![
                Cell::text(c.source),
                Cell::text(c.statement.clone()),
                Cell::text(c.quantity.clone()),
                Cell::number(c.demand.in_words()),
                theory,
                Cell::number(significant(c.measured, 8)),
                Cell::toned(word, tone),
            ]
        })
        .collect();
    PageTable {
        caption: caption.into(),
        command: Some(command.to_owned()),
        header: [
            "Source",
            "Claim",
            "Judged by",
            "Wanted",
            "Theory",
            "Measured",
            "Verdict",
        ]
        .map(str::to_owned)
        .to_vec(),
        rows,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn verdicts_follow_the_numbers() {
        let judge = |demand, measured| Claim::judge("s", "c", "q", demand, measured).verdict;
        assert_eq!(judge(Demand::Above(1.0), 1.1), Verdict::Holds);
        assert_eq!(judge(Demand::Above(1.0), 1.0), Verdict::DoesNotHold);
        assert_eq!(judge(Demand::Below(1.0), f64::NAN), Verdict::DoesNotHold);
        let near = Demand::Near {
            value: 2.0,
            within: 0.05,
        };
        assert_eq!(judge(near, 2.04), Verdict::Holds);
        assert_eq!(judge(near, 1.9), Verdict::DoesNotHold);
        let off = Claim::judge("s", "c", "q", near, 2.0).with_theory(2.1, 0.01, "rounding");
        assert!(!off.theory_agrees && off.verdict == Verdict::Holds);
    }
}
