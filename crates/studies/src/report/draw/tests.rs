//! What a drawn figure holds.

use super::*;
use crate::report::{Axis, Dash};

fn example() -> Figure {
    Figure::new("test", "Growth & <decay>", Axis::linear("ωh"), Axis::logarithmic("error / ε"))
        .with(Series::new(
            "theory",
            Look::Line(Dash::Dashed),
            0,
            (1..50).map(|i| (f64::from(i), f64::from(i).powi(2))),
        ))
        .with(
            Series::new(
                "measured",
                Look::Points(Symbol::Disc),
                1,
                vec![Point {
                    x: 3.0,
                    y: 9.0,
                    error: Some(20.0),
                    note: Some("n < 3".into()),
                    link: None,
                    x_range: Some((2.5, 3.5)),
                    label: Some("17".into()),
                }],
            )
            .with_failures([
                Point { x: 10.0, note: Some("blew up".into()), ..Point::default() },
                Point::from((20.0, f64::NAN)),
            ]),
        )
        .guided(Guide::Vertical(2.0, "limit".into()))
}

#[test]
fn the_same_data_give_the_same_bytes_and_text_is_escaped() {
    let svg = example().to_svg().unwrap();
    assert_eq!(svg, example().to_svg().unwrap());
    assert!(svg.starts_with("<svg role=\"img\" width=\"100%\" viewBox=\"0 0 4480 "));
    assert!(svg.trim_end().ends_with("</svg>"));
    assert!(svg.contains("<title>Growth &amp; &lt;decay&gt;</title>"));
    assert!(svg.contains("<title>n &lt; 3</title>"));
    assert!(!svg.contains("<decay>"));
    // Points and failures alike can be pointed at.
    assert!(svg.contains("<title>blew up</title>"));
    assert_eq!(svg.matches("class=\"hint\"").count(), 2);
    // Text stays text, and the legend says what a cross means.
    for word in ["theory", "measured", "failed: no value", "limit", "error / ε"] {
        assert!(svg.contains(word), "{word}");
    }
}

#[test]
fn lines_are_cut_at_the_frame_and_broken_where_there_is_no_value() {
    assert_eq!(clip((-1.0, 0.5), (1.0, 0.5)), Some(((0.0, 0.5), (1.0, 0.5), false, true)));
    assert_eq!(clip((-1.0, 2.0), (2.0, 2.0)), None);
    let frame = Frame {
        left: 0.0,
        top: 0.0,
        width: 100.0,
        height: 100.0,
        x: Axis::linear("x").from_to(0.0, 4.0).span("f", [].into_iter()).unwrap(),
        y: Axis::linear("y").from_to(0.0, 1.0).span("f", [].into_iter()).unwrap(),
    };
    let points: Vec<Point> = [0.5, 0.5, f64::NAN, 0.5, 0.5]
        .iter()
        .enumerate()
        .map(|(i, y)| Point { x: i as f64, y: *y, ..Point::default() })
        .collect();
    let pieces = visible_pieces(&frame, &points);
    assert_eq!(pieces, [[(0.0, 50.0), (25.0, 50.0)], [(75.0, 50.0), (100.0, 50.0)]]);
}

#[test]
fn failures_are_drawn_and_not_dropped() {
    let mut without = example();
    without.series[1].failures.clear();
    let count = |f: &Figure| f.to_svg().unwrap().matches("<polyline").count();
    // Two strokes for each of the two failures and two in the legend.
    assert_eq!(count(&example()), count(&without) + 6);
}

#[test]
fn a_floor_is_tinted_and_a_point_carries_its_range_and_its_word() {
    let count = |f: &Figure, what: &str| f.to_svg().unwrap().matches(what).count();
    let plain = example();
    let floor = example().guided(Guide::UpTo(4.0, "noise".into()));
    assert_eq!(count(&floor, "<rect"), count(&plain, "<rect") + 1);
    assert_eq!(count(&floor, "noise"), 1);
    let mut bare = example();
    bare.series[1].points[0].x_range = None;
    assert_eq!(count(&plain, "<polyline"), count(&bare, "<polyline") + 1);
    assert_eq!(count(&plain, ">17</text>"), 1);
}

#[test]
fn a_figure_without_values_is_an_error() {
    let empty = Figure::new("empty", "Empty", Axis::linear("x"), Axis::linear("y"));
    assert!(matches!(empty.to_svg(), Err(ReportError::NothingToDraw { .. })));
}

#[test]
fn a_left_part_is_tinted_and_no_word_lies_over_another() {
    let count = |f: &Figure, what: &str| f.to_svg().unwrap().matches(what).count();
    let cut = example().guided(Guide::Before(4.0, "averages begin".into()));
    assert_eq!(count(&cut, "<rect"), count(&example(), "<rect") + 1);
    // Marks at one place: their words stand around it, and those that find no place are left out.
    let span = || Axis::linear("x").from_to(0.0, 1.0).span("f", [].into_iter()).unwrap();
    let frame = Frame { left: 0.0, top: 0.0, width: 400.0, height: 300.0, x: span(), y: span() };
    let point = |i: usize| Point { label: Some(format!("word {i}")), ..Point::from((0.5, 0.5)) };
    let points: Vec<Point> = (0..40).map(point).collect();
    let mut words = Words::default();
    words.labels(&frame, points.iter());
    assert!((2..40).contains(&words.placed.len()), "{}", words.placed.len());
    let bounds = |(text, at, (height, _), anchor): &(String, Place, (f64, Rgb), Anchor)| {
        Words::bounds(text, *at, *height, *anchor)
    };
    for (i, word) in words.placed.iter().enumerate() {
        let [left, right, top, bottom] = bounds(word);
        assert!(left >= 0.0 && right <= 400.0 && top >= 0.0 && bottom <= 300.0, "{word:?}");
        for other in &words.placed[..i] {
            let [l, r, t, b] = bounds(other);
            assert!(right <= l || r <= left || bottom <= t || b <= top, "{word:?} over {other:?}");
        }
    }
}
