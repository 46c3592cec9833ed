//! What cannot be drawn is said by name.

use lennard_studies::report::{Axis, Dash, Figure, Look, Series};

#[test]
fn a_figure_that_cannot_be_drawn_says_which_and_why() {
    let line = |points: Vec<(f64, f64)>| Series::new("s", Look::Line(Dash::Solid), 0, points);
    let figure = |y: Axis, points| {
        let figure = Figure::new("drift", "Drift", Axis::linear("x"), y).with(line(points));
        figure.to_svg().unwrap_err().to_string()
    };
    assert_eq!(
        figure(Axis::logarithmic("y"), vec![(1.0, -1.0), (2.0, f64::NAN)]),
        "figure `drift` has no value that its axes can show"
    );
    assert_eq!(
        figure(Axis::linear("y").from_to(2.0, 1.0), vec![(1.0, 1.0), (2.0, 2.0)]),
        "figure `drift`: the axis `y` cannot run from 2 to 1"
    );
}
