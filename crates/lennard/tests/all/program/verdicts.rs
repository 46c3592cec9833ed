//! What is said of a run: results only where they were earned.

use crate::program::common::{Place, lennard_in};
use serde_json::Value;

const SCENE: &str = r#"
[system]
n_atoms = 108
density = 0.7
temperature = 1.5
seed = 3

[truncation]
r_cut = 2.5
tail_correction = true

[integrator]
dt = 0.004

[[stage]]
name = "melt"
steps = 1000
thermostat = { kind = "bussi", tau = 0.1 }

[[stage]]
name = "production"
steps = 6000

[[observable]]
kind = "rdf"
every = 50

[[observable]]
kind = "msd"

[[observable]]
kind = "structure-factor"
"#;

/// Runs the scene with changes; its record and what `compare` says of it.
fn run(changes: &[&str]) -> (Value, Value, String) {
    let place = Place::with(&[("scene.toml", SCENE)]);
    let mut arguments = vec!["run", "scene.toml", "--out", "out", "--json", "--no-report"];
    for change in changes {
        arguments.extend(["--set", change]);
    }
    let ran = lennard_in(place.root(), &arguments);
    let said = String::from_utf8_lossy(&ran.stderr).into_owned();
    assert!(ran.status.success(), "{said}");
    let record: Value = serde_json::from_slice(&ran.stdout).unwrap();
    let compare = |extra: &[&str]| {
        let all: Vec<&str> = ["compare", "out"].iter().chain(extra).copied().collect();
        lennard_in(place.root(), &all)
    };
    let compared: Value = serde_json::from_slice(&compare(&["--json"]).stdout).unwrap();
    let table = String::from_utf8_lossy(&compare(&[]).stdout).into_owned();
    (record, compared["runs"][0].clone(), table)
}

fn row<'a>(compared: &'a Value, quantity: &str) -> &'a Value {
    let rows = compared["rows"].as_array().unwrap();
    rows.iter().find(|r| r["quantity"] == quantity).unwrap_or_else(|| panic!("no {quantity}"))
}

#[test]
fn a_fluid_that_separates_by_itself_is_judged_by_no_equation_of_one_phase() {
    let (record, compared, table) = run(&[
        "system.n_atoms=500",
        "system.density=0.25",
        "system.temperature=0.75",
        "stage.melt.temperature=0.75",
        "stage.melt.steps=10000",
        "stage.production.thermostat={ kind = \"bussi\", tau = 0.2 }",
    ]);
    let remarks = record["remarks"].to_string();
    assert!(remarks.contains("separated: the density"), "{remarks}");
    assert!(record["averages"]["isothermal_compressibility"].is_null());
    // Where it still relaxes too, this is said of it.
    let pressure = &record["averages"]["pressure"];
    assert_ne!(pressure["standing"], "sound");
    assert!(pressure["standard_error"].is_null());
    let headline = compared["headline"].as_str().unwrap();
    assert!(headline.starts_with("The fluid has separated into two phases: "), "{headline}");
    assert_eq!(row(&compared, "pressure")["reference"], Value::Null);
    assert!(compared["state"]["phase"].is_null());
    assert!(table.contains("separated"), "{table}");
}

#[test]
fn means_of_a_run_that_still_relaxes_are_no_results() {
    // A bath at T = 0.8 that takes 10 τ to cool a fluid at 1.5, over 24 τ.
    let (record, compared, table) = run(&[
        "stage.production.temperature=0.8",
        "stage.production.thermostat={ kind = \"langevin\", friction = 0.05 }",
    ]);
    let averages = record["averages"].as_object().unwrap();
    for name in ["temperature", "potential_energy", "pressure", "heat_capacity", "rdf_first_peak"] {
        let average = &averages[name];
        assert_eq!(average["standing"], "not-in-equilibrium", "{name}: {average}");
        assert!(average["standard_error"].is_null(), "{name}: {average}");
        let reason = average["reason"].as_str().unwrap();
        assert!(reason.contains("falls from"), "{reason}");
    }
    assert!(record["comparison"].as_array().unwrap().is_empty());
    assert_eq!(row(&compared, "pressure")["verdict"], "not-in-equilibrium");
    assert!(table.contains("The run was not in equilibrium"), "{table}");
    assert!(!table.contains("agrees") && !table.contains("Thol"), "{table}");
}

