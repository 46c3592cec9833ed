//! What a tail correction adds to compressibilities from the structure.

use std::f64::consts::PI;

use lennard_observables::Remark;

use crate::common;

const FLUID: &str = r#"
    system = { n_atoms = 256, density = 0.6, temperature = 2.0, seed = 4 }
    truncation = { r_cut = 3.0 }
    integrator = { dt = 0.004 }
    stage = [{ name = "production", steps = 1000, thermostat = "bussi" }]
    observable = [{ kind = "kirkwood-buff", every = 20 }]
"#;

const REMARK: &str = "the structure is of the fluid without its tail";

#[test]
fn compressibilities_from_the_structure_are_told_with_the_tail_where_there_is_one() {
    let found = |tail: &str| {
        let scene = common::scene(FLUID, &format!("truncation.tail_correction={tail}"));
        common::ran(scene).findings()
    };
    let without = found("false");
    assert!(!without.iter().any(|f| f.remarks_in_words().contains(REMARK)));

    let with = found("true");
    let remarks = with.iter().flat_map(|f| &f.remarks).map(Remark::to_string);
    let told: Vec<String> = remarks.filter(|r| r.starts_with(REMARK)).collect();
    let [told] = &told[..] else {
        panic!("{told:?}");
    };
    // 2·P_tail of Lennard-Jones.
    let r = 3.0_f64;
    let added = 32.0 / 3.0 * PI * 0.36 * (2.0 / 3.0 * r.powi(-9) - r.powi(-3));
    assert!(told.contains(&format!("{added:.4} ε/σ³")), "{told}");
    let averages = with.iter().flat_map(|f| &f.averages);
    let from_structure = averages.filter(|a| a.name.starts_with("compressibility_kirkwood_buff"));
    let mut told_of = 0;
    for average in from_structure.filter(|a| a.estimate.mean > 0.0) {
        let kappa = 1.0 / (1.0 / average.estimate.mean + added);
        let words = format!("{} {kappa:.4} σ³/ε", average.name);
        assert!(told.contains(&words), "no {words} in {told}");
        // The tail attracts: the fluid with it gives way more easily.
        assert!(kappa > average.estimate.mean);
        told_of += 1;
    }
    assert!(told_of > 0);
}
