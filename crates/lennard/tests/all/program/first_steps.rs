//! The first hour: shipped scenes by name, a scene of one's own, man pages and the schema.

use rayon::iter::{IntoParallelRefIterator, ParallelIterator};

use crate::program::common::*;

#[test]
fn a_shipped_scene_runs_by_its_name_anywhere_and_a_file_of_that_name_wins() {
    let place = Place::with(&[]);
    let run = SMALL.replace("verlet-1967/triple-point", "run triple-point --no-report");
    place.succeed(&format!("{run} --out shipped"));
    contains(&place.read("shipped/scene.toml"), &["name = \"triple-point\""]);
    // The same scene as a file, with another density: the file is what runs.
    place.succeed("new triple-point --like verlet-1967/triple-point");
    let mine = place.read("triple-point.toml").replace("density = 0.8442", "density = 0.7");
    place.write("triple-point.toml", &mine);
    place.succeed(&format!("{run} --out own"));
    contains(&place.read("own/scene.toml"), &["density = 0.7\n"]);
}

#[test]
fn a_name_that_nothing_has_is_refused_with_the_nearest() {
    let place = Place::with(&[]);
    for (line, wanted) in [
        ("run tripel-point", "nearest: verlet-1967/triple-point"),
        ("run gas", "nearest: fluid/gas or npt/gas"),
        ("plan fluid/gass", "nearest: fluid/gas"),
        (
            "sweep sweep/isotherms",
            ": cannot be read: No such file or directory (os error 2)\n  allowed: the path of a sweep, or the name of a shipped sweep, such as sweep/isotherm\n  nearest: sweep/isotherm",
        ),
    ] {
        place.refused(line, &[wanted]);
    }
}

#[test]
fn a_new_scene_has_the_comments_of_its_model_and_its_own_command() {
    let place = Place::with(&[]);
    contains(&place.succeed("new my-fluid --schema"), &["lennard run my-fluid.toml"]);
    let text = place.read("my-fluid.toml");
    assert!(text.starts_with("#:schema ./scene.schema.json\n"), "{text}");
    let particles = "# The particles, which start on a lattice.";
    contains(&text, &["#     lennard run my-fluid.toml\n", particles]);
    let schema = json(&place.read("scene.schema.json"));
    assert_eq!(schema, json(&place.succeed("generate schema")));
    // What was written stays, unless it is to be replaced.
    let nowhere = "no-folder/my-fluid.toml: there is no folder no-folder\n  allowed: a name in a folder that exists";
    let absent = "copying a scene: there is no shipped scene of this name\n  found:   fluid/gass\n  \
        allowed: a name of `lennard list scenes`\n  nearest: fluid/gas";
    for (line, wanted) in [
        ("new my-fluid.toml", "writing a scene: my-fluid.toml: it exists already"),
        ("new no-folder/my-fluid", nowhere),
        ("new mine --like fluid/gass", absent),
    ] {
        place.refused(line, &[wanted]);
    }
    place.succeed("new my-fluid.toml --force");
    assert!(!place.read("my-fluid.toml").starts_with("#:schema"));
    std::fs::create_dir(place.path("taken.toml")).unwrap();
    let words = ["allowed: the name of a new file"];
    contains(&stderr(&place.output("new taken --force")), &words);
    // A name with a space stands in quotes where it can be typed.
    let said = place.succeed("new 'my fluid'");
    let lines: Vec<&str> = said.lines().collect();
    assert!(lines[1].starts_with("  lennard plan 'my fluid.toml' "), "{said}");
    assert_eq!(lines[2], "  lennard run 'my fluid.toml'");
    contains(&place.read("my fluid.toml"), &["#     lennard run 'my fluid.toml'\n"]);
}

#[test]
fn every_command_and_file_in_a_copy_is_of_the_copy() {
    let place = Place::with(&[]);
    for (shipped, commands) in [
        ("fluid/accuracy", ["tune mine.toml\n", "run mine.toml\n"]),
        ("npt/baths", ["run mine.toml\n", "chart mine.toml --ensemble\n"]),
        ("sweep/transport", ["sweep mine.toml --out runs/mine\n", "compare runs/mine/*/\n"]),
        ("verlet-1967/table", ["sweep mine.toml", "sweep mine.toml --out runs/verlet-4 --set"]),
    ] {
        place.succeed(&format!("new mine --like {shipped} --force"));
        let text = place.read("mine.toml");
        for command in commands {
            contains(&text, &[&format!("lennard {command}")]);
        }
        let is_tuned = shipped == "fluid/accuracy";
        assert_eq!(text.contains("writes them to mine.lock.toml."), is_tuned, "{text}");
    }
}

/// The words of every command with its help, groups of commands and the program itself included.
fn helps(place: &Place, words: &[&str]) -> Vec<(String, String)> {
    let help = place.succeed(&format!("{} --help", words.join(" ")));
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
fn a_copy_of_every_shipped_scene_is_a_scene_and_names_itself_alone() {
    let place = Place::with(&[]);
    let list = place.json("list scenes");
    let list = list["entries"].as_array().unwrap();
    assert!(list.len() > 30);
    for (i, scene) in list.iter().enumerate() {
        let (name, copy) = (scene["name"].as_str().unwrap(), format!("copy-{i}"));
        place.succeed(&format!("new {copy} --like {name}"));
        let text = place.read(&format!("{copy}.toml"));
        let own = format!("inputs/{name}.");
        assert!(!text.contains("cargo run") && !text.contains(&own), "{name}: {text}");
        // A study checks the scenes of its points; the largest scenes are only read.
        let words: Vec<&str> = scene["source"].as_str().unwrap().split(' ').collect();
        let command = words[1..words.len() - 1].join(" ");
        if command.starts_with("study ") {
            // These have no `--set`: their files have.
            let set = "[set]\n\"kernel.isa\" = \"x\"\n";
            let wrong = match text.contains("[set]") {
                true => text.replace("[set]\n", set),
                false => format!("{text}\n{set}"),
            };
            place.write(&format!("{copy}.toml"), &wrong);
            place.refused(&format!("{command} {copy}"), &["kernel.isa"]);
        } else if command != "run" {
            place.refused(&format!("{command} {copy} --set kernel.isa=x"), &["kernel.isa"]);
        } else {
            let path = place.path(&format!("{copy}.toml"));
            lennard_scene::Scene::load(&path, &[]).unwrap_or_else(|e| panic!("{name}: {e}"));
        }
    }
}

#[test]
fn every_command_has_a_man_page() {
    let place = Place::with(&[("file", "")]);
    place.succeed("generate man pages/man1");
    contains(&place.read("pages/man1/lennard-run.1"), &["max\\-walltime"]);
    contains(&place.read("pages/man1/lennard.1"), &["lennard\\-sweep"]);
    contains(&place.read("pages/man1/lennard-study-bench.1"), &["\\-\\-repeats"]);
    ended(&place.output("generate man file"), 1, &["writing man pages: file"]);
}

#[test]
fn a_tuned_shipped_scene_looks_for_its_lock_in_the_present_folder() {
    let place = Place::with(&[]);
    place.refused("run fluid/accuracy", &[]);
    place.write("accuracy.lock.toml", "not a lock");
    contains(&stderr(&place.output("run fluid/accuracy")), &["accuracy.lock.toml"]);
}
