//! Energies and virials of the NIST reference configurations.

use std::path::PathBuf;

use lennard_core::{Configuration, DVec3, ForceTerm, Part, PeriodicBox, Want};
use lennard_forcefield::{
    Conditions, ForceFieldOptions, Isa, Kernel, KernelOptions, ListMode, NeighborOptions,
    TruncationKind, TruncationOptions, build, tail_correction,
};

/// Relative error allowed against the full-precision columns.
const TOLERANCE: f64 = 1e-12;

fn folder() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../validation/reference/nist")
}

fn configuration(number: &str) -> (PeriodicBox, Vec<DVec3>) {
    let path = folder().join(format!("lj_sample_config_periodic{number}.txt"));
    let text = std::fs::read_to_string(path).unwrap();
    let mut lines = text.lines().map(|line| {
        line.split_whitespace().map(|word| word.parse::<f64>().unwrap()).collect::<Vec<f64>>()
    });
    let lengths = DVec3::from_slice(&lines.next().unwrap());
    let n = lines.next().unwrap()[0] as usize;
    let positions: Vec<DVec3> = lines.take(n).map(|l| DVec3::from_slice(&l[1..])).collect();
    assert_eq!(positions.len(), n);
    (PeriodicBox::new(lengths).unwrap(), positions)
}

fn close(found: f64, wanted: f64, what: &str) {
    let error = (found - wanted).abs() / wanted.abs().max(f64::MIN_POSITIVE);
    assert!(error <= TOLERANCE, "{what}: {found:e} against {wanted:e}, relative error {error:e}");
}

#[test]
fn nist_energies_and_virials_are_met_by_every_loop() {
    let table = std::fs::read_to_string(folder().join("reference_calculations.csv")).unwrap();
    let mut rows = 0;
    for line in table.lines().filter(|l| l.starts_with(['1', '3', '4'])) {
        let cell: Vec<&str> = line.split(',').collect();
        let number = |k: usize| cell[k].parse::<f64>().unwrap();
        let kind = match cell[4] {
            "LRC" => TruncationKind::Cut,
            "LTS" => TruncationKind::Shift,
            "LFS" => TruncationKind::ForceShift,
            other => panic!("unknown truncation {other}"),
        };
        let (periodic, positions) = configuration(cell[0]);
        let conditions = Conditions {
            cell: periodic,
            n_atoms: positions.len(),
            temperature: 1.0,
            dt: 0.005,
            mixture: None,
        };
        let list = NeighborOptions { mode: ListMode::Verlet, skin: None };
        let direct = NeighborOptions { mode: ListMode::Direct, skin: None };
        for (kernel, neighbor, isa) in [
            (Kernel::Reference, NeighborOptions::default(), Isa::Auto),
            (Kernel::Auto, direct, Isa::Auto),
            (Kernel::Auto, list, Isa::Auto),
            (Kernel::Auto, list, Isa::Portable),
        ] {
            let options = ForceFieldOptions {
                truncation: TruncationOptions::new(kind, number(5)),
                kernel: KernelOptions { kernel, isa, ..KernelOptions::default() },
                neighbor,
                ..ForceFieldOptions::default()
            };
            let mut forces = build(&options, &conditions).unwrap();
            let mut f = vec![DVec3::ZERO; positions.len()];
            let at = Configuration::at_rest(&periodic, &positions);
            let found = forces.evaluate(at, Part::All, Want::ENERGY_AND_VIRIAL, &mut f).unwrap();
            let what =
                format!("configuration {}, {} {}, {:?}", cell[0], cell[4], cell[5], forces.plan());
            assert_eq!(found.pairs, Some(number(6) as u64), "{what}");
            close(found.potential_energy.unwrap(), number(10), &what);
            close(found.scalar_virial().unwrap(), number(11), &what);
            if let Some(tail) = tail_correction(&options, positions.len(), periodic.volume()) {
                close(tail.energy, number(12), &what);
                close(tail.virial, number(13), &what);
            } else {
                assert_eq!(number(12), 0.0);
            }
        }
        rows += 1;
    }
    assert_eq!(rows, 18, "every row of configurations 1, 3 and 4");
}

#[test]
fn the_second_derivative_follows_from_energy_and_virial() {
    // Σ r²u″ = 19 W − 72 U for 12-6, here with the sum over pairs beside it.
    for (number, r_cut) in [("1", 3.0), ("3", 4.0), ("4", 3.0)] {
        let (periodic, positions) = configuration(number);
        let truncation = TruncationOptions::new(TruncationKind::Cut, r_cut);
        let options = ForceFieldOptions::default();
        let model = lennard_forcefield::Model::new(&options.potential, &truncation).unwrap();
        let (mut energy, mut virial, mut second) = (0.0, 0.0, 0.0);
        for (i, a) in positions.iter().enumerate() {
            for b in &positions[..i] {
                let r2 = periodic.minimum_image(*a - *b).length_squared();
                if r2 <= r_cut * r_cut {
                    let pair = model.eval(r2);
                    energy += pair.energy;
                    virial += pair.force * r2;
                    second += pair.curvature * r2;
                }
            }
        }
        close(19.0 * virial - 72.0 * energy, second, number);
    }
}
