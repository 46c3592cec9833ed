//! Bad input is refused before anything is written, with exit code 2 and a message that helps.

use lennard_scene::Scene;

use super::bad_scenes::BadInputs;
use super::common::*;

#[test]
fn every_bad_scene_ends_with_exit_code_2_and_its_message_and_writes_nothing() {
    let inputs = BadInputs::read();
    let place = Place::with(&[]);
    // A case names the folder.
    let folder = place.root().canonicalize().unwrap().join("bad");
    std::fs::create_dir(&folder).unwrap();
    inputs.write_files(&folder);
    let prefix = format!("{}/", folder.display());
    let mut unlike = Vec::new();
    for case in &inputs.case {
        let scene = format!("{}.toml", case.name);
        assert!(!folder.join(&scene).exists(), "{scene} is there twice");
        std::fs::write(folder.join(&scene), inputs.scene(case)).unwrap();
        let mut command = place.command(&format!("run {scene} --out out"));
        command.current_dir(&folder).args(case.set.iter().flat_map(|set| ["--set", set]));
        let output = command.output().unwrap();
        let message = ended(&output, 2, &[]).replace(&prefix, "");
        assert_eq!(stdout(&output), "", "{scene}");
        assert!(!folder.join("out").exists(), "{scene} left an output folder");
        let said = message.strip_prefix("error: ").unwrap().trim();
        let said = said.strip_prefix(&format!("reading the scene: {scene}, ")).unwrap_or(said);
        if said != case.expected.trim() {
            unlike.push(format!("{}\nexpected = '''\n{said}\n'''", case.name));
        }
        assert!(said.contains("allowed: "), "{scene} names nothing that is allowed: {said}");
    }
    assert!(unlike.is_empty(), "inputs/bad.toml expects another answer:\n{}", unlike.join("\n\n"));
    assert!(inputs.case.len() > 300, "only {} bad scenes", inputs.case.len());
}

/// A case is then refused for what it changes.
#[test]
fn every_base_of_the_bad_scenes_is_a_good_scene() {
    let inputs = BadInputs::read();
    let temporary = tempfile::tempdir().unwrap();
    inputs.write_files(temporary.path());
    for (name, text) in &inputs.bases {
        let path = temporary.path().join("base.toml");
        std::fs::write(&path, text).unwrap();
        let begun = Scene::load(&path, &[]).map(lennard_engine::prepare);
        assert!(matches!(begun, Ok(Ok(_))), "{name}");
    }
}

/// What went from the program is told its new way: no refusal alone can do that for columns and for names of libraries.
#[test]
fn every_refusal_of_what_was_removed_prints_the_new_way() {
    use lennard_scene::{RemovedKind, all_removed};
    for one in all_removed() {
        let name = &one.name;
        let line = match one.kind {
            RemovedKind::Key => format!("run fluid/gas --set {name}=1"),
            RemovedKind::Observable => {
                format!("run fluid/gas --set 'observable=[{{ kind = \"{name}\" }}]'")
            }
            RemovedKind::Method => {
                format!("run fluid/gas --set {}", name.replacen('.', ".kind=", 1))
            }
            RemovedKind::Option | RemovedKind::Command => name.clone(),
            RemovedKind::Column | RemovedKind::Name => continue,
        };
        refused(&line, &["was removed", &one.instead]);
    }
}

#[test]
fn the_refusal_that_the_documents_show_is_the_one_that_the_program_gives() {
    let document = std::fs::read_to_string(root().join("docs/running.md")).unwrap();
    let inputs = BadInputs::read();
    let expected = &inputs.case("unknown-key").expected;
    let shown = format!("error: reading the scene: unknown-key.toml, {expected}");
    assert!(document.contains(&shown), "{shown}");
}

#[test]
fn an_existing_folder_is_refused_unless_forced() {
    let place = Place::with(&[("liquid.toml", FLUID), ("out/precious.txt", "keep me")]);
    place.refused("run liquid.toml --quiet --out out", &["--force"]);
    place.succeed("run liquid.toml --quiet --out out --force");
    assert_eq!(place.read("out/precious.txt"), "keep me");
    place.refused("run liquid.toml --out out/precious.txt/out", &["out/precious.txt/out"]);
}

#[test]
fn overrides_that_fit_nothing_name_the_override() {
    for (set, wanted) in [
        ("system.densty=0.8", "nearest: density"),
        ("stage.productoin.steps=5", "production"),
        ("stage.melt.thermostat.tau=-1", "`stage.melt.thermostat.tau`"),
        ("observable.rdf.every=0", "`observable.rdf.every`"),
        ("stage.7.steps=5", "`stage.7` names no such entry"),
        ("system.seed.low=5", "`system.seed` holds a value, not a table"),
        ("system.seed=99999999999999999999", "99999999999999999999, an integer beyond 64 bits"),
    ] {
        let words = [&*format!("override `{set}`: "), wanted];
        refused(&format!("plan verlet-1967/triple-point --set {set}"), &words);
    }
}
