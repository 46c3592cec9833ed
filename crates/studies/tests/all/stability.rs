//! The quick stability study as a user gets it: numbers of the fluid part, and the files.

use lennard_observables::Verdict;
use lennard_observables::{Cell, Table, Value};
use lennard_studies::claims::ClaimsStudy;
use lennard_studies::{FluidStudy, Progress, Study, StudyOptions, stability};

/// Keeps what it is told.
#[derive(Default)]
struct Told(Vec<f64>);

impl Progress for Told {
    fn update(&mut self, _label: &str, done: f64) {
        self.0.push(done);
    }
}

fn study() -> (ClaimsStudy, Told) {
    let options = StudyOptions {
        quick: true,
        command: "lennard study stability --quick --out \"<dir>\"".into(),
        ..StudyOptions::default()
    };
    let mut told = Told::default();
    let fluid = FluidStudy::read("stability", None, true).expect("a shipped study");
    let study = stability::run(&fluid, &options, &mut told).expect("the quick study runs");
    (study, told)
}

/// Cells of a table by row and name.
struct Rows(Table);

impl Rows {
    fn of(study: &ClaimsStudy, name: &str) -> Self {
        Self(study.tables().into_iter().find(|table| table.name == name).expect(name))
    }

    fn cell(&self, row: usize, column: &str) -> &Cell {
        let is_it = |c: &&lennard_observables::Column| c.name == column;
        &self.0.columns.iter().find(is_it).expect(column).cells[row]
    }

    fn number(&self, row: usize, column: &str) -> f64 {
        self.cell(row, column).value.number()
    }

    fn words(&self, row: usize, column: &str) -> &str {
        match &self.cell(row, column).value {
            Value::Words(words) => words,
            other => panic!("{column}: {other:?}"),
        }
    }

    /// The row of a method, at a step where the table has steps.
    fn row(&self, method: &str, dt: Option<f64>) -> usize {
        let at = |row: usize| dt.is_none_or(|dt| self.number(row, "dt") == dt);
        let is_it = |row: &usize| self.words(*row, "method") == method && at(*row);
        (0..self.0.rows()).find(is_it).expect(method)
    }
}

fn check_numbers(study: &ClaimsStudy) {
    // Two claims of the manual fail: at the limit of symplectic Euler, and at infinite stiffness without damping.
    let failing: Vec<_> = study.claims.iter().filter(|c| c.verdict == Verdict::Differs).collect();
    assert_eq!(failing.len(), 2, "{failing:?}");
    assert!(failing[0].statement.starts_with("k ≤ 4m/h²"));
    assert!(failing[1].statement.starts_with("k = ∞, τ = 0"));
    // Not every number has a claim, so that a row that is lost shows in the count alone.
    assert_eq!(study.claims.len(), 71);
    // The document says how many there are.
    let document = include_str!("../../../../docs/stability.md");
    let count = format!("Two of {} claims do not hold", study.claims.len());
    assert!(document.contains(&count), "{count}");

    // The fluctuation of the energy falls as dt² for methods of second order: by 4 from 0.004 to 0.002,
    // up to the noise of runs of one τ. For methods of fourth order it falls more than twice as much.
    let runs = &Rows::of(study, "fluid");
    let number = |column, method, dt| runs.number(runs.row(method, Some(dt)), column);
    let fall = |method| number("energy rms", method, 0.004) / number("energy rms", method, 0.002);
    for method in ["velocity-verlet", "leapfrog", "stormer-verlet"] {
        assert!((3.4..4.6).contains(&fall(method)), "{method}: {}", fall(method));
    }
    assert!(fall("forest-ruth") > 8.0, "{}", fall("forest-ruth"));
    // Explicit Euler heats and implicit Euler cools at every step; velocity Verlet does neither.
    assert!(number("energy change", "implicit-euler", 0.004) < -1e-3);
    let outcome = runs.words(runs.row("explicit-euler", Some(0.016)), "outcome");
    assert!(outcome.starts_with("ran away"), "{outcome}");
    assert!(number("energy change", "velocity-verlet", 0.002).abs() < 1e-3);
    // Implicit Euler's solve costs more evaluations than any explicit method's step.
    assert!(number("force evaluations per step", "implicit-euler", 0.004) > 6.0);

    // Explicit Euler has hardly any stable step.
    let limits = Rows::of(study, "fluid-limits");
    let limit = |method| limits.number(limits.row(method, None), "middle");
    let verlet = limit("velocity-verlet");
    assert!((0.01..0.04).contains(&verlet), "{verlet}");
    assert!(limit("explicit-euler") < 0.1 * verlet);

    // Twice past its limit every method is stopped within a few steps, and says when and why.
    let of_part = |part| (0..runs.0.rows()).filter(move |row| runs.words(*row, "part") == part);
    let twice = |row: &usize| runs.number(*row, "dt / limit") == 2.0;
    let past: Vec<usize> = of_part("past the limit").filter(twice).collect();
    assert_eq!(past.len(), 6);
    for row in past {
        let (method, outcome) = (runs.words(row, "method"), runs.words(row, "outcome"));
        assert!(runs.number(row, "steps") < 500.0, "{method}");
        assert!(runs.number(row, "energy rms").is_nan() && runs.number(row, "drift").is_nan());
        assert!(outcome.starts_with("ran away: ") || outcome.starts_with("stopped at step "));
    }
    // At the smallest steps the rounding of f32 pairs stands above the rounding of f64 pairs.
    let floor = |precision| {
        let is_it = |row: &usize| runs.words(*row, "precision") == precision;
        runs.number(of_part("small steps").find(is_it).expect(precision), "energy rms")
    };
    assert!(floor("mixed") > 2.0 * floor("double"));
}

/// The shipped files name every method that moves a fluid, so that a new one is not forgotten there.
#[test]
fn the_study_files_name_every_method_that_moves_a_fluid() {
    use lennard_integrators::{OscillatorModel, integrators};
    for is_quick in [false, true] {
        let study = FluidStudy::read("stability", None, is_quick).expect("a shipped study");
        for entry in integrators().iter().filter(|e| e.oscillator == OscillatorModel::Force) {
            let has_it =
                study.points.iter().any(|p| p.scene.integrator.method.name() == entry.spec.name);
            assert!(has_it, "quick: {is_quick}, {}", entry.spec.name);
        }
    }
}

#[test]
fn the_quick_study_has_the_right_numbers_and_leaves_a_whole_folder() {
    let (study, told) = study();
    assert!(told.0.is_sorted() && told.0.last() == Some(&1.0), "progress only goes forward");
    check_numbers(&study);
    let dir = tempfile::tempdir().expect("a folder for the files");
    let html = crate::whole_folder(&study, dir.path(), [20, 14]);
    for outside in [" kg, from", "N/m", "[m]"] {
        assert!(!html.contains(outside), "{outside}");
    }
    assert!(html.contains("does not hold"));
}
