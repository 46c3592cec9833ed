//! How scenes are read: overrides, defaults, places, and that the reference says what the code does.

use std::path::Path;

use crate::keys::{beside, methods, with_table};
use lennard_scene::{Arrangement, Geometry, Scene, SceneError, reference};

const SMALL: &str = r#"[system]
n_atoms = 500
density = 0.8
temperature = 1.0

[[stage]]
name = "heat"
steps = 10
thermostat = "bussi"

[[stage]]
name = "production"
steps = 20

[[observable]]
kind = "rdf"
"#;

fn parse(text: &str) -> Result<Scene, SceneError> {
    Scene::parse(text, "scene.toml", &[])
}

fn with(overrides: &[(&str, &str)]) -> Result<Scene, SceneError> {
    Scene::parse(SMALL, "scene.toml", &beside(overrides))
}

/// The thermostat that a barostat goes with.
fn bath_of(barostat: &str) -> &'static str {
    let mut specs = lennard_integrators::barostats().iter();
    let spec = specs.find(|spec| spec.name == barostat);
    spec.and_then(|spec| spec.thermostat).unwrap_or("bussi")
}

/// The scene of atoms as dumbbells.
fn as_molecules(text: &str) -> String {
    let text = text.replace("n_atoms", "n_molecules").replace("density = 0.8", "density = 0.4");
    text + "\n[molecule]\nbond_length = 1.0\n"
}

/// A scene with one method's table, at its defaults, and with what the method cannot be without.
fn with_method(table: &str, kind: &str) -> Scene {
    let own = match (table, kind) {
        ("stage.barostat", _) => "pressure = 1.0".to_owned(),
        ("potential", "table") => format!(
            "tail_exponent = 6\nfile = \"{}/../../inputs/potential/lennard-jones.table\"",
            env!("CARGO_MANIFEST_DIR")
        ),
        _ => String::new(),
    };
    let wall = "[truncation]\nkind = \"shift\"\n[[wall]]\nkind = \"wca\"\n";
    let mut text = with_table(table, Some(kind), &own);
    match (table, kind) {
        ("wall", _) => text += "[truncation]\nkind = \"shift\"\n",
        ("observable", "wall-pressure") => text += wall,
        ("observable", "mutual-diffusion") => {
            text += &(two_species() + "[mixing]\nrule = \"geometric\"\n");
        }
        ("observable", "molecules" | "orientation") => text = as_molecules(&text),
        ("contact" | "bonds", "spook") => text += "[integrator]\nkind = \"spook\"\n",
        _ => {}
    }
    let bath = match (table, kind) {
        ("stage.barostat", _) => Some(bath_of(kind)),
        ("observable", "chemical-potential") => Some("bussi"),
        _ => None,
    };
    let bath = bath.map(|bath| ("stage.a.thermostat", bath));
    let scene = Scene::parse(&text, "scene.toml", &beside(bath.as_slice()));
    scene.unwrap_or_else(|e| panic!("{e}\n{text}"))
}

/// The tables of two species.
fn two_species() -> String {
    let species = |name: &str| format!("[[species]]\nname = \"{name}\"\nfraction = 0.5\n");
    species("A") + &species("B")
}

fn mixed(rule: &str) -> Scene {
    let pair = "[[pair]]\na = \"A\"\nb = \"B\"\nsigma = 1.1\nepsilon = 0.9\n";
    let species = two_species();
    let text = format!("{SMALL}\n{species}[mixing]\nrule = \"{rule}\"\n{pair}");
    parse(&text).unwrap_or_else(|e| panic!("{e}"))
}

/// Methods that are refused in a fluid.
const OSCILLATOR_ONLY: [&str; 2] = ["analytic", "spook"];

fn all_methods() -> Vec<(&'static str, &'static str)> {
    let tables =
        ["potential", "integrator", "wall", "stage.thermostat", "stage.barostat", "observable"];
    let of_table = |table| methods(table).into_iter().flatten().map(move |kind| (table, kind));
    let all = tables.into_iter().flat_map(of_table);
    all.filter(|(_, kind)| !OSCILLATOR_ONLY.contains(kind)).collect()
}

