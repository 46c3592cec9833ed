//! Claims as data: who claims what, by which number it is judged, what theory says, and the verdict.
//!
//! A study has a file of claims and a list of measured `Numbers`. A row of the file names its number by a key, and
//! the labels of that number fill the braces of the row. A row may stand for every number of its key.

use crate::report::{Given, Page, Section, filled, significant, written};
use crate::{Study, StudyError, StudyOptions};
use lennard_observables::{Allowed, Cell, Reference, Table, Tone, Verdict, judge};
use serde::{Deserialize, Serialize, Serializer};

/// Who makes a claim.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
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
    pub(crate) fn words(self) -> &'static str {
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
    pub tolerance_reason: String,
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

/// A measured number, with the labels that tell it apart from others of its key.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Number {
    key: &'static str,
    measured: f64,
    labels: Vec<(&'static str, String)>,
}

impl Number {
    /// Adds a label.
    pub(crate) fn of(&mut self, label: &'static str, value: impl ToString) -> &mut Self {
        self.labels.push((label, value.to_string()));
        self
    }

    /// Adds what theory gives for the number; `None` where it gives none.
    pub(crate) fn theory(&mut self, theory: impl Into<Option<f64>>) -> &mut Self {
        self.of("theory", theory.into().map_or("none".into(), |value| value.to_string()))
    }

    /// Whether the number has every label of a list `name=value; name=value`.
    fn is_at(&self, labels: &str) -> bool {
        labels.split("; ").filter_map(|label| label.split_once('=')).all(|(name, value)| {
            self.labels.iter().any(|(label, has)| *label == name && has == value)
        })
    }

    /// A text with the values of the labels in braces.
    fn filled(&self, text: &str) -> String {
        filled(text, &self.labels)
    }

    /// The value of a sum of products, such as `0.02 + 1e-6 * {theory}`; `None` where a part of it is no number.
    fn value(&self, sum: &str) -> Option<f64> {
        let product = |term: &str| -> Option<f64> {
            term.split(" * ").map(|factor| factor.trim().parse::<f64>().ok()).product()
        };
        self.filled(sum).split(" + ").map(product).sum()
    }
}

/// The measured numbers of a study that judge its claims.
#[derive(Debug, Clone, Default, Serialize)]
pub(crate) struct Numbers(Vec<Number>);

impl Numbers {
    /// Adds a number under its key; the labels follow.
    pub(crate) fn add(&mut self, key: &'static str, measured: f64) -> &mut Number {
        self.0.push(Number { key, measured, labels: Vec::new() });
        let last = self.0.len() - 1;
        &mut self.0[last]
    }
}

/// A row of a file of claims. Texts in braces stand for labels of the number that judges the claim.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
struct Row {
    /// Who makes the claim. A row without a source goes on with the row above: a number belongs to the first of such
    /// rows whose labels it has.
    source: Option<Source>,
    /// What is said.
    statement: String,
    /// The number that decides, in words.
    quantity: String,
    /// Key of that number.
    key: String,
    /// Labels that the number must have.
    at: String,
    /// `> x`, `< x`, `x ± y`, or `near`: the theory within the tolerance.
    demand: String,
    /// What theory gives for the number; empty where it gives none.
    theory: String,
    /// The largest difference between theory and measurement that its cause explains.
    tolerance: String,
    /// That cause.
    reason: String,
}

impl Row {
    /// The claim about a number; `None` where a value of the row is no number.
    fn judged(&self, source: Source, number: &Number) -> Option<Claim> {
        let theory = number.value(&self.theory);
        let tolerance = theory.and_then(|_| number.value(&self.tolerance));
        let demand = match self.demand.split_once(' ') {
            Some((">", bound)) => Demand::Above(number.value(bound)?),
            Some(("<", bound)) => Demand::Below(number.value(bound)?),
            Some(_) => {
                let (value, within) = self.demand.split_once(" ± ")?;
                Demand::Near { value: number.value(value)?, within: number.value(within)? }
            }
            None => Demand::Near { value: theory?, within: tolerance? },
        };
        let measured = number.measured;
        Some(Claim {
            source,
            statement: number.filled(&self.statement),
            quantity: number.filled(&self.quantity),
            demand,
            theory,
            measured,
            tolerance: tolerance.unwrap_or(0.0),
            tolerance_reason: theory.map_or(String::new(), |_| self.reason.clone()),
            theory_agrees: theory.is_none_or(|value| {
                let near = Demand::Near { value, within: tolerance.unwrap_or(0.0) };
                near.judge(measured) == Verdict::Agrees
            }),
            verdict: demand.judge(measured),
        })
    }
}

fn rows(file: &str) -> Result<Vec<Row>, StudyError> {
    Ok(csv::Reader::from_reader(file.as_bytes()).deserialize().collect::<Result<_, _>>()?)
}

