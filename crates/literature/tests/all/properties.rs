//! Every property of the equations beside values computed by teqp.

use lennard_literature::{
    EquationOfState, PROPERTIES, johnson_1993, pohl_2023, property, thol_2016,
};

fn equation(key: &str, exponent: f64) -> &'static dyn EquationOfState {
    match key {
        "thol-2016" => thol_2016(),
        "johnson-1993" => johnson_1993(),
        "pohl-2023" => pohl_2023(exponent).expect("the table keeps to the exponents covered"),
        other => panic!("no equation of state is called {other}"),
    }
}

#[test]
fn every_property_of_every_equation_is_that_of_teqp() {
    let mut reader = csv::ReaderBuilder::new()
        .comment(Some(b'#'))
        .from_reader(include_str!("../data/teqp-properties.csv").as_bytes());
    let headers = reader.headers().unwrap().clone();
    let mut rows = 0;
    for record in reader.records() {
        let record = record.unwrap();
        let number = |column: usize| record[column].parse::<f64>().unwrap();
        let (rho, t) = (number(2), number(3));
        let state = equation(&record[0], number(1)).at(rho, t);
        for column in 4..record.len() {
            let (name, expected) = (&headers[column], number(column));
            if expected.is_nan() {
                continue;
            }
            let found = (property(name).unwrap().of)(&state);
            // Near the spinodal k is a small difference, by which some of the properties divide.
            let near = 1.0 / (state.dp_drho / t).abs().min(1.0);
            assert!(
                (found - expected).abs() <= 1e-10 * near * expected.abs().max(1.0),
                "{} at ρ {rho} T {t}: {name} is {found}, expected {expected}",
                &record[0]
            );
        }
        rows += 1;
    }
    assert_eq!(rows, 60);
}

#[test]
fn pohl_is_offered_for_the_exponents_that_it_covers() {
    for n in [10.9, 13.1, f64::NAN] {
        assert!(pohl_2023(n).is_none(), "{n}");
    }
    let critical = pohl_2023(12.0).unwrap().spec().critical;
    // Computed with teqp.
    assert!((critical.temperature - 1.321_946_098_5).abs() < 1e-5);
    assert!((critical.density - 0.304_474_795_5).abs() < 1e-4);
}

#[test]
fn names_of_properties_are_unique_and_explained() {
    for (at, one) in PROPERTIES.iter().enumerate() {
        assert!(!one.equation.is_empty());
        assert!(PROPERTIES[..at].iter().all(|other| other.key != one.key));
    }
    assert!(property("pressure_of_nothing").is_none());
}
