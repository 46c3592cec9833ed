//! Two output folders, byte by byte.

use std::collections::BTreeSet;
use std::error::Error;
use std::fs;
use std::path::Path;

use serde_json::Value;

/// Entries of `run.json` that may differ: wall time, performance and the machine.
const MAY_DIFFER: [&str; 3] = ["wall_s", "performance", "host"];

/// The page of a run shows wall times and the machine, too: it has to be there, its bytes may differ.
const PAGE: &str = "report.html";

/// Fails where a file is missing, too much, or different. Checkpoints hold wall times: their names must be
/// the same, their bytes need not.
pub fn folders(whole: &Path, disturbed: &Path) -> Result<(), Box<dyn Error>> {
    let (wanted, found) = (names(whole)?, names(disturbed)?);
    // How many there are depends on the clock where the scene says so: the last one has to be there.
    let checkpoint = |name: &&String| name.ends_with(".lennard");
    let others = |names: &BTreeSet<String>| -> BTreeSet<String> {
        names.iter().filter(|n| !checkpoint(n)).cloned().collect()
    };
    if others(&wanted) != others(&found) {
        return Err(format!("files {found:?}, wanted {wanted:?}").into());
    }
    if wanted.iter().rfind(checkpoint) != found.iter().rfind(checkpoint) {
        return Err("the last checkpoints differ in their step".into());
    }
    for name in others(&wanted) {
        let read = |folder: &Path| fs::read(folder.join(&name));
        let (a, b) = (read(whole)?, read(disturbed)?);
        let same = match name.as_str() {
            "run.json" => record(&a)? == record(&b)?,
            PAGE => !a.is_empty() && !b.is_empty(),
            _ => a == b,
        };
        if !same {
            let at = a.iter().zip(&b).take_while(|(x, y)| x == y).count();
            return Err(format!(
                "{name} differs at byte {at} ({} bytes, wanted {})",
                b.len(),
                a.len()
            )
            .into());
        }
    }
    Ok(())
}

fn names(folder: &Path) -> Result<BTreeSet<String>, Box<dyn Error>> {
    let mut names = BTreeSet::new();
    for entry in fs::read_dir(folder)? {
        names.insert(entry?.file_name().to_string_lossy().into_owned());
    }
    Ok(names)
}

fn record(bytes: &[u8]) -> Result<Value, Box<dyn Error>> {
    let mut value: Value = serde_json::from_slice(bytes)?;
    if let Some(entries) = value.as_object_mut() {
        for key in MAY_DIFFER {
            entries.remove(key);
        }
    }
    Ok(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_changed_byte_is_seen_and_the_wall_time_is_not() {
        let root = std::env::temp_dir().join(format!("soak-compare-{}", std::process::id()));
        let (a, b) = (root.join("a"), root.join("b"));
        for (folder, wall) in [(&a, 1), (&b, 2)] {
            fs::create_dir_all(folder).unwrap();
            let text = format!("{{\"steps\": 5, \"wall_s\": {wall}, \"host\": {{}}}}");
            fs::write(folder.join("run.json"), text).unwrap();
            fs::write(folder.join("thermo.csv"), "step\n1\n").unwrap();
            fs::write(folder.join("checkpoint-5.lennard"), wall.to_string()).unwrap();
        }
        folders(&a, &b).unwrap();
        fs::write(b.join("thermo.csv"), "step\n2\n").unwrap();
        let text = folders(&a, &b).unwrap_err().to_string();
        assert!(text.contains("thermo.csv differs at byte 5"), "{text}");
        fs::write(b.join("thermo.csv"), "step\n1\n").unwrap();
        fs::write(b.join("run.json"), "{\"steps\": 4}").unwrap();
        assert!(folders(&a, &b).is_err());
        fs::remove_file(b.join("run.json")).unwrap();
        assert!(folders(&a, &b).is_err());
        fs::remove_dir_all(root).unwrap();
    }
}
