//! A sweep in parts: many processes share its points, one collects, and schedulers get scripts.

use crate::program::common::*;

const SWEEP: &str =
    "base = \"base.toml\"\n[grid]\ndensity = [0.4, 0.5]\ntemperature = [1.5, 2.0, 2.5]\n";

fn place() -> Place {
    Place::with(&[("base.toml", FLUID), ("sweep.toml", SWEEP)])
}

#[test]
fn points_have_numbers_names_and_values() {
    let place = place();
    let listed = place.succeed("sweep sweep.toml --points");
    assert_eq!(listed.lines().count(), 6);
    contains(&listed, &["    5  rho0.5-T2.5\n"]);
    let points = &place.json("sweep sweep.toml --points")["points"];
    assert_eq!(points[4]["name"], "rho0.5-T2");
    assert_eq!(points[4]["values"]["temperature"], 2);
    assert!(!place.has("runs"), "nothing is written");
    for (wrong, nearest) in [("6", ""), ("rho0.5-T2.4", "\n  nearest: rho0.5-T2.5")] {
        let wanted = format!(
            "the sweep: sweep.toml: there is no point `{wrong}`\n  allowed: a number from 0 to 5, or the name of a point{nearest}"
        );
        place.refused(&format!("sweep sweep.toml --out out --point {wrong}"), &[&wanted]);
        assert!(!place.has("out"));
    }
}

#[test]
fn a_point_whose_folder_cannot_be_made_is_a_fault_of_the_input() {
    let place = place();
    place.write("out/rho0.4-T1.5", "a file, no folder");
    place.refused("sweep sweep.toml --out out --quiet", &["rho0.4-T1.5"]);
    assert!(place.has("out/rho0.5-T2.5/run.json"), "the others are run");
}

#[test]
fn four_processes_in_any_order_run_each_point_once_and_give_the_table_of_one() {
    let place = place();
    place.succeed("sweep sweep.toml --out one --quiet");
    let run_in = |order: [usize; 6]| {
        let mut finished = Vec::new();
        for k in order {
            let output = place.output(&format!("sweep sweep.toml --out many --point {k}"));
            if !output.status.success() {
                ended(&output, 2, &["is at work there"]);
            } else if stdout(&output).contains(": finished\n") {
                finished.push(k);
            }
        }
        finished
    };
    let orders = [[0, 1, 2, 3, 4, 5], [5, 4, 3, 2, 1, 0], [3, 0, 5, 1, 4, 2], [2, 4, 0, 5, 3, 1]];
    let mut ran: Vec<usize> = std::thread::scope(|scope| {
        let loops = orders.map(|order| scope.spawn(move || run_in(order)));
        loops.into_iter().flat_map(|l| l.join().unwrap()).collect()
    });
    ran.sort_unstable();
    assert_eq!(ran, [0, 1, 2, 3, 4, 5]);
    place.succeed("sweep sweep.toml --out many --collect");
    place.same("many", "one", &["table.csv"]);
}

#[test]
fn collecting_names_what_is_missing_and_chunks_run_some_points() {
    let place = place();
    place.succeed("sweep sweep.toml --out out --chunk 4 --point 1");
    let collected = place.output("sweep sweep.toml --out out --collect --json");
    let wanted = "4 of 6 points are not finished: rho0.4-T1.5, rho0.4-T2, rho0.4-T2.5, rho0.5-T1.5\n  \
        to run them: lennard sweep sweep.toml --out out";
    ended(&collected, 4, &[wanted]);
    let record = json(&stdout(&collected));
    assert_eq!(record["ending"], "incomplete");
    assert!(record["points"][0]["compared"].is_null());
    assert!(!record["points"][5]["compared"].is_null());
    // The same command as always runs what is missing.
    place.succeed("sweep sweep.toml --out out --quiet");
    place.succeed("sweep sweep.toml --out out --collect --quiet");
}

#[test]
fn a_point_that_runs_out_of_time_goes_on_to_the_same_bits() {
    let place = place();
    let point = "--set stage.production.steps=60000 --point rho0.4-T2";
    let run = |folder: &str, more: &str| {
        place.output(&format!("sweep sweep.toml --out {folder} --no-report {point} {more}"))
    };
    ended(&run("whole", ""), 0, &[]);
    ended(&run("parts", "--max-walltime 300ms"), 4, &[point]);
    ended(&run("parts", ""), 0, &[]);
    place.same("parts", "whole", &["rho0.4-T2/final.xyz"]);
}

#[test]
fn a_claim_of_another_machine_is_named_and_nothing_is_run() {
    let place = place();
    place.write("out/rho0.4-T1.5/.lennard-claim", "17\nnode-7\nanother-start\n");
    let wanted = "rho0.4-T1.5: the output folder out/rho0.4-T1.5 is in use: process 17 on node-7 is at work there";
    place.refused("sweep sweep.toml --out out --point 0", &[wanted]);
    assert!(!place.has("out/rho0.4-T1.5/run.json"));
}
