//! Each command as a user types it.

use crate::program::common::*;

#[test]
fn a_run_writes_its_folder_and_prints_the_same_record_as_json() {
    let place = Place::with(&[]);
    let record = place.json(&format!("run {SMALL} --out out"));
    assert_eq!(record["finished"], true);
    assert_eq!((&record["steps"], &record["atoms"]), (&600.into(), &256.into()));
    let neighbor = &record["neighbor"];
    assert!(number(&neighbor["checked_forces"]) > 0.0, "{neighbor}");
    assert!(number(&neighbor["largest_deviation"]) <= 1.0, "{neighbor}");
    let keys = "schema scene seed version host wall_s performance averages conservation comparison";
    for key in keys.split(' ').chain(["n_dof"]) {
        assert!(!record[key].is_null(), "`{key}` is missing");
    }
    let means = "temperature potential_energy potential_energy_without_tail pressure \
        pressure_without_tail configurational_temperature";
    for name in means.split_whitespace() {
        let average = &record["averages"][name];
        for key in ["mean", "n_effective", "equilibration_cut"] {
            assert!(average[key].is_number(), "{name}.{key}: {average}");
        }
        // A number has an error, or the reason why it has none.
        let sound = average["standing"] == "sound";
        assert_eq!(average["standard_error"].is_number(), sound, "{average}");
        assert_eq!(average["reason"] == "", sound, "{average}");
    }
    assert_eq!(place.record("out"), record);
    let files = "scene.toml thermo.csv rdf.csv msd.csv topology.gro trajectory.xyz final.xyz";
    for file in files.split(' ') {
        assert!(!place.bytes(&format!("out/{file}")).is_empty(), "{file}");
    }
    let picture = place.read("out/particles.svg");
    contains(&picture, &["The particles at step 600"]);
    contains(&place.read("out/report.html"), &[&picture]);
    let thermo = place.read("out/thermo.csv");
    assert!(thermo.starts_with("step,time,stage,temperature,"), "{thermo}");
    let rows = thermo.lines().filter(|line| !line.starts_with('#'));
    assert_eq!(rows.count(), 1 + 600 / 10, "one row every ten steps of every stage");
}

#[test]
fn the_energy_of_a_published_configuration_is_printed_with_all_digits() {
    let report = json(&succeed("energy inputs/fluid/from-configuration.toml --json"));
    for key in ["potential_energy", "tail_energy", "virial", "tail_virial", "pressure", "pairs"] {
        assert!(report[key].is_number(), "{key}");
    }
    // NIST SRSW reference calculation 4 at r_cut = 4, five digits as printed there: U = −17.060, U_LRC = −0.23008.
    assert_eq!(format!("{:.4e}", number(&report["potential_energy"])), "-1.7060e1");
    assert_eq!(format!("{:.4e}", number(&report["tail_energy"])), "-2.3008e-1");
    assert_eq!(report["temperature_from"], "scene-temperature");
}

#[test]
fn forces_are_written_at_full_precision() {
    let place = Place::with(&[]);
    let forces = place.path("forces.xyz").display().to_string();
    succeed(&format!("energy inputs/fluid/from-configuration.toml --forces {forces} --json"));
    let text = place.read("forces.xyz");
    assert!(text.lines().nth(1).unwrap().contains("forces:R:3"), "{text}");
    // Newton's third law over the file: the sum of forces vanishes to rounding of numbers of order ten.
    let mut sum = [0.0_f64; 3];
    for line in text.lines().skip(2) {
        let fields: Vec<f64> =
            line.split_whitespace().skip(1).map(|f| f.parse().unwrap()).collect();
        for axis in 0..3 {
            sum[axis] += fields[fields.len() - 3 + axis];
        }
    }
    assert!(sum.iter().all(|s| s.abs() < 1e-11), "{sum:?}");
}

#[test]
fn a_plan_is_ten_lines_and_verbose_says_what_is_on_and_off_and_why() {
    let short = succeed("plan bench/fluid-864");
    assert!(short.lines().count() <= 10, "{short}");
    // Which parts have a line of their own depends on measured times. A test beside the printer gives it times.
    contains(&short, &["stages: melt 2000 steps", "memory: about", "time: ", "--verbose: every"]);
    // In short, a part that takes little time is only counted.
    let all = succeed("plan verlet-1967/triple-point --verbose");
    contains(&all, &["pair forces", "neighbor list", "tail correction", "rdf", "off", "memory"]);
    contains(&all, &["wall-pressure", "not in the scene", "time: "]);
    let plan = json(&succeed("plan fluid/gas --json"));
    let items = plan["items"].as_array().unwrap();
    assert!(items.iter().any(|i| i["on"] == false && i["share"].is_null()));
    // Each part of the work has its share of the time of the run, where that time is known.
    let item = |part: &str| items.iter().find(|i| i["part"] == part).unwrap();
    for part in ["pair forces", "neighbor list", "integrator", "watchdog"] {
        let share = &item(part)["share"];
        assert_eq!(share.is_number(), plan["estimated_seconds"].is_number(), "{part}: {share}");
    }
}

