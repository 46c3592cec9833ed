//! Groups of contacts that share bodies.

use lennard_core::Masses;

use super::rows::Contact;

/// The bodies of some contacts, ascending.
pub(super) fn bodies_of(contacts: &[Contact], group: &[usize]) -> Vec<usize> {
    let of = |c: &usize| [contacts[*c].first, Some(contacts[*c].second)];
    let mut bodies: Vec<usize> = group.iter().flat_map(of).flatten().collect();
    bodies.sort_unstable();
    bodies.dedup();
    bodies
}

/// The groups of contacts that share bodies that move, each in the order of its contacts, in the order of their first contacts.
#[must_use]
pub fn groups(contacts: &[Contact], masses: &Masses) -> Vec<Vec<usize>> {
    let all: Vec<usize> = (0..contacts.len()).collect();
    let bodies = bodies_of(contacts, &all);
    let place = |body: usize| bodies.binary_search(&body).unwrap_or_default();
    let mut parents: Vec<usize> = (0..bodies.len()).collect();
    let root = |parents: &mut [usize], mut of: usize| {
        while parents[of] != of {
            parents[of] = parents[parents[of]];
            of = parents[of];
        }
        of
    };
    let moving = |body: Option<usize>| body.filter(|body| !masses.is_held(*body));
    for contact in contacts {
        if let (Some(i), Some(j)) = (moving(contact.first), moving(Some(contact.second))) {
            let (a, b) = (root(&mut parents, place(i)), root(&mut parents, place(j)));
            parents[a.max(b)] = a.min(b);
        }
    }
    let mut of_root: Vec<Option<usize>> = vec![None; bodies.len()];
    let mut groups: Vec<Vec<usize>> = Vec::new();
    for (c, contact) in contacts.iter().enumerate() {
        let body = moving(Some(contact.second)).or(moving(contact.first));
        // Two held bodies have nothing to solve for.
        let Some(body) = body else { continue };
        let root = root(&mut parents, place(body));
        let group = *of_root[root].get_or_insert_with(|| {
            groups.push(Vec::new());
            groups.len() - 1
        });
        groups[group].push(c);
    }
    groups
}

#[cfg(test)]
mod tests {
    use lennard_core::{DVec3, System};

    use super::*;

    #[test]
    fn a_held_body_joins_no_groups() {
        let row =
            |first, second| Contact { first: Some(first), second, normal: DVec3::X, gap: 0.0 };
        let contacts = [row(0, 1), row(1, 2), row(3, 4), row(4, 2)];
        let free = Masses::Uniform(1.0);
        assert_eq!(groups(&contacts, &free), [vec![0, 1, 2, 3]]);
        let held = System::atoms(5).holding(&[2]).masses;
        assert_eq!(groups(&contacts, &held), [vec![0, 1], vec![2, 3]]);
    }
}
