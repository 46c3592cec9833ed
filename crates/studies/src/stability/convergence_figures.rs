//! The figures of orders and of the discretisation error.

use crate::report::{Axis, Dash, Figure, Look, Picture, Series};

use super::figures::dense;
use super::orders::OrderLine;
use super::study::OscillatorStudy;
use super::variable_step::exact_path;

pub(crate) fn discretisation(study: &OscillatorStudy) -> Picture {
    let mut figure = Figure::new(
        "exponential-error",
        "Error of Störmer–Verlet on ẍ = w²x",
        Axis::linear("wt"),
        Axis::linear("|x/exp(wt) − 1| / (wh)²"),
    );
    let growth = &study.growth[1];
    let scale = growth.wh * growth.wh;
    let scaled = |errors: &[f64]| -> Vec<(f64, f64)> {
        growth.times.iter().copied().zip(errors.iter().map(|e| e / scale)).collect()
    };
    let end = growth.times.last().copied().unwrap_or(1.0);
    for (i, (name, errors)) in [
        ("measured, x₁ = q₊", &growth.exact_start_errors),
        ("measured, Taylor start", &growth.taylor_start_errors),
    ]
    .into_iter()
    .enumerate()
    {
        figure = figure.marks(name, i, scaled(errors).into_iter().step_by(4));
    }
    for (i, (name, offset)) in
        [("theory: wt/24", 0.0), ("theory: wt/24 + 1/16", 1.0 / 16.0)].into_iter().enumerate()
    {
        let line = dense(0.0, end, 2).map(|t| (t, t / 24.0 + offset));
        figure = figure.with(Series::new(name, Look::Line(Dash::cycle(7 * i)), i, line));
    }
    Picture::new(
        figure,
        format!(
            "Relative error in units of (wh)², at wh = {}. From the growing root the line starts at zero \
             and its slope is 1/24; the Taylor start adds 1/16 once its decaying part is gone.",
            growth.wh
        ),
        "exponential-error.csv",
    )
}

pub(crate) fn variable_step(study: &OscillatorStudy) -> Vec<Picture> {
    let mut path = Figure::new(
        "variable-step",
        "A step that changes by a factor of two",
        Axis::linear("time / τ"),
        Axis::linear("x / σ"),
    )
    .with(Series::new("analytic", Look::Line(Dash::Solid), 6, exact_path()));
    let mut errors =
        log_log("variable-step-error", "Error with a changing step", "largest error of x / σ");
    for (i, run) in study.step_rules.iter().enumerate() {
        // Three of four lie on the analytic line: each shows every third point, so that all can be seen.
        let (look, first, every) = if run.method.is_none() {
            let symbol = crate::report::Symbol::cycle(i);
            (Look::LineAndPoints(Dash::Dashed, symbol), 0, 1)
        } else {
            (Look::marks(i), i, 3)
        };
        let points = run.path.iter().skip(first).step_by(every).copied();
        path = path.with(Series::new(run.rule, look, i, points));
        let name = match run.order {
            // Adding zero turns −0.00 into 0.00.
            Some(order) => {
                format!("{}: order {:.2}", run.rule, (100.0 * order).round() / 100.0 + 0.0)
            }
            None => run.rule.to_owned(),
        };
        errors = errors.joined(name, i, run.errors.iter().copied());
    }
    vec![
        Picture::new(
            path,
            "Four steps of h and four of h/2 by turns, h = 0.125 τ, ω = 1 τ⁻¹: the plain rule takes each \
             change of the step for a change of velocity.",
            "variable-step.csv",
        ),
        Picture::new(errors, "Largest error over 12 τ against the long step.", "orders.csv"),
    ]
}

fn log_log(name: &str, title: &str, y: &str) -> Figure {
    Figure::new(name, title, Axis::logarithmic("step h / τ"), Axis::logarithmic(y))
}

/// The errors as marks, each with the line of its declared order.
fn with_lines<'a>(
    mut figure: Figure,
    lines: impl Iterator<Item = (usize, &'a str, &'a OrderLine)>,
) -> Figure {
    for (i, name, line) in lines {
        let order = line.measured.map_or("rounding".to_owned(), |p| format!("order {p:.2}"));
        // The theory line goes through the error at the middle step with the declared slope.
        let (h, e) = line.errors[line.errors.len() / 2];
        let (first, last) = (line.errors[0].0, line.errors[line.errors.len() - 1].0);
        let theory = [first, last].map(|x| (x, e * (x / h).powf(line.theory)));
        if line.measured.is_some() {
            figure = figure.line("", i, theory);
        }
        let name = format!("{name}: {order}");
        figure = figure.marks(name, i, line.errors.iter().copied());
    }
    figure
}

pub(crate) fn orders(study: &OscillatorStudy) -> Vec<Picture> {
    let orders = &study.orders;
    let global = |name: &str, title: &str, y: &str, lines: &[OrderLine]| {
        let mut figure = log_log(name, title, y);
        figure.y = figure.y.from_to(1e-15, 1.0);
        let groups = study.groups.iter().enumerate();
        let of_groups = groups.filter_map(|(g, group)| {
            let first = group.first().spec.name;
            let line = lines.iter().find(|l| l.name == first)?;
            Some((g, group.name.as_str(), line))
        });
        let caption = "Largest error over 2 τ on the oscillator with ω = 1 τ⁻¹, against the step. Lines: the \
                       declared order through the middle point. Marks that level off have reached rounding.";
        Picture::new(with_lines(figure, of_groups), caption, "orders.csv")
    };
    let listed = |name: &str, title: &str, y: &str, lines: Vec<&OrderLine>, caption: &str| {
        let lines = lines.into_iter().enumerate();
        let lines = lines.map(|(i, l)| (i, l.name.as_str(), l));
        Picture::new(with_lines(log_log(name, title, y), lines), caption, "orders.csv")
    };
    vec![
        global(
            "order-positions",
            "Global error of positions",
            "largest error of x / σ",
            &orders.positions,
        ),
        global(
            "order-velocities",
            "Global error of velocities",
            "largest error of v / (σ/τ)",
            &orders.velocities,
        ),
        listed(
            "order-estimates",
            "Starts and velocity estimates of Störmer–Verlet",
            "largest error",
            orders.starts.iter().chain(&orders.velocity_estimates).collect(),
            "A2 and A5: the start with and without its acceleration term (error of x), and three velocities \
             made from positions.",
        ),
        listed(
            "order-local",
            "Local errors and energy of the Verlet family",
            "error",
            orders.local.iter().chain([&orders.energy]).collect(),
            "A7: errors of a single step from exact values, and the bound of the energy's oscillation.",
        ),
    ]
}
