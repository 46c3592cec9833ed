use super::*;
use crate::claim::CLAIM_FILE;

#[test]
fn the_first_free_number_is_taken() {
    let root = tempfile::tempdir().unwrap();
    let runs = root.path().join("runs");
    for n in [1, 2, 3] {
        let made = create_numbered_folder(&runs, "gas").unwrap();
        assert_eq!(made.path(), runs.join(format!("gas-{n}")));
        fs::write(made.path().join("run.json"), "{}").unwrap();
    }
    fs::remove_dir_all(runs.join("gas-2")).unwrap();
    let made = create_numbered_folder(&runs, "gas").unwrap();
    assert_eq!(made.path(), runs.join("gas-2"));
}

/// The names in a folder, in order.
fn names_in(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap();
    let mut names: Vec<String> =
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

#[test]
fn force_removes_the_files_of_the_old_run_and_nothing_else() {
    let root = tempfile::tempdir().unwrap();
    let record = r#"{"tables": ["rdf.csv", "../x.csv"]}"#;
    fs::write(root.path().join("run.json"), record).unwrap();
    let of_run = [
        "rdf.csv",
        ".rdf.csv.partial",
        "thermo.csv",
        "trajectory.xtc",
        "checkpoint-000000000100.lennard",
    ];
    let others = ["checkpoint-x.lennard", "data.csv", "movie.xyz", "notes.txt", "vacf.csv"];
    for name in of_run.iter().chain(&others) {
        fs::write(root.path().join(name), "x").unwrap();
    }
    drop(create_named_folder(root.path(), Existing::Replace).unwrap());
    assert_eq!(names_in(root.path()), others);
}

/// Proves that a process which a signal ends leaves nothing: neither what was there nor what comes after.
#[test]
fn an_abandoned_folder_has_no_file_of_the_run_and_gets_none() {
    let root = tempfile::tempdir().unwrap();
    let path = root.path().join("out");
    let held = create_named_folder(&path, Existing::Refuse).unwrap();
    crate::write_text_atomically(&path.join("scene.toml"), "x").unwrap();
    fs::write(path.join(".thermo.csv.partial"), "x").unwrap();
    held.abandon();
    let late = crate::write_text_atomically(&path.join("run.json"), "x").unwrap_err();
    assert!(late.to_string().contains("the run was given up"), "{late}");
    assert!(!path.exists());
    // What stood there before stays.
    fs::create_dir(root.path().join("own")).unwrap();
    fs::write(root.path().join("own/final.xyz"), "mine").unwrap();
    let held = create_named_folder(&root.path().join("own"), Existing::Replace).unwrap();
    crate::write_text_atomically(&held.path().join("scene.toml"), "x").unwrap();
    held.abandon();
    assert_eq!(names_in(held.path()), ["final.xyz"]);
}

#[test]
fn a_folder_is_held_until_it_is_dropped_and_the_process_is_named() {
    let root = tempfile::tempdir().unwrap();
    let path = root.path().join("out");
    let held = create_named_folder(&path, Existing::Refuse).unwrap();
    fs::write(path.join("run.json"), "{}").unwrap();
    fs::write(path.join("rdf.csv"), "x").unwrap();
    for existing in [Existing::Refuse, Existing::Replace, Existing::Keep] {
        let error = create_named_folder(&path, existing).unwrap_err();
        let wanted = format!("process {} is at work there", std::process::id());
        assert!(error.to_string().contains(&wanted), "{error}");
        assert!(path.join("rdf.csv").exists(), "nothing is removed");
    }
    drop(held);
    assert!(!path.join(CLAIM_FILE).exists(), "no trace is left");
    create_named_folder(&path, Existing::Keep).unwrap();
    assert!(path.join("rdf.csv").exists(), "it was to be kept");
}

#[test]
fn the_claim_of_a_process_that_is_gone_blocks_nothing() {
    let root = tempfile::tempdir().unwrap();
    fs::write(root.path().join(CLAIM_FILE), "1\n\n\n").unwrap();
    let held = create_named_folder(root.path(), Existing::Refuse).unwrap();
    assert!(is_empty_folder(held.path()));
}

#[test]
fn the_claim_of_another_machine_holds_until_it_is_no_longer_renewed() {
    let root = tempfile::tempdir().unwrap();
    let claim = root.path().join(CLAIM_FILE);
    fs::write(&claim, "17\nnode-7\nanother-start\n").unwrap();
    let error = create_named_folder(root.path(), Existing::Keep).unwrap_err();
    let wanted = "is in use: process 17 on node-7 is at work there";
    assert!(error.to_string().contains(wanted), "{error}");
    assert_eq!(fs::read_dir(root.path()).unwrap().count(), 1, "no trace is left");
    let long_ago = std::time::SystemTime::now() - std::time::Duration::from_secs(301);
    fs::File::options().write(true).open(&claim).unwrap().set_modified(long_ago).unwrap();
    let held = create_named_folder(root.path(), Existing::Keep).unwrap();
    held.still_held().unwrap();
    assert!(fs::read_to_string(&claim).unwrap().starts_with(&std::process::id().to_string()));
    drop(held);
    assert_eq!(fs::read_dir(root.path()).unwrap().count(), 0);
}

#[test]
fn of_many_threads_that_find_a_dead_claim_one_takes_the_folder() {
    for _ in 0..50 {
        let root = tempfile::tempdir().unwrap();
        fs::write(root.path().join(CLAIM_FILE), "1\n\n\n").unwrap();
        let taken: Vec<_> = std::thread::scope(|scope| {
            let tries: Vec<_> = (0..8)
                .map(|_| scope.spawn(|| create_named_folder(root.path(), Existing::Keep).ok()))
                .collect();
            tries.into_iter().filter_map(|t| t.join().unwrap()).collect()
        });
        assert_eq!(taken.len(), 1);
        taken[0].still_held().unwrap();
    }
}

#[test]
fn folders_that_were_made_and_never_written_to_are_removed_and_no_others() {
    let root = tempfile::tempdir().unwrap();
    let deep = root.path().join("a/b/c");
    drop(create_named_folder(&deep, Existing::Refuse).unwrap());
    assert!(!root.path().join("a").exists());
    fs::create_dir_all(&deep).unwrap();
    drop(create_named_folder(&deep, Existing::Refuse).unwrap());
    assert!(deep.exists(), "it was there before");
    let runs = root.path().join("runs");
    drop(create_numbered_folder(&runs, "gas").unwrap());
    assert!(!runs.exists());
    let kept = create_named_folder(&root.path().join("d/e"), Existing::Refuse).unwrap();
    fs::write(kept.path().join("notes.txt"), "x").unwrap();
    drop(kept);
    assert!(root.path().join("d/e/notes.txt").exists());
}
