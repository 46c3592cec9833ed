//! What is said of a run: results only where they were earned.

use serde_json::Value;

use crate::program::common::*;

const SCENE: &str = r#"
system = { n_atoms = 108, density = 0.7, temperature = 1.5, seed = 3 }
truncation = { r_cut = 2.5, tail_correction = true }
integrator = { dt = 0.004 }
stage = [
    { name = "melt", steps = 1000, thermostat = { kind = "bussi", tau = 0.1 } },
    { name = "production", steps = 6000 },
]
observable = [{ kind = "rdf", every = 50 }, { kind = "msd" }, { kind = "structure-factor" }]
"#;

/// A bath of the measured stage.
const BATH: &str = "'stage.production.thermostat={ kind = \"bussi\", tau = 0.2 }'";

/// Runs a scene with changes, each a word, and compares the run: its record, the document and the table.
fn compared(scene: &str, changes: &str) -> (Value, Value, String) {
    let place = Place::with(&[("scene.toml", scene)]);
    let mut command = place.command("run scene.toml --out out --json --no-report");
    let sets = words(changes).into_iter().flat_map(|change| ["--set", change]);
    let record = json(&success(command.args(sets)));
    let document = place.json("compare out");
    (record, document["runs"][0].clone(), place.succeed("compare out"))
}

fn run(changes: &str) -> (Value, Value, String) {
    compared(SCENE, changes)
}

#[test]
fn a_fluid_that_separates_by_itself_is_judged_by_no_equation_of_one_phase() {
    let (record, compared, table) = run(&format!(
        "system.n_atoms=500 system.density=0.25 system.temperature=0.75 stage.melt.temperature=0.75 \
         stage.melt.steps=10000 {BATH}"
    ));
    contains(&record["remarks"].to_string(), &["separated: the density"]);
    assert!(record["averages"]["isothermal_compressibility"].is_null());
    // Where it still relaxes too, this is said of it.
    let pressure = &record["averages"]["pressure"];
    assert_ne!(pressure["standing"], "sound");
    assert!(pressure["standard_error"].is_null());
    let headline = compared["headline"].as_str().unwrap();
    assert!(headline.starts_with("The fluid has separated into two phases: "), "{headline}");
    assert_eq!(row(&compared, "pressure")["reference"], Value::Null);
    assert!(compared["state"]["phase"].is_null());
    contains(&table, &["separated"]);
}

#[test]
fn means_of_a_run_that_still_relaxes_are_no_results() {
    // A bath at T = 0.8 that takes 10 τ to cool a fluid at 1.5, over 24 τ.
    let (record, compared, table) = run("stage.production.temperature=0.8 \
         'stage.production.thermostat={ kind = \"langevin\", friction = 0.05 }'");
    for name in ["temperature", "potential_energy", "pressure", "heat_capacity", "rdf_first_peak"] {
        let average = &record["averages"][name];
        assert_eq!(average["standing"], "not-in-equilibrium", "{name}: {average}");
        assert!(average["standard_error"].is_null(), "{name}: {average}");
        contains(average["reason"].as_str().unwrap(), &["falls from"]);
    }
    assert!(record["comparison"].as_array().unwrap().is_empty());
    assert_eq!(row(&compared, "pressure")["verdict"], "not-in-equilibrium");
    contains(&table, &["The run was not in equilibrium"]);
    assert!(!table.contains("agrees") && !table.contains("Thol"), "{table}");
}

/// A reason of a whole sentence would fill seven lines of a narrow cell.
#[test]
fn long_reasons_stand_below_the_table_of_the_page() {
    let place = Place::with(&[("scene.toml", SCENE)]);
    place.succeed("run scene.toml --out out --quiet --set stage.production.steps=1500");
    let page = place.read("out/report.html");
    let (table, below) = page
        .split_once("Every quantity beside the literature</h2>")
        .and_then(|(_, rest)| rest.split_once("</table>"))
        .unwrap();
    contains(table, &[">too short</td>"]);
    assert!(!table.contains("independent samples"), "{table}");
    // Nothing is held against a reference, and four columns would be empty.
    assert!(!table.contains("Allowed"), "{table}");
    let (notes, _) = below.split_once("</ul>").unwrap();
    contains(notes, &["<strong>pressure</strong>: worth "]);
}

