//! The stability study.

pub mod amplification;
pub mod discretisation;
pub mod displacement;
mod fit;
pub mod groups;
pub mod infinite;
mod map;
pub mod orders;
mod rig;
pub mod variable_step;

#[cfg(test)]
mod trial {
    #[test]
    fn look() {
        let g = super::groups::groups();
        let t = std::time::Instant::now();
        for m in super::amplification::measure(&g, false).unwrap() {
            println!("{} g{} diff {:e} decl {:?} theory {:?} measured {:?} {:?}", m.method, m.group, m.largest_radius_difference, m.declared_limit, m.theory_limit, m.measured_limit, m.bounded_at_1000);
        }
        println!("{:?}", t.elapsed());
        let t = std::time::Instant::now();
        for c in super::displacement::measure(&g, false).unwrap() {
            println!("{} {}", c.title, c.omega_h);
            for s in c.summaries { println!("   {s:?}"); }
        }
        println!("{:?}", t.elapsed());
        let i = super::infinite::measure(false).unwrap();
        println!("{:e}", i.deviation_from_linear);
        for r in i.rigid { println!("{} {} {} {} {}", r.damping_steps, r.theory_radius, r.measured_radius, r.last_displacement, r.growth_of_halves); }
        for r in i.stiff { println!("{} {} {}", r.omega_h, r.theory_amplitude, r.measured_amplitude); }
        println!("{:?}", t.elapsed());
        for d in super::discretisation::measure().unwrap() { println!("{} {} {} {}", d.wh, d.exact_start_coefficient*24., d.taylor_start_coefficient*24., d.taylor_start_offset*16.); }
        let o = super::orders::measure(&g, false).unwrap();
        for l in o.positions.iter().chain(&o.velocities).chain(&o.starts).chain(&o.velocity_estimates).chain(&o.local).chain([&o.energy]) { println!("{} {} {:?} {:.2e}", l.name, l.theory, l.measured, l.errors.last().unwrap().1); }
        println!("{:e} {:e}", o.energy_drift_share, o.velocity_verlet_against_stormer);
        println!("{:?}", t.elapsed());
    }
}
