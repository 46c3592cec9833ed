//! Numbers that are not finite are errors.

use super::*;

#[test]
fn a_number_that_is_not_finite_is_an_error_that_names_the_particle() {
    let (cell, start) = liquid([8, 8, 8], 0.8442, 0.1);
    let mut strategies: Vec<ForceFieldOptions> = kernels()
        .into_iter()
        .map(|kernel| ForceFieldOptions {
            kernel,
            neighbor: verlet(None),
            ..ForceFieldOptions::default()
        })
        .collect();
    let base = ForceFieldOptions::default();
    strategies.push(ForceFieldOptions { canonical: true, ..base });
    strategies.push(ForceFieldOptions {
        neighbor: NeighborOptions { mode: ListMode::Direct, skin: None },
        ..base
    });
    strategies.push(ForceFieldOptions {
        kernel: KernelOptions { kernel: Kernel::Reference, ..KernelOptions::default() },
        ..base
    });
    for options in strategies {
        for warm in [false, true] {
            for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
                let mut forces = build(&options, &conditions(cell, start.len())).unwrap();
                if warm {
                    all(&mut forces, cell, &start, Want::NOTHING);
                }
                let mut positions = start.clone();
                positions[137].y = bad;
                for threads in [1, 3] {
                    let error = in_threads(threads, || {
                        evaluate(&mut forces, cell, &positions, Part::All, Want::NOTHING)
                    });
                    assert_eq!(error.unwrap_err(), ForceError::NonFinitePosition { particle: 137 });
                }
            }
            // Far away is no reason to hang, to panic or to read elsewhere.
            for far in [1e6, -1e9, 1e15, 1e300, -1.7e308] {
                let mut forces = build(&options, &conditions(cell, start.len())).unwrap();
                if warm {
                    all(&mut forces, cell, &start, Want::NOTHING);
                }
                let mut positions = start.clone();
                positions[5].x = far;
                let _ = evaluate(&mut forces, cell, &positions, Part::All, Want::TOTALS);
            }
            let mut forces = build(&options, &conditions(cell, start.len())).unwrap();
            if warm {
                all(&mut forces, cell, &start, Want::NOTHING);
            }
            let mut positions = start.clone();
            positions[200] = positions[33];
            let error = evaluate(&mut forces, cell, &positions, Part::All, Want::NOTHING);
            assert_eq!(
                error.unwrap_err(),
                ForceError::NonFiniteForce { particle: 33 },
                "{options:?}"
            );
            // The forces are usable again.
            all(&mut forces, cell, &start, Want::TOTALS);
        }
    }
}
