//! What a reader sees: no number that is not finite, none with more digits than it is worth, and one name for one number.

use lennard_core::number::{significant, with_error};
use serde_json::Value;

use crate::program::common::*;

const SCENE: &str = r#"
system = { n_atoms = 108, density = 0.6, temperature = 1.3, seed = 3 }
integrator = { dt = 0.004 }
stage = [
    { name = "melt", steps = 50, thermostat = { kind = "bussi", tau = 0.1 } },
    { name = "production", steps = 20, thermostat = { kind = "bussi", tau = 0.5 } },
]
observable = [
    { kind = "rdf" },
    { kind = "msd", viscosity = 2.1174670663845836 },
    { kind = "vacf" },
    { kind = "structure-factor" },
]
"#;

/// The words of a text that are not finite, or that have ten decimals or more.
fn bad_numbers(text: &str) -> Vec<&str> {
    let is_part = |c: char| c.is_alphanumeric() || c == '.' || c == '∞';
    let is_bad = |word: &&str| {
        let decimals = word.rsplit_once('.').map_or("", |(_, after)| after);
        let digits = decimals.chars().take_while(char::is_ascii_digit).count();
        digits > 9 || word.contains('∞') || ["nan", "inf"].contains(&&*word.to_lowercase())
    };
    text.split(|c| !is_part(c)).filter(is_bad).collect()
}

/// The words of a page, without markup, style and script.
pub fn words_of(page: &str) -> String {
    let mut words = String::new();
    let mut rest = page;
    while let Some((before, tag)) = rest.split_once('<') {
        words += before;
        words.push(' ');
        let end = ["style", "script"]
            .into_iter()
            .find(|name| tag.starts_with(name))
            .map_or(">".to_owned(), |name| format!("</{name}>"));
        rest = tag.split_once(&end).map_or("", |(_, after)| after);
    }
    words + rest
}

/// Every text in a document.
fn texts(value: &Value) -> Vec<&str> {
    match value {
        Value::String(text) => vec![text],
        Value::Array(all) => all.iter().flat_map(texts).collect(),
        Value::Object(all) => all.values().flat_map(texts).collect(),
        _ => Vec::new(),
    }
}

#[test]
fn a_production_of_few_steps_is_too_short_and_says_so_without_an_error() {
    let place = Place::with(&[("scene.toml", SCENE)]);
    for steps in [1, 5, 10, 20, 30] {
        let set = format!("--set stage.production.steps={steps}");
        let ran = place.output(&format!("run scene.toml {set} --out {steps}"));
        let said = stdout(&ran) + &ended(&ran, 0, &[]);
        contains(&said, &["The run is too short: "]);
        let compared = place.succeed(&format!("compare {steps} --verbose"));
        let page = words_of(&place.read(&format!("{steps}/report.html")));
        let mut record = place.record(&steps.to_string());
        // The scene in the record is read by programs, and has every digit.
        record["scene"].take();
        let shown = [&*said, &compared, &page];
        for text in shown.into_iter().chain(texts(&record)) {
            assert_eq!(bad_numbers(text), Vec::<&str>::new(), "{steps}: {text}");
        }
        for (name, average) in record["averages"].as_object().unwrap() {
            assert_eq!(average["standing"], "too-short", "{steps}: {name}");
            assert!(average["standard_error"].is_null(), "{steps}: {name}");
        }
    }
}

/// The diffusion coefficient of the slope as it is.
const PLAIN: &str = "diffusion_coefficient_uncorrected";

#[test]
fn the_figure_of_the_displacement_has_its_fit_and_says_which_d_is_corrected() {
    let place = Place::with(&[("scene.toml", SCENE)]);
    // Two estimates of D are made within seconds.
    place.succeed(
        "run scene.toml --out out --set system.density=0.8 --set stage.melt.steps=1000 \
         --set stage.production.steps=8000 --set observable.msd.viscosity=2.0",
    );
    let record = place.record("out");
    let mean = |name: &str| number(&record["averages"][name]["mean"]);
    let page = place.read("out/report.html");
    let caption = |name: &str| {
        let start = page.find(name).unwrap();
        let from = page[start..].find("<figcaption>").unwrap() + start;
        page[from..].split("</figcaption>").next().unwrap().to_owned()
    };
    let msd = caption("<title>Mean-square displacement</title>");
    // The line in the figure is the line whose slope is told.
    let table = place.read("out/msd.csv");
    let mut rows = table.lines().filter(|line| !line.starts_with('#'));
    let names: Vec<&str> = rows.next().unwrap().split(',').collect();
    let column = |of: &str| names.iter().position(|name| *name == of).unwrap();
    let (time, fit) = (column("time"), column("fit"));
    let line: Vec<(f64, f64)> = rows
        .map(|row| row.split(',').map(|x| x.parse::<f64>().unwrap()).collect::<Vec<_>>())
        .map(|row| (row[time], row[fit]))
        .filter(|(_, y)| y.is_finite())
        .collect();
    let (first, last) = (line[0], line[line.len() - 1]);
    let slope = (last.1 - first.1) / (last.0 - first.0);
    let plain = mean(PLAIN);
    assert!((slope / 6.0 / plain - 1.0).abs() < 1e-9, "{slope} {plain}");
    let told = |name: &str| {
        let average = &record["averages"][name];
        match average["standard_error"].as_f64() {
            Some(error) => with_error(mean(name), error),
            None => format!("{} (no result: ", significant(mean(name), 4)),
        }
    };
    let corrected = told("diffusion_coefficient_corrected");
    let words = [
        &*format!("fitted from {}", significant(first.0, 3)),
        &format!("A sixth of its slope: D = {}", told(PLAIN)),
        &format!("Corrected for finite size (Yeh and Hummer): D = {corrected}"),
    ];
    contains(&msd, &words);
    // The other route stands on the same footing.
    let integral = told("diffusion_coefficient_green_kubo");
    let words = [
        &*format!("A third of its integral: D = {integral}"),
        &format!("the slope of the displacement gives {}", told(PLAIN)),
        "Neither is corrected",
    ];
    contains(&caption("<title>Velocity autocorrelation</title>"), &words);
}