#[test]
fn a_plan_for_ranks_has_a_line_for_each_number_and_refuses_what_does_not_fit() {
    let few = "bench/melt-32k --set system.n_atoms=4000";
    let text = succeed(&format!("plan {few} --ranks 6 --latency 500ns --cores 4"));
    contains(
        &text,
        &[
            "halo",
            "partners",
            "ranks pay up to",
            "0.5 µs, 12 GB/s and 4 cores a rank; not measured",
        ],
    );
    let plan = json(&succeed(&format!("plan {few} --ranks 6 --json")));
    let steps = plan["ranks"]["steps"].as_array().unwrap();
    let numbers: Vec<_> = steps.iter().map(|step| step["ranks"].as_u64().unwrap()).collect();
    assert_eq!(numbers, [1, 2, 4, 6]);
    assert!(number(&steps[3]["halo"]) > number(&steps[3]["atoms"]));
    assert_eq!(steps[0]["efficiency"], 1.0);
    // Without a number there are as many ranks as pay.
    let plan = json(&succeed(&format!("plan {few} --json --ranks")));
    let last = plan["ranks"]["steps"].as_array().unwrap().last().unwrap();
    assert_eq!(last["ranks"], plan["ranks"]["pays_up_to"]);
    let few = "sharing the run between ranks: 1000 ranks for 864 particles\n  allowed: at most 1 in this box";
    for (arguments, wanted) in [
        ("--ranks 1000", few),
        ("--ranks=2 --set=neighbor.mode=direct", "each force would need all particles"),
        ("--ranks 0", "0 is not in"),
        ("--latency 1us", "--ranks"),
        ("--bandwidth 25", "wanted a rate above zero"),
        ("--nodes 8", "`lennard plan --ranks P`"),
    ] {
        refused(&format!("plan bench/fluid-864 {arguments}"), &[wanted]);
    }
}

#[test]
fn options_that_only_clusters_need_stand_apart_in_the_help() {
    for (command, first, last) in
        [("sweep", "--points", "--emit <SCHEDULER>"), ("plan", "--ranks", "--cores")]
    {
        let help = succeed(&format!("{command} --help"));
        let (everyday, of_clusters) = help.split_once("\nOn a cluster:\n").unwrap();
        contains(of_clusters, &[&format!("  {first}"), &format!("  {last}")]);
        assert!(!everyday.contains(&format!("  {first}")), "{help}");
    }
}

#[test]
fn list_alone_names_every_list_and_a_list_has_a_line_for_each_entry() {
    let said = succeed("list");
    contains(&said, &["scenes  ", "Rules for σ and ε of unlike species"]);
    assert!(said.lines().all(|l| l.chars().count() <= 100), "{said}");
    let entries = json(&succeed("list --json"));
    for entry in entries["entries"].as_array().unwrap() {
        let command = entry["properties"]["command"].as_str().unwrap();
        assert_eq!(command, format!("lennard list {}", entry["name"].as_str().unwrap()));
        // A command is no source.
        assert_eq!(entry.get("source"), None);
        let line = command.strip_prefix("lennard ").unwrap();
        let [text, document] = [succeed(line), succeed(&format!("{line} --json"))];
        let document = json(&document);
        let methods = document["entries"].as_array().unwrap();
        assert!(methods.iter().all(|e| text.contains(e["name"].as_str().unwrap())), "{text}");
    }
    refused("list --verbose", &["<WHAT>"]);
    // What a scene should take unless it has a reason.
    let integrators = json(&succeed("list integrators --json"));
    let first = &integrators["entries"][0];
    assert!(first["name"] == "velocity-verlet" && first["source"].is_string(), "{first}");
    let list = succeed("list integrators");
    assert!(list.lines().all(|l| l.chars().count() <= 100), "{list}");
    assert!(!list.contains("source:"), "{list}");
    let one = succeed("list integrators leapfrog");
    assert!(one.contains("source:") && !one.contains("stormer"), "{one}");
    contains(&succeed("list integrators --verbose"), &["source:"]);
    let words = ["reading a list: nothing in the list has this name", "nearest: leapfrog"];
    refused("list integrators leap-frog", &words);
    let words = ["`bit-reversible-verlet` was removed", "kind = \"stormer-verlet\""];
    refused("list integrators bit-reversible-verlet", &words);
}

#[test]
fn completions_and_version_are_printed() {
    contains(&succeed("generate completions bash"), &["lennard"]);
    contains(&succeed("version"), &[env!("CARGO_PKG_VERSION")]);
    assert!(json(&succeed("version --json"))["isa"].is_array());
}

#[test]
fn the_default_folder_is_the_first_free_one() {
    let place = Place::with(&[("liquid.toml", FLUID)]);
    for n in 1..=2 {
        let folder = format!("runs/liquid-{n}");
        contains(&place.succeed("run liquid.toml"), &[&folder]);
        assert!(place.has(&format!("{folder}/run.json")));
    }
}

#[test]
fn progress_comes_as_plain_lines_where_there_is_no_terminal_and_not_at_all_when_quiet() {
    let place = Place::with(&[("liquid.toml", FLUID)]);
    let plain = place.output("run liquid.toml --out plain");
    contains(&stderr(&plain), &["production: step 200 of 200 (100 %)"]);
    for text in [stderr(&plain), stdout(&plain)] {
        assert!(!text.contains('\u{1b}'), "no control codes in a file");
    }
    let quiet = place.output("run liquid.toml --out quiet --quiet");
    assert_eq!((stdout(&quiet), stderr(&quiet)), (String::new(), String::new()));
}
