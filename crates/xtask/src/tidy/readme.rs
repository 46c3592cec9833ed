//! What README.md and the documents in docs/ name must exist: paths, commands and their options.

use std::collections::BTreeMap;
use std::error::Error;
use std::path::Path;

use crate::workspace::Workspace;

/// Commands of a program with the options that each knows.
pub type Commands = BTreeMap<String, Vec<String>>;

/// Folders that runs and builds make.
const MADE_LATER: [&str; 3] = ["runs", "target", ".venv"];
const XTASK: [&str; 12] = [
    "docs", "test", "check", "physics", "cluster", "mpi", "tidy", "soak", "fuzz", "ledger",
    "python", "help",
];
const CARGO: [&str; 12] = [
    "check", "run", "xtask", "test", "build", "bench", "fmt", "clippy", "doc", "install",
    "publish", "tree",
];

/// Reads the documents and asks the built program what it knows.
pub fn faults_in_documents(workspace: &Workspace) -> Result<Vec<String>, Box<dyn Error>> {
    let commands = commands(workspace)?;
    let mut found = Vec::new();
    for name in workspace.tracked(&["README.md", "CONTRIBUTING.md", "docs/*.md"])? {
        let path = workspace.root.join(&name);
        let text = std::fs::read_to_string(&path).map_err(|e| format!("{name}: {e}"))?;
        let folder = path.parent().unwrap_or(&workspace.root);
        let faults = faults(&text, &workspace.root, folder, &commands);
        found.extend(faults.into_iter().map(|fault| format!("{name}, {fault}")));
    }
    Ok(found)
}

/// The names of the commands of `lennard`.
pub fn lennard_commands(workspace: &Workspace) -> Result<Vec<String>, Box<dyn Error>> {
    let names = commands(workspace)?.into_keys();
    Ok(names.filter(|name| name != "help").collect())
}

/// The commands of `lennard` with their options, from its own help.
pub fn commands(workspace: &Workspace) -> Result<Commands, Box<dyn Error>> {
    let help = |arguments: &[&str]| -> Result<String, Box<dyn Error>> {
        let output = workspace
            .command(workspace.binary())
            .args(arguments)
            .arg("--help")
            .output()
            .map_err(|e| format!("{}: {e}", workspace.binary().display()))?;
        Ok(String::from_utf8(output.stdout)?)
    };
    let mut commands = Commands::new();
    for name in names_in(&help(&[])?) {
        let options = options_in(&help(&[&name])?);
        commands.insert(name, options);
    }
    if commands.is_empty() {
        return Err("`lennard --help` lists no commands".into());
    }
    Ok(commands)
}

/// The first words below `Commands:`.
fn names_in(help: &str) -> Vec<String> {
    help.lines()
        .skip_while(|line| line.trim() != "Commands:")
        .skip(1)
        .take_while(|line| !line.trim().is_empty())
        // A description that was wrapped stands further to the right.
        .filter(|line| line.starts_with("  ") && !line.starts_with("   "))
        .filter_map(|line| line.split_whitespace().next())
        .map(str::to_owned)
        .collect()
}

fn options_in(help: &str) -> Vec<String> {
    help.split(|c: char| c.is_whitespace() || ",=[]<>`".contains(c))
        .filter(|word| word.starts_with("--"))
        .map(str::to_owned)
        .collect()
}

/// Whether a path names the lock file that `lennard tune` makes beside an existing scene.
fn is_lock_of_a_scene(path: &str, root: &Path) -> bool {
    path.strip_suffix(".lock.toml").is_some_and(|scene| root.join(format!("{scene}.toml")).exists())
}

