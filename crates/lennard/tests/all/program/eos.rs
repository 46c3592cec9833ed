//! `lennard eos` as a user types it.

use serde_json::Value;

use crate::program::common::*;

fn document(line: &str) -> Value {
    json(&succeed(&format!("eos {line} --json")))
}

#[test]
fn one_state_has_every_property_by_every_equation() {
    let words = [
        "Thol 2016",
        "Kolafa–Nezbeda 1994",
        "Pohl 2023",
        "Johnson 1993",
        "Joule–Thomson coefficient",
        "left out: virial series covers densities up to 0.04, found 0.75",
        "nothing is judged by it",
    ];
    let table = succeed("eos --density 0.75 --temperature 1.2");
    assert!(table.lines().all(|line| line.chars().count() <= 100), "{table}");
    contains(&table, &words);
    let states = document("-d 0.75 -T 1.2");
    let thol = &states["states"][0];
    assert_eq!(thol["equation"], "thol-2016");
    assert_eq!(thol["phase"], "liquid");
    // Computed with teqp 0.23.2.
    let sound = thol["properties"]["speed_of_sound"].as_f64().unwrap();
    assert!((sound - 5.192_582_7).abs() < 1e-7, "{sound}");
}

#[test]
fn a_pressure_gives_the_same_state_as_its_density() {
    let by_density = document("thol-2016 -d 0.75 -T 1.2");
    let pressure = by_density["states"][0]["properties"]["pressure"].to_string();
    let by_pressure = document(&format!("thol-2016 -p {pressure} -T 1.2"));
    let density = by_pressure["states"][0]["density"].as_f64().unwrap();
    assert!((density - 0.75).abs() < 1e-6, "{density}");
}

#[test]
fn a_curve_has_a_row_for_each_state_and_the_properties_that_were_named() {
    let curve = document("pohl-2023 -d 0.1:0.5:0.1 -T 1.5,2 --properties pressure,heat_capacity");
    let states = curve["states"].as_array().unwrap();
    assert_eq!(states.len(), 10);
    let properties = states[9]["properties"].as_object().unwrap();
    assert_eq!(properties.len(), 2);
    assert!(properties["heat_capacity"].as_f64() > Some(1.5));
}

#[test]
fn coexistence_is_a_table_up_to_the_critical_point() {
    let all = document("thol-2016 --saturation -T 0.7,1,1.5");
    let rows = all["equations"][0]["coexistence"].as_array().unwrap();
    assert_eq!(rows.len(), 2, "nothing coexists at 1.5");
    let liquid = rows[0]["liquid_density"].as_f64().unwrap();
    assert!((liquid - 0.8428).abs() < 1e-3, "{liquid}");
    let [vapor, spinodal] =
        [&rows[1]["vapor_density"], &rows[1]["spinodal"][0]].map(|v| v.as_f64().unwrap());
    assert!(vapor < spinodal && spinodal < 0.3, "{vapor} {spinodal}");
    contains(&succeed("eos thol-2015 --saturation"), &["critical point T = 1.08"]);
}

#[test]
fn freezing_is_a_table_of_both_lines_with_the_triple_point() {
    let all = document("thol-2016 --freezing -T 0.69,1,1.5");
    let rows = all["equations"][0]["freezing"].as_array().unwrap();
    // Below the triple point of one line, at 0.69, the other is there alone.
    assert_eq!(rows.len(), 5, "{rows:?}");
    let of = |row: &serde_json::Value, key: &str| row[key].as_f64().unwrap();
    assert!((of(&rows[1], "liquid_density") - 0.91857).abs() < 1e-5);
    assert!((of(&rows[1], "crystal_density") - 1.00628).abs() < 1e-5);
    let [cold, hot] = [1, 3].map(|i| of(&rows[i], "pressure"));
    assert!(0.0 < cold && cold < hot, "{cold} {hot}");
    let triple = all["equations"][0]["triple_points"].as_array().unwrap();
    assert_eq!(triple.len(), 2);
    assert!((of(&triple[0], "temperature") - 0.694).abs() < 1e-3);
    let said = succeed("eos thol-2016 --freezing");
    contains(&said, &["triple point T = 0.69", "van der Hoef"]);
}

/// A temperature alone has no state: it asks for vapor and liquid side by side.
#[test]
fn a_temperature_alone_gives_what_coexists_there() {
    let line = "eos thol-2016 --substance argon --temperature 94K";
    let [alone, named] = ["", "--saturation"].map(|more| succeed(&format!("{line} {more}")));
    assert_eq!(alone, named);
    assert!(alone.contains("ρ liquid") && alone.contains("P / MPa"), "{alone}");
    assert!(alone.lines().all(|line| line.chars().count() <= 100), "{alone}");
}

#[test]
fn what_an_equation_does_not_give_and_what_is_typed_wrongly_is_refused_by_name() {
    let twelve = "a Mie potential has two exponents: --exponents 14,6";
    for (line, words) in [
        ("thol-2061 -d 0.5 -T 1.5", "did you mean `thol-2016`?"),
        ("thol-2016 -d 0.5 -T 1.5 --properties presure", "did you mean `pressure`?"),
        ("thol-2016 -d 0.5 -T 0.3", "Thol 2016 covers temperatures from 0.66 to 9.24, found 0.3"),
        ("virial -d 0.5 -T 1.5", "virial series covers densities up to 0.04, found 0.5"),
        (
            "pohl-2023 --exponents 14,6 -d 0.5 -T 1.5",
            "pohl-2023 is for repulsive exponents from 11 to 13",
        ),
        ("virial --exponents 6,12 -d 0.01 -T 1.5", "exponents must be above 3"),
        ("thol-2016 -T 1.5", "--density VALUES or --pressure VALUES"),
        ("thol-2016 -d 0.5", "a state needs a temperature"),
        ("thol-2016 -p -1 -T 1", "the pressure must be a finite positive number, found -1"),
        (
            "thol-2016 --saturation -T 5",
            "nothing coexists there: Thol 2016 has vapor and liquid from T = 0.66 to 1.3200",
        ),
        ("virial --saturation", "virial series is for a gas alone"),
        ("thol-2015 --freezing", "nothing freezes there: no freezing line is known"),
        ("thol-2016 --freezing -T 0.5", "begin at the triple point"),
        ("lisal-2004 --bond 3 -d 0.5 -T 3", "found --bond 3"),
        ("lisal-2004 --bond 5 -d 0.5 -T 2", "lisal-2004 is for bonds from"),
        ("thol-2016 -d 0.5:0.1:0.1 -T 1", "the range goes from 0.5 to 0.1"),
        ("-d x -T 1", "`x` is no finite number; wanted a number"),
        ("-d 0:1000000:1 -T 1", "the range has 1000000 steps; at most 10000 are taken"),
    ] {
        let output = lennard(&format!("eos {line}")).output().unwrap();
        ended(&output, 2, &[words]);
        assert_eq!(stdout(&output), "");
    }
    let words = ["error: evaluating an equation of state", twelve];
    refused("eos -d 0.5 -T 1 --exponents 12", &words);
}
