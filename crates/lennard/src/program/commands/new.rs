//! `lennard new`: a scene of one's own.

use std::path::{Path, PathBuf};

use lennard_io::path_in_shell;
use lennard_scene::Scene;
use lennard_scene::shipped::{self, Shipped};

use crate::program::args::NewArgs;
use crate::program::failure::{DONE, Failure, INPUT};
use crate::program::lammps::scene_of_lammps;

/// The shipped scene that is copied where none is named.
const TEMPLATE: &str = "template";
/// The schema beside the scene.
const SCHEMA: &str = "scene.schema.json";

/// Writes a scene file, and the schema where it is asked for.
pub fn new(args: &NewArgs) -> Result<u8, Failure> {
    let like = args.like.as_deref().unwrap_or(Path::new(TEMPLATE));
    let scene = shipped::find(like).ok_or_else(|| unknown(like))?;
    let name = match (&args.name, &args.from) {
        (Some(name), _) => name.clone(),
        (None, from) => name_of(from.as_deref().unwrap_or(Path::new("scene"))),
    };
    let file = file_of(&name);
    let schema = file.with_file_name(SCHEMA);
    refuse_existing(&file, args.force)?;
    refuse_missing_folder(&file)?;
    let mut text = match &args.from {
        Some(input) => from_lammps(input, &file)?,
        None => copy_of(scene, &file),
    };
    if args.schema {
        text = format!("#:schema ./{SCHEMA}\n{text}");
        lennard_io::write_json_atomically(&schema, &lennard_scene::schema())?;
    }
    lennard_io::write_text_atomically(&file, &text)?;
    let shown = file.display();
    match &args.from {
        Some(input) => {
            println!("{shown}: a scene from {}; its head says what is not equal", input.display())
        }
        None => println!("{shown}: a copy of the shipped scene {}", scene.name),
    }
    if args.schema {
        println!("{}: for editors", schema.display());
    }
    let typed = path_in_shell(&file);
    if scene.is_study() {
        println!("  lennard {} {typed}", scene.command());
    } else {
        println!("  lennard plan {typed}   what it computes, and for how long");
        println!("  lennard run {typed}");
    }
    Ok(DONE)
}

/// The name of an input of LAMMPS: `melt` for `in.melt` and `melt.in`.
fn name_of(input: &Path) -> PathBuf {
    let name = input.file_name().unwrap_or_default().to_string_lossy();
    let name = name.strip_prefix("in.").or(name.strip_suffix(".in")).unwrap_or(&name);
    format!("{name}.toml").into()
}

/// The scene of an input of LAMMPS, read once as the scene of a file.
fn from_lammps(input: &Path, file: &Path) -> Result<String, Failure> {
    let doing = "reading an input of LAMMPS";
    let shown = input.display().to_string();
    let text = std::fs::read_to_string(input)
        .map_err(|error| Failure::new(doing, format!("{shown}: {error}"), INPUT))?;
    let text = scene_of_lammps(&text, &shown).map_err(|why| Failure::new(doing, why, INPUT))?;
    Scene::parse(&text, &file.display().to_string(), &[])?;
    Ok(text)
}

/// NAME.toml, for a name with or without the ending.
fn file_of(name: &Path) -> PathBuf {
    if name.extension().is_some_and(|ending| ending == "toml") {
        return name.to_owned();
    }
    let mut file = name.as_os_str().to_owned();
    file.push(".toml");
    file.into()
}

fn refuse_existing(file: &Path, force: bool) -> Result<(), Failure> {
    if !file.exists() || force && file.is_file() {
        return Ok(());
    }
    let allowed = if file.is_file() {
        "the name of a new file, or --force"
    } else {
        "the name of a new file"
    };
    Err(Failure::new(
        "writing a scene",
        format!("{}: it exists already\n  allowed: {allowed}", file.display()),
        INPUT,
    ))
}

fn refuse_missing_folder(file: &Path) -> Result<(), Failure> {
    let folder = file.parent().filter(|folder| *folder != Path::new(""));
    let Some(folder) = folder.filter(|folder| !folder.is_dir()) else {
        return Ok(());
    };
    Err(Failure::new(
        "writing a scene",
        format!(
            "{}: there is no folder {}\n  allowed: a name in a folder that exists",
            file.display(),
            folder.display()
        ),
        INPUT,
    ))
}

fn unknown(like: &Path) -> Failure {
    let nearest =
        shipped::suggestion(like).map_or_else(String::new, |name| format!("\n  nearest: {name}"));
    Failure::new(
        "copying a scene",
        format!(
            "there is no shipped scene of this name\n  found:   {}\n  allowed: a name of `lennard list scenes`{nearest}",
            like.display()
        ),
        INPUT,
    )
}

/// The text of a shipped scene as the text of `file`: its commands name the copy. The base of a sweep has its
/// shipped name.
fn copy_of(scene: &Shipped, file: &Path) -> String {
    let last = scene.name.rsplit('/').next().unwrap_or(scene.name);
    let own = file.file_stem().map(Path::new).unwrap_or(file);
    let lock = file.with_extension("lock.toml");
    let mut text = scene.text.to_owned();
    for (shipped, copy) in [
        (format!("inputs/{}.toml", scene.name), path_in_shell(file)),
        (format!("inputs/{}.lock.toml", scene.name), path_in_shell(&lock)),
        (format!("runs/{last}"), path_in_shell(&Path::new("runs").join(own))),
    ] {
        text = with_path(&text, &shipped, &copy);
    }
    if scene.name == TEMPLATE {
        text = text.replace("# `lennard new NAME` writes a copy. Every", "# Every");
    }
    text.split_inclusive('\n').map(|line| with_base(scene, line)).collect()
}

/// The text with another path in the place of one, where the path ends there: `runs/a` stands in `runs/a/b`, and not in `runs/ab`.
fn with_path(text: &str, old: &str, new: &str) -> String {
    let mut parts = text.split(old);
    let mut copy = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let goes_on = part.starts_with(|c: char| c.is_alphanumeric() || "-_".contains(c));
        copy += if goes_on { old } else { new };
        copy += part;
    }
    copy
}

/// A line, with the base of a sweep by its shipped name.
fn with_base(scene: &Shipped, line: &str) -> String {
    let base = line.strip_prefix("base = \"").and_then(|rest| rest.split_once('"')).and_then(
        |(path, rest)| {
            let joined = Path::new(scene.name).parent()?.join(path);
            Some((shipped::find(&joined)?, rest))
        },
    );
    match base {
        Some((base, rest)) => format!("base = \"{}\"{rest}", base.name),
        None => line.to_owned(),
    }
}