/// Everything that the text names and that does not exist: paths begin in the root, and links in the folder of the text.
fn faults(text: &str, root: &Path, folder: &Path, lennard: &Commands) -> Vec<String> {
    let mut faults = Vec::new();
    for (line, code) in code_in(text) {
        let words: Vec<&str> = code.split_whitespace().collect();
        let mut tell = |fault: String| faults.push(format!("line {line}: {fault}"));
        for (i, word) in words.iter().enumerate() {
            // The value of --out is a folder that the command makes.
            let made = i > 0 && words[i - 1] == "--out";
            if !made
                && let Some(path) = path_in(word, root)
                && !root.join(&path).exists()
                && !is_lock_of_a_scene(&path, root)
            {
                tell(format!("there is no {path}"));
            }
        }
        for start in 0..words.len() {
            check_command(&words[start..], start, lennard, &mut tell);
        }
    }
    for (line, target) in links_in(text) {
        let target = target.split('#').next().unwrap_or_default();
        if !target.is_empty() && !target.contains("://") && !folder.join(target).exists() {
            faults.push(format!("line {line}: the link goes to {target}, which is not there"));
        }
    }
    faults
}

/// Checks a command that begins with the first word: `cargo …` anywhere, `lennard …` at the
/// beginning of the code.
fn check_command(words: &[&str], start: usize, lennard: &Commands, tell: &mut impl FnMut(String)) {
    match words {
        ["cargo", "xtask", name, ..] if is_name(name) && !XTASK.contains(name) => {
            tell(format!("`cargo xtask {name}` is not a command"));
        }
        ["cargo", name, rest @ ..] if is_name(name) => {
            if !CARGO.contains(name) {
                tell(format!("`cargo {name}` is not a command used here"));
            }
            let ours = *name == "run"
                && !rest.iter().any(|w| ["-p", "--package", "--example"].contains(w));
            if ours && let Some(dashes) = rest.iter().position(|w| *w == "--") {
                check_lennard(&rest[dashes + 1..], lennard, tell);
            }
        }
        [program, rest @ ..]
            if *program == "lennard" && start == 0
                || program.ends_with("/lennard") && rest.first().is_some_and(|w| is_name(w)) =>
        {
            check_lennard(rest, lennard, tell);
        }
        _ => {}
    }
}

fn check_lennard(words: &[&str], lennard: &Commands, tell: &mut impl FnMut(String)) {
    let Some(name) = words.first().filter(|w| is_name(w)) else {
        return;
    };
    let Some(options) = lennard.get(*name) else {
        tell(format!("`lennard {name}` is not a command"));
        return;
    };
    for word in &words[1..] {
        if word.starts_with(['|', '>', '#', '&', ';']) {
            break;
        }
        let option = word.split('=').next().unwrap_or_default();
        if option.starts_with("--") && !options.iter().any(|o| o == option) {
            tell(format!("`lennard {name}` has no option {option}"));
        }
    }
}

fn is_name(word: &str) -> bool {
    word.starts_with(|c: char| c.is_ascii_lowercase())
        && word.chars().all(|c| c.is_ascii_lowercase() || c == '-')
}

/// A word that can only be a path of this repository.
fn path_in(word: &str, root: &Path) -> Option<String> {
    let word = word.trim_matches(|c: char| "\"'(),;".contains(c));
    let word = word.trim_end_matches(['.', ':']).trim_start_matches("./");
    let plain = |c: char| c.is_ascii_alphanumeric() || "._-/".contains(c);
    let (first, rest) = word.split_once('/')?;
    if !word.chars().all(plain) || first.is_empty() || MADE_LATER.contains(&first) {
        return None;
    }
    // `atom-steps/s` or `ns/day` are units: they neither begin in the repository nor name a file.
    let file = rest.rsplit('/').next().is_some_and(|name| name.contains('.'));
    (file || root.join(first).is_dir() || first == "..").then(|| word.to_owned())
}

/// Pieces of code with their line numbers: inline code, and each line of fenced or indented blocks.
fn code_in(text: &str) -> Vec<(usize, String)> {
    let mut found = Vec::new();
    let mut fenced = false;
    for (i, line) in text.lines().enumerate() {
        if line.trim_start().starts_with("```") {
            fenced = !fenced;
        } else if fenced || line.starts_with("    ") {
            let code = line.trim().trim_start_matches("$ ");
            found.push((i + 1, code.to_owned()));
        } else {
            // Odd pieces between backticks are code.
            for code in line.split('`').skip(1).step_by(2) {
                found.push((i + 1, code.to_owned()));
            }
        }
    }
    found
}

