use lennard_core::DVec3;

use super::*;

fn figure(sides: DVec3, places: Vec<DVec3>) -> ParticleFigure {
    ParticleFigure {
        name: "particles".into(),
        title: "Particles <at the end>".into(),
        sides,
        species: vec![Sphere { name: "Ar".into(), diameter: 1.0 }],
        places,
        of_particle: Vec::new(),
    }
}

/// A simple cubic crystal with this many particles along each side.
fn crystal(cells: usize) -> ParticleFigure {
    let all = 0..cells * cells * cells;
    let place = |i: usize| {
        let along = [i % cells, i / cells % cells, i / (cells * cells)];
        DVec3::from_array(along.map(|k| k as f64 + 0.5))
    };
    figure(DVec3::splat(cells as f64), all.map(place).collect())
}

fn spheres(svg: &str) -> usize {
    svg.matches("<use ").count()
}

#[test]
fn what_others_hide_is_not_drawn_and_the_nearest_is_drawn_last() {
    let six = crystal(6);
    let seen = Scenery::of(&six).seen;
    // The three faces toward the viewer have 91 spheres; between them some more are seen.
    assert!((91..190).contains(&seen.len()), "{}", seen.len());
    assert!(seen.windows(2).all(|pair| pair[0].depth >= pair[1].depth));
    let front = seen.last().unwrap();
    assert!(front.depth < 0.2, "{}", front.depth);
    assert_eq!(spheres(&six.to_svg().unwrap()), seen.len());
    let apart = vec![DVec3::splat(2.0), DVec3::splat(10.0), DVec3::new(2.0, 14.0, 3.0)];
    assert_eq!(Scenery::of(&figure(DVec3::splat(16.0), apart)).seen.len(), 3);
}

#[test]
fn a_large_system_shows_a_corner_with_a_bounded_number_of_spheres() {
    let large = crystal(50);
    let svg = large.to_svg().unwrap();
    assert!(spheres(&svg) <= MOST_SPHERES, "{}", spheres(&svg));
    assert!(spheres(&svg) > MOST_SPHERES / 3, "{}", spheres(&svg));
    assert!(svg.contains("a corner of the box: "), "{}", &svg[svg.len() - 400..]);
    assert!(svg.len() < 120_000, "{} bytes", svg.len());
    assert!(!crystal(6).to_svg().unwrap().contains("a corner"));
}

#[test]
fn places_are_folded_into_the_box_and_the_text_is_escaped_and_repeatable() {
    let side = DVec3::splat(5.0);
    let inside = figure(side, vec![DVec3::new(1.0, 2.0, 3.0)]);
    let outside = figure(side, vec![DVec3::new(-4.0, 12.0, 3.0)]);
    let svg = inside.to_svg().unwrap();
    assert_eq!(svg, outside.to_svg().unwrap());
    assert!(svg.contains("Particles &lt;at the end&gt;"), "{svg}");
    assert!(svg.contains("5.00 × 5.00 × 5.00 σ"), "{svg}");
    assert!(figure(side, Vec::new()).to_svg().is_err());
}

#[test]
fn the_longest_side_lies_from_left_to_right_and_species_have_colors_and_a_legend() {
    let mut mixture =
        figure(DVec3::new(5.0, 5.0, 20.0), vec![DVec3::splat(1.0), DVec3::new(1.0, 1.0, 15.0)]);
    let krypton = Sphere { name: "Kr".into(), diameter: 1.2 };
    mixture.species.push(krypton);
    mixture.of_particle = vec![0, 1];
    let seen = Scenery::of(&mixture).seen;
    let [first, second] = [0, 1].map(|a| seen.iter().find(|s| s.species == a).unwrap().at);
    assert!(second.0 - first.0 > 200.0, "{first:?} {second:?}");
    let svg = mixture.to_svg().unwrap();
    assert!(svg.contains("#particles-0-") && svg.contains("#particles-1-"), "{svg}");
    assert!(svg.contains(">Kr</text>"), "{svg}");
    assert!(svg.contains("5.00 × 5.00 × 20.00 σ"), "{svg}");
}