#[test]
fn friction_is_said_beside_diffusion_and_no_correction_is_added() {
    let (record, compared, table) = run("stage.production.steps=20000 \
         'stage.production.thermostat={ kind = \"langevin\", friction = 10.0 }'");
    let averages = record["averages"].as_object().unwrap();
    let diffusion = &averages["diffusion_coefficient_uncorrected"];
    assert_eq!(diffusion["standing"], "thermostat", "{diffusion}");
    assert!(!averages.contains_key("diffusion_coefficient_corrected"));
    let row = row(&compared, "diffusion_coefficient_uncorrected");
    assert_eq!(row["verdict"], "thermostat");
    assert!(row["reference"].is_null());
    contains(&table, &["langevin"]);
    // What does not move through time is the fluid's own.
    assert_eq!(averages["pressure"]["standing"], "sound", "{}", averages["pressure"]);
}

#[test]
fn velocity_scaling_in_production_is_judged_by_nothing() {
    let (record, compared, _) =
        run("'stage.production.thermostat={ kind = \"rescale\", every = 10 }'");
    let temperature = &record["averages"]["temperature"];
    assert_eq!(temperature["standing"], "thermostat");
    assert!(temperature["standard_error"].is_null(), "{temperature}");
    assert_eq!(row(&compared, "potential_energy")["verdict"], "thermostat");
    assert!(record["comparison"].as_array().unwrap().is_empty());
}

/// The sentence says why nothing is judged, though the two temperatures agree.
#[test]
fn a_state_inside_the_dome_is_named_in_the_headline() {
    let (_, compared, table) = run("system.density=0.4 system.temperature=0.9");
    let headline = compared["headline"].as_str().unwrap();
    contains(headline, &["No reference of a homogeneous fluid applies: "]);
    assert!(!table.contains("agrees with its reference: pressure"));
}

#[test]
fn a_slab_is_set_beside_saturation_and_not_beside_the_mean_density() {
    let place = Place::with(&[]);
    let run = "run fluid/slab --out out --quiet --no-report --set stage.production.steps=12000";
    place.succeed(run);
    let compared = &place.json("compare out")["runs"][0];
    assert!(row(compared, "potential_energy")["reference"].is_null());
    assert!(compared["equation"].is_null());
    let normal = row(compared, "pressure_zz");
    assert_eq!(normal["primary"], true);
    // The vapor pressure of the truncated-shifted fluid at T = 0.75.
    assert!((0.007..0.011).contains(&number(&normal["reference"])), "{normal}");
    contains(normal["source"].as_str().unwrap(), &["Vrabec"]);
}

/// Means over five bodies say nothing of a fluid, and the run says so.
#[test]
fn a_run_of_few_bodies_ends_with_its_last_state() {
    let place = Place::with(&[]);
    let said = place.succeed("run mechanics/cradle --out out");
    contains(&said, &["So few bodies have no thermodynamic state", "last state: out/final.xyz"]);
    // Energy is conserved to the bit, and the time of five bodies is the time of files.
    contains(&said, &["drift 0 ± 0 ε"]);
    assert!(!said.contains("too short") && !said.contains("atom-step"), "{said}");
    // The page has the picture of the bodies, and no table of their means.
    let page = place.read("out/report.html");
    contains(&page, &["So few bodies", "The particles at step", "Time series"]);
    for absent in [
        "Mean ",
        "averages",
        "beside the literature",
        "Every equation",
        "too short",
        "<h2>Averages",
    ] {
        assert!(!page.contains(absent), "{absent}");
    }
    place.succeed("run mechanics/stack --out stack --quiet");
    contains(&place.succeed("compare stack"), &["a few bodies with"]);
}

