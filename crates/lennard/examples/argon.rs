//! Argon without a scene: a box, positions, a potential, a method, and the energies after some steps.
#![allow(clippy::print_stdout)] // printing is what this program is for

use std::error::Error;

use lennard::dynamics::{
    Conditions, DVec3, ForceFieldOptions, ForceSum, IntegratorOptions, PeriodicBox, State, Streams,
    System, TruncationKind, TruncationOptions, Want, build, integrator, thermal_velocities,
};

/// The step in τ: 10 fs for argon.
const DT: f64 = 0.0046;

/// The fcc lattice of 4·cells³ particles in a cube, σ.
fn lattice(cell: &PeriodicBox, cells: usize) -> Vec<DVec3> {
    let edge = cell.lengths().x / cells as f64;
    let basis = [[0.0, 0.0, 0.0], [0.0, 0.5, 0.5], [0.5, 0.0, 0.5], [0.5, 0.5, 0.0]];
    let corners = (0..cells.pow(3)).map(|k| [k / cells.pow(2), k / cells % cells, k % cells]);
    let corners = corners.map(|corner| DVec3::from(corner.map(|k| k as f64 + 0.25)));
    corners.flat_map(|corner| basis.map(|b| edge * (corner + DVec3::from(b)))).collect()
}

/// The last state, and U and K in ε after each block of steps.
type Run = (State, Vec<[f64; 2]>);

/// Takes blocks of ten steps from positions in a box.
pub(crate) fn argon(
    cell: PeriodicBox,
    positions: Vec<DVec3>,
    temperature: f64,
    blocks: usize,
) -> Result<Run, Box<dyn Error>> {
    let n_atoms = positions.len();
    let potential = ForceFieldOptions {
        truncation: TruncationOptions::new(TruncationKind::Shift, 2.5),
        ..ForceFieldOptions::default()
    };
    let conditions = Conditions { cell, n_atoms, temperature, dt: DT, mixture: None };
    let mut forces = ForceSum::new(build(&potential, &conditions)?);
    let mut method = integrator(&IntegratorOptions::default());

    let system = System::atoms(n_atoms);
    let velocities = thermal_velocities(&system, &positions, temperature, Streams::new(1));
    let mut state = State::new(cell, positions, velocities);
    method.start(&system, &mut state, &mut forces, DT, Want::ENERGY)?;
    let mut energies = Vec::new();
    for _ in 0..blocks {
        method.advance(&system, &mut state, &mut forces, DT, 10, Want::ENERGY)?;
        let potential = state.energetics.potential_energy.unwrap_or(f64::NAN);
        energies.push([potential, system.kinetic_energy(&state.velocities)]);
    }
    Ok((state, energies))
}

pub(crate) fn main() -> Result<(), Box<dyn Error>> {
    let cell = PeriodicBox::cubic_for_density(864, 0.8072)?;
    let (state, energies) = argon(cell, lattice(&cell, 6), 1.5, 30)?;
    let n = state.len() as f64;
    for [potential, kinetic] in &energies {
        println!("U = {:.4} ε, K = {:.4} ε", potential / n, kinetic / n);
    }
    let total = |[potential, kinetic]: [f64; 2]| (potential + kinetic) / n;
    let drift = total(energies[29]) - total(energies[0]);
    println!("energy drift in {} steps: {drift:.1e} ε", state.step);
    assert!(drift.abs() < 2e-3, "{drift}");
    Ok(())
}