/// The claims of a file about numbers, in the order of the file.
///
/// # Errors
/// [`StudyError::Claims`] where the file is no table of claims.
pub(crate) fn judged(file: &str, numbers: &Numbers) -> Result<Vec<Claim>, StudyError> {
    let mut claims = Vec::new();
    for rows in rows(file)?.chunk_by(|_, next| next.source.is_none()) {
        for number in numbers.0.iter().filter(|n| n.key == rows[0].key) {
            let row = rows.iter().find(|row| number.is_at(&row.at));
            claims.extend(row.zip(rows[0].source).and_then(|(row, by)| row.judged(by, number)));
        }
    }
    Ok(claims)
}

/// Rows of a file that judge no number, keys of numbers that no row names, and texts with braces that no label fills.
fn loose_ends(file: &str, numbers: &Numbers) -> Vec<String> {
    let mut loose = Vec::new();
    let all = rows(file).expect("a table of claims");
    for rows in all.chunk_by(|_, next| next.source.is_none()) {
        let of_key: Vec<&Number> = numbers.0.iter().filter(|n| n.key == rows[0].key).collect();
        for (i, row) in rows.iter().enumerate() {
            let is_first = |n: &&&Number| rows.iter().position(|r| n.is_at(&r.at)) == Some(i);
            let number = of_key.iter().find(is_first);
            if number.and_then(|n| row.judged(Source::Ours, n)).is_none() {
                loose.push(format!("no number answers: {}", row.statement));
            }
        }
    }
    for number in &numbers.0 {
        if !all.iter().any(|row| row.key == number.key) {
            loose.push(format!("no claim uses: {}", number.key));
        }
    }
    let claims = judged(file, numbers).expect("a table of claims");
    let is_open = |text: &str| text.split('{').skip(1).any(|t| t.starts_with(char::is_alphabetic));
    let texts = claims.iter().flat_map(|c| [&c.statement, &c.quantity]);
    loose.extend(texts.filter(|text| is_open(text)).map(|text| format!("no label fills: {text}")));
    loose
}

