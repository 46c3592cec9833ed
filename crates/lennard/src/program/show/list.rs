//! Lists of methods and scenes.

use lennard_observables::Table;
use lennard_studies::report::Section;

use crate::program::list_entry::Entry;

/// Names with what they are, one after the other.
pub fn list(entries: &[Entry]) -> Section {
    let table = Table::rows_of("list", entries)
        .column("", |e| e.name.as_str())
        .column("", |e| e.summary.as_str());
    Section::new("").table(table.table())
}

/// Everything that is known of an entry.
pub fn entry(entry: &Entry) -> Section {
    let properties = entry.properties.iter().map(|(name, value)| {
        let shown = match value {
            serde_json::Value::Bool(b) => if *b { "yes" } else { "no" }.to_owned(),
            serde_json::Value::Null => "–".to_owned(),
            serde_json::Value::String(s) => s.clone(),
            other => other.to_string(),
        };
        format!("{name}: {shown}")
    });
    Section::new(&entry.name)
        .text(&entry.summary)
        .texts(&entry.equation)
        .texts(properties)
        .text(format!("source: {}", entry.source))
}
