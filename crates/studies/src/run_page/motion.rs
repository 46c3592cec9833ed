//! The figures of motion and transport on a run's page.

use crate::report::{Axis, Dash, Figure, Guide, Look, Picture, Series, significant};

use super::figures::{LINE, MARKS, curve, said_of, series, with_errors};
use crate::compare::RunFolder;

pub(super) const MOTION: &str = "Mean-square displacement, velocity autocorrelation, and the correlations of stress and heat flux whose integrals are the viscosity and the \
     conductivity.";

/// The diffusion coefficient by the integral of the velocity autocorrelation.
const GREEN_KUBO: &str = "diffusion_coefficient_green_kubo";

/// A level at a mean of the run, with a word beside it that says whether the mean is a result.
fn level_at(run: &RunFolder, figure: Figure, average: &str, word: &str) -> Figure {
    match run.average(average) {
        Some(a) if a.standard_error.is_finite() => figure.level(a.mean, word),
        Some(a) => figure.level(a.mean, format!("{word}: no result")),
        None => figure,
    }
}

/// Mean-square displacement, velocity autocorrelation, Green–Kubo integrals.
pub(super) fn motion(run: &RunFolder) -> Vec<Picture> {
    let viscosity = ["shear_viscosity", "shear viscosity", "η / (ετ/σ³)"];
    let conductivity = ["thermal_conductivity", "thermal conductivity", "λ / (k_B/(στ))"];
    [
        displacement(run),
        autocorrelation(run),
        running_integral(run),
        green_kubo(run, viscosity),
        green_kubo(run, conductivity),
    ]
    .into_iter()
    .flatten()
    .collect()
}

/// The names of the diffusion coefficient as measured, and corrected for finite size. The second is empty where the run has no
/// correction.
fn diffusion(run: &RunFolder) -> [&'static str; 2] {
    const CORRECTED: &str = "diffusion_coefficient";
    const PLAIN: &str = "diffusion_coefficient_uncorrected";
    match run.average(PLAIN) {
        Some(_) => [PLAIN, CORRECTED],
        None => [CORRECTED, ""],
    }
}

fn displacement(run: &RunFolder) -> Option<Picture> {
    let table = run.table("msd")?;
    let shown = |column: &str| {
        let mut curve = curve(&table, "time", column)?;
        curve.retain(|(t, x)| *t > 0.0 && *x > 0.0);
        Some(curve)
    };
    let mut figure = Figure::new(
        "msd",
        "Mean-square displacement",
        Axis::logarithmic("lag / τ"),
        Axis::logarithmic("⟨|r(t) − r(0)|²⟩ / σ²"),
    )
    .with(Series::new("measured", LINE, 0, shown("msd")?));
    let mut caption = "No straight part was found: the run is too short.".to_owned();
    if let Some(fit) = shown("fit").filter(|fit| fit.len() > 1) {
        let (from, to) = (fit[0].0, fit[fit.len() - 1].0);
        let [plain, corrected] = diffusion(run);
        caption = format!(
            "The dashed line is fitted from {} to {} τ.{}{}",
            significant(from, 3),
            significant(to, 3),
            said_of(run, plain, " A sixth of its slope: D = {} σ²/τ in this box."),
            said_of(run, corrected, " Corrected for finite size (Yeh and Hummer): D = {} σ²/τ."),
        );
        let look = Look::Line(Dash::Dashed);
        figure = figure
            .with(Series::new("fit", look, 1, fit))
            .guided(Guide::Vertical(from, "fit".into()))
            .guided(Guide::Vertical(to, String::new()));
    }
    Some(Picture::new(figure, caption, "msd.csv"))
}

fn autocorrelation(run: &RunFolder) -> Option<Picture> {
    let c = curve(&run.table("vacf")?, "time", "normalised")?;
    let figure = Figure::new(
        "vacf",
        "Velocity autocorrelation",
        Axis::linear("lag / τ"),
        Axis::linear("C(t)/C(0)"),
    )
    .with(series(LINE, c))
    .level(0.0, "");
    let integral = "A third of its integral: D = {} σ²/τ in this box";
    let mut caption = said_of(run, GREEN_KUBO, integral);
    let [plain, _] = diffusion(run);
    caption += &said_of(run, plain, "; the slope of the displacement gives {}");
    if !caption.is_empty() {
        caption += ". Neither is corrected for finite size.";
    }
    Some(Picture::new(figure, caption, "vacf.csv"))
}

fn running_integral(run: &RunFolder) -> Option<Picture> {
    let integral = curve(&run.table("vacf")?, "time", "diffusion")?;
    let figure = Figure::new(
        "vacf_integral",
        "Running integral of the velocity autocorrelation",
        Axis::linear("upper limit / τ"),
        Axis::linear("D(t) / (σ²/τ)"),
    )
    .with(series(LINE, integral));
    let figure = level_at(run, figure, GREEN_KUBO, "D in this box");
    Some(Picture::new(figure, "", "vacf.csv"))
}

fn green_kubo(run: &RunFolder, [name, words, label]: [&str; 3]) -> Option<Picture> {
    let columns = ["time", "integral", "integral_standard_error"];
    let points = with_errors(&run.table(name)?, columns)?;
    let mut figure = Figure::new(
        name,
        format!("Green–Kubo integral of the {words}"),
        Axis::linear("upper limit / τ"),
        Axis::linear(label),
    )
    .with(series(MARKS, points));
    let mut caption = "No plateau was found.".to_owned();
    if let Some(a) = run.average(name) {
        figure = level_at(run, figure, name, "plateau");
        caption = said_of(run, name, &format!("Plateau {{}} {}.", a.unit));
    }
    Some(Picture::new(figure, caption, format!("{name}.csv")))
}