#[test]
fn overrides_reach_every_table_by_index_and_by_name() {
    let scene = with(&[
        ("system.seed", "42"),
        ("stage.0.steps", "11"),
        ("stage.production.steps", "2_000"),
        ("stage.heat.thermostat", "langevin"),
        ("observable.rdf.bins", "77"),
        ("observable.0.every", "5"),
        ("truncation.kind", "shift"),
        ("truncation.r_cut", "3"),
        ("output.velocities", "false"),
        ("start.lattice", "\"fcc\""),
    ])
    .unwrap();
    assert_eq!(scene.system.seed, 42);
    assert_eq!((scene.stages[0].steps, scene.stages[1].steps), (11, 2000));
    let bath = scene.stages[0].thermostat.as_ref().map(|t| t.name());
    assert_eq!(bath, Some("langevin"));
    assert_eq!(scene.observables[0].every, 5);
    assert_eq!(scene.truncation.r_cut, 3.0);
    assert!(!scene.truncation.tail_correction && !scene.output.velocities);
    // Those written last win.
    let twice = with(&[("system.seed", "1"), ("system.seed", "2")]).unwrap();
    assert_eq!(twice.system.seed, 2);
}

#[test]
fn an_override_of_density_takes_the_place_of_a_box() {
    let boxed = SMALL.replace("density = 0.8", "box = 8.6");
    let density = beside(&[("system.density", "0.5")]);
    let scene = Scene::parse(&boxed, "scene.toml", &density).unwrap();
    let Arrangement::Lattice { geometry, .. } = scene.system.start else {
        panic!("a lattice");
    };
    assert_eq!(geometry, Geometry::Density(0.5));
    let scene = with(&[("system.box", "[8.0, 8.0, 8.0]")]).unwrap();
    let Arrangement::Lattice { geometry, .. } = scene.system.start else {
        panic!("a lattice");
    };
    assert_eq!(geometry, Geometry::Box([8.0; 3]));
}

#[test]
fn late_trouble_is_put_on_the_line_of_its_key() {
    let scene = parse(SMALL).unwrap();
    assert_eq!(scene.source.locate("system.density"), Some(3));
    assert_eq!(scene.source.locate("stage.1.steps"), Some(13));
    // A key that was not written is looked for in its table.
    assert_eq!(scene.source.locate("system.seed"), Some(1));
    assert_eq!(scene.source.locate("truncation.r_cut"), None);
    let error = scene.source.invalid("system.density", 0.8, "less");
    assert_eq!(
        error.to_string(),
        "scene.toml, line 3: `system.density` does not fit\n  found:   0.8\n  allowed: less"
    );
}

#[test]
fn a_slab_stands_in_the_middle_of_its_longer_box() {
    let text = SMALL.replace("density = 0.8", "box = [8.0, 8.0, 8.0]")
        + "\n[start]\nvacuum = 12.0\n[truncation]\nkind = \"shift\"\n";
    let placement = parse(&text).unwrap().placement().unwrap().unwrap();
    assert_eq!(placement.cell.lengths().to_array(), [8.0, 8.0, 20.0]);
    assert_eq!(placement.corner.to_array(), [0.0, 0.0, 6.0]);
    assert_eq!(placement.filled.to_array(), [8.0; 3]);
    assert_eq!(placement.cells, Some([5; 3]));
}

#[test]
fn the_lattice_of_a_density_has_that_density() {
    let cases = [
        ("start.lattice", "fcc", 864),
        ("start.lattice", "bcc", 1024),
        ("start.lattice", "sc", 1000),
        ("start.kind", "random", 777),
    ];
    for (key, name, n) in cases {
        let scene = with(&[(key, name), ("system.n_atoms", &n.to_string())]).unwrap();
        let placement = scene.placement().unwrap().unwrap();
        let density = n as f64 / placement.cell.volume();
        assert!((density - 0.8).abs() < 1e-14, "{name}: {density}");
        let Arrangement::Lattice { lattice, .. } = scene.system.start else {
            panic!("a lattice");
        };
        let sites = placement.cells.zip(lattice);
        let sites = sites.map(|(c, lattice)| lattice.basis().len() * c.iter().product::<usize>());
        assert_eq!(sites, (name != "random").then_some(n));
    }
}

