//! Maxima and minima of a noisy curve.

use glam::{DMat4, DVec4};

/// A maximum or a minimum.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Extremum {
    pub maximum: bool,
    /// Index of the highest or lowest point.
    pub bin: usize,
    /// Place and height of the vertex of the parabola through it and its neighbors.
    pub place: f64,
    pub height: f64,
}

/// Alternating maxima and minima of `y` over the equally spaced `x`, beginning with a maximum. Each
/// extremum differs from the one before by more than `prominence` of its bin. The last extremum counts
/// only if the curve has come back from it by as much.
pub(crate) fn extrema(x: &[f64], y: &[f64], prominence: impl Fn(usize) -> f64) -> Vec<Extremum> {
    let mut found = Vec::new();
    let mut rising = true;
    let mut best = 0;
    let mut lowest_before_rise = 0;
    for k in 0..y.len() {
        if found.is_empty() && rising && y[k] < y[lowest_before_rise] {
            lowest_before_rise = k;
            best = k;
        }
        let better = if rising { y[k] > y[best] } else { y[k] < y[best] };
        if better {
            best = k;
        } else if (y[k] - y[best]).abs() > prominence(best) {
            // A first maximum must have been climbed: the noise at small r is none.
            let climbed = !found.is_empty() || y[best] - y[lowest_before_rise] > prominence(best);
            if climbed {
                found.push(vertex(x, y, best, rising));
                rising = !rising;
            }
            best = k;
        }
    }
    found
}

fn vertex(x: &[f64], y: &[f64], bin: usize, maximum: bool) -> Extremum {
    let here = Extremum { maximum, bin, place: x[bin], height: y[bin] };
    if bin == 0 || bin + 1 >= y.len() {
        return here;
    }
    let (left, middle, right) = (y[bin - 1], y[bin], y[bin + 1]);
    let curvature = left - 2.0 * middle + right;
    if curvature == 0.0 {
        return here;
    }
    let shift = (0.5 * (left - right) / curvature).clamp(-0.5, 0.5);
    Extremum {
        place: x[bin] + shift * (x[bin + 1] - x[bin]),
        height: middle - 0.25 * (left - right) * shift,
        ..here
    }
}

/// A place and a height.
pub(crate) type Vertex = (f64, f64);

/// The maximum or minimum near `start`: the vertex of a cubic. The cubic is fitted within `half_width` of its own vertex,
/// and the window follows the vertex until it rests. `None` where the points near `start` have no such vertex.
///
/// Points count with (1 − u²)² at a distance u·half_width from the centre, so that no point enters or leaves the window
/// with a jump. The vertex is therefore a smooth function of the data. The lowest of many noisy points is not smooth, and
/// lies too low.
pub(crate) fn fitted_extremum(
    x: &[f64],
    y: &[f64],
    start: f64,
    half_width: f64,
    maximum: bool,
) -> Option<Vertex> {
    /// The window follows the vertex so many times at most.
    const MOVES: usize = 100;
    /// It rests where it moves by less than this part of its half width.
    const AT_REST: f64 = 1e-7;
    let mut found = (start, f64::NAN);
    for _ in 0..MOVES {
        let centre = found.0;
        found = fitted_vertex(x, y, centre, half_width, maximum)?;
        if (found.0 - centre).abs() < AT_REST * half_width {
            break;
        }
    }
    // A start is near: what has wandered off is another extremum.
    ((found.0 - start).abs() <= 2.0 * half_width).then_some(found)
}

/// The maximum or minimum of the cubic fitted within `half_width` of `centre`; `None` where it has none there.
fn fitted_vertex(
    x: &[f64],
    y: &[f64],
    centre: f64,
    half_width: f64,
    maximum: bool,
) -> Option<Vertex> {
    let [a, b, c, d] = cubic(x, y, centre, half_width)?;
    // a + bu + cu² + du³ with u from −1 to 1: b + 2cu + 3du² = 0, the root that is a small change of −b/2c.
    let discriminant = c * c - 3.0 * b * d;
    if discriminant < 0.0 || (c < 0.0) != maximum {
        return None;
    }
    let u = -b / (c + c.signum() * discriminant.sqrt());
    (u.abs() <= 1.5).then_some((centre + u * half_width, a + u * (b + u * (c + u * d))))
}