#[test]
fn every_document_names_its_schema_by_one_rule() {
    let place = Place::with(&[("scene.toml", SCENE)]);
    for line in [
        "run scene.toml --out out",
        "version",
        "plan scene.toml",
        "energy scene.toml",
        "compare out",
        "generate lammps scene.toml out-lammps",
        "eos --temperature 2 --density 0.5",
        "eos thol-2016 --saturation",
        "eos thol-2016 --freezing",
        "list",
        "list scenes",
    ] {
        let document = place.json(line);
        let schema = document["schema"].as_str().unwrap_or_default();
        let rest = schema.strip_prefix("lennard-").and_then(|s| s.split_once('/'));
        let (name, version) = rest.unwrap_or_else(|| panic!("{line}: {schema:?}"));
        assert!(line.split(' ').take(2).any(|word| word == name), "{schema}");
        assert!(version.parse::<u32>().is_ok(), "{schema}");
    }
}

#[test]
fn a_point_of_a_sweep_that_is_no_result_has_an_open_mark_and_a_word_in_the_caption() {
    let sweep = "base = \"scene.toml\"\n[grid]\ndensity = [0.5, 0.6, 0.7]\n";
    let place = Place::with(&[("scene.toml", SCENE), ("sweep.toml", sweep)]);
    place.succeed("sweep sweep.toml --out out");
    let page = place.read("out/report.html");
    let drawn = |svg: &str| {
        let marks =
            svg.lines().filter(|line| line.starts_with("<circle") && !line.contains("hint"));
        marks.filter(|mark| mark.contains("#787878") && mark.contains("fill=\"none\"")).count()
    };
    // Three marks, and none of them filled; the legend shows the mark of a result.
    let pressure = place.read("out/pressure.svg");
    assert_eq!(drawn(&pressure), 3, "{pressure}");
    let figures = page.matches("Bars are one standard error").count();
    let said = page.matches("Open grey marks have no known error: they are no results.").count();
    assert!(figures > 1 && said == figures, "{said} of {figures}");
}

#[test]
fn quantities_of_a_page_have_words_and_those_of_a_file_have_keys() {
    let sweep = "base = \"scene.toml\"\n[grid]\ndensity = [0.2, 0.3, 0.4]\n[set]\nstage.production.steps = 30000\nsystem.temperature = 2\n";
    let place = Place::with(&[("scene.toml", SCENE), ("sweep.toml", sweep)]);
    place.succeed("sweep sweep.toml --out out");
    let file = place.read("out/equations.csv");
    let keys = file.lines().skip(1).filter_map(|row| row.split(',').next());
    let keys: Vec<&str> = keys.filter(|key| key.contains('_')).collect();
    let page = words_of(&place.read("out/report.html"));
    assert!(keys.contains(&"isentropic_compressibility"), "{file}");
    for key in keys {
        assert!(!page.contains(key), "{key}");
    }
}

#[test]
fn a_length_that_the_program_computes_has_no_more_digits_than_it_is_worth() {
    // 0.8 of a cutoff of 3 σ is 2.4000000000000004 in binary.
    let switched = "--set truncation.kind=switch --set truncation.r_cut=3 --set system.density=0.3";
    let place = Place::with(&[("scene.toml", SCENE)]);
    let dt = "--set integrator.dt=0.0046188021535170061";
    let said = place.succeed(&format!("plan scene.toml {switched} {dt}"));
    contains(&said, &["switched off from 2.4 to 3 σ"]);
    assert_eq!(bad_numbers(&said), Vec::<&str>::new(), "{said}");
}