#[test]
fn a_cutoff_of_exactly_half_the_box_is_legal() {
    let boxed = |r_cut: &str| {
        with(&[
            ("system.box", "[10.0, 9.0, 8.0]"),
            ("start.kind", "random"),
            ("truncation.r_cut", r_cut),
        ])
    };
    assert!(boxed("4.0").is_ok());
    assert!(boxed("4.000000000000001").is_err());
}

#[test]
fn a_method_of_the_oscillator_is_refused_in_a_fluid() {
    for kind in OSCILLATOR_ONLY {
        let error = with(&[("integrator.kind", kind)]).unwrap_err();
        let words = match kind {
            "spook" => "has nothing to solve for without `[molecule]` or `[contact]`",
            _ => "cannot move a fluid",
        };
        assert!(error.message().contains(words), "{error}");
    }
}

#[test]
fn the_force_field_knows_what_the_integrator_needs() {
    let plain = with(&[]).unwrap().force_field();
    assert!(plain.split.is_none());
    let respa = with(&[("integrator.kind", "respa"), ("integrator.r_split", "1.6")]).unwrap();
    assert_eq!(respa.force_field().split.map(|s| s.r_split), Some(1.6));
    let wide = with(&[("integrator.kind", "respa"), ("integrator.r_split", "2.5")]).unwrap_err();
    assert_eq!(wide.key_path(), Some("integrator.r_split"));
}

#[test]
fn every_method_loads_at_its_defaults_and_loads_back() {
    for (table, kind) in all_methods() {
        let scene = with_method(table, kind);
        let text = scene.resolved_toml();
        let again = parse(&text).unwrap_or_else(|e| panic!("{e}\n{text}"));
        assert_eq!(scene, again, "{text}");
    }
}

#[test]
fn the_reference_states_the_defaults_that_the_code_takes() {
    let value_in = |scene: &Scene, table: &str, key: &str| -> Option<toml::Value> {
        let resolved: toml::Table = scene.resolved_toml().parse().unwrap();
        let mut at = &toml::Value::Table(resolved);
        for step in table.split('.').filter(|step| !step.is_empty()) {
            at = at.get(step)?;
            if let Some(items) = at.as_array() {
                at = items.first()?;
            }
        }
        at.get(key).cloned()
    };
    let mut compared = 0;
    for doc in reference::keys() {
        let Some(stated) = doc.default.strip_prefix('`').and_then(|d| d.strip_suffix('`')) else {
            continue;
        };
        let Ok(stated) = format!("x = {stated}").parse::<toml::Table>() else {
            continue;
        };
        // The first stage of the small scene states its thermostat; the others their defaults.
        let scene = match (doc.method, doc.table, doc.key) {
            (Some(rule), "mixing", _) => mixed(rule),
            (Some(kind), table, _) => with_method(table, kind),
            (None, "wall", _) => with_method("wall", "wca"),
            (None, "contact", _) => with_method("contact", "soft"),
            // A field of zero is none.
            (None, "field", _) => continue,
            // A stage without exchange has no table of it.
            (None, "stage.exchange", _) => {
                let scene =
                    with(&[("stage.heat.thermostat", "none"), ("stage.heat.exchange", "heat")])
                        .unwrap();
                let taken = value_in(&scene, "stage.exchange", doc.key);
                assert_eq!(taken.as_ref(), stated.get("x"), "{}", doc.key);
                continue;
            }
            (None, "stage", "thermostat" | "barostat" | "exchange") => {
                let scene = parse(SMALL).unwrap();
                assert_eq!(scene.stages[1].thermostat, None);
                assert_eq!(scene.stages[1].barostat, None);
                assert_eq!(scene.stages[1].exchange, None);
                continue;
            }
            (None, "molecule" | "bonds", _) | (None, "output", "whole") => {
                with_method("bonds", "direct")
            }
            (None, "species" | "pair" | "mixing", _) | (None, "truncation", "r_cut_in") => {
                mixed("geometric")
            }
            _ => parse(SMALL).unwrap(),
        };
        let taken = value_in(&scene, doc.table, doc.key);
        assert_eq!(taken.as_ref(), stated.get("x"), "{}.{}", doc.table, doc.key);
        compared += 1;
    }
    // Most keys have a default that can be written down.
    assert!(compared > 30, "{compared}");
}