/// How many claims there are, and how many of them hold, as the end of a sentence.
fn tally(claims: &[Claim]) -> String {
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
fn table(claims: &[Claim]) -> Table {
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

/// What the parts of a study have measured. Each part adds tables and numbers of its own.
#[derive(Debug, Default, Serialize)]
pub(crate) struct Measured {
    /// Tables with every digit: they are in the record, and files.
    pub tables: Vec<Table>,
    /// Tables of curves, which are files and figures alone.
    #[serde(skip)]
    pub curves: Vec<Table>,
    /// The numbers that judge claims.
    pub numbers: Numbers,
    /// Words and lists of the page, and tables of the page alone.
    #[serde(skip)]
    pub given: Given,
}

impl Measured {
    /// Words that the text of the page has in braces.
    pub(crate) fn word(&mut self, name: &'static str, word: String) {
        self.given.words.push((name, word));
    }
}

/// The files of a study: who claims what, and the page with its figures.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Text {
    pub claims: &'static str,
    pub page: &'static str,
}

/// A study that judges claims.
#[derive(Debug, Serialize)]
pub struct ClaimsStudy {
    /// Name and version of the schema.
    pub schema: &'static str,
    /// What was asked for.
    pub options: StudyOptions,
    #[serde(flatten)]
    found: Measured,
    /// What is claimed, by whom, and whether it holds.
    pub claims: Vec<Claim>,
    #[serde(skip)]
    page: &'static str,
}

impl ClaimsStudy {
    /// Judges what was measured. A claim may find no number where the fluid is a user's own. Elsewhere a loose end of claims or numbers
    /// is a panic of debug builds.
    pub(crate) fn new(
        schema: &'static str,
        text: Text,
        options: &StudyOptions,
        found: Measured,
        is_own: bool,
    ) -> Result<Self, StudyError> {
        let loose = || loose_ends(text.claims, &found.numbers);
        debug_assert!(is_own || loose().is_empty(), "{:?}", loose());
        let claims = judged(text.claims, &found.numbers)?;
        Ok(Self { schema, options: options.clone(), found, claims, page: text.page })
    }
}

impl Study for ClaimsStudy {
    fn tables(&self) -> Vec<Table> {
        [&self.found.tables[..], &self.found.curves, &[csv(&self.claims)]].concat()
    }

    fn page(&self) -> Result<Page, StudyError> {
        let mut given = self.found.given.clone();
        // A table of the page alone comes first: it has every column that the page names.
        given.tables.extend([&self.found.tables[..], &self.found.curves].concat());
        let (claims, options) = (&self.claims, &self.options);
        let differing = claims.iter().filter(|c| !c.theory_agrees).count();
        given.words.extend([("verdicts", tally(claims)), ("differing", differing.to_string())]);
        let mut page = written(self.page, &given)?;
        let settings = if options.quick { "quick: shorter runs" } else { "full" };
        let is_open = |claim: &&Claim| claim.verdict == Verdict::Differs || !claim.theory_agrees;
        let open: Vec<Claim> = claims.iter().filter(is_open).cloned().collect();
        if !open.is_empty() {
            let section = Section::new("Claims that do not hold, and theory that differs");
            page.sections.insert(1, section.table(table(&open)));
        }
        let all = Section::new("Claims and verdicts").table(table(claims));
        page.sections.push(all.brief(&["Judged by", "Wanted"]).folded());
        page.command = Some(options.command.clone());
        page.provenance = vec![
            ("Command".into(), format!("`{}`", options.command)),
            ("Settings".into(), settings.into()),
        ];
        page.provenance.extend(options.provenance.iter().cloned());
        Ok(page)
    }
}

/// The claims for a program.
fn csv(claims: &[Claim]) -> Table {
    Table::rows_of("claims", claims)
        .column("source", |c| c.source.words())
        .column("claim", |c| &c.statement)
        .column("judged by", |c| &c.quantity)
        .column("theory", |c| c.theory)
        .column("measured", |c| c.measured)
        .column("tolerance", |c| c.tolerance)
        .column("tolerance from", |c| &c.tolerance_reason)
        .column("theory agrees", |c| c.theory_agrees)
        .column("verdict", |c| c.verdict.words_of_claim())
        .table()
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEADING: &str = "source,statement,quantity,key,at,demand,theory,tolerance,reason\n";

    /// The claims of some rows about numbers 1.5 and 2.5 of the key `k`, with labels `a` and `b`.
    fn claims(rows: &str) -> (Vec<Claim>, Vec<String>) {
        let mut numbers = Numbers::default();
        numbers.add("k", 1.5).of("name", "a").theory(1.4);
        numbers.add("k", 2.5).of("name", "b").theory(None);
        let file = format!("{HEADING}{rows}");
        (judged(&file, &numbers).unwrap(), loose_ends(&file, &numbers))
    }

    #[test]
    fn verdicts_follow_the_numbers() {
        let demands = [
            (Demand::Above(1.0), 1.1, true),
            (Demand::Above(1.0), 1.0, false),
            (Demand::Below(1.0), f64::NAN, false),
            (Demand::Near { value: 2.0, within: 0.05 }, 2.04, true),
            (Demand::Near { value: 2.0, within: 0.05 }, 1.9, false),
        ];
        for (demand, measured, holds) in demands {
            assert_eq!(demand.judge(measured) == Verdict::Agrees, holds, "{demand:?}, {measured}");
        }
        // Theory and claim are two questions.
        let (claims, _) = claims("ours,s,q,k,name=a,> 2,{theory},0.2 * {theory},rounding\n");
        assert!(claims[0].theory_agrees && claims[0].verdict == Verdict::Differs);
        assert_eq!((claims[0].theory, claims[0].tolerance), (Some(1.4), 0.2 * 1.4));
    }

    #[test]
    fn a_row_judges_every_number_of_its_key_and_the_first_row_that_fits_a_number_has_it() {
        let (claims, loose) = claims(
            "manual,of {name},q,k,name=b,> 1 + 2,{theory},1,none\n,else of {name},q,,,1 ± 0.5,,,\n",
        );
        let said: Vec<_> = claims.iter().map(|c| (c.statement.as_str(), c.verdict)).collect();
        assert_eq!(said, [("else of a", Verdict::Agrees), ("of b", Verdict::Differs)]);
        assert_eq!((claims[1].theory, claims[1].tolerance_reason.as_str()), (None, ""));
        assert_eq!(loose, Vec::<String>::new());
    }

    #[test]
    fn rows_without_numbers_and_numbers_without_rows_are_found_and_a_broken_file_is_an_error() {
        let (_, loose) = claims("ours,s of {who},q,k,,> 1,,,\nours,other,q,none,,> 1,,,\n");
        let wanted = ["no number answers: other", "no label fills: s of {who}"];
        assert_eq!(loose[..2], wanted.map(str::to_owned));
        let (_, loose) = claims("ours,s,q,k,name=c,> 1,,,\nours,t,q,k,name=a,> {theory} * x,,,\n");
        assert_eq!(loose, ["no number answers: s", "no number answers: t"]);
        let (_, loose) = claims("");
        assert_eq!(loose, ["no claim uses: k", "no claim uses: k"]);
        let error = judged("source,statement\nnobody,s\n", &Numbers::default()).unwrap_err();
        assert!(error.to_string().starts_with("the table of claims: "), "{error}");
    }
}