#[test]
fn a_run_too_short_says_how_many_steps_are_missing_and_gives_no_error() {
    let (record, compared, table) =
        run(&["system.density=0.003", "system.temperature=0.9", "stage.production.steps=2500"]);
    let energy = &record["averages"]["potential_energy"];
    assert_eq!(energy["standing"], "too-short", "{energy}");
    assert!(energy["standard_error"].is_null());
    let reason = energy["reason"].as_str().unwrap();
    assert!(reason.contains("collides") && reason.contains("more steps"), "{reason}");
    assert_eq!(row(&compared, "potential_energy")["verdict"], "too-short");
    assert!(table.contains("The run is too short"), "{table}");
    let fits = |line: &str| line.chars().count() <= 100;
    assert!(table.lines().all(fits), "{table}");
}

/// A reason of a whole sentence would fill seven lines of a narrow cell.
#[test]
fn long_reasons_stand_below_the_table_of_the_page() {
    let place = Place::with(&[("scene.toml", SCENE)]);
    let run = ["run", "scene.toml", "--out", "out", "--quiet"];
    let short = ["--set", "stage.production.steps=1500"];
    assert!(lennard_in(place.root(), &[&run[..], &short].concat()).status.success());
    let page = std::fs::read_to_string(place.root().join("out/report.html")).unwrap();
    let (table, below) = page
        .split_once("Every quantity beside the literature</h2>")
        .and_then(|(_, rest)| rest.split_once("</table>"))
        .unwrap();
    assert!(table.contains(">too short</td>"), "{table}");
    assert!(!table.contains("independent samples"), "{table}");
    // Nothing is held against a reference, and four columns would be empty.
    assert!(!table.contains("Allowed"), "{table}");
    let (notes, _) = below.split_once("</ul>").unwrap();
    let reason = "<strong>pressure</strong>: worth ";
    assert!(notes.contains(reason), "{notes}");
}

#[test]
fn a_heat_capacity_under_a_bath_is_never_below_its_kinetic_part() {
    for seed in ["1", "2", "3"] {
        let (record, ..) = run(&[
            &format!("system.seed={seed}"),
            "stage.production.steps=1000",
            "stage.production.thermostat={ kind = \"bussi\", tau = 0.5 }",
        ]);
        let found = &record["averages"]["heat_capacity"];
        assert!(found["mean"].as_f64().unwrap() >= 1.5, "{found}");
        assert_ne!(found["standing"], "sound", "{found}");
        assert!(found["standard_error"].is_null());
    }
}

#[test]
fn friction_is_said_beside_diffusion_and_no_correction_is_added() {
    let (record, compared, table) = run(&[
        "stage.production.steps=20000",
        "stage.production.thermostat={ kind = \"langevin\", friction = 10.0 }",
    ]);
    let averages = record["averages"].as_object().unwrap();
    let diffusion = &averages["diffusion_coefficient_uncorrected"];
    assert_eq!(diffusion["standing"], "thermostat", "{diffusion}");
    assert!(!averages.contains_key("diffusion_coefficient_corrected"));
    let row = row(&compared, "diffusion_coefficient_uncorrected");
    assert_eq!(row["verdict"], "thermostat");
    assert!(row["reference"].is_null());
    assert!(table.contains("langevin"), "{table}");
    // What does not move through time is the fluid's own.
    assert_eq!(averages["pressure"]["standing"], "sound", "{}", averages["pressure"]);
}