/// The mean of `y` over the points within `half_width` of each.
pub(crate) fn smoothed(x: &[f64], y: &[f64], half_width: f64) -> Vec<f64> {
    let near = |centre: f64| {
        let from = x.partition_point(|x| *x < centre - half_width);
        let to = x.partition_point(|x| *x <= centre + half_width);
        from..to
    };
    x.iter()
        .map(|x| {
            let points = &y[near(*x)];
            points.iter().sum::<f64>() / points.len() as f64
        })
        .collect()
}

/// Coefficients of the cubic in u = (x − centre)/half_width; `None` for fewer than five points.
fn cubic(x: &[f64], y: &[f64], centre: f64, half_width: f64) -> Option<[f64; 4]> {
    let (mut moments, mut products, mut points) = ([0.0; 7], [0.0; 4], 0);
    for (x, y) in x.iter().zip(y) {
        let u = (x - centre) / half_width;
        if u.abs() > 1.0 || !y.is_finite() {
            continue;
        }
        points += 1;
        let mut power = (1.0 - u * u).powi(2);
        for k in 0..7 {
            moments[k] += power;
            if k < 4 {
                products[k] += power * y;
            }
            power *= u;
        }
    }
    if points < 5 {
        return None;
    }
    let row = |k: usize| DVec4::new(moments[k], moments[k + 1], moments[k + 2], moments[k + 3]);
    let matrix = DMat4::from_cols(row(0), row(1), row(2), row(3));
    let solved = matrix.inverse() * DVec4::from_array(products);
    solved.is_finite().then(|| solved.to_array())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fitted_minimum_is_that_of_a_cubic_and_ripples_do_not_move_it() {
        let x: Vec<f64> = (0..200).map(|k| 0.01 * f64::from(k)).collect();
        let cubic = |x: f64| 0.5 + (x - 1.0).powi(2) + 0.4 * (x - 1.0).powi(3);
        let y: Vec<f64> = x.iter().map(|x| cubic(*x)).collect();
        let fitted = |y: &[f64], start: f64| fitted_extremum(&x, y, start, 0.2, false);
        let (place, height) = fitted(&y, 1.2).unwrap();
        assert!((place - 1.0).abs() < 1e-8 && (height - 0.5).abs() < 1e-12);
        let rippled: Vec<f64> =
            y.iter().enumerate().map(|(k, y)| y + if k % 2 == 0 { 0.01 } else { -0.01 }).collect();
        let (place, _) = fitted(&rippled, 1.15).unwrap();
        assert!((place - 1.0).abs() < 0.01, "{place}");
        assert_eq!(fitted_extremum(&x, &y, 1.0, 0.2, true), None);
        assert_eq!(fitted_extremum(&x[..3], &y[..3], 0.0, 0.2, false), None);
        let means = smoothed(&x, &rippled, 0.015);
        assert!((means[50] - rippled[49..=51].iter().sum::<f64>() / 3.0).abs() < 1e-12);
    }

    #[test]
    fn extrema_of_a_damped_wave_are_found_and_ripples_are_not() {
        let x: Vec<f64> = (0..400).map(|k| 0.02 * f64::from(k)).collect();
        let y: Vec<f64> = x
            .iter()
            .enumerate()
            .map(|(k, x)| (-0.3 * x).exp() * (2.0 * x).sin() + if k % 2 == 0 { 0.004 } else { 0.0 })
            .collect();
        let found = extrema(&x, &y, |_| 0.05);
        // Extrema where tan 2x = 2/0.3: x = ½·atan(6.667) + kπ/2, of height exp(−0.3x)·sin 2x.
        for (k, e) in found.iter().enumerate() {
            let exact = 0.5 * (2.0_f64 / 0.3).atan() + k as f64 * std::f64::consts::FRAC_PI_2;
            assert!((e.place - exact).abs() < 0.07, "{} {exact}", e.place);
            assert_eq!(e.maximum, k % 2 == 0);
        }
        assert_eq!(found.len(), 5);
    }

    #[test]
    fn a_parabola_gives_its_vertex_exactly() {
        let x: Vec<f64> = (0..11).map(|k| 0.1 * f64::from(k)).collect();
        let y: Vec<f64> = x.iter().map(|x| 1.0 - (x - 0.53).powi(2)).collect();
        let found = extrema(&x, &y, |_| 0.01);
        assert!((found[0].place - 0.53).abs() < 1e-12);
        assert!((found[0].height - 1.0).abs() < 1e-12);
    }
}
