//! temporary
fn main() {
    let o = lennard_studies::stability::StabilityOptions { quick: std::env::args().any(|a| a == "--quick"), ..Default::default() };
    let t = std::time::Instant::now();
    struct P; impl lennard_studies::Progress for P { fn update(&mut self, l: &str, d: f64) { eprintln!("{l} {d}"); } }
    let s = lennard_studies::stability::run(&o, &mut P).unwrap();
    eprintln!("{:?}", t.elapsed());
    lennard_studies::stability::write(&s, std::path::Path::new("/tmp/t/stab")).unwrap();
    eprintln!("{:?}", t.elapsed());
    for c in &s.claims { if !c.theory_agrees || c.verdict != lennard_studies::claims::Verdict::Holds { eprintln!("{c:?}"); } }
}
