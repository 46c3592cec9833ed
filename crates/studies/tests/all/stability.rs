//! The quick stability study as a user gets it: its claims, the numbers of both parts against theory, and the files.

use std::sync::LazyLock;

use lennard_observables::Verdict;
use lennard_observables::{Column, Table, Value};
use lennard_studies::claims::{ClaimsStudy, Source};
use lennard_studies::{FluidStudy, Progress, Study, StudyOptions, stability};

/// Keeps what it is told.
#[derive(Default)]
struct Told(Vec<f64>);

impl Progress for Told {
    fn update(&mut self, _label: &str, done: f64) {
        self.0.push(done);
    }
}

/// The quick study, run once for all tests.
static QUICK: LazyLock<(ClaimsStudy, Told)> = LazyLock::new(|| {
    let options = StudyOptions {
        quick: true,
        command: "lennard study stability --quick --out \"<dir>\"".into(),
        ..StudyOptions::default()
    };
    let mut told = Told::default();
    let fluid = FluidStudy::read("stability", None, true).expect("a shipped study");
    let study = stability::run(&fluid, &options, &mut told).expect("the quick study runs");
    (study, told)
});

/// Cells of a table of the study by row and name.
struct Rows(Table);

impl Rows {
    fn of(name: &str) -> Self {
        Self(QUICK.0.tables().into_iter().find(|table| table.name == name).expect(name))
    }

    fn number(&self, row: usize, column: &str) -> f64 {
        self.0.numbers(column).expect(column)[row]
    }

    fn words(&self, row: usize, column: &str) -> &str {
        let is_it = |c: &&Column| c.name == column;
        match &self.0.columns.iter().find(is_it).expect(column).cells[row].value {
            Value::Words(words) => words,
            other => panic!("{column}: {other:?}"),
        }
    }

    /// The numbers of some columns row by row, with the names in another column.
    fn each<const N: usize>(&self, name: &str, columns: [&str; N]) -> Vec<(&str, [f64; N])> {
        let row = |row| (self.words(row, name), columns.map(|column| self.number(row, column)));
        (0..self.0.rows()).map(row).collect()
    }

    /// The row of a method, at a step where the table has steps.
    fn row(&self, method: &str, dt: Option<f64>) -> usize {
        let at = |row: usize| dt.is_none_or(|dt| self.number(row, "dt") == dt);
        let is_it = |row: &usize| self.words(*row, "method") == method && at(*row);
        (0..self.0.rows()).find(is_it).expect(method)
    }
}

#[test]
fn two_claims_of_the_manual_fail_where_a_map_has_one_eigenvector() {
    let claims = &QUICK.0.claims;
    let failing = claims.iter().filter(|c| c.verdict == Verdict::Differs);
    let failing: Vec<_> = failing.map(|c| (c.source, c.statement.as_str())).collect();
    let limit = "k ≤ 4m/h²: semi-implicit Euler is stable, the limit itself included";
    let rigid = "k = ∞, τ = 0: SPOOK does not diverge";
    assert_eq!(failing, [(Source::Manual, limit), (Source::Manual, rigid)]);
    for claim in claims {
        assert!(claim.theory_agrees, "{claim:?}");
    }
    // Not every number has a claim, so that a row that is lost shows in the count alone.
    assert_eq!(claims.len(), 71);
    // The document says how many there are.
    let document = include_str!("../../../../docs/stability.md");
    let count = format!("Two of {} claims do not hold", claims.len());
    assert!(document.contains(&count), "{count}");
}

#[test]
fn every_method_has_the_limit_of_its_declared_map() {
    let columns = ["limit measured", "limit by theory", "map differs by"];
    for (method, [measured, theory, differs]) in Rows::of("limits").each("method", columns) {
        // The window of `blanes-moan` opens so slowly that its edge is seen 6·10⁻⁶ late.
        let is_same = (measured - theory).abs() <= 1e-5 * theory;
        assert!(is_same || measured.is_nan() && theory.is_nan(), "{method}: {measured} {theory}");
        // Runs with the largest radii grow a thousandfold per step, from a start on a grid.
        assert!(differs < 1e-9, "{method}: {differs}");
    }
    let limits = Rows::of("limits");
    let limit = |method| limits.number(limits.row(method, None), "limit measured");
    assert_eq!(limit("explicit-euler"), 0.0);
    assert!(limit("implicit-euler").is_nan() && limit("spook").is_nan());
}

