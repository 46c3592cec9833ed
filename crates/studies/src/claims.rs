//! Who claims what, what theory says, what was measured, and the verdict that follows.

use crate::report::significant;
use lennard_core::{Cell, Table, Tone};
use lennard_observables::{Allowed, Reference, Verdict, judge};
use serde::{Serialize, Serializer};

/// A tolerance of rounding.
pub(crate) const ROUNDING: &str = "rounding over the steps";
/// A tolerance of an order.
pub(crate) const NEXT_TERM: &str = "next term of the error expansion at the smallest step";

/// Who makes a claim.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Source {
    /// The article on Verlet integration.
    Article,
    /// The manual of the SPOOK integrator.
    Manual,
    /// This program: declared by a method, or derived here.
    Ours,
}

impl Source {
    /// The source in words.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            Self::Article => "article on Verlet integration",
            Self::Manual => "manual of the SPOOK integrator",
            Self::Ours => "ours",
        }
    }
}

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
    /// Whether a number meets it: it agrees or it differs. Not-a-number meets nothing.
    #[must_use]
    pub fn judge(self, measured: f64) -> Verdict {
        let (reference, within) = match self {
            Self::Above(bound) => (Reference::above(bound), 0.0),
            Self::Below(bound) => (Reference::below(bound), 0.0),
            Self::Near { value, within } => (Reference::value(value), within),
        };
        judge(measured, reference, Allowed::within(within))
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

/// One claim beside its measurement.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Claim {
    /// Who makes it.
    pub source: Source,
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
    #[serde(serialize_with = "as_a_claim")]
    pub verdict: Verdict,
}

/// `holds` or `does-not-hold`.
fn as_a_claim<S: Serializer>(verdict: &Verdict, to: S) -> Result<S::Ok, S::Error> {
    to.serialize_str(&verdict.words_of_claim().replace(' ', "-"))
}

/// A claim judged by a measured number.
pub(crate) fn judged(
    source: Source,
    statement: impl Into<String>,
    quantity: impl Into<String>,
    demand: Demand,
    measured: f64,
) -> Claim {
    Claim {
        source,
        statement: statement.into(),
        quantity: quantity.into(),
        demand,
        theory: None,
        measured,
        tolerance: 0.0,
        tolerance_reason: "",
        theory_agrees: true,
        verdict: demand.judge(measured),
    }
}

/// A claim that a number is the one of theory, within a tolerance with a cause.
pub(crate) fn near(
    source: Source,
    statement: impl Into<String>,
    quantity: impl Into<String>,
    theory: (f64, f64, &'static str),
    measured: f64,
) -> Claim {
    let (value, within, _) = theory;
    let near = Demand::Near { value, within };
    judged(source, statement, quantity, near, measured).with_theory(theory)
}

impl Claim {
    /// With what theory gives, how far the measurement may be from it, and why.
    #[must_use]
    pub fn with_theory(self, (theory, tolerance, reason): (f64, f64, &'static str)) -> Self {
        Self {
            theory: Some(theory),
            tolerance,
            tolerance_reason: reason,
            theory_agrees: Demand::Near { value: theory, within: tolerance }.judge(self.measured)
                == Verdict::Agrees,
            ..self
        }
    }
}

/// How many claims there are, and how many of them hold, as the end of a sentence.
pub(crate) fn tally(claims: &[Claim]) -> String {
    let failing = claims.iter().filter(|c| c.verdict == Verdict::Differs);
    let failing = failing.count();
    format!(
        "Of {} claims, {} hold and {failing} {} not",
        claims.len(),
        claims.len() - failing,
        if failing == 1 { "does" } else { "do" },
    )
}

/// The claims for a reader.
#[must_use]
pub fn table(claims: &[Claim]) -> Table {
    let caption = "What each source claims beside what was measured. “Ours” is what a method of this program declares, \
                   or what is derived here. A verdict is computed: it says whether \
                   the measured number meets the claim. In the column of the theory, “differs” \
                   means that theory and measurement disagree by more than a stated cause explains. `claims.csv` \
                   has tolerances and their causes.";
    Table::rows_of("claims", claims)
        .caption(caption)
        .column("Source", |c| c.source.words())
        .column("Claim", |c| &c.statement)
        .column("Judged by", |c| &c.quantity)
        .column("Wanted", |c| Cell::figures(c.demand.in_words()))
        .column("Theory", |c| match c.theory {
            Some(t) if !c.theory_agrees => {
                Cell::figures(format!("{} (differs)", significant(t, 8))).toned(Tone::Bad)
            }
            theory => Cell::rounded(theory, 8),
        })
        .column("Measured", |c| Cell::rounded(c.measured, 8))
        .column("Verdict", |c| Cell::words(c.verdict.words_of_claim()).toned(c.verdict.tone()))
        .table()
}

/// The claims for a program.
pub(crate) fn csv(claims: &[Claim]) -> Table {
    Table::rows_of("claims", claims)
        .column("source", |c| c.source.words())
        .column("claim", |c| &c.statement)
        .column("judged by", |c| &c.quantity)
        .column("theory", |c| c.theory)
        .column("measured", |c| c.measured)
        .column("tolerance", |c| c.tolerance)
        .column("tolerance from", |c| c.tolerance_reason)
        .column("theory agrees", |c| c.theory_agrees)
        .column("verdict", |c| c.verdict.words_of_claim())
        .table()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn verdicts_follow_the_numbers() {
        let verdict = |demand, measured| judged(Source::Ours, "c", "q", demand, measured).verdict;
        assert_eq!(verdict(Demand::Above(1.0), 1.1), Verdict::Agrees);
        assert_eq!(verdict(Demand::Above(1.0), 1.0), Verdict::Differs);
        assert_eq!(verdict(Demand::Below(1.0), f64::NAN), Verdict::Differs);
        let near = Demand::Near { value: 2.0, within: 0.05 };
        assert_eq!(verdict(near, 2.04), Verdict::Agrees);
        assert_eq!(verdict(near, 1.9), Verdict::Differs);
        let off = judged(Source::Ours, "c", "q", near, 2.0);
        let off = off.with_theory((2.1, 0.01, "rounding"));
        assert!(!off.theory_agrees && off.verdict == Verdict::Agrees);
    }
}
