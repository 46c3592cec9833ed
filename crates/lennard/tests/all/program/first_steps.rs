//! The first hour: shipped scenes by name, a scene of one's own, man pages and the schema.

use rayon::iter::{IntoParallelRefIterator, ParallelIterator};

use crate::program::common::{Place, SMALL, stderr, stdout, success};

#[test]
fn a_shipped_scene_runs_by_its_name_anywhere_and_a_file_of_that_name_wins() {
    let place = Place::with(&[]);
    let run = |more: &[&str]| {
        let mut command = place.command(&["run", "triple-point", "--quiet", "--no-report"]);
        command.args(SMALL).args(more);
        success(&mut command)
    };
    run(&["--out", "shipped"]);
    assert!(place.read("shipped/scene.toml").contains("name = \"triple-point\""));
    // The same scene as a file, with another density: the file is what runs.
    success(&mut place.command(&["new", "triple-point", "--like", "verlet-1967/triple-point"]));
    let mine = place.read("triple-point.toml").replace("density = 0.8442", "density = 0.7");
    place.write("triple-point.toml", &mine);
    run(&["--out", "own"]);
    assert!(place.read("own/scene.toml").contains("density = 0.7\n"));
}

#[test]
fn a_name_that_nothing_has_is_refused_with_the_nearest() {
    let place = Place::with(&[]);
    for (arguments, wanted) in [
        (["run", "tripel-point"], "nearest: verlet-1967/triple-point"),
        (["run", "gas"], "nearest: fluid/gas or npt/gas"),
        (["plan", "fluid/gass"], "nearest: fluid/gas"),
        (
            ["sweep", "sweep/isotherms"],
            ": cannot be read: No such file or directory (os error 2)\n  allowed: the path of a sweep, or the name of a shipped sweep, such as sweep/isotherm\n  nearest: sweep/isotherm",
        ),
    ] {
        let output = place.output(&arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        let said = stderr(&output);
        assert!(said.contains(wanted), "{arguments:?}: {said}");
    }
}

#[test]
fn a_new_scene_has_the_comments_of_its_model_and_its_own_command() {
    let place = Place::with(&[]);
    let said = success(&mut place.command(&["new", "my-fluid", "--schema"]));
    assert!(said.contains("lennard run my-fluid.toml"), "{said}");
    let text = place.read("my-fluid.toml");
    assert!(text.starts_with("#:schema ./scene.schema.json\n"), "{text}");
    assert!(text.contains("#     lennard run my-fluid.toml\n"), "{text}");
    assert!(text.contains("# The particles, which start on a lattice."), "{text}");
    let schema: serde_json::Value = serde_json::from_str(&place.read("scene.schema.json")).unwrap();
    assert_eq!(
        schema,
        serde_json::from_str::<serde_json::Value>(&success(
            &mut place.command(&["generate", "schema"])
        ))
        .unwrap()
    );
    // What was written stays, unless it is to be replaced.
    let again = place.output(&["new", "my-fluid.toml"]);
    assert_eq!(again.status.code(), Some(2));
    assert!(
        stderr(&again).contains("writing a scene: my-fluid.toml: it exists already"),
        "{}",
        stderr(&again)
    );
    let nowhere = place.output(&["new", "no-folder/my-fluid"]);
    assert_eq!(nowhere.status.code(), Some(2));
    let wanted = "no-folder/my-fluid.toml: there is no folder no-folder\n  allowed: a name in a folder that exists";
    assert!(stderr(&nowhere).contains(wanted), "{}", stderr(&nowhere));
    success(&mut place.command(&["new", "my-fluid.toml", "--force"]));
    assert!(!place.read("my-fluid.toml").starts_with("#:schema"));
    std::fs::create_dir(place.path("taken.toml")).unwrap();
    let folder = place.output(&["new", "taken", "--force"]);
    assert!(stderr(&folder).contains("allowed: the name of a new file"), "{}", stderr(&folder));
    let absent = place.output(&["new", "mine", "--like", "fluid/gass"]);
    assert_eq!(absent.status.code(), Some(2));
    let said = stderr(&absent);
    let wanted = "copying a scene: there is no shipped scene of this name\n  found:   fluid/gass\n  \
        allowed: a name of `lennard list scenes`\n  nearest: fluid/gas";
    assert!(said.contains(wanted), "{said}");
}

#[test]
fn every_command_and_file_in_a_copy_is_of_the_copy() {
    let place = Place::with(&[]);
    for (shipped, commands) in [
        (
            "fluid/accuracy",
            &[
                "lennard tune mine.toml\n",
                "lennard run mine.toml\n",
                "writes them to mine.lock.toml.",
            ][..],
        ),
        ("npt/baths", &["lennard run mine.toml\n", "lennard chart mine.toml --ensemble\n"]),
        (
            "sweep/transport",
            &["lennard sweep mine.toml --out runs/mine\n", "lennard compare runs/mine/*/\n"],
        ),
        (
            "verlet-1967/table",
            &["lennard sweep mine.toml --out runs/verlet-4 --set truncation.r_cut=4\n"],
        ),
    ] {
        success(&mut place.command(&["new", "mine", "--like", shipped, "--force"]));
        let text = place.read("mine.toml");
        for command in commands {
            assert!(text.contains(command), "{shipped}: {command}: {text}");
        }
    }
    for scene in lennard_scene::shipped::scenes() {
        success(&mut place.command(&["new", "mine", "--like", scene.name, "--force"]));
        let text = place.read("mine.toml");
        let own = format!("inputs/{}.", scene.name);
        assert!(!text.contains("cargo run") && !text.contains(&own), "{}: {text}", scene.name);
    }
}

#[test]
fn a_name_with_a_space_stands_in_quotes_where_it_can_be_typed() {
    let place = Place::with(&[]);
    let said = success(&mut place.command(&["new", "my fluid"]));
    let lines: Vec<&str> = said.lines().collect();
    assert!(lines[1].starts_with("  lennard plan 'my fluid.toml' "), "{said}");
    assert_eq!(lines[2], "  lennard run 'my fluid.toml'");
    let text = place.read("my fluid.toml");
    assert!(text.contains("#     lennard run 'my fluid.toml'\n"), "{text}");
}

/// The words of every command with its help, groups of commands and the program itself included.
fn helps(place: &Place, words: &[&str]) -> Vec<(String, String)> {
    let help = success(&mut place.command(&[words, &["--help"]].concat()));
    let below = help.lines().skip_while(|line| *line != "Commands:").skip(1);
    let below = below.take_while(|line| !line.is_empty()).filter(|line| !line.starts_with("   "));
    let names = below.filter_map(|line| line.split_whitespace().next()).filter(|n| *n != "help");
    let mut found = vec![(words.join(" "), help.clone())];
    found.extend(names.flat_map(|name| helps(place, &[words, &[name]].concat())));
    found
}

/// An example as the test runs it, and whether it is refused there. Runs have stages of 100 steps. Studies and sweeps read their
/// scenes, and a setting that is none ends them. Studies without a scene are left out.
fn cheap(place: &Place, example: &str) -> Option<(String, bool)> {
    let words: Vec<&str> = example.split_whitespace().collect();
    match words[1..] {
        ["run", scene, ..] => {
            let own = place.path(scene);
            let file =
                if own.exists() { own } else { lennard_scene::shipped::locate(scene.as_ref()) };
            let stages = lennard_scene::Scene::load(&file, &[]).unwrap().stages;
            let shorter = stages.iter().map(|s| format!(" --set stage.{}.steps=100", s.name));
            Some((example.to_owned() + &shorter.collect::<String>(), false))
        }
        ["study", "stability" | "mechanics", ..] => None,
        ["chart" | "tune" | "sweep" | "study", ..] => {
            Some((format!("{example} --set kernel.isa=x"), true))
        }
        _ => Some((example.to_owned(), false)),
    }
}

/// Who has the program alone has no folder `inputs`.
#[test]
fn every_command_shows_three_examples_that_work_in_any_folder() {
    let commands = helps(&Place::with(&[]), &[]);
    assert!(commands.len() > 18, "{}", commands.len());
    let programs = std::path::Path::new(env!("CARGO_BIN_EXE_lennard")).parent().unwrap();
    let path = format!("{}:{}", programs.display(), std::env::var("PATH").unwrap_or_default());
    commands.par_iter().for_each(|(command, help)| {
        let place = Place::with(&[]);
        let examples: Vec<&str> =
            help.lines().filter(|line| line.starts_with("  lennard ")).collect();
        let own = format!("  lennard {command}");
        let is_own = examples.iter().any(|line| line.starts_with(own.trim_end()));
        assert!(is_own && examples.len() >= 3, "{command}: {help}");
        for example in examples {
            let typed = example.trim().split("   ").next().unwrap();
            let Some((line, is_refused)) = cheap(&place, typed) else { continue };
            let mut bash = std::process::Command::new("bash");
            bash.args(["-c", &line]).current_dir(place.root()).env("PATH", &path);
            let output = bash.env("HOME", place.root()).output().unwrap();
            let (code, said) = (output.status.code(), stderr(&output));
            let is_as_wanted = if is_refused {
                code == Some(2) && said.contains("kernel.isa")
            } else {
                code == Some(0)
            };
            assert!(is_as_wanted, "{line}: {code:?}: {said}");
        }
    });
}

#[test]
fn a_copy_of_every_shipped_scene_is_a_scene() {
    let place = Place::with(&[]);
    let list = success(&mut place.command(&["list", "scenes", "--json"]));
    let list: serde_json::Value = serde_json::from_str(&list).unwrap();
    let list = list["entries"].as_array().unwrap();
    assert!(list.len() > 30);
    for (i, scene) in list.iter().enumerate() {
        let (name, copy) = (scene["name"].as_str().unwrap(), format!("copy-{i}"));
        success(&mut place.command(&["new", &copy, "--like", name]));
        // A study checks the scenes of its points; the largest scenes are only read.
        let command = scene["source"].as_str().unwrap().split(' ').nth(1).unwrap();
        if command != "run" {
            let refused = place.output(&[command, &copy, "--set", "kernel.isa=x"]);
            let said = stderr(&refused);
            assert!(said.contains("kernel.isa"), "{name}: {said}");
        } else {
            let path = place.path(&format!("{copy}.toml"));
            lennard_scene::Scene::load(&path, &[]).unwrap_or_else(|e| panic!("{name}: {e}"));
        }
    }
}

#[test]
fn every_command_has_a_man_page() {
    let place = Place::with(&[]);
    success(&mut place.command(&["generate", "man", "pages/man1"]));
    let page = place.read("pages/man1/lennard-run.1");
    assert!(page.contains("max\\-walltime"), "{page}");
    assert!(place.read("pages/man1/lennard.1").contains("lennard\\-sweep"));
    assert!(place.read("pages/man1/lennard-study-bench.1").contains("\\-\\-repeats"));
    place.write("file", "");
    let refused = place.output(&["generate", "man", "file"]);
    assert_eq!(refused.status.code(), Some(1), "{}", stdout(&refused));
    assert!(stderr(&refused).contains("writing man pages: file"), "{}", stderr(&refused));
}

#[test]
fn a_tuned_shipped_scene_looks_for_its_lock_in_the_present_folder() {
    let place = Place::with(&[]);
    let refused = place.output(&["run", "fluid/accuracy"]);
    assert_eq!(refused.status.code(), Some(2), "{}", stderr(&refused));
    place.write("accuracy.lock.toml", "not a lock");
    let refused = place.output(&["run", "fluid/accuracy"]);
    assert!(stderr(&refused).contains("accuracy.lock.toml"), "{}", stderr(&refused));
}
