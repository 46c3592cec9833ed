//! Tests of studies from outside.

mod mechanics;
mod stability;

use std::path::Path;

use lennard_studies::Study;
use lennard_studies::claims::ClaimsStudy;

/// Writes a study whose command has `--out "<dir>"`, and wants a page that stands alone, with more figures and tables than these.
pub(crate) fn whole_folder(study: &ClaimsStudy, dir: &Path, more_than: [usize; 2]) -> String {
    study.write(dir).expect("everything is written");
    let text = |name: &str| std::fs::read_to_string(dir.join(name)).expect(name);
    let html = text("report.html");
    for outside in ["src=\"", "href=\"http", "NaN"] {
        assert!(!html.contains(outside), "{outside}");
    }
    assert!(html.contains("--out &quot;&lt;dir&gt;&quot;"));
    // Every figure file is on the page, and every CSV file has the same number of fields in each row.
    let mut figures = 0;
    for file in std::fs::read_dir(dir.join("figures")).expect("figures") {
        let svg = std::fs::read_to_string(file.expect("entry").path()).expect("svg");
        assert!(svg.starts_with("<svg ") && svg.trim_end().ends_with("</svg>"));
        // On the page, figures of a row may share one legend: their texts differ from their files.
        let title = svg.lines().nth(1).expect("a title");
        assert!(title.starts_with("<title>") && html.contains(title), "{title}");
        figures += 1;
    }
    assert!(figures > more_than[0], "{figures}");
    let mut tables = 0;
    for file in std::fs::read_dir(dir).expect("folder") {
        let path = file.expect("entry").path();
        if path.extension().is_some_and(|e| e == "csv") {
            let mut reader =
                csv::ReaderBuilder::new().comment(Some(b'#')).from_path(&path).expect("opens");
            let mut rows = 0;
            for row in reader.records() {
                row.expect("as many fields as headings");
                rows += 1;
            }
            assert!(rows > 0, "{}", path.display());
            tables += 1;
        }
    }
    assert!(tables >= more_than[1], "{tables}");
    let json: serde_json::Value = serde_json::from_str(&text("study.json")).expect("JSON");
    assert_eq!(json["claims"].as_array().map(Vec::len), Some(study.claims.len()));
    // Written again, the same bytes.
    study.write(dir).expect("written over");
    assert_eq!(text("report.html"), html);
    html
}