fn links_in(text: &str) -> Vec<(usize, String)> {
    let mut found = Vec::new();
    for (i, line) in text.lines().enumerate() {
        for piece in line.split("](").skip(1) {
            if let Some((target, _)) = piece.split_once(')') {
                found.push((i + 1, target.to_owned()));
            }
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    fn here() -> &'static Path {
        Path::new(env!("CARGO_MANIFEST_DIR"))
    }

    fn known() -> Commands {
        let help = "Usage: lennard\n\nCommands:\n  run   Run a scene\n          and wrap\n  list  List\n\nOptions:\n  -h, --help  Print help\n";
        let options =
            options_in("Options:\n  -o, --out <DIR>  Folder [default: x]\n  --set <K=V>\n");
        names_in(help).into_iter().map(|n| (n, options.clone())).collect()
    }

    fn found(text: &str) -> Vec<String> {
        faults(text, here(), here(), &known())
    }

    #[test]
    fn commands_and_options_are_read_from_help() {
        assert_eq!(known().keys().collect::<Vec<_>>(), ["list", "run"]);
        assert_eq!(known()["run"], ["--out", "--set"]);
    }

    #[test]
    fn what_exists_is_fine() {
        let text = "See `src/main.rs` and [the code](src/tidy/mod.rs#top), `ns/day`, `U/N`.\n\n\
            \x20   cargo run --release -- run src/main.rs --out runs/new --set a.b=3\n\n\
            ```sh\n$ lennard run src/main.rs --out some/where.d\ncargo xtask test\n```\n\
            A [link](https://example.org/nowhere.html), `lennard`, `cargo run -p other --example x -- y`.\n";
        assert_eq!(found(text), Vec::<String>::new());
    }

    #[test]
    fn links_begin_in_the_folder_of_the_document_and_paths_in_the_root() {
        let text = "[a](../Cargo.toml) and `src/main.rs`\n";
        let in_folder = |folder| faults(text, here(), &here().join(folder), &known());
        assert_eq!(in_folder("src"), Vec::<String>::new());
        assert_eq!(in_folder("src/tidy").len(), 1);
    }

    #[test]
    fn a_lock_file_is_made_beside_a_scene_that_is_there() {
        assert!(is_lock_of_a_scene("Cargo.lock.toml", here()));
        assert!(!is_lock_of_a_scene("absent.lock.toml", here()));
        assert!(!is_lock_of_a_scene("Cargo.toml", here()));
    }

    #[test]
    fn what_does_not_exist_is_told_with_its_line() {
        for (text, fault) in [
            ("`src/absent.rs`", "there is no src/absent.rs"),
            ("`src/absent.lock.toml`", "there is no src/absent.lock.toml"),
            ("`gone/scene.toml`", "there is no gone/scene.toml"),
            ("`src/nothing`", "there is no src/nothing"),
            ("`../elsewhere/x`", "there is no ../elsewhere/x"),
            ("[x](src/absent.md)", "src/absent.md"),
            ("    lennard fly", "`lennard fly` is not a command"),
            ("`cargo run --release -- fly`", "`lennard fly` is not a command"),
            ("`lennard run x --fast`", "`lennard run` has no option --fast"),
            ("`cargo xtask dance`", "`cargo xtask dance` is not a command"),
            ("`cargo flamegraph`", "`cargo flamegraph` is not a command"),
        ] {
            let faults = found(&format!("first\n{text}\n"));
            assert_eq!(faults.len(), 1, "{text}: {faults:?}");
            assert!(faults[0].starts_with("line 2: "), "{faults:?}");
            assert!(faults[0].contains(fault), "{faults:?}");
        }
    }
}