#[test]
fn velocity_scaling_in_production_is_judged_by_nothing() {
    let (record, compared, _) =
        run(&["stage.production.thermostat={ kind = \"rescale\", every = 10 }"]);
    let temperature = &record["averages"]["temperature"];
    assert_eq!(temperature["standing"], "thermostat");
    assert!(temperature["standard_error"].is_null(), "{temperature}");
    assert_eq!(row(&compared, "potential_energy")["verdict"], "thermostat");
    assert!(record["comparison"].as_array().unwrap().is_empty());
}

#[test]
fn a_state_without_a_reference_is_named_and_has_none() {
    // Inside the vapor–liquid dome.
    let (_, compared, table) = run(&["system.density=0.4", "system.temperature=0.9"]);
    for quantity in ["potential_energy", "pressure", "heat_capacity"] {
        assert!(row(&compared, quantity)["reference"].is_null(), "{quantity}");
    }
    assert!(table.contains("metastable") || table.contains("dome"), "{table}");
    assert!(!table.contains("agrees with its reference: pressure"));
    // The sentence says why, though the two temperatures agree.
    let headline = compared["headline"].as_str().unwrap();
    assert!(headline.contains("No reference of a homogeneous fluid applies: "), "{headline}");
    // A crystal is not set beside the equation of the fluid.
    let (_, compared, table) =
        run(&["system.density=1.1", "system.temperature=0.7", "truncation.r_cut=2.2"]);
    assert!(row(&compared, "potential_energy")["reference"].is_null());
    assert!(table.contains("freezing") || table.contains("range"), "{table}");
}

#[test]
fn a_slab_is_set_beside_saturation_and_not_beside_the_mean_density() {
    let folder = tempfile::tempdir().unwrap();
    let inputs = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../inputs");
    let slab = inputs.join("fluid/slab.toml");
    let arguments = [
        "run",
        slab.to_str().unwrap(),
        "--out",
        "out",
        "--quiet",
        "--no-report",
        "--set",
        "stage.production.steps=12000",
    ];
    assert!(lennard_in(folder.path(), &arguments).status.success());
    let compared = lennard_in(folder.path(), &["compare", "out", "--json"]);
    let compared: Value = serde_json::from_slice(&compared.stdout).unwrap();
    let run = &compared["runs"][0];
    assert!(row(run, "potential_energy")["reference"].is_null());
    assert!(run["equation"].is_null());
    let normal = row(run, "pressure_zz");
    assert_eq!(normal["primary"], true);
    // The vapor pressure of the truncated-shifted fluid at T = 0.75.
    let reference = normal["reference"].as_f64().unwrap();
    assert!((0.007..0.011).contains(&reference), "{normal}");
    assert!(normal["source"].as_str().unwrap().contains("Vrabec"));
}

/// Means over five bodies say nothing of a fluid, and the run says so.
#[test]
fn a_run_of_few_bodies_ends_with_its_last_state() {
    let folder = tempfile::tempdir().unwrap();
    let run = lennard_in(folder.path(), &["run", "mechanics/cradle", "--out", "out"]);
    let said = String::from_utf8_lossy(&run.stdout).into_owned();
    assert!(run.status.success());
    assert!(said.contains("So few bodies have no thermodynamic state"), "{said}");
    assert!(said.contains("last state: out/final.xyz"), "{said}");
    assert!(!said.contains("too short"), "{said}");
    // Energy is conserved to the bit, and the time of five bodies is the time of files.
    assert!(said.contains("drift 0 ± 0 ε"), "{said}");
    assert!(!said.contains("atom-step"), "{said}");
    // The page has the picture of the bodies, and no table of their means.
    let page = std::fs::read_to_string(folder.path().join("out/report.html")).unwrap();
    assert!(page.contains("So few bodies") && page.contains("The particles at step"));
    assert!(page.contains("Time series") && !page.contains("Mean ") && !page.contains("averages"));
    for absent in ["beside the literature", "Every equation", "too short", "<h2>Averages"] {
        assert!(!page.contains(absent), "{absent}");
    }
    let stack = ["run", "mechanics/stack", "--out", "stack", "--quiet"];
    assert!(lennard_in(folder.path(), &stack).status.success());
    let compared = lennard_in(folder.path(), &["compare", "stack"]).stdout;
    let compared = String::from_utf8_lossy(&compared);
    assert!(compared.contains("a few bodies with"), "{compared}");
}

