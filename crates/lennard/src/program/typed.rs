//! The command as it was typed, for whoever is to type it again.

use std::ffi::OsString;
use std::path::Path;
use std::sync::{Mutex, PoisonError};

use lennard_io::{in_shell, path_in_shell};

static TYPED: Mutex<Vec<OsString>> = Mutex::new(Vec::new());

/// What says how a command answers, and not what it does.
const NOT_AGAIN: [&str; 3] = ["--json", "--quiet", "--force"];

/// Keeps the arguments of the program, its name first.
pub fn keep(arguments: &[OsString]) {
    *TYPED.lock().unwrap_or_else(PoisonError::into_inner) = arguments.to_vec();
}

/// The command with the output folder that it has, or without one, as a shell reads it. It lacks what says how it answers,
/// and the options of `without`: `--collect`, or `--point=` where an option has a value.
pub fn again(folder: Option<&Path>, without: &[&str]) -> String {
    let typed = TYPED.lock().unwrap_or_else(PoisonError::into_inner);
    of(typed.get(1..).unwrap_or_default(), folder, without)
}

fn of(arguments: &[OsString], folder: Option<&Path>, without: &[&str]) -> String {
    let mut words = vec!["lennard".to_owned()];
    let named = folder.map(|folder| ["--out".to_owned(), path_in_shell(folder)]);
    let mut has_folder = false;
    let mut arguments = arguments.iter();
    while let Some(argument) = arguments.next() {
        let text = argument.to_string_lossy();
        let option = text.split_once('=').map_or(&*text, |(option, _)| option);
        let is_folder = option == "--out";
        let has_value = is_folder || without.contains(&&*format!("{option}="));
        if has_value && option.len() == text.len() {
            arguments.next();
        }
        if is_folder {
            words.extend(named.iter().flatten().cloned());
            has_folder = true;
        } else if !has_value && !NOT_AGAIN.contains(&option) && !without.contains(&option) {
            words.push(in_shell(argument));
        }
    }
    if !has_folder {
        words.extend(named.into_iter().flatten());
    }
    words.join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_command_is_typed_again_with_its_folder_and_without_what_was_asked_once() {
        let typed = |words: &str| words.split(' ').map(OsString::from).collect::<Vec<_>>();
        let sweep = typed("sweep a.toml --quiet --out b --set x=[1,2] --point 3 --threads=2");
        let without = ["--point=", "--threads=", "--collect"];
        let folder = Some(Path::new("my runs"));
        assert_eq!(
            of(&sweep, folder, &without),
            "lennard sweep a.toml --out 'my runs' --set 'x=[1,2]'"
        );
        assert_eq!(of(&sweep, None, &without), "lennard sweep a.toml --set 'x=[1,2]'");
        assert_eq!(
            of(&typed("study bench --json --force"), folder, &[]),
            "lennard study bench --out 'my runs'"
        );
    }
}
