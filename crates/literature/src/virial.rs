//! Virial coefficients of Mie potentials, and the virial series as an equation of state of dilute gases.

use std::f64::consts::PI;
use std::sync::Mutex;

use crate::equation::{EquationOfState, EquationSpec, OwnUncertainty, Range};
use crate::fluid_state::CriticalPoint;
use crate::jet::Jet;
use crate::made::Made;
use crate::model::{is_lennard_jones, thol_2016};
use crate::phase::Phase;
use crate::pohl::pohl_2023;
use crate::saturation::Saturation;

/// The densities that the series with two coefficients is offered for, σ⁻³.
const HIGHEST_DENSITY: f64 = 0.04;
const TEMPERATURES: [f64; 2] = [0.66, 20.0];

/// A Mie potential C(r⁻ⁿ − r⁻ᵐ) with C = (n/(n − m))(n/m)^{m/(n − m)}; n = 12 and m = 6 is Lennard-Jones.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mie {
    /// The exponent n of the repulsion.
    pub repulsive: f64,
    /// The exponent m of the attraction, above 3 and below n.
    pub attractive: f64,
}

impl Mie {
    /// The Lennard-Jones potential.
    pub const LENNARD_JONES: Self = Self { repulsive: 12.0, attractive: 6.0 };

    fn strength(self) -> f64 {
        let (n, m) = (self.repulsive, self.attractive);
        n / (n - m) * (n / m).powf(m / (n - m))
    }

    fn energy(self, r: f64) -> f64 {
        self.strength() * (r.powf(-self.repulsive) - r.powf(-self.attractive))
    }

    /// The second virial coefficient B₂ in σ³ with its first and second derivatives in β = 1/T:
    ///
    /// B₂ = −(2π/n) Σ_{i≥0} a^{3/n + i(1 − m/n)} Γ((mi − 3)/n)/i!, a = Cβ.
    ///
    /// The series converges for every temperature. For 12-6 its sum is
    /// (√2π²/3)β e^y (I_{−3/4} + I_{3/4} − I_{1/4} − I_{−1/4})(y), y = β/2.
    #[must_use]
    pub fn second_virial(self, beta: Jet) -> Jet {
        const MOST_TERMS: u32 = 400;
        let (n, m) = (self.repulsive, self.attractive);
        let a = beta * self.strength();
        let mut sum = Jet::constant(0.0);
        let mut inverse_factorial = 1.0;
        for i in 0..MOST_TERMS {
            let i = f64::from(i);
            if i > 0.0 {
                inverse_factorial /= i;
            }
            let gamma = libm::tgamma((m * i - 3.0) / n);
            let term = a.powf(3.0 / n + i * (1.0 - m / n)) * (gamma * inverse_factorial);
            sum += term;
            let negligible = |term: f64, sum: f64| term.abs() <= 1e-17 * sum.abs();
            if i > 4.0 && negligible(term.value, sum.value) && negligible(term.xx, sum.xx) {
                break;
            }
        }
        sum * (-2.0 * PI / n)
    }

    /// The third virial coefficient B₃ in σ⁶ with its first and second derivatives in β = 1/T.
    ///
    /// With the Mayer function f = e^{−βu} − 1 and F(x) = ∫₀ˣ f(t) t dt,
    ///
    /// B₃ = −(8π²/3) ∫∫ r f(r) s f(s) [F(r + s) − F(|r − s|)] dr ds,
    ///
    /// which is −(1/3)∫∫ f₁₂ f₁₃ f₂₃ in bipolar coordinates. Derivatives have ∂f/∂β = −u e^{−βu} in the place of one
    /// f. The integrands are even in r and s, so that sums over equal steps converge faster than any power of the step.
    /// What lies beyond the reach of the integral is below 10⁻⁷ of the sum.
    #[must_use]
    pub fn third_virial(self, beta: f64) -> Jet {
        ThirdVirial::at(self, beta)
    }
}

