//! Lists of methods and scenes.

use comfy_table::{ColumnConstraint, ContentArrangement, Width};

use super::WIDTH;
use crate::program::list_entry::Entry;
use crate::program::out;

/// Names with what they are, one after the other.
pub fn list(entries: &[Entry]) {
    let mut shown = comfy_table::Table::new();
    shown
        .load_style(comfy_table::presets::NOTHING)
        .set_content_arrangement(ContentArrangement::Dynamic)
        .set_width(WIDTH);
    for entry in entries {
        shown.add_row([&entry.name, &entry.summary]);
    }
    // Names stay whole: they are typed again.
    let longest = entries.iter().map(|e| e.name.chars().count()).max();
    let width = Width::Fixed(u16::try_from(longest.unwrap_or(0) + 2).unwrap_or(WIDTH / 2));
    if let Some(names) = shown.column_mut(0) {
        names.set_constraint(ColumnConstraint::Absolute(width));
    }
    for line in shown.to_string().lines() {
        println!("{}", line.trim_end());
    }
}

/// Everything that is known of each entry.
pub fn entries(entries: &[Entry]) {
    for entry in entries {
        out::heading(&entry.name);
        println!("  {}", entry.summary);
        if let Some(equation) = &entry.equation {
            println!("  {equation}");
        }
        for (name, value) in &entry.properties {
            let shown = match value {
                serde_json::Value::Bool(b) => if *b { "yes" } else { "no" }.to_owned(),
                serde_json::Value::Null => "–".to_owned(),
                serde_json::Value::String(s) => s.clone(),
                other => other.to_string(),
            };
            println!("  {name}: {shown}");
        }
        println!("  source: {}", entry.source);
    }
}
