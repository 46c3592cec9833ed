//! The file of a table: three columns r, U and F, one row per line.

/// The fewest rows of a table.
const FEWEST_ROWS: usize = 16;
/// The most rows of a table.
const MOST_ROWS: usize = 1_000_000;
/// The largest number of a table: its square must not overflow single precision.
const LARGEST: f64 = 1e15;
/// By how much F may differ from the slope of U, as a share of the largest force among three rows.
const SHARE_OF_NEIGHBORS: f64 = 0.01;
/// The same as a share of the median force of the table.
const SHARE_OF_MEDIAN: f64 = 1e-3;
/// A row or a column that is off by so many times as much is the wrong one.
const FAR_WORSE: f64 = 1.2;

/// One row of a file.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Knot {
    /// Line in the file, from 1.
    pub line: usize,
    /// r, σ.
    pub r: f64,
    /// U, ε.
    pub energy: f64,
    /// F = −U′, ε/σ: positive for repulsion.
    pub force: f64,
}

impl Knot {
    /// r².
    pub fn s(&self) -> f64 {
        self.r * self.r
    }

    /// dU/ds with s = r².
    pub fn slope(&self) -> f64 {
        -self.force / (2.0 * self.r)
    }
}

/// Why a file is no table.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Refusal {
    /// What was found, with the line.
    pub found: String,
    /// What is allowed.
    pub allowed: String,
}

impl Refusal {
    pub fn new(found: impl Into<String>, allowed: impl Into<String>) -> Self {
        Self { found: found.into(), allowed: allowed.into() }
    }
}

/// Reads the rows of a text. Empty lines and lines that begin with `#` count for nothing.
pub fn read(text: &str) -> Result<Vec<Knot>, Refusal> {
    let mut knots: Vec<Knot> = Vec::new();
    for (line, content) in (1..).zip(text.lines()) {
        let content = content.trim();
        if content.is_empty() || content.starts_with('#') {
            continue;
        }
        let allowed = "three finite numbers: r, U and F = -dU/dr, at most 1e15, with r above 0";
        let numbers: Vec<f64> = content
            .split_ascii_whitespace()
            .map_while(|token| token.parse().ok().filter(|x: &f64| x.abs() <= LARGEST))
            .collect();
        let columns = content.split_ascii_whitespace().count();
        let &[r, energy, force] = numbers.as_slice() else {
            let shown: String = content.chars().take(60).collect();
            return Err(Refusal::new(format!("line {line}: `{shown}`"), allowed));
        };
        if columns != 3 || !(1e-3..=1e6).contains(&r) {
            return Err(Refusal::new(
                format!("line {line}: {columns} columns with r = {r}"),
                "three columns, with r from 0.001 to 1e6",
            ));
        }
        if let Some(before) = knots.last()
            && r <= before.r
        {
            return Err(Refusal::new(
                format!("line {line}: r = {r} after r = {}", before.r),
                "r that grows from line to line",
            ));
        }
        if knots.len() == MOST_ROWS {
            return Err(Refusal::new(
                format!("more than {MOST_ROWS} rows"),
                format!("at most {MOST_ROWS}"),
            ));
        }
        knots.push(Knot { line, r, energy, force });
    }
    if knots.len() < FEWEST_ROWS {
        return Err(Refusal::new(
            format!("{} rows", knots.len()),
            format!("at least {FEWEST_ROWS} rows"),
        ));
    }
    Ok(knots)
}

/// Refuses a table whose force is not −dU/dr.
///
/// The cubic that has the values and slopes of the rows before and after gives the slope of U at each row.
pub fn check(knots: &[Knot]) -> Result<(), Refusal> {
    let mut sizes: Vec<f64> = knots.iter().map(|k| k.force.abs()).collect();
    sizes.sort_by(f64::total_cmp);
    let floor = SHARE_OF_MEDIAN * sizes[sizes.len() / 2];
    let judged: Vec<Judged<'_>> = knots.windows(3).filter_map(|k| judged(k, floor)).collect();
    let Some(first) = judged.iter().position(|row| row.force.1 > 1.0) else {
        return Ok(());
    };
    // A wrong row bends the cubics of the rows beside it, so that these fail too, by less. The first row that fails is named, or one of the
    // next two that is far worse.
    let near = judged[first..].iter().take(3);
    let worst = near.fold(&judged[first], |worst, row| {
        if row.excess() > FAR_WORSE * worst.excess() { row } else { worst }
    });
    let Knot { line, r, energy, force } = worst.at;
    let found = if worst.energy.1 > FAR_WORSE * worst.force.1 {
        let by_others = worst.energy.0;
        format!(
            "line {line}: U = {energy} at r = {r}, where the rows beside it give {by_others:.6}"
        )
    } else {
        let by_slope = worst.force.0;
        format!("line {line}: F = {force} at r = {r}, where the slope of U gives {by_slope:.6}")
    };
    Err(Refusal::new(
        found,
        "F = -dU/dr in every row, and rows near enough to each other to show it within 1 %",
    ))
}

/// A row beside the cubic through the rows before and after it.
struct Judged<'a> {
    at: &'a Knot,
    /// U of the cubic, and its difference from U of the row: over what the allowed difference of F makes over a row.
    energy: (f64, f64),
    /// F of the cubic, and its difference from F of the row over the allowed one.
    force: (f64, f64),
}

impl Judged<'_> {
    fn excess(&self) -> f64 {
        self.energy.1.max(self.force.1)
    }
}

fn judged(three: &[Knot], floor: f64) -> Option<Judged<'_>> {
    let [before, at, after] = three else {
        return None;
    };
    let cubic = super::spline::Cubic::between(before, after);
    let (energy, slope, _) = cubic.at(at.s() - before.s());
    let force = -2.0 * at.r * slope;
    let sizes = three.iter().map(|k| k.force.abs());
    let allowed = SHARE_OF_NEIGHBORS * sizes.fold(0.0, f64::max) + floor;
    let width = 0.5 * (after.r - before.r);
    Some(Judged {
        at,
        energy: (energy, (energy - at.energy).abs() / (allowed * width)),
        force: (force, (force - at.force).abs() / allowed),
    })
}
