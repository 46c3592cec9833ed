//! Complementarity problems of stacks, pyramids and rows.

use lennard_core::System;

use super::*;

fn problem<'a>(contacts: &'a [Contact], b: &'a [f64]) -> Problem<'a> {
    Problem { contacts, masses: &Masses::Uniform(1.0), sigma: 0.0, b, bonds: TwoSided::default() }
}

#[test]
fn direct_and_sweeps_agree_where_some_contacts_push_and_others_part() {
    // A pyramid of balls in a plane on a floor, some of them thrown: every third contact is pulled apart.
    let at = |x: f64, z: f64| DVec3::new(x, 0.0, z);
    let height = 0.75_f64.sqrt();
    let places = [
        at(0.0, 0.0),
        at(1.0, 0.0),
        at(2.0, 0.0),
        at(0.5, height),
        at(1.5, height),
        at(1.0, 2.0 * height),
    ];
    let mut contacts: Vec<Contact> =
        (0..3).map(|second| Contact { first: None, second, normal: DVec3::Z, gap: 0.0 }).collect();
    for [i, j] in [[0, 3], [1, 3], [1, 4], [2, 4], [3, 5], [4, 5]] {
        contacts.push(Contact {
            first: Some(i),
            second: j,
            normal: places[j] - places[i],
            gap: 0.0,
        });
    }
    let masses = Masses::Each((0..6).map(|i| 1.0 + 0.4 * f64::from(i)).collect());
    for sigma in [0.0, 0.3] {
        for shift in 0..9 {
            let b: Vec<f64> =
                (0..9).map(|c| (2.3 * f64::from(c) + 1.7 * f64::from(shift)).sin()).collect();
            let problem = Problem {
                contacts: &contacts,
                masses: &masses,
                sigma,
                b: &b,
                bonds: TwoSided::default(),
            };
            let direct = problem.solve(Solver::Exact);
            assert_eq!(direct.sweeps, 0);
            let swept = problem.solve(Solver::Sweeps(5000));
            let mut v = vec![DVec3::ZERO; 6];
            for (contact, impulse) in contacts.iter().zip(&direct.impulses) {
                contact.push(*impulse, &masses, &mut v);
            }
            for (c, (a, b_)) in direct.impulses.iter().zip(&swept.impulses).enumerate() {
                assert!((a - b_).abs() < 1e-12, "{sigma} {shift}: {a} {b_}");
                let rate = contacts[c].rate(&v) + sigma * a + b[c];
                assert!(*a >= 0.0 && rate > -1e-13 && (a * rate).abs() < 1e-13);
            }
            assert!(direct.impulses.contains(&0.0));
        }
    }
}

#[test]
fn contacts_that_follow_from_others_share_the_load() {
    // The same contact three times: the matrix is singular, and its impulses add up to the one of a single contact.
    let contacts = vec![column(1)[0]; 3];
    let found = problem(&contacts, &[-1.0; 3]).solve(Solver::Exact);
    assert!((found.impulses.iter().sum::<f64>() - 1.0).abs() < 1e-14);
    assert!(found.sweeps > 0);
}

#[test]
fn a_long_column_that_sweeps_do_not_solve_is_an_error_and_a_short_one_ends_at_rounding() {
    let solve = |n: usize| {
        let mut b = vec![0.0; n];
        b[0] = -1.0;
        problem(&column(n), &b).solve(Solver::Exact)
    };
    let solved = solve(36).settled(Solver::Exact).unwrap();
    assert!(solved.sweeps > 0 && solved.sweeps < MOST_SWEEPS);
    let off = (solved.impulses.iter().enumerate()).map(|(i, x)| (x - (36 - i) as f64).abs());
    assert!(off.fold(0.0, f64::max) < 1e-11);
    let unsolved = solve(200);
    assert!(unsolved.clone().settled(Solver::Sweeps(20_000)).is_ok());
    let error = unsolved.settled(Solver::Exact).unwrap_err();
    let StepError::ContactsNotConverged {
        contacts: 200, iterations: MOST_SWEEPS, residual, ..
    } = error
    else {
        panic!("{error}");
    };
    // The slowest of the modes is left: cos²(π/400) to the number of sweeps.
    assert!(residual > 1e-5 && residual < 1e-2, "{residual}");
}

#[test]
fn bonds_pull_and_push_and_direct_and_sweeps_agree_beside_contacts() {
    // A row of five that is joined end to end, and stands on two contacts of which one is lifted.
    let masses = Masses::Each((0..5).map(|i| 1.0 + 0.3 * f64::from(i)).collect());
    let turn = |k: usize| 0.7 * k as f64;
    let bonds = (0..4).map(|k| Contact {
        first: Some(k),
        second: k + 1,
        normal: DVec3::new(turn(k).cos(), 0.0, turn(k).sin()),
        gap: 0.0,
    });
    let floor = [0, 3, 4].map(|second| Contact { first: None, second, normal: DVec3::Z, gap: 0.0 });
    let contacts: Vec<Contact> = bonds.chain(floor).collect();
    for sigma in [0.0, 0.2] {
        let mut signs = [0, 0];
        for shift in 0..8 {
            let b: Vec<f64> =
                (0..7).map(|c| (2.3 * f64::from(c) + 1.7 * f64::from(shift)).sin()).collect();
            let problem = Problem {
                bonds: TwoSided { contacts: 4, sigma },
                masses: &masses,
                ..problem(&contacts, &b)
            };
            let direct = problem.solve(Solver::Exact);
            assert_eq!(direct.sweeps, 0);
            let swept = problem.solve(Solver::Sweeps(20_000));
            let mut v = vec![DVec3::ZERO; 5];
            for (contact, impulse) in contacts.iter().zip(&direct.impulses) {
                contact.push(*impulse, &masses, &mut v);
            }
            for (c, (a, b_)) in direct.impulses.iter().zip(&swept.impulses).enumerate() {
                assert!((a - b_).abs() < 1e-11, "{sigma} {shift}, {c}: {a} {b_}");
                let rate = contacts[c].rate(&v) + b[c];
                if c < 4 {
                    assert!((rate + sigma * a).abs() < 1e-12);
                    signs[usize::from(*a > 0.0)] += 1;
                } else {
                    assert!(*a >= 0.0 && rate > -1e-12 && (a * rate).abs() < 1e-12);
                }
            }
        }
        assert!(signs[0] > 3 && signs[1] > 3, "{signs:?}");
    }
}

#[test]
fn a_held_body_joins_no_groups() {
    let row = |first, second| Contact { first: Some(first), second, normal: DVec3::X, gap: 0.0 };
    let contacts = [row(0, 1), row(1, 2), row(3, 4), row(4, 2)];
    let free = Masses::Uniform(1.0);
    assert_eq!(groups(&contacts, &free), [vec![0, 1, 2, 3]]);
    let held = System::atoms(5).holding(&[2]).masses;
    assert_eq!(groups(&contacts, &held), [vec![0, 1], vec![2, 3]]);
}
