//! The quick mechanics study as a user gets it: verdicts, numbers and files.

use std::path::Path;

use lennard_integrators::bond_methods;
use lennard_observables::Verdict;
use lennard_studies::claims::Source;
use lennard_studies::mechanics::comparison::Convergence;
use lennard_studies::mechanics::{self, MechanicsStudy};
use lennard_studies::{Silent, Study, StudyOptions};

fn study() -> MechanicsStudy {
    let options = StudyOptions {
        quick: true,
        command: "lennard study mechanics --quick --out \"<dir>\"".into(),
        ..StudyOptions::default()
    };
    mechanics::run(&options, &mut Silent).expect("the quick study runs")
}

fn check_verdicts(study: &MechanicsStudy) {
    let all = study.claims.iter();
    let failing: Vec<_> = all.filter(|c| c.verdict == Verdict::Differs).collect();
    assert!(failing.is_empty(), "{failing:#?}");
    // The article has nothing on orders and stability of bonds, nor on fluids with bonds. The manual has one closed form.
    for claim in &study.claims {
        let of_the_article = matches!(claim.source, Source::Article);
        let (label, _) = claim.statement.split_once(':').expect("a label");
        let its_own = [
            "Gauss–Seidel",
            "small matrices",
            "penalty force that is too",
            "projection",
            "may be set",
        ];
        let is_its_own = its_own.iter().any(|words| claim.statement.contains(words));
        assert_eq!(of_the_article, is_its_own && label != "B1", "{claim:?}");
        assert_eq!(matches!(claim.source, Source::Manual), label == "B2", "{claim:?}");
    }
    // Not every number has a claim, so that a row that is lost shows in the count alone.
    assert_eq!(study.claims.len(), 105);
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
        // The error of a spring is its distance from a rigid bond: no order belongs to it.
        let is_spring = method.name == "spring";
        assert_eq!(way.convergence == Convergence::Model, is_spring, "{way:?}");
    }
    let orders = found.ways.iter().filter_map(|w| w.convergence.order());
    assert!(orders.clone().all(|order| order > 0.9), "{:?}", found.ways);
    assert!(orders.count() >= 6, "{:?}", found.ways);
    // SPOOK has no largest step on a slow rotor that an explicit spring has.
    let limit = |name: &str| found.ways.iter().find(|w| w.name == name).unwrap().largest_step;
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
    study.write(dir).expect("the files are written");
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
        assert!(dir.join(format!("figures/{figure}.svg")).is_file(), "{figure}");
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
