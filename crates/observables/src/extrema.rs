//! Maxima and minima of a noisy curve.

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

/// Alternating maxima and minima of `y` over the equally spaced `x`, beginning with a maximum: each stands
/// out from the last one by more than `prominence` of its bin. The last one counts only if the curve has
/// come back from it by as much.
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
        let better = if rising {
            y[k] > y[best]
        } else {
            y[k] < y[best]
        };
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
    let here = Extremum {
        maximum,
        bin,
        place: x[bin],
        height: y[bin],
    };
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

#[cfg(test)]
mod tests {
    use super::*;

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
