//! Runs with a potential from a table, from the first step to a file that has changed.

use crate::program::common::*;

/// The fluid with the potential of a table.
fn place() -> Place {
    let table = "[potential]\nkind = \"table\"\nfile = \"tables/fluid.table\"\n[output]\ntrajectory_every = 20\n";
    let scene = FLUID.replace("[truncation]", "[truncation]\nkind = \"switch\"") + table;
    let place = Place::with(&[("scene.toml", &scene)]);
    write_table(&place, 1.0);
    place
}

/// Writes a table of Lennard-Jones times a factor.
fn write_table(place: &Place, factor: f64) {
    let row = |k: u32| {
        let r = 0.7 + 0.01 * f64::from(k);
        let u = 4.0 * (r.powi(-12) - r.powi(-6));
        let f = (48.0 * r.powi(-12) - 24.0 * r.powi(-6)) / r;
        format!("{r} {} {}\n", factor * u, factor * f)
    };
    place.write("tables/fluid.table", &(0..200).map(row).collect::<String>());
}

#[test]
fn a_run_goes_on_to_the_byte_with_its_table_and_not_with_a_changed_one() {
    let place = place();
    place.succeed("run scene.toml --quiet --out whole");
    place.succeed("run scene.toml --quiet --out parts --set stage.production.steps=100");
    place.succeed("resume parts --quiet --steps 100");
    place.same("whole", "parts", &["trajectory.xyz"]);
    let record = place.read("whole/run.json");
    contains(&record, &["fluid.table", "\"checksum\"", "spline within"]);
    write_table(&place, 1.1);
    let output = place.output("resume parts --quiet --steps 100");
    assert!(!output.status.success());
    contains(&stderr(&output), &["fluid.table with the checksum"]);
}

#[test]
fn a_table_that_begins_too_far_out_for_the_temperature_says_so() {
    let place = place();
    let said = |temperature: &str| {
        let set = format!("system.temperature={temperature} --set stage.production.steps=2");
        let output = place.output(&format!("run scene.toml --out {temperature} --set {set}"));
        stdout(&output) + &ended(&output, 0, &[])
    };
    // U is 255 ε at the first row, r = 0.7 σ.
    assert!(!said("25.0").contains("the table begins"));
    let words = "the table begins at r = 0.7 σ with U = 254.991 ε, below 10·T = 260.000 ε";
    contains(&said("26.0"), &[words]);
}