/// N over the whole box is no density of the fluid in a slit: no phase is named by it.
#[test]
fn a_fluid_between_walls_is_said_to_be_in_no_phase() {
    let wall = "[[wall]]\naxis = \"z\"\nkind = \"hard\"\n[[stage]]\nname = \"melt\"";
    let scene = SCENE
        .replace("tail_correction = true", "tail_correction = false")
        .replace("[[stage]]\nname = \"melt\"", wall);
    let scene = scene.split("[[observable]]").next().unwrap();
    let place = Place::with(&[("scene.toml", scene)]);
    let run = ["run", "scene.toml", "--out", "out", "--quiet"];
    assert!(lennard_in(place.root(), &run).status.success());
    let said = lennard_in(place.root(), &["compare", "out"]).stdout;
    let said = String::from_utf8_lossy(&said);
    assert!(said.contains(": a fluid that has walls\n"), "{said}");
    let page = place.read("out/report.html");
    assert!(!page.contains("stable"), "{page:.2000}");
}

/// 108 dumbbells at T = 2.5.
fn dumbbells(density: &str, bond_length: &str) -> String {
    let molecule = format!("[molecule]\nkind = \"dumbbell\"\n{bond_length}\n[truncation]");
    SCENE
        .replace("n_atoms = 108", "n_molecules = 108")
        .replace("density = 0.7", density)
        .replace("temperature = 1.5", "temperature = 2.5")
        .replace("dt = 0.004", "dt = 0.002")
        .replace("[truncation]", &molecule)
        .replace("[[observable]]\nkind = \"structure-factor\"", "")
        .replace("[[observable]]\nkind = \"msd\"", "")
}

/// The equation has its critical point at T = 2.52, and its S(0) makes a finite-size term that the fluid does not have.
#[test]
fn the_tolerance_holds_a_finite_size_term_near_the_critical_point_of_the_equation() {
    let scene = dumbbells("density = 0.3", "bond_length = 0.6");
    let place = Place::with(&[("scene.toml", &scene)]);
    let bath = "stage.production.thermostat={ kind = \"bussi\", tau = 0.2 }";
    let run = ["run", "scene.toml", "--out", "out", "--quiet", "--no-report"];
    let longer = ["--set", bath, "--set", "stage.production.steps=30000"];
    assert!(lennard_in(place.root(), &[&run[..], &longer].concat()).status.success());
    let compared = lennard_in(place.root(), &["compare", "out", "--json"]).stdout;
    let compared: Value = serde_json::from_slice(&compared).unwrap();
    let row = row(&compared["runs"][0], "potential_energy");
    let number = |key: &str| row[key].as_f64().unwrap();
    // 4 combined errors, 0.02 of the equations, and a term of 0.08.
    let statistical = 4.0 * number("combined_error") + 0.02;
    assert!(number("tolerance") > statistical + 0.06, "{row}");
    assert!(["agrees", "too-coarse"].iter().any(|v| row["verdict"] == *v), "{row}");
    let words = row["tolerance_words"].as_str().unwrap();
    assert!(words.contains("of the finite-size term"), "{row}");
    let table = lennard_in(place.root(), &["compare", "out"]).stdout;
    let table = String::from_utf8_lossy(&table);
    let words: Vec<&str> = table.split_whitespace().collect();
    let near = "not trusted near the critical point of the equation";
    assert!(words.join(" ").contains(near), "{table}");
}

