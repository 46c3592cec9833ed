//! Bad input is refused before anything is written, with exit code 2 and a message that helps.

use lennard_scene::Scene;

use super::bad_scenes::BadInputs;
use super::common::{lennard, lennard_in, root, run_small, stderr, stdout};

#[test]
fn every_bad_scene_ends_with_exit_code_2_and_its_message_and_writes_nothing() {
    let inputs = BadInputs::read();
    let temporary = tempfile::tempdir().unwrap();
    let folder = temporary.path().canonicalize().unwrap().join("bad");
    std::fs::create_dir(&folder).unwrap();
    inputs.write_files(&folder);
    let mut unlike = Vec::new();
    for case in &inputs.case {
        let scene = format!("{}.toml", case.name);
        assert!(!folder.join(&scene).exists(), "{scene} is there twice");
        std::fs::write(folder.join(&scene), inputs.scene(case)).unwrap();
        let mut arguments = vec!["run", &scene, "--out", "out"];
        arguments.extend(case.set.iter().flat_map(|set| ["--set", set]));
        let output = lennard_in(&folder, &arguments);
        let message = stderr(&output).replace(&format!("{}/", folder.display()), "");
        assert_eq!(output.status.code(), Some(2), "{scene}: {message}");
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
        let observable = format!("observable=[{{ kind = \"{}\" }}]", one.name);
        let key = format!("{}=1", one.name);
        let method = one.name.replacen('.', ".kind=", 1);
        let arguments: Vec<&str> = match one.kind {
            RemovedKind::Key => vec!["run", "fluid/gas", "--set", &key],
            RemovedKind::Observable => vec!["run", "fluid/gas", "--set", &observable],
            RemovedKind::Method => vec!["run", "fluid/gas", "--set", &method],
            RemovedKind::Option | RemovedKind::Command => one.name.split(' ').collect(),
            RemovedKind::Column | RemovedKind::Name => continue,
        };
        let output = lennard(&arguments).output().unwrap();
        let message = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{}: {message}", one.name);
        assert!(message.contains("was removed") && message.contains(&one.instead), "{message}");
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
    let temporary = tempfile::tempdir().unwrap();
    std::fs::write(temporary.path().join("precious.txt"), "keep me").unwrap();
    let run = |more: &[&str]| {
        let mut command = run_small(temporary.path());
        command.arg("--quiet").args(more).output().unwrap()
    };
    let refused = run(&[]);
    assert_eq!(refused.status.code(), Some(2), "{}", stderr(&refused));
    assert!(stderr(&refused).contains("--force"), "{}", stderr(&refused));
    let forced = run(&["--force"]);
    assert!(forced.status.success(), "{}", stderr(&forced));
    assert_eq!(std::fs::read_to_string(temporary.path().join("precious.txt")).unwrap(), "keep me");
}

#[test]
fn a_folder_that_cannot_be_made_is_refused() {
    let temporary = tempfile::tempdir().unwrap();
    let file = temporary.path().join("file");
    std::fs::write(&file, "").unwrap();
    let below = file.join("out");
    let args = ["run", "inputs/verlet-1967/triple-point.toml", "--out", below.to_str().unwrap()];
    let output = lennard(&args).output().unwrap();
    assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
    assert!(stderr(&output).contains(below.to_str().unwrap()), "{}", stderr(&output));
}

#[test]
fn overrides_that_fit_nothing_name_the_override() {
    for (set, wanted) in [
        ("system.densty=0.8", "nearest: density"),
        ("truncation.r_cut=9", "r_cut"),
        ("stage.productoin.steps=5", "production"),
        ("stage.melt.thermostat=andersen", "`stage.melt.thermostat` cannot be \"andersen\""),
        ("stage.melt.thermostat.tau=-1", "`stage.melt.thermostat.tau`"),
        ("observable.rdf.every=0", "`observable.rdf.every`"),
        ("stage.7.steps=5", "`stage.7` names no such entry"),
        ("system..seed=5", "`system..seed` has an empty part"),
        ("system.seed.low=5", "`system.seed` holds a value, not a table"),
        ("system.seed=99999999999999999999", "99999999999999999999, an integer beyond 64 bits"),
        ("integrator.kind=velocity-verlt", "nearest: velocity-verlet"),
    ] {
        let output = lennard(&["plan", "inputs/verlet-1967/triple-point.toml", "--set", set])
            .output()
            .unwrap();
        assert_eq!(output.status.code(), Some(2), "{set}: {}", stderr(&output));
        for words in [&*format!("override `{set}`: "), wanted] {
            assert!(stderr(&output).contains(words), "{set}: {}", stderr(&output));
        }
    }
}

/// A disk that is full, played by a limit on the size of files: writes past it fail as they do there.
#[cfg(unix)]
#[test]
fn a_full_disk_stops_the_run_and_leaves_nothing_that_looks_finished() {
    let temporary = tempfile::tempdir().unwrap();
    let out = temporary.path().join("out");
    let mut args = vec![
        "run",
        "inputs/verlet-1967/triple-point.toml",
        "--quiet",
        "--set",
        "output.trajectory_every=10",
    ];
    args.extend(crate::program::common::SMALL);
    // 100 kB: enough for the scene and the record, too little for the trajectory.
    let script = format!(
        "ulimit -f 200; exec '{}' {} --out '{}'",
        env!("CARGO_BIN_EXE_lennard"),
        args.join(" "),
        out.display()
    );
    let output = std::process::Command::new("sh")
        .args(["-c", &script])
        .current_dir(root())
        .output()
        .unwrap();
    let message = stderr(&output);
    assert_eq!(output.status.code(), Some(1), "{message}");
    assert!(message.contains("trajectory.xyz"), "{message}");
    let record = std::fs::read_to_string(out.join("run.json")).unwrap();
    assert!(record.contains("\"finished\": false"), "{record}");
    assert!(!out.join("final.xyz").exists());
    // Whole frames only: every frame has the same number of lines, and the last line ends.
    let trajectory = std::fs::read_to_string(out.join("trajectory.xyz")).unwrap();
    assert!(trajectory.is_empty() || trajectory.ends_with('\n'));
    assert_eq!(trajectory.lines().count() % 258, 0);
}
