use super::*;

fn found(files: &[(&str, &str)]) -> Vec<Vec<String>> {
    let files: Vec<(Module, String)> = files
        .iter()
        .map(|(module, text)| {
            let module = module.split('/').filter(|part| !part.is_empty());
            (module.map(str::to_owned).collect(), (*text).to_owned())
        })
        .collect();
    let circles = circles(&files).unwrap();
    let names = |circle: Vec<Module>| circle.iter().map(|m| m.join("/")).collect();
    circles.into_iter().map(names).collect()
}

#[test]
fn files_that_need_each_other_are_found_by_any_kind_of_path() {
    for (a, b) in [
        ("use crate::b::B;", "use crate::a::A;"),
        ("use super::b::{self, B as C};", "fn f() { super::a::g() }"),
        ("use crate::{c::X, b::{B, D}};", "struct S(crate::a::A);"),
        ("use super::b::*;", "mod inside { use super::super::a::A; }"),
    ] {
        let files = [("", "mod a; mod b; mod c;"), ("a", a), ("b", b), ("c", "")];
        assert_eq!(found(&files), [["a", "b"]], "{a} {b}");
    }
}

#[test]
fn a_path_to_a_re_export_leads_to_the_file_that_defines_the_item() {
    let facade = "mod x; mod y; pub use x::X; pub(crate) use y::Y as Z;";
    // `x` needs `y` through the facade, and `y` needs nothing.
    let files =
        [("", "mod d;"), ("d", facade), ("d/x", "use super::Z;"), ("d/y", "use std::fmt::Debug;")];
    assert!(found(&files).is_empty());
    // An item of the facade makes a circle where the facade uses the child, and not where it only shows it.
    let with = |more: &str| format!("{facade} pub struct Own; {more}");
    let circles = |facade: &str| found(&[("d", facade), ("d/x", "use super::Own;"), ("d/y", "")]);
    assert!(circles(&with("")).is_empty());
    assert_eq!(circles(&with("fn f() { x::g() }")), [["d", "d/x"]]);
}

#[test]
fn tests_and_other_crates_make_no_circle() {
    let files = [
        ("a", "use crate::b::B; use std::b::X;"),
        ("b", "use serde::a::A; #[cfg(test)] mod tests { use crate::a::A; }"),
    ];
    assert!(found(&files).is_empty());
    let files = [("", "mod a; pub use glam::DVec3; pub use a::A;"), ("a", "use crate::DVec3;")];
    assert!(found(&files).is_empty());
}

#[test]
fn a_circle_is_excused_as_a_set_so_that_a_new_file_in_it_is_a_fault() {
    let explained = |files: &[&str]| {
        is_explained("forcefield", &files.iter().map(|f| (*f).to_owned()).collect::<Vec<_>>())
    };
    assert!(explained(&["walls", "walls/hard", "walls/a_new_kind"]));
    assert!(!explained(&["error", "walls", "walls/hard"]));
    assert!(!explained(&["walls", "walls/hard/inside"]));
    assert!(!is_explained("observables", &["walls".to_owned(), "walls/hard".to_owned()]));
}