/// One reference, one error and one tolerance for a number: the card forgets neither the number of particles nor the cutoff.
#[test]
fn the_card_says_what_the_table_says() {
    let bath = "stage.production.thermostat={ kind = \"bussi\", tau = 0.2 }";
    let few = [
        "system.n_atoms=32",
        "system.density=0.1",
        "system.temperature=3.0",
        "system.seed=1",
        "truncation.r_cut=3.0",
        "stage.melt.steps=5000",
        "stage.production.steps=60000",
        bath,
    ];
    // The bias of the cutoff is many errors large.
    let biased = [
        "system.density=0.8442",
        "system.temperature=0.73",
        "stage.melt.temperature=2.0",
        "truncation.r_cut=2.5",
        "system.seed=2",
        "observable.0.r_max=3.3",
        "stage.production.steps=30000",
        "system.n_atoms=256",
        bath,
    ];
    let mut seen = Vec::new();
    for changes in [&few[..], &biased] {
        let (_, compared, _) = run(changes);
        let rows = compared["card"]["rows"].as_array().unwrap();
        for beside in rows {
            let property = beside["property"].as_str().unwrap();
            let row = row(&compared, property);
            if row["reference"].is_null() {
                continue;
            }
            let first = beside["values"][0].as_f64().unwrap();
            let reference = row["reference"].as_f64().unwrap();
            assert!((first - reference).abs() <= 1e-12 * reference.abs(), "{row}");
            let pair = [&row["verdict"], &beside["verdict"]].map(|v| v.as_str().unwrap());
            let ["agrees" | "sharper" | "too-coarse" | "predicted-bias" | "differs", there] = pair
            else {
                panic!("{row}");
            };
            let fits = match pair[0] {
                "agrees" => matches!(there, "agrees" | "sharper"),
                "differs" => there != "predicted-bias",
                same => there == same,
            };
            assert!(fits, "{property}: {pair:?} {row} {beside}");
            let number = |key: &str| row[key].as_f64().unwrap();
            let is_fine = number("tolerance") <= 0.05 * number("scale");
            assert!(pair[0] != "agrees" || is_fine, "{row}");
            assert!(pair[0] != "too-coarse" || !is_fine, "{row}");
            seen.push((changes.len(), property.to_owned(), pair[0].to_owned()));
        }
    }
    // A barostat holds P, and U stands beside the equation at that pressure: the card is at the measured density.
    let barostat =
        "stage.production.barostat={ kind = \"stochastic-cell-rescaling\", pressure = 2.0 }";
    let (_, compared, _) = run(&[bath, barostat, "stage.production.steps=20000"]);
    assert!(row(&compared, "pressure")["reference"].is_number());
    let rows = compared["card"]["rows"].as_array().unwrap();
    assert!(rows.iter().all(|r| r["property"] != "pressure"), "{rows:?}");
    let has = |changes: &[&str], property: &str, verdict: &str| {
        let wanted = (changes.len(), property.to_owned(), verdict.to_owned());
        assert!(seen.contains(&wanted), "{wanted:?} {seen:?}");
    };
    has(&few, "potential_energy", "agrees");
    has(&few, "isothermal_compressibility", "too-coarse");
    has(&biased, "potential_energy", "predicted-bias");
    has(&biased, "heat_capacity_pressure", "too-coarse");
}

