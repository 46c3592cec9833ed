//! The one-step maps of the oscillator. What the quick study finds with them is asked in its own tests.

use super::amplification;
use super::groups::entry;
use super::map::StepMap;
use super::oscillator::{Spring, excursion, measured_map};

#[test]
fn spook_turns_by_twice_the_arctangent_and_swings_by_the_root_at_every_finite_stiffness() {
    let spook = entry("spook").unwrap();
    // At ωh = 2 a step is a quarter of a turn, and no sample comes near a crest.
    for omega_h in [0.01, 0.1, 1.0, 2.1, 6.3, 50.0, 1000.0] {
        let map = measured_map(spook, omega_h, 1.0).unwrap();
        let theta = map.phase().expect("never real");
        // Near its ends the arc cosine behind an angle loses half the digits.
        let tolerance = 1e-13 * (1.0 / omega_h + omega_h).powi(2);
        assert!((theta - 2.0 * (0.5 * omega_h).atan()).abs() < tolerance, "ωh = {omega_h}");
        assert!((map.radius() - 1.0).abs() < 1e-12 * (1.0 + omega_h));
        let far =
            excursion(spook, Spring::Stiffness(omega_h * omega_h), 1.0, 100_000, f64::INFINITY);
        let amplitude = 1.0_f64.hypot(0.5 * omega_h);
        // The samples come within 10⁻³ of a crest in phase.
        assert!((far.unwrap().largest / amplitude - 1.0).abs() < 1e-6, "ωh = {omega_h}");
    }
}

#[test]
fn a_wrong_map_would_be_noticed() {
    // The comparison behind every figure must be able to fail: symplectic Euler against the map of
    // velocity Verlet has the same radius, and another amplitude.
    let symplectic = measured_map(entry("symplectic-euler").unwrap(), 1.0, 1.0).unwrap();
    let verlet = amplification::theory(entry("velocity-verlet").unwrap(), 1.0);
    assert!((symplectic.radius() - verlet.radius()).abs() < 1e-12);
    assert!(
        (symplectic.amplitude(1.0, 0.0).unwrap() - verlet.amplitude(1.0, 0.0).unwrap()).abs() > 0.1
    );
    assert!(StepMap::phase(verlet).is_some());
}
