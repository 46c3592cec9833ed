//! What can be typed after `lennard eos`.

use clap::Args;
use lennard_literature::units::split;

/// Arguments of `eos`.
#[derive(Debug, Args)]
#[command(arg_required_else_help = true)]
pub struct EosArgs {
    /// Equations by name (`lennard list equations-of-state`); by default all for the full Lennard-Jones potential.
    #[arg(value_name = "EQUATION")]
    pub equations: Vec<String>,
    /// Temperatures, ε/k_B: a number, a list such as 0.8,1.0, or a range FROM:TO:STEP; with a substance also 94K, 85:95:5K.
    /// Alone: vapor and liquid side by side.
    #[arg(long, short = 'T', value_name = "VALUES", value_parser = values, allow_hyphen_values = true)]
    pub temperature: Option<Values>,
    /// Densities, σ⁻³, in the same form.
    #[arg(long, short = 'd', value_name = "VALUES", value_parser = values, allow_hyphen_values = true, conflicts_with = "pressure")]
    pub density: Option<Values>,
    /// Pressures, ε/σ³, in the place of densities: the stable fluid there.
    #[arg(long, short = 'p', value_name = "VALUES", value_parser = values, allow_hyphen_values = true)]
    pub pressure: Option<Values>,
    /// Vapor and liquid side by side, at the temperatures or from the lowest to the critical one.
    #[arg(long, conflicts_with_all = ["density", "pressure", "properties"])]
    pub saturation: bool,
    /// Liquid and crystal side by side, with the triple point, by the freezing lines of the model. Temperatures go up to twice the
    /// critical one where none are named.
    #[arg(long, conflicts_with_all = ["density", "pressure", "properties", "saturation"])]
    pub freezing: bool,
    /// The substance that numbers with units are of; results have both units then.
    #[arg(long, value_name = "NAME")]
    pub substance: Option<String>,
    /// Properties by name, such as pressure,speed_of_sound; by default all of a single state, and a few of a curve.
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    pub properties: Vec<String>,
    /// Exponents of the Mie potential of `pohl-2023` and `virial`.
    #[arg(long, value_name = "N,M", value_delimiter = ',', num_args = 1, default_values_t = [12.0, 6.0])]
    pub exponents: Vec<f64>,
    /// Length of the bond of the two-center equations, σ.
    #[arg(long, value_name = "L", default_value_t = 0.67)]
    pub bond: f64,
    /// One JSON document on standard output, nothing else.
    #[arg(long)]
    pub json: bool,
}

/// Numbers that were typed, and the unit of all of them; empty for reduced units.
#[derive(Debug, Clone, PartialEq)]
pub struct Values {
    pub numbers: Vec<f64>,
    pub unit: String,
}

/// A range has no more values than this.
const MOST_VALUES: f64 = 10_000.0;

fn values(text: &str) -> Result<Values, String> {
    let wanted =
        "wanted a number, a list such as 0.8,1.0, or a range FROM:TO:STEP such as 0.7:1.3:0.05";
    // The unit stands behind the last number at least.
    let last = text.rsplit([',', ':']).next().unwrap_or_default();
    let unit = split(last).map_or("", |(_, unit)| unit);
    let number = |text: &str| match split(text) {
        Some((x, found)) if x.is_finite() && (found.is_empty() || found == unit) => Ok(x),
        Some((_, found)) if found != unit => {
            Err(format!("`{}` has the unit {found}, and the last number has not", text.trim()))
        }
        _ => Err(format!("`{}` is no finite number; {wanted}", text.trim())),
    };
    let with_unit = |numbers| Values { numbers, unit: unit.to_owned() };
    let parts: Vec<&str> = text.split(':').collect();
    match parts[..] {
        [list] => list.split(',').map(number).collect::<Result<_, _>>().map(with_unit),
        [from, to, step] => {
            let (from, to, step) = (number(from)?, number(to)?, number(step)?);
            // The last value counts where it is reached up to rounding.
            let steps = ((to - from) / step + 1e-9).floor();
            if !(step > 0.0 && steps >= 0.0) {
                return Err(format!(
                    "the range goes from {from} to {to} in steps of {step}; {wanted}"
                ));
            }
            if steps >= MOST_VALUES {
                return Err(format!(
                    "the range has {steps} steps; at most {MOST_VALUES} are taken"
                ));
            }
            Ok(with_unit((0..=steps as u64).map(|i| from + i as f64 * step).collect()))
        }
        _ => Err(wanted.into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_lists_and_ranges_are_read_and_others_are_not() {
        for (text, expected, unit) in [
            ("0.7", vec![0.7], ""),
            ("0.8, 1", vec![0.8, 1.0], ""),
            ("1:2:0.5", vec![1.0, 1.5, 2.0], ""),
            ("0.7:0.75:0.1", vec![0.7], ""),
            ("94K", vec![94.0], "K"),
            ("90, 94 K", vec![90.0, 94.0], "K"),
            ("85:95:5K", vec![85.0, 90.0, 95.0], "K"),
            ("85K:95K:5K", vec![85.0, 90.0, 95.0], "K"),
            ("1.374 g/cm3", vec![1.374], "g/cm3"),
        ] {
            let unit = unit.to_owned();
            assert_eq!(values(text), Ok(Values { numbers: expected, unit }), "{text}");
        }
        // Rounding leaves out no last value.
        assert_eq!(values("0.1:0.7:0.1").unwrap().numbers.len(), 7);
        let others = "|a|1:2|2:1:0.1|1:2:0|1:2:-1|nan|0:1:1e-9|1:2:3:4|90K,94bar|90K,94";
        for text in others.split('|') {
            assert!(values(text).is_err(), "{text}");
        }
    }
}