#[test]
fn declared_maps_and_long_runs_agree_on_every_fate() {
    let columns =
        ["growth of halves", "radius by theory", "amplitude by theory", "amplitude measured"];
    for (method, [growth, radius, theory, measured]) in
        Rows::of("stiffnesses").each("method", columns)
    {
        assert_eq!(growth.is_finite(), radius < 1.0 + 1e-9, "{method}");
        // A run that grows has neither.
        let has_both = measured.is_finite() && theory.is_finite();
        let is_same = (measured / theory - 1.0).abs() < 1e-5;
        assert!(is_same || !has_both, "{method}: {measured} {theory}");
    }
}

#[test]
fn where_a_map_has_one_eigenvector_displacements_are_two_n_plus_one() {
    let columns = ["deviation from 2n + 1", "last |x|", "radius by theory"];
    for (run, [off, last, radius]) in Rows::of("at-infinity").each("run", columns) {
        // Rounding splits the double eigenvalue −1 by some 10⁻⁸: (n·10⁻⁸)² over 20 000 steps.
        if run == "k = inf, tau/h = 0" || run == "k = 4m/h²" {
            assert!(off < 1e-6, "{run}: {off}");
        } else if run.starts_with("k = inf") {
            assert!(radius < 1.0 && last < 1e-100, "{run}: {radius} {last}");
        }
    }
}

#[test]
fn large_stiffnesses_swing_by_the_root() {
    let columns = ["amplitude by theory", "amplitude measured"];
    for (run, [theory, measured]) in Rows::of("at-infinity").each("run", columns) {
        // The crest is sampled within half the angle that a beat advances, 2/(ωh)² of it.
        let omega_h = 2.0 * (theory * theory - 1.0).sqrt();
        let is_good = (measured / theory - 1.0).abs() < 2.0 / omega_h.powi(2) + 1e-7;
        assert!(is_good || theory.is_nan(), "{run}: {theory} {measured}");
    }
}

#[test]
fn measured_orders_are_the_declared_ones() {
    let columns = ["order by theory", "order measured"];
    for (name, [theory, order]) in Rows::of("orders").each("name", columns) {
        // Rounding alone has no order, and the rules of a changing step have a test of their own.
        let is_rounding = order.is_nan() && theory == 0.0;
        assert!(theory.is_nan() || is_rounding || (order - theory).abs() < 0.05, "{name}: {order}");
    }
}

#[test]
fn a_claim_of_ours_is_in_no_mouth_of_a_document() {
    let source = |words: &str| {
        let claim = QUICK.0.claims.iter().find(|c| c.statement.contains(words));
        claim.unwrap_or_else(|| panic!("no claim has “{words}”")).source
    };
    for ours in [
        "the Taylor start adds an offset",
        "one velocity-Verlet step errs by O(h³) in x",
        "amplitude √(1 + ω²h²/4)",
        "`pefrl` is stable below",
    ] {
        assert_eq!(source(ours), Source::Ours, "{ours}");
    }
    for manual in ["SPOOK is of order 1", "SPOOK takes no variable step"] {
        assert_eq!(source(manual), Source::Manual, "{manual}");
    }
    assert_eq!(source("n(n + 1)/2"), Source::Article);
}

#[test]
fn methods_keep_lose_or_gain_the_energy_of_a_fluid_as_their_orders_say() {
    // The fluctuation of the energy falls as dt² for methods of second order: by 4 from 0.004 to 0.002,
    // up to the noise of runs of one τ. For methods of fourth order it falls more than twice as much.
    let runs = &Rows::of("fluid");
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
    let limits = Rows::of("fluid-limits");
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
fn the_quick_study_only_goes_forward_and_leaves_a_whole_folder() {
    let (study, told) = &*QUICK;
    assert!(told.0.is_sorted() && told.0.last() == Some(&1.0), "progress only goes forward");
    let dir = tempfile::tempdir().expect("a folder for the files");
    let html = crate::whole_folder(study, dir.path(), [20, 14]);
    for outside in [" kg, from", "N/m", "[m]"] {
        assert!(!html.contains(outside), "{outside}");
    }
    assert!(html.contains("does not hold"));
}
