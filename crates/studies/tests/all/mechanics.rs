//! The quick mechanics study as a user gets it: verdicts, numbers and files.

use std::path::Path;

use lennard_integrators::bond_methods;
use lennard_studies::Silent;
use lennard_studies::claims::Verdict;
use lennard_studies::mechanics::{self, MechanicsOptions, MechanicsStudy};

fn study() -> MechanicsStudy {
    let options = MechanicsOptions {
        quick: true,
        command: "lennard mechanics --quick --out \"<dir>\"".into(),
        ..MechanicsOptions::default()
    };
    mechanics::run(&options, &mut Silent).expect("the quick study runs")
}

fn check_verdicts(study: &MechanicsStudy) {
    // Two claims fail: the article's relaxation along the new bond is not the direct solve, and SPOOK without damping diverges.
    let failing = study
        .claims
        .iter()
        .filter(|c| c.verdict == Verdict::DoesNotHold);
    let failing: Vec<_> = failing.collect();
    assert_eq!(failing.len(), 2, "{failing:#?}");
    assert!(failing[0].statement.contains("along the new bond, agrees"));
    assert!(failing[1].statement.starts_with("k = ∞"));
    assert!(study.claims.len() > 60, "{}", study.claims.len());
    let differing: Vec<_> = study.claims.iter().filter(|c| !c.theory_agrees).collect();
    assert!(differing.is_empty(), "{differing:#?}");
}

fn check_numbers(study: &MechanicsStudy) {
    let found = &study.found;
    for method in bond_methods() {
        let way = found.ways.iter().find(|w| w.name == method.name);
        let way = way.unwrap_or_else(|| panic!("{} is not compared", method.name));
        assert!(way.points.len() >= 2, "{}", way.name);
        assert!(way.cost.iter().all(|c| *c > 0.0), "{way:?}");
    }
    // SPOOK has no largest step on a slow rotor that an explicit spring has.
    let limit = |name: &str| {
        found
            .ways
            .iter()
            .find(|w| w.name == name)
            .unwrap()
            .largest_step
    };
    assert!(limit("spring").unwrap() < 0.1 * limit("direct").unwrap());
    // Sweeps grow with the length of a chain, iterations of the direct solve do not.
    let [loose, middle, tight, direct] = found.relaxing.chain_iterations;
    assert!(loose < middle && middle < tight && direct < 6.0);
    // Costs are the only numbers that a clock decides.
    let wall = &found.pressure.points;
    let last = wall.last().expect("points along the run");
    assert!((last.of_walls - last.with_boundary).abs() < 1e-10);
    assert!((last.of_walls - last.of_virial).abs() < 0.1);
}

fn check_files(study: &MechanicsStudy, dir: &Path) {
    mechanics::write(study, dir).expect("the files are written");
    for name in ["ways.csv", "claims.csv", "study.json", "report.html"] {
        assert!(dir.join(name).is_file(), "{name}");
    }
    let page = std::fs::read_to_string(dir.join("report.html")).unwrap();
    for figure in [
        "ways-error",
        "ways-cost",
        "sweeps",
        "tolerance-energy",
        "drift-density",
        "spook-amplification",
        "penalty-energy",
        "bounces",
        "wall-pressure",
        "states-energy",
    ] {
        assert!(
            dir.join(format!("figures/{figure}.svg")).is_file(),
            "{figure}"
        );
    }
    assert!(page.contains("--out &quot;&lt;dir&gt;&quot;"));
    assert!(!page.contains("NaN"));
}

#[test]
fn the_quick_study_of_mechanics_has_its_verdicts_numbers_and_files() {
    let study = study();
    let dir = tempfile::tempdir().unwrap();
    check_files(&study, dir.path());
    check_verdicts(&study);
    check_numbers(&study);
}