/// The sums of the third virial coefficient.
struct ThirdVirial;

impl ThirdVirial {
    /// The largest distance, σ.
    const REACH: f64 = 12.0;
    const STEPS: usize = 900;

    fn at(potential: Mie, beta: f64) -> Jet {
        let h = Self::REACH / Self::STEPS as f64;
        // f, ∂f/∂β and ∂²f/∂β², each times r.
        let mayer = |r: f64| -> [f64; 3] {
            let u = if r > 0.0 { potential.energy(r) } else { f64::INFINITY };
            // Where e^{−βu} underflows, so do its products with u.
            if beta * u > 700.0 {
                return [-r, 0.0, 0.0];
            }
            let boltzmann = (-beta * u).exp();
            [r * (-beta * u).exp_m1(), -r * u * boltzmann, r * u * u * boltzmann]
        };
        let at: Vec<[f64; 3]> = (1..Self::STEPS).map(|k| mayer(k as f64 * h)).collect();
        // Integrals of f·t and of ∂f/∂β·t up to each multiple of the step, by four Gauss points a step.
        let mut integrals = vec![[0.0; 2]; 2 * Self::STEPS];
        for k in 1..integrals.len() {
            let middle = (k as f64 - 0.5) * h;
            let mut step = [0.0; 2];
            for (x, weight) in [
                (0.339_981_043_584_856_26, 0.652_145_154_862_546_1),
                (0.861_136_311_594_052_6, 0.347_854_845_137_453_86),
            ] {
                for side in [-1.0, 1.0] {
                    let values = mayer(middle + 0.5 * h * side * x);
                    step[0] += 0.5 * h * weight * values[0];
                    step[1] += 0.5 * h * weight * values[1];
                }
            }
            integrals[k] = [integrals[k - 1][0] + step[0], integrals[k - 1][1] + step[1]];
        }
        // The form is symmetric in its three functions: T(f, f, f), T(f′, f, f), T(f″, f, f), T(f′, f′, f).
        let mut forms = [0.0; 4];
        for (i, a) in at.iter().enumerate() {
            let mut row = [0.0; 3];
            for (j, b) in at.iter().enumerate() {
                let (sum, difference) = (i + j + 2, i.abs_diff(j));
                let g = integrals[sum][0] - integrals[difference][0];
                row[0] += b[0] * g;
                row[1] += b[1] * g;
            }
            forms[0] += a[0] * row[0];
            forms[1] += a[1] * row[0];
            forms[2] += a[2] * row[0];
            forms[3] += a[1] * row[1];
        }
        let factor = -8.0 * PI * PI / 3.0 * h * h;
        Jet {
            value: factor * forms[0],
            x: factor * 3.0 * forms[1],
            xx: factor * (3.0 * forms[2] + 6.0 * forms[3]),
            ..Jet::constant(0.0)
        }
    }
}

/// The virial series a_res/T = B₂ρ + B₃ρ²/2 with exact coefficients: the better judge of a dilute gas.
#[derive(Debug)]
pub struct VirialSeries {
    spec: EquationSpec,
    potential: Mie,
    /// The last third coefficient with its β: states of one temperature follow each other.
    last: Mutex<Option<(f64, Jet)>>,
}

