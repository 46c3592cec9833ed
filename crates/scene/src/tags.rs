//! Tables that name their method, and entries that are taken out of a table.

use crate::tree::{Entry, Node, Value};

/// A table with a key that names its method, where it has none.
pub(crate) fn with_tag(node: &Node, key: &str, name: &str) -> Node {
    let mut node = node.clone();
    if let Value::Table(table) = &mut node.value
        && table.get(key).is_none()
    {
        let name = Node { value: Value::Text(name.to_owned()), place: node.place.clone() };
        table.set(key, name);
    }
    node
}

pub(crate) fn take(node: &mut Node, key: &str) -> Option<Entry> {
    match &mut node.value {
        Value::Table(table) => table.remove(key),
        _ => None,
    }
}