/// N over the whole box is no density of the fluid in a slit: no phase is named by it.
#[test]
fn a_fluid_between_walls_is_said_to_be_in_no_phase() {
    let place = Place::with(&[("scene.toml", FLUID)]);
    let slit =
        "--set truncation.tail_correction=false --set 'wall=[{ axis = \"z\", kind = \"hard\" }]'";
    place.succeed(&format!("run scene.toml --out out --quiet {slit}"));
    contains(&place.succeed("compare out"), &[": a fluid that has walls\n"]);
    let page = place.read("out/report.html");
    assert!(!page.contains("stable"), "{page:.2000}");
}

/// 108 dumbbells at T = 2.5.
fn dumbbells(density: &str, bond_length: &str) -> String {
    let molecule = format!("molecule = {{ kind = \"dumbbell\", bond_length = {bond_length} }}\n");
    let scene = SCENE
        .replace("n_atoms = 108", "n_molecules = 108")
        .replace(
            "density = 0.7, temperature = 1.5",
            &format!("density = {density}, temperature = 2.5"),
        )
        .replace("dt = 0.004", "dt = 0.002");
    let (before, _) = scene.split_once("observable = ").unwrap();
    format!("{before}{molecule}observable = [{{ kind = \"rdf\", every = 50 }}]\n")
}

/// The equation has its critical point at T = 2.52, and its S(0) makes a finite-size term that the fluid does not have.
#[test]
fn the_tolerance_holds_a_finite_size_term_near_the_critical_point_of_the_equation() {
    let scene = dumbbells("0.3", "0.6");
    let (_, compared, table) = compared(&scene, &format!("stage.production.steps=30000 {BATH}"));
    let row = row(&compared, "potential_energy");
    let of = |key: &str| number(&row[key]);
    // 4 combined errors, 0.02 of the equations, and a term of 0.08.
    let statistical = 4.0 * of("combined_error") + 0.02;
    assert!(of("tolerance") > statistical + 0.06, "{row}");
    assert!(["agrees", "too-coarse"].iter().any(|v| row["verdict"] == *v), "{row}");
    contains(row["tolerance_words"].as_str().unwrap(), &["of the finite-size term"]);
    let near = "not trusted near the critical point of the equation";
    contains(&in_one_line(&table), &[near]);
}

/// One reference, one error and one tolerance for a number: the card forgets neither the number of particles nor the cutoff.
#[test]
fn the_card_says_what_the_table_says() {
    let few = "system.n_atoms=32 system.density=0.1 system.temperature=3.0 system.seed=1 truncation.r_cut=3.0 \
        stage.melt.steps=5000 stage.production.steps=60000";
    // The bias of the cutoff is many errors large.
    let biased = "system.density=0.8442 system.temperature=0.73 stage.melt.temperature=2.0 truncation.r_cut=2.5 \
        system.seed=2 observable.0.r_max=3.3 stage.production.steps=30000 system.n_atoms=256";
    for (changes, expected) in [
        (few, [("potential_energy", "agrees"), ("isothermal_compressibility", "too-coarse")]),
        (
            biased,
            [("potential_energy", "predicted-bias"), ("heat_capacity_pressure", "too-coarse")],
        ),
    ] {
        let (_, compared, _) = run(&format!("{changes} {BATH}"));
        let mut seen = Vec::new();
        for beside in compared["card"]["rows"].as_array().unwrap() {
            let property = beside["property"].as_str().unwrap();
            let row = row(&compared, property);
            if row["reference"].is_null() {
                continue;
            }
            let reference = number(&row["reference"]);
            let first = number(&beside["values"][0]);
            assert!((first - reference).abs() <= 1e-12 * reference.abs(), "{row}");
            let [verdict, there] =
                [&row["verdict"], &beside["verdict"]].map(|v| v.as_str().unwrap());
            let fits = match verdict {
                "agrees" => matches!(there, "agrees" | "sharper"),
                "differs" => there != "predicted-bias",
                "sharper" | "too-coarse" | "predicted-bias" => there == verdict,
                _ => panic!("{row}"),
            };
            assert!(fits, "{property}: {row} {beside}");
            let is_fine = number(&row["tolerance"]) <= 0.05 * number(&row["scale"]);
            assert!(verdict != "agrees" || is_fine, "{row}");
            assert!(verdict != "too-coarse" || !is_fine, "{row}");
            seen.push((property.to_owned(), verdict.to_owned()));
        }
        for (property, verdict) in expected {
            let wanted = (property.to_owned(), verdict.to_owned());
            assert!(seen.contains(&wanted), "{wanted:?} {seen:?}");
        }
    }
    // A barostat holds P, and U stands beside the equation at that pressure: the card is at the measured density.
    let barostat =
        "'stage.production.barostat={ kind = \"stochastic-cell-rescaling\", pressure = 2.0 }'";
    let (_, compared, _) = run(&format!("{BATH} {barostat} stage.production.steps=20000"));
    assert!(row(&compared, "pressure")["reference"].is_number());
    let rows = compared["card"]["rows"].as_array().unwrap();
    assert!(rows.iter().all(|r| r["property"] != "pressure"), "{rows:?}");
}

