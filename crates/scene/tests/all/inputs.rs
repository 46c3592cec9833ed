//! The scenes of `inputs/` load and load back.

use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use lennard_scene::{Scene, reference};

/// Files are named from the root of the repository, as a user does who stands there.
fn enter_root() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    std::env::set_current_dir(root).unwrap();
}

/// All scenes below a folder, without sweeps and refused scenes.
pub(crate) fn good_scenes(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        if path.is_dir() && name != "sweep" {
            found.extend(good_scenes(&path));
        } else if name.ends_with(".toml")
            && name != "bad.toml"
            && !name.ends_with(".lock.toml")
            && !is_sweep(&path)
        {
            found.push(path);
        }
    }
    found.sort();
    found
}

/// A list of state points for `lennard sweep`, which names its scene as `base`.
fn is_sweep(path: &Path) -> bool {
    std::fs::read_to_string(path).unwrap().lines().any(|line| line.starts_with("base = "))
}

#[test]
fn every_good_scene_loads_and_its_resolved_text_loads_back_to_the_same() {
    enter_root();
    for path in good_scenes(Path::new("inputs")) {
        let scene = Scene::load(&path, &[]).unwrap_or_else(|e| panic!("{e}"));
        let text = scene.resolved_toml();
        let again = Scene::parse(&text, "resolved", &[]).unwrap_or_else(|e| panic!("{e}\n{text}"));
        assert_eq!(scene, again, "{text}");
        assert_eq!(text, again.resolved_toml());
    }
}

#[test]
fn every_scene_says_at_its_head_what_it_shows_and_how_to_run_it() {
    enter_root();
    for path in good_scenes(Path::new("inputs")) {
        let text = std::fs::read_to_string(&path).unwrap();
        let head: Vec<&str> = text.lines().take_while(|line| line.starts_with('#')).collect();
        let command = format!(" run {}", path.display());
        assert!(head.len() >= 3, "{}", path.display());
        assert!(head.iter().any(|line| line.contains(&command)), "{}", path.display());
    }
}

#[test]
fn a_few_scenes_hold_every_key_of_every_table() {
    enter_root();
    let text = std::fs::read_to_string("inputs/fluid/everything.toml").unwrap();
    let scene = Scene::load(Path::new("inputs/fluid/everything.toml"), &[]).unwrap();
    let others = [
        "inputs/chain/everything.toml",
        // Molecules are chains, or have bonds of their own with lengths from a list or from a shape.
        "inputs/molecules/triangles.toml",
        "inputs/molecules/rings.toml",
        // An accuracy excludes walls and fields.
        "inputs/walls/gravity.toml",
        // A list of positions excludes lattices.
        "inputs/mechanics/cradle.toml",
        "inputs/mechanics/pendulum.toml",
        "inputs/npt/everything.toml",
        // An exchange excludes baths.
        "inputs/thermodynamics/heat-exchange.toml",
        // A slab excludes a lattice.
        "inputs/interface/everything.toml",
        "inputs/two-phase/melting.toml",
        "inputs/mixture/everything.toml",
        // Fractions exclude counts.
        "inputs/mixture/relabelled.toml",
        // A format has keys of its own.
        "inputs/formats/xtc.toml",
        "inputs/formats/ase.toml",
        // A file in other units excludes a lattice.
        "inputs/formats/from-gro.toml",
        "inputs/fluid/argon.toml",
    ];
    let mut scenes = vec![scene];
    scenes.extend(others.map(|path| Scene::load(Path::new(path), &[]).unwrap()));
    let wrote = |table: &str, key: &str| {
        let wrote = |name: &str| scenes.iter().any(|scene| scene.source.wrote(name));
        match table.split_once('.') {
            _ if table.is_empty() => wrote(key),
            None if ["stage", "observable", "wall", "species", "pair"].contains(&table) => {
                (0..10).any(|i| wrote(&format!("{table}.{i}.{key}")))
            }
            None => wrote(&format!("{table}.{key}")),
            Some((list, of_entry)) => {
                (0..10).any(|i| wrote(&format!("{list}.{i}.{of_entry}.{key}")))
            }
        }
    };
    // Some keys exclude each other, and a scene has one potential and one integrator.
    let elsewhere = ["box"];
    let other_method = |doc: &&reference::KeyDoc| {
        ["potential", "integrator", "bonds", "wall", "contact"].contains(&doc.table)
            && doc.method.is_some()
    };
    let missing: BTreeSet<String> = reference::keys()
        .iter()
        .filter(|doc| !elsewhere.contains(&doc.key) && !other_method(doc))
        .filter(|doc| !wrote(doc.table, doc.key))
        .map(|doc| format!("{}.{}", doc.table, doc.key))
        .collect();
    assert!(missing.is_empty(), "not in everything.toml: {missing:?}");
    assert!(text.contains("box = [Lx, Ly, Lz]"));
}

/// The scene reference as Markdown: a section a table, a row a key.
fn markdown() -> String {
    let mut out = String::new();
    for table in reference::tables() {
        let _ = write!(out, "### {}\n\n{}\n\n", table.heading(), table.meaning);
        out.push_str("| Key | Allowed | Default | Unit | Meaning |\n|---|---|---|---|---|\n");
        for doc in reference::keys().iter().filter(|doc| doc.table == table.table) {
            let only = match doc.method {
                Some(method) => format!(" (`{method}`)"),
                None => String::new(),
            };
            let _ = writeln!(
                out,
                "| `{}`{only} | {} | {} | {} | {} |",
                doc.key,
                doc.allowed.text(),
                doc.default,
                doc.unit,
                doc.meaning
            );
        }
        out.push('\n');
    }
    out
}

#[test]
fn the_scene_reference_in_the_readme_is_the_one_in_the_code() {
    enter_root();
    let readme = std::fs::read_to_string("inputs/README.md").unwrap();
    assert!(
        readme.contains(&markdown()),
        "inputs/README.md is out of date: cargo test -p lennard-scene --test all write_reference -- --ignored"
    );
}

const SCHEMA: &str = "inputs/scene.schema.json";

fn schema_text() -> String {
    serde_json::to_string_pretty(&lennard_scene::schema()).unwrap() + "\n"
}

#[test]
fn the_schema_beside_the_scenes_is_the_one_in_the_code() {
    enter_root();
    assert!(
        std::fs::read_to_string(SCHEMA).unwrap() == schema_text(),
        "{SCHEMA} is out of date: cargo test -p lennard-scene --test all write_reference -- --ignored"
    );
}

/// Writes the tables of `inputs/README.md` and the schema anew: run by hand after a change of the reference.
#[test]
#[ignore = "writes inputs/README.md and inputs/scene.schema.json"]
fn write_reference() {
    const START: &str = "<!-- From the code: cargo test -p lennard-scene --test all write_reference -- --ignored -->\n\n";
    enter_root();
    let readme = std::fs::read_to_string("inputs/README.md").unwrap();
    let (before, _) = readme.split_once(START).unwrap();
    std::fs::write("inputs/README.md", format!("{before}{START}{}", markdown())).unwrap();
    std::fs::write(SCHEMA, schema_text()).unwrap();
}
