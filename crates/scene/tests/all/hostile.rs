//! No text makes the reader panic, and what it accepts it can write out and read again.

use lennard_scene::Scene;
use proptest::prelude::*;

const EVERYTHING: &str = include_str!("../../../../inputs/fluid/everything.toml");

/// Reads a text; an accepted scene must survive being written out.
fn read(text: &str, overrides: &[(String, String)]) {
    match Scene::parse(text, "hostile.toml", overrides) {
        Ok(scene) => {
            let resolved = scene.resolved_toml();
            let again = Scene::parse(&resolved, "resolved.toml", &[]);
            assert_eq!(again.as_ref(), Ok(&scene), "{resolved}");
        }
        Err(error) => assert!(error.to_string().starts_with("hostile.toml")),
    }
}

/// Pieces that scenes are made of, and some that they should not be.
fn value() -> impl Strategy<Value = String> {
    prop_oneof![
        any::<f64>().prop_map(|x| format!("{x:?}")),
        any::<i64>().prop_map(|x| x.to_string()),
        (0.0..20.0).prop_map(|x: f64| x.to_string()),
        (0_u32..5000).prop_map(|x| x.to_string()),
        "[a-z-]{0,12}".prop_map(|word| format!("\"{word}\"")),
        Just("true".to_owned()),
        Just("[1.0, 2.0, 3.0]".to_owned()),
        Just("[[1.0], []]".to_owned()),
        Just("{ kind = \"bussi\", tau = 1 }".to_owned()),
        Just("\"random\"".to_owned()),
        Just("\"respa\"".to_owned()),
        Just("1979-05-27".to_owned()),
        ".{0,8}",
    ]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_text_gives_a_scene_or_an_error(text in "(\\PC|[\\[\\]=\"{}.,#\n0-9a-z_-]){0,200}") {
        read(&text, &[]);
    }

    #[test]
    fn a_scene_with_some_bytes_changed_gives_a_scene_or_an_error(
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
        cut in prop::option::of(any::<prop::sample::Index>()),
    ) {
        let mut bytes = EVERYTHING.as_bytes().to_vec();
        for (at, byte) in changes {
            let at = at.index(bytes.len());
            bytes[at] = byte;
        }
        if let Some(cut) = cut {
            bytes.truncate(cut.index(bytes.len()));
        }
        read(&String::from_utf8_lossy(&bytes), &[]);
    }

    #[test]
    fn a_scene_with_some_values_changed_gives_a_scene_or_an_error(
        changes in prop::collection::vec((any::<prop::sample::Index>(), value()), 1..4),
    ) {
        let mut lines: Vec<String> = EVERYTHING.lines().map(str::to_owned).collect();
        for (at, value) in changes {
            let at = at.index(lines.len());
            if let Some((key, _)) = lines[at].clone().split_once(" = ") {
                lines[at] = format!("{key} = {value}");
            }
        }
        read(&lines.join("\n"), &[]);
    }

    #[test]
    fn any_override_gives_a_scene_or_an_error(
        key in "(system|stage|observable|integrator|output|[a-z]{0,3})(\\.(0|5|heat|rdf|kind|dt|seed|box|[a-z.]{0,6})){0,3}",
        value in value(),
    ) {
        read(EVERYTHING, &[(key, value)]);
    }
}