/// Densities count molecules, in the comparison too: a run of dumbbells has the equation of Lísal beside it.
#[test]
fn a_run_of_dumbbells_is_compared_at_the_density_of_its_molecules() {
    let scene = dumbbells("0.4", "0.67");
    let place = Place::with(&[("scene.toml", &scene)]);
    place.succeed("run scene.toml --out out --quiet --no-report");
    // Every command counts sites and molecules, and names the density of molecules.
    for (line, words) in [
        ("plan scene.toml", "216 sites in 108 molecules at density 0.4000"),
        ("energy scene.toml", "216 sites in 108 molecules, "),
        ("compare out", "216 sites in 108 molecules, 6000 measured steps, ρ = 0.4000"),
    ] {
        contains(&place.succeed(line), &[words]);
    }
    let run = &place.json("compare out")["runs"][0];
    assert!((number(&run["state"]["density"]) - 0.4).abs() < 1e-9, "{run}");
    for quantity in ["potential_energy", "pressure"] {
        let row = row(run, quantity);
        let of = |key: &str| number(&row[key]);
        assert!(row["source"].as_str().unwrap().starts_with("Lísal 2004"), "{row}");
        let is_coarse = of("tolerance") > 0.05 * of("scale");
        assert_eq!(row["verdict"], if is_coarse { "too-coarse" } else { "agrees" }, "{row}");
        let note = row["remark"].to_string();
        contains(&note, &["for 216 sites in 108 molecules in a closed box"]);
        // What the equations disagree by is part of the tolerance.
        let own = of("reference_error");
        let wanted = own + 4.0 * of("combined_error");
        assert!(own >= 0.02 && (of("tolerance") - wanted).abs() < 2e-4, "{row}");
    }
}

#[test]
fn few_rows_by_default_and_every_one_with_all() {
    let place = Place::with(&[("scene.toml", SCENE)]);
    let rows = |line: &str| {
        let text = place.succeed(line);
        (text.lines().filter(|l| l.starts_with('│') && l.contains(" ± ")).count(), text)
    };
    let (few, text) = rows("run scene.toml --out out --no-report");
    assert!((5..=8).contains(&few), "{text}");
    let table = || text.lines().filter(|l| l.starts_with(['┌', '│', '└']));
    assert!(table().count() > 7 && text.contains("Allowed"), "{text}");
    assert!(table().all(|l| l.chars().count() <= 100), "{text}");
    assert!(text.contains("--verbose") && !text.contains("note:"), "{text}");
    let (every, text) = rows("compare out --verbose");
    assert!(every > 12, "{text}");
    contains(&text, &["kinetic energy", "Difference / s.e.", "Allowed"]);
}

#[test]
fn one_part_of_the_run_is_discarded_for_every_observable() {
    // A bath at another temperature, which it reaches in a tenth of the run.
    let (record, ..) = run("stage.production.steps=20000 stage.production.temperature=1.0 \
         'stage.production.thermostat={ kind = \"langevin\", friction = 0.1 }'");
    let discarded = |name: &str| record["averages"][name]["equilibration_cut"].as_u64().unwrap();
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
