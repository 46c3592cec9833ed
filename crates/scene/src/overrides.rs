//! Values given beside the file, as `--set stage.production.steps=1000`.

use std::sync::Arc;

use crate::error::{Place, SceneError};
use crate::names::nearest;
use crate::tree::{self, Node, Table, Value};

/// Writes the overrides over what the file says, in their order.
pub(crate) fn apply(
    root: &mut Table,
    overrides: &[(String, String)],
    file: &str,
) -> Result<(), SceneError> {
    for (key, value) in overrides {
        let place = Place::Override(Arc::from(format!("{key}={value}")));
        let at = At { file, place: &place };
        let node = tree::parse_value(value, &place).map_err(|(found, allowed)| {
            at.error("holds a number that cannot be read").key(key).found(found).allowed(allowed)
        })?;
        let steps: Vec<&str> = key.split('.').map(str::trim).collect();
        if steps.iter().any(|step| step.is_empty()) {
            return Err(at
                .error("has an empty part")
                .key(key)
                .found(format!("{key:?}"))
                .allowed("names joined by dots, as `system.n_atoms` or `stage.0.steps`"));
        }
        if let Some(other) = rival(key)
            && let Some(Value::Table(system)) = root.get_mut("system").map(|n| &mut n.value)
        {
            system.remove(other);
        }
        set(root, &steps, node, &at, String::new())?;
    }
    Ok(())
}

/// `density` and `box` say the same thing twice: giving one beside the file drops the other.
fn rival(key: &str) -> Option<&'static str> {
    match key {
        "system.density" => Some("box"),
        "system.box" => Some("density"),
        _ => None,
    }
}

struct At<'a> {
    file: &'a str,
    place: &'a Place,
}

impl At<'_> {
    fn error(&self, message: impl Into<String>) -> SceneError {
        SceneError::new(self.file, message).at(Some(self.place.clone()))
    }
}

fn set(
    table: &mut Table,
    steps: &[&str],
    value: Node,
    at: &At<'_>,
    prefix: String,
) -> Result<(), SceneError> {
    let (first, rest) = (steps[0], &steps[1..]);
    let name = join(&prefix, first);
    if rest.is_empty() {
        table.set(first, value);
        return Ok(());
    }
    if table.get(first).is_none() {
        table.set(first, Node { value: Value::Table(Table::default()), place: at.place.clone() });
    }
    let Some(inner) = table.get_mut(first) else {
        return Ok(());
    };
    match &mut inner.value {
        Value::Table(inner) => set(inner, rest, value, at, name),
        Value::Array(items) => {
            let which = pick(items, rest[0], at, &name)?;
            let name = join(&name, &which.to_string());
            match (&mut items[which].value, &rest[1..]) {
                (_, []) => {
                    items[which] = value;
                    Ok(())
                }
                (Value::Table(inner), rest) => set(inner, rest, value, at, name),
                (_, _) => Err(not_a_table(&items[which], at, &name)),
            }
        }
        _ => Err(not_a_table(inner, at, &name)),
    }
}

fn join(prefix: &str, name: &str) -> String {
    match prefix {
        "" => name.to_owned(),
        prefix => format!("{prefix}.{name}"),
    }
}

fn not_a_table(node: &Node, at: &At<'_>, name: &str) -> SceneError {
    at.error("holds a value, not a table").key(name).found(node).allowed("a key that ends here")
}

/// The member of an array of tables that is meant: by its index, or by its `name` or `kind`.
fn pick(items: &[Node], which: &str, at: &At<'_>, array: &str) -> Result<usize, SceneError> {
    let names: Vec<&str> = items.iter().filter_map(label).collect();
    let found = match which.parse::<usize>() {
        Ok(index) => (index < items.len()).then_some(index),
        Err(_) => items.iter().position(|item| label(item) == Some(which)),
    };
    found.ok_or_else(|| {
        let last = items.len().saturating_sub(1);
        let by_name = match names.as_slice() {
            [] => String::new(),
            names => format!(", or {}", names.join(", ")),
        };
        at.error("names no such entry")
            .key(join(array, which))
            .found(format!("{which:?}"))
            .allowed(format!("an index from 0 to {last}{by_name}"))
            .suggestion(nearest(which, names.iter().copied()))
    })
}

fn label(node: &Node) -> Option<&str> {
    let table = node.table()?;
    let name = table.get("name").or_else(|| table.get("kind"))?;
    name.text()
}