impl VirialSeries {
    fn new(potential: Mie) -> Self {
        let (n, m) = (potential.repulsive, potential.attractive);
        let model = if is_lennard_jones(n, m) {
            "full Lennard-Jones potential, dilute gas".to_owned()
        } else {
            format!("full Mie potential with exponents {n} and {m}, dilute gas")
        };
        Self {
            spec: EquationSpec {
                key: "virial".into(),
                name: "virial series".into(),
                model,
                citation: "B₂ by its exact series and B₃ by quadrature (J. E. Mayer and M. G. Mayer, Statistical Mechanics, 1940, chapter 13)".into(),
                doi: String::new(),
                status: "computed here; B₂ beside its closed form in Bessel functions and B₃ beside an independent sine transform, to six digits and more".into(),
                superseded: None,
                range: Range {
                    t_min: TEMPERATURES[0],
                    t_max: TEMPERATURES[1],
                    p_max: f64::MAX,
                    rho_max: Some(HIGHEST_DENSITY),
                    status: "densities at which the third coefficient is small beside the second".into(),
                },
                uncertainty: None,
                // A series of a gas has none.
                critical: CriticalPoint {
                    temperature: 0.0,
                    density: f64::MAX,
                },
            },
            potential,
            last: Mutex::new(None),
        }
    }

    /// B₂ in σ³ and B₃ in σ⁶ at a temperature in ε/k_B, with derivatives in β.
    #[must_use]
    pub fn coefficients(&self, temperature: f64) -> [Jet; 2] {
        let beta = 1.0 / temperature;
        [self.potential.second_virial(Jet::first(beta)), self.third(beta)]
    }

    fn third(&self, beta: f64) -> Jet {
        let mut last = self.last.lock().expect("no thread panics while it holds this");
        match *last {
            Some((at, found)) if at == beta => found,
            _ => last.insert((beta, self.potential.third_virial(beta))).1,
        }
    }

    /// The equation that knows where the gas condenses.
    fn condensing(&self) -> Option<&'static dyn EquationOfState> {
        let (n, m) = (self.potential.repulsive, self.potential.attractive);
        if is_lennard_jones(n, m) {
            return Some(thol_2016());
        }
        let pohl = pohl_2023(n).filter(|_| m == Mie::LENNARD_JONES.attractive)?;
        Some(pohl)
    }
}

impl EquationOfState for VirialSeries {
    fn spec(&self) -> &EquationSpec {
        &self.spec
    }

    fn residual(&self, beta: Jet, rho: Jet) -> Jet {
        let third = self.third(beta.value);
        // The chain rule for the third coefficient, whose derivatives are in β.
        let third = beta.map(third.value, third.x, third.xx);
        rho * self.potential.second_virial(beta) + rho.powi(2) * third * 0.5
    }

    /// The next terms of the series, as large as other equations have them.
    fn uncertainty(&self, rho: f64, temperature: f64) -> Option<OwnUncertainty> {
        let equation = self.condensing()?;
        let at = |rho: f64| equation.residual(Jet::first(1.0 / temperature), Jet::second(rho));
        let (zero, here) = (at(0.0), at(rho));
        let h = 1e-4;
        let third = (at(h).xy - zero.xy) / h;
        let energy = here.x - rho * zero.xy - 0.5 * rho * rho * third;
        let pressure = rho * temperature * rho * (here.y - zero.y - rho * zero.yy);
        Some(OwnUncertainty {
            potential_energy: energy.abs(),
            pressure: pressure.abs(),
            status: format!("the terms beyond B₃ in {}", equation.spec().name),
        })
    }

    fn freezing_density(&self, _temperature: f64) -> Option<f64> {
        None
    }

    /// A series of a gas has no liquid.
    fn saturation(&self, _temperature: f64) -> Option<Saturation> {
        None
    }

    /// As another equation of the same potential has it: the series itself does not condense.
    fn phase(&self, rho: f64, temperature: f64) -> Phase {
        if self.check(rho, temperature).is_err() {
            return Phase::OutsideRange;
        }
        self.condensing().map_or(Phase::Gas, |e| e.phase(rho, temperature))
    }
}

/// The virial series of a full Mie potential.
///
/// Each potential makes one equation, which stays for the rest of the program.
#[must_use]
pub fn virial_series(potential: Mie) -> &'static VirialSeries {
    static MADE: Made<2, VirialSeries> = Made::new();
    MADE.for_parameters([potential.repulsive, potential.attractive], || {
        VirialSeries::new(potential)
    })
}
