//! The dashpots of soft walls on molecules whose bonds are held.

use lennard_core::DVec3;

use super::MoleculesAtWalls;

impl MoleculesAtWalls {
    /// Lets the dashpots of all walls act on all molecules for a time h, τ; returns the kinetic energy put in, 0 or less, ε.
    ///
    /// A site that moves outward with u at the depth δ takes the impulse p = (u′ − u)/κ, where u′ is the speed after the decay of a
    /// mass 1/κ. Before the flight sites come in their order and after it in reverse, so that the whole step is symmetric in time.
    pub(super) fn damp_all(&mut self, x: &[DVec3], v: &mut [DVec3], h: f64, is_after: bool) -> f64 {
        if self.damped.is_empty() {
            return 0.0;
        }
        let sites = self.system.molecules.sites();
        let mut heat = 0.0;
        for first in (0..x.len()).step_by(sites) {
            let own = first..first + sites;
            let is_in_contact = |x: &DVec3| {
                let mut planes = self.damped.iter();
                planes.any(|plane| self.distance(*plane, *x) < 0.0)
            };
            if x[own.clone()].iter().any(is_in_contact) {
                self.take_masses(&own);
                heat += self.damp_one(&x[own.clone()], &mut v[own], h, is_after);
            }
        }
        heat
    }

    fn damp_one(&mut self, x: &[DVec3], v: &mut [DVec3], h: f64, is_after: bool) -> f64 {
        self.project(x, v);
        let mut heat = 0.0;
        let planes = self.damped.len();
        let all = x.len() * planes;
        for k in 0..all {
            let k = if is_after { all - 1 - k } else { k };
            let (site, plane) = (k / planes, self.damped[k % planes]);
            let depth = -self.distance(plane, x[site]);
            if depth <= 0.0 || self.one.masses.is_held(site) {
                continue;
            }
            let (along, kappa) = self.pushed(x, site, plane);
            let outward = self.towards(plane, v[site]);
            let Some(contact) = self.walls.surface(plane).dashpot() else {
                continue;
            };
            let after = contact.damped(depth, outward, 1.0 / kappa, h);
            let impulse = (after - outward) / kappa;
            for (v, along) in v.iter_mut().zip(&along) {
                *v += impulse * *along;
            }
            self.walls.take_momentum(plane, -impulse);
            heat += 0.5 * (after * after - outward * outward) / kappa;
        }
        heat
    }
}
