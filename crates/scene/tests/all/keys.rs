//! A key that is declared once is read, written and documented.

use std::collections::BTreeSet;
use std::path::Path;

use lennard_scene::{Scene, reference};

use crate::inputs::good_scenes;

const SYSTEM: &str = "[system]\nn_atoms = 500\ndensity = 0.8\ntemperature = 1.0\n";
const STAGE: &str = "[[stage]]\nname = \"a\"\nsteps = 10\n";

/// Proves that no number of a scene may be as large as a machine can write it.
#[test]
fn every_number_has_a_largest_value() {
    use reference::Allowed::{NotNegative, Positive};
    let open = |doc: &&reference::KeyDoc| matches!(doc.allowed, Positive | NotNegative);
    for doc in reference::keys().iter().filter(open) {
        let largest = format!("{} = 1e300", doc.key);
        let text = with_unknown_key(doc.table, doc.method).replace("zzz = 1", &largest);
        let error = Scene::parse(&text, "scene.toml", &[]).expect_err(&text);
        assert_eq!(error.message(), "is too large", "{error}\n{text}");
    }
}

/// Keys and values beside a scene file.
pub(crate) fn beside(overrides: &[(&str, &str)]) -> Vec<(String, String)> {
    overrides.iter().map(|(key, value)| (key.to_string(), value.to_string())).collect()
}

/// The key that names the method of a table.
fn tag(table: &str) -> Option<&'static str> {
    match table {
        "mixing" => Some("rule"),
        "bonds" => Some("method"),
        "start" | "potential" | "integrator" | "wall" | "contact" | "observable"
        | "stage.thermostat" | "stage.barostat" => Some("kind"),
        _ => None,
    }
}

/// The methods of a table by the reference; `None` alone for a table without methods.
pub(crate) fn methods(table: &str) -> Vec<Option<&'static str>> {
    let of_tag = |doc: &&reference::KeyDoc| doc.table == table && Some(doc.key) == tag(table);
    match reference::keys().iter().find(of_tag).map(|doc| doc.allowed) {
        Some(reference::Allowed::Names(names)) => names().into_iter().map(Some).collect(),
        _ => vec![None],
    }
}

/// A scene with a table in which one key is unknown.
fn with_unknown_key(table: &str, method: Option<&str>) -> String {
    with_table(table, method, "zzz = 1")
}

/// A scene with a table that has a method and these rows.
pub(crate) fn with_table(table: &str, method: Option<&str>, own: &str) -> String {
    let named = match (tag(table), method) {
        (Some(tag), Some(name)) => format!("{tag} = {name:?}, "),
        _ => String::new(),
    };
    let rows = format!("{named}{own}").replace(", ", "\n");
    let species = "[[species]]\nname = \"A\"\n";
    let stage = |key: &str| format!("{SYSTEM}{STAGE}{key}\n");
    let scene = |tables: &str| format!("{SYSTEM}{STAGE}{tables}\n");
    match table {
        "" => format!("{own}\n{SYSTEM}{STAGE}"),
        "system" => format!("{SYSTEM}{rows}\n{STAGE}"),
        "species" => scene(&format!("{species}{rows}")),
        "mixing" => scene(&format!("{species}[mixing]\n{rows}")),
        "pair" => scene(&format!("{species}[[pair]]\n{rows}")),
        "molecule" | "bonds" => {
            let molecule = match table {
                "bonds" => "[molecule]\nbond_length = 1.0\n",
                _ => "",
            };
            scene(&format!("{molecule}[{table}]\n{rows}")).replace("n_atoms", "n_molecules")
        }
        "wall" | "observable" => scene(&format!("[[{table}]]\n{rows}")),
        "stage" => stage(&rows),
        "stage.temperature" => stage(&format!("temperature = {{ from = 1.0, to = 2.0, {own} }}")),
        "stage.barostat.pressure" => {
            let pressure = format!("{{ from = 1.0, to = 2.0, {own} }}");
            stage(&format!("barostat = {{ kind = \"mtk\", pressure = {pressure} }}"))
        }
        _ => match table.strip_prefix("stage.") {
            Some(part) => stage(&format!("{part} = {{ {named}{own} }}")),
            None => scene(&format!("[{table}]\n{rows}")),
        },
    }
}

/// The keys that the reader knows in a table, from its refusal of another one.
fn known(table: &str, method: Option<&str>) -> BTreeSet<String> {
    let text = with_unknown_key(table, method);
    let error = Scene::parse(&text, "scene.toml", &[]).expect_err(&text);
    let message = error.message();
    assert!(message.starts_with("is not a known key"), "{error}\n{text}");
    let allowed = error.what_is_allowed().unwrap();
    allowed.split(", ").map(str::to_owned).collect()
}

fn documented(table: &str, method: Option<&str>) -> BTreeSet<String> {
    reference::keys()
        .iter()
        .filter(|doc| doc.table == table && (doc.method.is_none() || doc.method == method))
        .map(|doc| doc.key.to_owned())
        .collect()
}

#[test]
fn the_reader_knows_exactly_the_documented_keys_of_every_table() {
    for table in reference::tables() {
        let table = table.table;
        for method in methods(table) {
            let mut expected = documented(table, method);
            if table.is_empty() {
                // Tables stand beside the keys at the top.
                let root = reference::tables().iter().map(|t| t.table);
                expected
                    .extend(root.filter(|t| !t.is_empty() && !t.contains('.')).map(str::to_owned));
            }
            assert_eq!(known(table, method), expected, "[{table}] {method:?}");
        }
    }
}

/// Every `table.key` of a scene as it is written out; numbers of entries are left out.
fn written(prefix: &str, table: &toml::Table, found: &mut BTreeSet<String>) {
    let is_table = |name: &str| reference::tables().iter().any(|t| t.table == name);
    for (key, value) in table {
        let name = match prefix {
            "" => key.clone(),
            prefix => format!("{prefix}.{key}"),
        };
        if !is_table(&name) || prefix.starts_with("stage") {
            found.insert(name.clone());
        }
        match value {
            toml::Value::Table(inner) if is_table(&name) => written(&name, inner, found),
            toml::Value::Array(items) if is_table(&name) => {
                for item in items {
                    written(&name, item.as_table().unwrap(), found);
                }
            }
            _ => {}
        }
    }
}

#[test]
fn scenes_are_written_with_documented_keys_and_each_of_them_is_written() {
    let inputs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../inputs");
    let mut found = BTreeSet::new();
    for path in good_scenes(&inputs) {
        let scene = Scene::load(&path, &[]).unwrap_or_else(|e| panic!("{e}"));
        written("", &scene.resolved_toml().parse().unwrap(), &mut found);
    }
    let documented = |method: bool| -> BTreeSet<String> {
        let docs = reference::keys().iter();
        docs.filter(|doc| method || doc.method.is_none())
            .map(|doc| match doc.table {
                "" => doc.key.to_owned(),
                table => format!("{table}.{}", doc.key),
            })
            .collect()
    };
    let all = documented(true);
    let unknown: Vec<_> = found.difference(&all).collect();
    assert!(unknown.is_empty(), "written and not documented: {unknown:?}");
    let shared = documented(false);
    let missing: Vec<_> = shared.difference(&found).collect();
    assert!(missing.is_empty(), "documented and not written: {missing:?}");
}
