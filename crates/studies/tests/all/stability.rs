//! The quick stability study as a user gets it: numbers of the fluid part, and the files.

use std::path::Path;

use lennard_observables::Verdict;
use lennard_studies::stability::fluid::run::{FluidRun, Outcome};
use lennard_studies::stability::{self, StabilityStudy};
use lennard_studies::{Progress, Study, StudyOptions};

/// Keeps what it is told.
#[derive(Default)]
struct Told(Vec<f64>);

impl Progress for Told {
    fn update(&mut self, _label: &str, done: f64) {
        self.0.push(done);
    }
}

fn study() -> (StabilityStudy, Told) {
    let options = StudyOptions {
        quick: true,
        command: "lennard study stability --quick --out \"<dir>\"".into(),
        ..StudyOptions::default()
    };
    let mut told = Told::default();
    let study = stability::run(&options, &mut told).expect("the quick study runs");
    (study, told)
}

fn run_of<'a>(study: &'a StabilityStudy, method: &str, dt: f64) -> &'a FluidRun {
    let place = |r: &&FluidRun| r.method == method && r.dt == dt;
    study.fluid.runs.iter().find(place).expect("the run is there")
}

fn check_numbers(study: &StabilityStudy) {
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
    let fall = |method: &str| {
        let rms = |dt| run_of(study, method, dt).fluctuation.expect("completed");
        rms(0.004) / rms(0.002)
    };
    for method in ["velocity-verlet", "leapfrog", "stormer-verlet"] {
        assert!((3.4..4.6).contains(&fall(method)), "{method}: {}", fall(method));
    }
    assert!(fall("forest-ruth") > 8.0, "{}", fall("forest-ruth"));
    // Explicit Euler heats and implicit Euler cools at every step; velocity Verlet does neither.
    let change = |method, dt| run_of(study, method, dt).change;
    assert!(change("implicit-euler", 0.004).expect("completed") < -1e-3);
    assert!(!run_of(study, "explicit-euler", 0.016).completed());
    assert!(change("velocity-verlet", 0.002).expect("completed").abs() < 1e-3);
    // Implicit Euler's solve costs more evaluations than any explicit method's step.
    assert!(run_of(study, "implicit-euler", 0.004).evaluations_per_step > 6.0);

    let limit = |method: &str| {
        let found = study.fluid.limits.iter().find(|l| l.method == method);
        found.and_then(|l| l.middle()).expect("a bracket")
    };
    // Explicit Euler has hardly any stable step.
    let verlet = limit("velocity-verlet");
    assert!((0.01..0.04).contains(&verlet), "{verlet}");
    assert!(limit("explicit-euler") < 0.1 * verlet);

    // Twice past its limit every method is stopped within a few steps, and says when and why.
    for (factor, run) in &study.fluid.past_limit {
        if *factor == 2.0 {
            assert!(run.steps < 500 && !run.completed(), "{}", run.method);
            assert!(run.fluctuation.is_none() && run.drift.is_none());
            match &run.outcome {
                Outcome::RanAway { change, .. } => assert!(change.is_finite() || change.is_nan()),
                Outcome::Stopped { reason, .. } => assert!(!reason.is_empty()),
                Outcome::Completed => unreachable!("checked above"),
            }
        }
    }
    // At the smallest steps the rounding of f32 pairs stands above the rounding of f64 pairs.
    let floor = |runs: &[FluidRun]| runs[0].fluctuation.expect("completed");
    assert!(floor(&study.fluid.mixed) > 2.0 * floor(&study.fluid.double));
}

fn check_files(study: &StabilityStudy, dir: &Path) {
    study.write(dir).expect("everything is written");
    let text = |name: &str| std::fs::read_to_string(dir.join(name)).expect(name);
    let html = text("report.html");
    for outside in ["src=\"", "href=\"http", "NaN", " kg, from", "N/m", "[m]"] {
        assert!(!html.contains(outside), "{outside}");
    }
    assert!(html.contains("--out &quot;&lt;dir&gt;&quot;"));
    assert!(html.contains("does not hold"));
    // Every figure file is on the page, and every CSV file has the same number of fields in each row.
    let mut figures = 0;
    for file in std::fs::read_dir(dir.join("figures")).expect("figures") {
        let svg = std::fs::read_to_string(file.expect("entry").path()).expect("svg");
        assert!(svg.starts_with("<svg ") && svg.trim_end().ends_with("</svg>"));
        // On the page, figures of a row may share one legend: their texts differ from their files.
        let title = svg.lines().nth(1).expect("a title");
        assert!(title.starts_with("<title>") && html.contains(title), "{title}");
        figures += 1;
    }
    assert!(figures > 20, "{figures}");
    let mut tables = 0;
    for file in std::fs::read_dir(dir).expect("folder") {
        let path = file.expect("entry").path();
        if path.extension().is_some_and(|e| e == "csv") {
            let mut reader =
                csv::ReaderBuilder::new().comment(Some(b'#')).from_path(&path).expect("opens");
            let mut rows = 0;
            for row in reader.records() {
                row.expect("as many fields as headings");
                rows += 1;
            }
            assert!(rows > 0, "{}", path.display());
            tables += 1;
        }
    }
    assert!(tables >= 15, "{tables}");
    let json: serde_json::Value = serde_json::from_str(&text("study.json")).expect("JSON");
    assert_eq!(json["claims"].as_array().map(Vec::len), Some(study.claims.len()));
    // Written again, the same bytes.
    study.write(dir).expect("written over");
    assert_eq!(text("report.html"), html);
}

#[test]
fn the_quick_study_has_the_right_numbers_and_leaves_a_whole_folder() {
    let (study, told) = study();
    assert!(told.0.is_sorted() && told.0.last() == Some(&1.0), "progress only goes forward");
    check_numbers(&study);
    let dir = tempfile::tempdir().expect("a folder for the files");
    check_files(&study, dir.path());
}
