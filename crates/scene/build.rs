//! Puts the scenes of `inputs/` into the program, each with its name.

use std::env;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

fn main() {
    // A link to the folder of the repository, so that a package of this crate has the scenes.
    let package = env::var_os("CARGO_MANIFEST_DIR").expect("cargo sets it");
    let inputs = Path::new(&package).join("inputs");
    let mut files = Vec::new();
    collect(&inputs, &mut files);
    files.sort();
    let mut list = String::from("&[\n");
    for file in files {
        let name = file.strip_prefix(&inputs).expect("a file of inputs/");
        let name = name.with_extension("");
        let name = name.to_string_lossy().replace('\\', "/");
        let file = file.canonicalize().expect("a file that was listed");
        let _ = writeln!(
            list,
            "Shipped {{ name: {name:?}, text: include_str!({:?}) }},",
            file.display().to_string()
        );
    }
    list.push(']');
    let out = env::var_os("OUT_DIR").expect("cargo sets it");
    fs::write(Path::new(&out).join("shipped.rs"), list).expect("a file in OUT_DIR");
}

/// Every scene and every sweep that stands alone, in this folder and below.
fn collect(folder: &Path, files: &mut Vec<PathBuf>) {
    println!("cargo::rerun-if-changed={}", folder.display());
    for entry in fs::read_dir(folder).expect("a folder of inputs/") {
        let path = entry.expect("an entry of inputs/").path();
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        if path.is_dir() {
            collect(&path, files);
        } else if name == "bad.toml" {
            // Scenes that are refused teach the tests alone.
        } else if name.ends_with(".toml") && !name.ends_with(".lock.toml") {
            println!("cargo::rerun-if-changed={}", path.display());
            let text = fs::read_to_string(&path).expect("a scene is text");
            // A start configuration or a table is a second file, which the program does not hold.
            let names_a_file =
                |line: &str| line.starts_with("configuration") || line.starts_with("file = ");
            if !text.lines().any(names_a_file) {
                files.push(path);
            }
        }
    }
}