#[test]
fn the_name_is_that_of_the_file_unless_the_scene_has_one() {
    assert_eq!(parse(SMALL).unwrap().name, "scene");
    let named = |file: &str| Scene::parse(SMALL, file, &[]).unwrap().name;
    assert_eq!(named("inputs/my fluid (2).toml"), "my-fluid--2-");
    assert_eq!(named("<>"), "scene");
    assert_eq!(parse(&format!("name = \"a.b\"\n{SMALL}")).unwrap().name, "a.b");
}

#[test]
fn a_configuration_is_looked_for_beside_the_scene() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("scene.toml");
    let start = "start = { kind = \"file\", file = \"start.xyz\" }\n[system]";
    let text = SMALL.replace("[system]\nn_atoms = 500\ndensity = 0.8", start);
    std::fs::write(&scene, text).unwrap();
    let error = Scene::load(&scene, &[]).unwrap_err();
    assert_eq!(error.key_path(), Some("start.file"));
    assert_eq!(error.line(), Some(1));
    std::fs::write(folder.path().join("start.xyz"), "").unwrap();
    let loaded = Scene::load(&scene, &[]).unwrap();
    // The resolved scene can stand anywhere.
    let elsewhere = tempfile::tempdir().unwrap();
    let copy = elsewhere.path().join("copy.toml");
    std::fs::write(&copy, loaded.resolved_toml()).unwrap();
    assert_eq!(Scene::load(&copy, &[]).unwrap(), loaded);
}

#[test]
fn files_that_are_no_scenes_are_refused_with_their_name() {
    let folder = tempfile::tempdir().unwrap();
    let missing = folder.path().join("missing.toml");
    let error = Scene::load(&missing, &[]).unwrap_err();
    assert!(error.to_string().contains("missing.toml: the scene file cannot be read"));
    let binary = folder.path().join("binary.toml");
    std::fs::write(&binary, b"[system]\n\xff\xfe").unwrap();
    let error = Scene::load(&binary, &[]).unwrap_err();
    assert_eq!((error.line(), error.message()), (Some(2), "this is not text"));
    let huge = "#".repeat(2 << 20);
    assert_eq!(parse(&huge).unwrap_err().message(), "is too large for a scene");
    let error = Scene::load(Path::new("/"), &[]).unwrap_err();
    assert_eq!(error.message(), "the scene file cannot be read");
}

/// Proves that a method named beside the file takes the place of the file's, whose own keys go, and that shared keys stay.
#[test]
fn a_method_beside_the_file_takes_the_keys_of_the_other_with_it() {
    let text = "[system]\nn_atoms = 108\ndensity = 0.5\ntemperature = 1.0\n[[stage]]\nname = \"a\"\nsteps = 10\nmeasure = true\n\
        thermostat = { kind = \"nose-hoover\", tau = 0.5 }\n\
        barostat = { kind = \"stochastic-cell-rescaling\", pressure = 0.7, tau = 2.0, interval = 5 }\n\
        [[stage]]\nname = \"b\"\nsteps = 10\nmeasure = false\n[truncation]\nr_cut = 2.0\n";
    let read = |set: &[(&str, &str)]| Scene::parse(text, "t.toml", &beside(set));
    // The measured stage is the one that says so.
    let scene = read(&[("stage.measured.barostat.kind", "mtk")]).unwrap();
    let barostat = scene.stages[0].barostat.as_ref().unwrap();
    assert_eq!((barostat.options.name(), barostat.pressure), ("mtk", 0.7));
    assert_eq!(barostat.options.tau(), 2.0);
    // What was set beside the file, or belongs to no method, is refused as ever.
    let set = [("stage.a.barostat.kind", "mtk"), ("stage.a.barostat.interval", "5")];
    assert!(read(&set).unwrap_err().to_string().contains("barostat.interval`"));
    let wrong = text.replace("interval = 5", "intervall = 5");
    let other = beside(&[("stage.a.barostat.kind", "mtk")]);
    let message = Scene::parse(&wrong, "t.toml", &other).unwrap_err().to_string();
    assert!(message.contains("`stage.0.barostat.intervall` is not a known key"), "{message}");
}
