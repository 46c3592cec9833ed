//! Restarts continue with the same bits.

use super::*;

#[test]
fn a_restart_continues_with_the_same_bits() {
    let (cell, start) = liquid([9, 8, 8], 0.8442, 0.15);
    for kernel in kernels() {
        let options = ForceFieldOptions {
            kernel,
            neighbor: verlet(Some(0.4)),
            split: Some(SplitOptions { r_split: 1.6, width: 0.3 }),
            ..ForceFieldOptions::default()
        };
        let at = conditions(cell, start.len());
        let parts = [Part::All, Part::Near, Part::Far];
        let mut one = build(&options, &at).unwrap();
        for part in parts {
            evaluate(&mut one, cell, &start, part, Want::NOTHING).unwrap();
        }
        let mut archive = StateArchive::default();
        one.save(&mut archive.writer());
        let mut other = build(&options, &at).unwrap();
        other.restore(&archive.reader()).unwrap();
        let later = moved(&start, 0.15);
        for part in parts {
            let a = evaluate(&mut one, cell, &later, part, Want::TOTALS).unwrap();
            let b = evaluate(&mut other, cell, &later, part, Want::TOTALS).unwrap();
            assert!(a == b, "{part:?}");
        }
        let (a, b) = (one.statistics(), other.statistics());
        assert_eq!((a.builds, a.evaluations), (b.builds, b.evaluations));
        // New forces build their list at other positions and sum in another order.
        let mut fresh = build(&options, &at).unwrap();
        let a = all(&mut one, cell, &later, Want::NOTHING).0;
        assert!(
            a != all(&mut fresh, cell, &later, Want::NOTHING).0,
            "the test can tell orders apart"
        );
    }
}

#[test]
fn pairs_that_were_inserted_since_the_build_are_part_of_a_restart() {
    let (cell, start) = liquid([16, 16, 16], 0.8442, 0.15);
    // One particle in 33 moves by more than half the skin toward others.
    let push = |r: &DVec3, k: usize| {
        let direction = DVec3::from((*r * 12.9898).to_array().map(f64::sin)).normalize();
        if k.is_multiple_of(33) { 0.295 * direction } else { -0.145 * direction }
    };
    let pushed = |at: &[DVec3]| -> Vec<DVec3> {
        at.iter().enumerate().map(|(k, r)| *r + push(r, k)).collect()
    };
    let later = pushed(&start);
    for kernel in kernels().into_iter().filter(|k| k.precision == Precision::Mixed) {
        let options = ForceFieldOptions {
            potential: PotentialOptions::SoftSphere(SoftSphere { exponent: 4 }),
            kernel,
            neighbor: verlet(Some(0.3)),
            ..ForceFieldOptions::default()
        };
        let at = conditions(cell, start.len());
        let mut one = build(&options, &at).unwrap();
        all(&mut one, cell, &start, Want::NOTHING);
        let (_, found) = all(&mut one, cell, &later, Want::ENERGY);
        assert_eq!(found.pairs, reference(&options, cell, &later).1.pairs);
        assert_eq!(one.statistics().builds, 1, "the missing pairs were inserted");
        let mut archive = StateArchive::default();
        one.save(&mut archive.writer());
        let (name, inserted) =
            archive.arrays.iter().find(|(name, _)| name.ends_with("inserted")).unwrap();
        let Array::U64(pairs) = inserted else { panic!("{inserted:?}") };
        assert!(pairs.len() >= 16, "{} particles", pairs.len());

        let restored = |pairs: Vec<u64>| {
            let mut archive = archive.clone();
            archive.arrays.insert(name.clone(), Array::U64(pairs));
            let mut other = build(&options, &at).unwrap();
            other.restore(&archive.reader()).map(|()| other)
        };
        // Inserted pairs decide the order of the sums, even after they have moved apart.
        let mut same = restored(pairs.clone()).unwrap();
        let mut without = restored(Vec::new()).unwrap();
        let mut differ = false;
        for share in [0.3, 0.5, 0.7, 0.8] {
            let again: Vec<DVec3> =
                start.iter().zip(&later).map(|(a, b)| a.lerp(*b, share)).collect();
            let expected = all(&mut one, cell, &again, Want::NOTHING).0;
            assert!(expected == all(&mut same, cell, &again, Want::NOTHING).0);
            differ |= expected != all(&mut without, cell, &again, Want::NOTHING).0;
        }
        assert!(differ, "{kernel:?}: inserted pairs change nothing");
        for wrong in [vec![0, 1, 2], vec![0, 4096], vec![3, 3]] {
            let error = restored(wrong).err().unwrap().to_string();
            assert!(
                error.contains("no pairs of 4096 particles that this list can take"),
                "{error}"
            );
        }
    }
}

#[test]
fn the_count_of_builds_continues_after_a_restart() {
    let (cell, start) = liquid([8, 8, 8], 0.8442, 0.1);
    let options = ForceFieldOptions { neighbor: verlet(Some(0.3)), ..ForceFieldOptions::default() };
    let at = conditions(cell, start.len());
    let mut forces = build(&options, &at).unwrap();
    all(&mut forces, cell, &start, Want::NOTHING);
    let mut archive = StateArchive::default();
    forces.save(&mut archive.writer());
    assert_eq!(archive.arrays["list/counters"], Array::U64(vec![1]));
    for (wrong, said) in [
        (vec![], "0 values, wanted 3"),
        (vec![9.0; 2], "2 values, wanted 3"),
        (vec![-1.0; 3], "a box side must be"),
    ] {
        let said = format!("`list/built_box` does not fit: {said}");
        let mut archive = archive.clone();
        archive.arrays.insert("list/built_box".into(), Array::F64(wrong));
        let mut other = build(&options, &at).unwrap();
        let error = other.restore(&archive.reader()).unwrap_err().to_string();
        assert!(error.contains(&said), "{error}");
    }
    let mut restored = |counters: &[u64]| {
        let counters = Array::U64(counters.to_vec());
        archive.arrays.insert("list/counters".into(), counters);
        let mut other = build(&options, &at).unwrap();
        let found = other.restore(&archive.reader());
        found.map(|()| other.statistics().builds)
    };
    assert_eq!(restored(&[7]).unwrap(), 7);
    for wrong in [&[][..], &[1, 2]] {
        let error = restored(wrong).unwrap_err().to_string();
        let said = format!("`list/counters` does not fit: {} numbers, wanted 1", wrong.len());
        assert!(error.contains(&said), "{error}");
    }
}
