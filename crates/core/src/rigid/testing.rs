//! Molecules in motion, for the tests of the velocity stages.

use super::kick;
use crate::lanes::{Scalar, WithSimd, in_lanes};
use crate::{DVec3, Masses};

/// Sites of molecules before a kick.
pub struct Kicked {
    pub masses: Masses,
    pub x: Vec<DVec3>,
    pub v: Vec<DVec3>,
    pub f: Vec<DVec3>,
}

impl Kicked {
    /// Length of the kick, τ.
    pub const TIME: f64 = 0.1;

    /// The same sites with equal masses, and with a mass of each.
    pub fn with_either_masses(sites: usize) -> [Self; 2] {
        let of = |shift: f64| -> Vec<DVec3> {
            let at = |i: usize| shift + 1.7 * i as f64;
            let site = |i| DVec3::new(at(i).sin(), (0.7 * at(i)).cos(), (1.9 * at(i)).sin());
            (0..sites).map(site).collect()
        };
        let each = (0..sites).map(|i| 1.0 + 0.1 * i as f64).collect();
        [Masses::Uniform(1.3), Masses::Each(each)].map(|masses| Self {
            masses,
            x: of(0.0),
            v: of(0.4),
            f: of(0.8),
        })
    }

    /// The kick of the sites from `first` on.
    pub fn kick(&self) -> impl Fn(usize, &mut [DVec3]) {
        |first, v| kick(&self.masses, first, v, &self.f[first..], Self::TIME)
    }
}

/// The velocities after a stage, which has the same bits in registers as with numbers one by one.
pub fn in_registers_and_one_by_one(
    before: &[DVec3],
    run: impl Fn(&mut [DVec3], Way),
) -> Vec<DVec3> {
    let after = |way| {
        let mut v = before.to_vec();
        run(&mut v, way);
        v
    };
    let found = after(Way::Registers);
    assert_eq!(found, after(Way::OneByOne), "{} sites", before.len());
    found
}

/// How the numbers of a stage are taken.
#[derive(Clone, Copy)]
pub enum Way {
    Registers,
    OneByOne,
}

impl Way {
    /// Runs a stage.
    pub fn run(self, stage: impl WithSimd<Output = ()>) {
        match self {
            Self::Registers => in_lanes(stage),
            Self::OneByOne => stage.with_simd(Scalar),
        }
    }
}
