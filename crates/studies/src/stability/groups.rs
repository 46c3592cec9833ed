//! Methods that are the same map on the oscillator stand together: one theory line, many marks.

use std::sync::LazyLock;

use lennard_core::IntegratorSpec;
use lennard_integrators::{IntegratorEntry, integrators};

use crate::StudyError;

/// Two maps whose entries differ by less are one; they are computed by different formulas.
const SAME: f64 = 1e-12;
/// Places at which maps are compared, as (ω, h).
const PROBES: [(f64, f64); 3] = [(0.7, 1.0), (1.9, 0.5), (10.0, 0.13)];

/// The method after whose family its group is called.
const FAMILY: &str = "velocity-verlet";

/// Methods with one map.
#[derive(Debug, Clone)]
pub(crate) struct Group {
    /// Name for legends.
    pub(crate) name: String,
    /// Its methods.
    pub(crate) members: Vec<&'static IntegratorEntry>,
}

impl Group {
    /// The method that is drawn where all members would lie on top of each other.
    pub(crate) fn representative(&self) -> &'static IntegratorEntry {
        let known = self.members.iter().find(|e| e.spec.name == FAMILY);
        known.copied().unwrap_or(self.members[0])
    }
}

fn same_map(a: &IntegratorSpec, b: &IntegratorSpec) -> bool {
    let (Some(a), Some(b)) = (a.oscillator_map, b.oscillator_map) else {
        return false;
    };
    PROBES.iter().all(|(omega, dt)| {
        let difference = a(*omega, *dt) - b(*omega, *dt);
        difference.to_cols_array().iter().all(|d| d.abs() < SAME)
    })
}

/// All integrators, grouped, in the order of the list.
pub(crate) fn groups() -> &'static [Group] {
    static GROUPS: LazyLock<Vec<Group>> = LazyLock::new(|| {
        let mut groups: Vec<Group> = Vec::new();
        for entry in integrators() {
            match groups.iter_mut().find(|g| same_map(g.members[0].spec, entry.spec)) {
                Some(group) => group.members.push(entry),
                None => groups.push(Group { name: String::new(), members: vec![entry] }),
            }
        }
        for group in &mut groups {
            let first = group.members[0].spec.name;
            group.name = match group.members.len() {
                1 => first.to_owned(),
                n if group.members.iter().any(|e| e.spec.name == FAMILY) => {
                    format!("Verlet family ({n})")
                }
                n => format!("{first} (+{})", n - 1),
            };
        }
        groups
    });
    &GROUPS
}

/// All methods, group by group.
pub(crate) fn methods() -> Vec<&'static IntegratorEntry> {
    groups().iter().flat_map(|group| group.members.iter().copied()).collect()
}

/// The group of a method, with its index.
pub(crate) fn group_of(method: &str) -> (usize, &'static Group) {
    let has = |group: &Group| group.members.iter().any(|e| e.spec.name == method);
    let index = groups().iter().position(has).unwrap_or_default();
    (index, &groups()[index])
}

/// Whether a method is drawn. Methods with one map on the oscillator run alike on the fluid up to rounding, and
/// the best known method stands for all.
pub(crate) fn stands_for_itself(method: &str) -> bool {
    group_of(method).1.representative().spec.name == method
}

/// A method by name.
pub(crate) fn entry(name: &'static str) -> Result<&'static IntegratorEntry, StudyError> {
    integrators().iter().find(|e| e.spec.name == name).ok_or(StudyError::NoSuchMethod(name))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_verlet_family_is_one_group_and_every_method_is_in_exactly_one() {
        let groups = groups();
        let all: Vec<&str> =
            groups.iter().flat_map(|g| g.members.iter().map(|e| e.spec.name)).collect();
        assert_eq!(all.len(), integrators().len());
        let family = groups
            .iter()
            .find(|g| g.members.iter().any(|e| e.spec.name == "velocity-verlet"))
            .unwrap();
        let members: Vec<&str> = family.members.iter().map(|e| e.spec.name).collect();
        for name in ["stormer-verlet", "leapfrog"] {
            assert!(members.contains(&name), "{name}");
        }
        assert!(!members.contains(&"symplectic-euler"));
    }
}
