//! The quick mechanics study as a user gets it: verdicts, numbers and files.

use lennard_integrators::bond_methods;
use lennard_observables::Verdict;
use lennard_observables::{Column, Value};
use lennard_studies::claims::{ClaimsStudy, Source};
use lennard_studies::{FluidStudy, Silent, Study, StudyOptions, mechanics};

fn study() -> ClaimsStudy {
    let options = StudyOptions {
        quick: true,
        command: "lennard study mechanics --quick --out \"<dir>\"".into(),
        ..StudyOptions::default()
    };
    let fluid = FluidStudy::read("mechanics", None, true).expect("a shipped study");
    mechanics::run(&fluid, &options, &mut Silent).expect("the quick study runs")
}

fn check_verdicts(study: &ClaimsStudy) {
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

fn column(study: &ClaimsStudy, table: &str, column: &str) -> Column {
    let table = study.tables().into_iter().find(|t| t.name == table);
    let columns = table.unwrap_or_else(|| panic!("no table for {column}")).columns;
    columns.into_iter().find(|c| c.name == column).unwrap_or_else(|| panic!("no column {column}"))
}

fn check_numbers(study: &ClaimsStudy) {
    let of_ways = |name: &str| column(study, "ways-in-a-line", name);
    let ways = of_ways("Way");
    let names: Vec<&Value> = ways.cells.iter().map(|cell| &cell.value).collect();
    let row_of = |name: &str| {
        let row = names.iter().position(|way| **way == Value::Words(name.into()));
        row.unwrap_or_else(|| panic!("{name} is not compared"))
    };
    let of_points = column(study, "ways", "way");
    let orders = of_ways("Order");
    for method in bond_methods() {
        let row = row_of(method.name);
        let points = of_points.cells.iter().filter(|cell| cell.value == *names[row]);
        assert!(points.count() >= 2, "{}", method.name);
        for cost in ["Dumbbell", "Chain of 10"] {
            assert!(of_ways(cost).numbers()[row] > 0.0, "{}, {cost}", method.name);
        }
        // The error of a spring is its distance from a rigid bond: no order belongs to it.
        let is_of_the_model = orders.cells[row].value == Value::Words("error of the model".into());
        assert_eq!(is_of_the_model, method.name == "spring", "{}: {orders:?}", method.name);
    }
    let orders: Vec<f64> = orders.numbers().into_iter().filter(|order| order.is_finite()).collect();
    assert!(orders.iter().all(|order| *order > 0.9) && orders.len() >= 6, "{orders:?}");
    // SPOOK has no largest step on a slow rotor that an explicit spring has.
    let limits = of_ways("Largest stable step").numbers();
    assert!(limits[row_of("spring")] < 0.1 * limits[row_of("direct")]);
    // Sweeps grow with the length of a chain, iterations of the direct solve do not.
    let iterations = column(study, "chain-iterations", "iterations per step").numbers();
    let [loose, middle, tight, direct] = iterations[..] else { panic!("{iterations:?}") };
    assert!(loose < middle && middle < tight && direct < 6.0);
    // Costs are the only numbers that a clock decides.
    let last = |name: &str| *column(study, "wall-pressure", name).numbers().last().unwrap();
    assert!((last("P of walls") - last("P of virial less boundary term")).abs() < 1e-10);
    assert!((last("P of walls") - last("P of virial")).abs() < 0.1);
}

#[test]
fn the_quick_study_of_mechanics_has_its_verdicts_numbers_and_files() {
    let study = study();
    let dir = tempfile::tempdir().unwrap();
    assert_eq!(study.schema, "lennard-mechanics/2");
    crate::whole_folder(&study, dir.path(), [9, 4]);
    check_verdicts(&study);
    check_numbers(&study);
}