/// Densities count molecules, in the comparison too: a run of dumbbells has the equation of Lísal beside it.
#[test]
fn a_run_of_dumbbells_is_compared_at_the_density_of_its_molecules() {
    let scene = dumbbells("density = 0.4", "bond_length = 0.67");
    let place = Place::with(&[("scene.toml", &scene)]);
    let run = ["run", "scene.toml", "--out", "out", "--quiet", "--no-report"];
    let ran = lennard_in(place.root(), &run);
    assert!(ran.status.success(), "{}", String::from_utf8_lossy(&ran.stderr));
    // Every command counts sites and molecules, and names the density of molecules.
    for (command, words) in [
        (["plan", "scene.toml"], "216 sites in 108 molecules at density 0.4000"),
        (["energy", "scene.toml"], "216 sites in 108 molecules, "),
        (["compare", "out"], "216 sites in 108 molecules, 6000 measured steps, ρ = 0.4000"),
    ] {
        let said = lennard_in(place.root(), &command).stdout;
        let said = String::from_utf8_lossy(&said);
        assert!(said.contains(words), "wanted {words} in\n{said}");
    }
    let compared = lennard_in(place.root(), &["compare", "out", "--json"]);
    let compared: Value = serde_json::from_slice(&compared.stdout).unwrap();
    let run = &compared["runs"][0];
    assert!((run["state"]["density"].as_f64().unwrap() - 0.4).abs() < 1e-9, "{run}");
    for quantity in ["potential_energy", "pressure"] {
        let row = row(run, quantity);
        let source = row["source"].as_str().unwrap();
        assert!(source.starts_with("Lísal 2004"), "{row}");
        let is_coarse = row["tolerance"].as_f64() > row["scale"].as_f64().map(|s| 0.05 * s);
        let verdict = if is_coarse { "too-coarse" } else { "agrees" };
        assert_eq!(row["verdict"], verdict, "{row}");
        let note = row["remark"].to_string();
        assert!(note.contains("for 216 sites in 108 molecules in a closed box"), "{row}");
        // What the equations disagree by is part of the tolerance.
        let number = |key: &str| row[key].as_f64().unwrap();
        let own = number("reference_error");
        let wanted = own + 4.0 * number("combined_error");
        assert!(own >= 0.02 && (number("tolerance") - wanted).abs() < 2e-4, "{row}");
    }
}

#[test]
fn few_rows_by_default_and_every_one_with_all() {
    let place = Place::with(&[("scene.toml", SCENE)]);
    let rows = |arguments: &[&str]| {
        let said = lennard_in(place.root(), arguments);
        let text = String::from_utf8_lossy(&said.stdout).into_owned();
        (text.lines().filter(|l| l.starts_with('│') && l.contains(" ± ")).count(), text)
    };
    let (few, text) = rows(&["run", "scene.toml", "--out", "out", "--no-report"]);
    assert!((5..=8).contains(&few), "{text}");
    let table = || text.lines().filter(|l| l.starts_with(['┌', '│', '└']));
    assert!(table().count() > 7 && text.contains("Allowed"), "{text}");
    assert!(table().all(|l| l.chars().count() <= 100), "{text}");
    assert!(text.contains("--verbose") && !text.contains("note:"), "{text}");
    let (every, text) = rows(&["compare", "out", "--verbose"]);
    assert!(every > 12 && text.contains("kinetic energy"), "{text}");
    assert!(text.contains("Difference / s.e.") && text.contains("Allowed"), "{text}");
}

#[test]
fn one_part_of_the_run_is_discarded_for_every_observable() {
    // A bath at another temperature, which it reaches in a tenth of the run.
    let (record, ..) = run(&[
        "stage.production.steps=20000",
        "stage.production.temperature=1.0",
        "stage.production.thermostat={ kind = \"langevin\", friction = 0.1 }",
    ]);
    let discarded = |name: &str| {
        let average = &record["averages"][name];
        average["equilibration_cut"].as_u64().unwrap()
    };
    let steps = 10 * discarded("potential_energy");
    assert!((200..12_000).contains(&steps), "{steps}");
    // Blocks are left out whole: of 64 at most, a 32nd part of the run.
    for (name, every) in [
        ("rdf_first_peak", 50),
        ("structure_factor_first_peak", 100),
        ("diffusion_coefficient_uncorrected", 10),
    ] {
        let own = every * discarded(name);
        assert!((steps..=steps + 20_000 / 32).contains(&own), "{name}: {own} {steps}");
    }
}
