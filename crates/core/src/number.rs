//! Numbers as people read them, in tables, figures, messages and remarks alike.
//!
//! No function here writes a number that is not finite, or more digits than say something: [`UNKNOWN`] stands in its place.

/// What stands where there is no finite number.
pub const UNKNOWN: &str = "–";

/// An exponent in superscript digits.
#[must_use]
pub fn superscript(n: i32) -> String {
    n.to_string()
        .chars()
        .map(|c| match c {
            '-' => '⁻',
            '1' => '¹',
            '2' => '²',
            '3' => '³',
            '0' | '4'..='9' => char::from_u32('⁰' as u32 + (c as u32 - '0' as u32)).unwrap_or(c),
            other => other,
        })
        .collect()
}

/// A number with so many significant digits, as `1.25·10⁻⁷` or plain between 10⁻³ and 10⁵.
///
/// [`UNKNOWN`] for a number that is not finite.
#[must_use]
pub fn significant(value: f64, digits: usize) -> String {
    if !value.is_finite() {
        return UNKNOWN.into();
    }
    if value == 0.0 {
        return "0".into();
    }
    let digits = digits.max(1);
    // Rounding first: 9.996 at three digits is 10.0, not 9.100.
    let text = format!("{:.*e}", digits - 1, value.abs());
    let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    let exponent: i32 = exponent.parse().unwrap_or(0);
    let sign = if value < 0.0 { "−" } else { "" };
    if (-3..5).contains(&exponent) {
        let decimals = usize::try_from(digits as i32 - 1 - exponent).unwrap_or(0);
        format!("{sign}{:.decimals$}", value.abs())
    } else {
        format!("{sign}{mantissa}·10{}", superscript(exponent))
    }
}

/// A number with its sign, whichever it is: `+0.0012`, `−0.010`.
#[must_use]
pub fn signed(value: f64, digits: usize) -> String {
    let text = significant(value, digits);
    if value.is_finite() && value > 0.0 { format!("+{text}") } else { text }
}

/// A number as a person writes it, with six digits at most: `0.1`, `1000`, `1e-9`.
#[must_use]
pub fn short(value: f64) -> String {
    if !value.is_finite() {
        return UNKNOWN.into();
    }
    // The shortest text of the nearest number that six digits can hold.
    let rounded = format!("{value:.5e}").parse().unwrap_or(value);
    if rounded == 0.0 || (1e-3..1e5).contains(&rounded.abs()) {
        format!("{rounded}")
    } else {
        format!("{rounded:e}")
    }
}

/// A number as short as it can be: whole numbers without a point, others with four significant digits.
#[must_use]
pub fn plain_or_scientific(value: f64) -> String {
    if value.is_finite() && value == value.trunc() && value.abs() < 1e6 {
        format!("{value:.0}").replace('-', "−")
    } else {
        significant(value, 4)
    }
}

/// A part of a whole: `12.3 %`.
#[must_use]
pub fn percent(part: f64) -> String {
    if !part.is_finite() {
        return UNKNOWN.into();
    }
    format!("{:.1} %", 100.0 * part)
}

/// A number of things: `1 thread`, `2 threads`.
#[must_use]
pub fn counted(n: usize, thing: &str) -> String {
    format!("{n} {thing}{}", if n == 1 { "" } else { "s" })
}

/// What a fluid is made of: `864 particles`, or `1000 sites in 500 molecules`.
#[must_use]
pub fn particles(sites: usize, molecules: usize) -> String {
    if sites == molecules {
        counted(sites, "particle")
    } else {
        format!("{} in {}", counted(sites, "site"), counted(molecules, "molecule"))
    }
}

/// Below this, values with errors are written with a power of ten.
const SMALL: f64 = 1e-3;

/// A value with its standard error in the last digits, `−5.4812(13)`; two digits of error. Small ones share a power of
/// ten, `−0.8(35)·10⁻⁶`.
#[must_use]
pub fn with_error(value: f64, error: f64) -> String {
    if !(value.is_finite() && error.is_finite() && error > 0.0) {
        return significant(value, 6);
    }
    let last = error.log10().floor() as i32 - 1;
    let largest = value.abs().max(error);
    let power = largest.log10().floor() as i32;
    if last - power.min(0) < -12 {
        return format!("{} ± {}", significant(value, 6), significant(error, 2));
    }
    if largest < SMALL {
        let unit = 10f64.powi(power);
        return format!("{}·10{}", with_error(value / unit, error / unit), superscript(power));
    }
    if last >= 0 {
        return format!("{}({error:.0})", fixed(value, 0));
    }
    let scaled = error / 10f64.powi(last);
    let decimals = last.unsigned_abs() as usize;
    format!("{}({scaled:.0})", fixed(value, decimals))
}

/// A number with so many decimals, and no sign where none of its digits counts.
fn fixed(value: f64, decimals: usize) -> String {
    let digits = format!("{:.decimals$}", value.abs());
    let counts = digits.contains(|c: char| c.is_ascii_digit() && c != '0');
    let sign = if value < 0.0 && counts { "−" } else { "" };
    sign.to_owned() + &digits
}

/// A value with its standard error, both to the second digit of the error: `−6.0812 ± 0.0019`; the value alone
/// where it has no error.
#[must_use]
pub fn plus_minus(value: f64, error: f64) -> String {
    if !(value.is_finite() && error.is_finite()) {
        return significant(value, 5);
    }
    if error <= 0.0 {
        return format!("{} ± –", fixed(value, 6));
    }
    let decimals = (1.0 - error.log10().floor()).clamp(0.0, 17.0) as usize;
    if decimals > 8 {
        return format!("{} ± {}", significant(value, 4), significant(error, 2));
    }
    format!("{} ± {error:.decimals$}", fixed(value, decimals))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_as_written_in_a_paper() {
        assert_eq!(significant(0.0, 3), "0");
        assert_eq!(significant(9.996, 3), "10.0");
        assert_eq!(significant(-1.25e-7, 3), "−1.25·10⁻⁷");
        assert_eq!(significant(119.760_479, 6), "119.760");
        assert_eq!(significant(123_456.0, 3), "1.23·10⁵");
        assert_eq!(short(2.117_467_066_384_583_6), "2.11747");
        assert_eq!(
            [0.0, 0.1, 1000.0, 1e-9, -2.5e7].map(short),
            ["0", "0.1", "1000", "1e-9", "-2.5e7"]
        );
        assert_eq!(plain_or_scientific(-864.0), "−864");
        assert_eq!(superscript(-1_234_567_890), "⁻¹²³⁴⁵⁶⁷⁸⁹⁰");
    }

    #[test]
    fn no_function_writes_a_number_that_is_not_finite() {
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            assert_eq!(significant(bad, 3), UNKNOWN);
            assert_eq!(signed(bad, 3), UNKNOWN);
            assert_eq!(plain_or_scientific(bad), UNKNOWN);
            assert_eq!(percent(bad), UNKNOWN);
            assert_eq!(short(bad), UNKNOWN);
            assert_eq!(with_error(bad, 0.1), UNKNOWN);
            assert_eq!(plus_minus(bad, 0.1), UNKNOWN);
            assert_eq!(with_error(0.5599, bad), "0.559900");
            assert_eq!(plus_minus(0.5599, bad), "0.55990");
        }
    }

    #[test]
    fn one_thing_is_no_plural() {
        assert_eq!([0, 1, 2].map(|n| counted(n, "thread")), ["0 threads", "1 thread", "2 threads"]);
    }

    #[test]
    fn a_value_is_shown_to_the_second_digit_of_its_error() {
        for (value, error, text) in [
            (-6.081_234, 0.001_94, "−6.0812 ± 0.0019"),
            (-0.004, 0.51, "0.00 ± 0.51"),
            (0.164_9, 0.032, "0.165 ± 0.032"),
            (108.9, 12.0, "109 ± 12"),
            (1.0, f64::NAN, "1.0000"),
            (1.0, 0.0, "1.000000 ± –"),
            (1.0, 1e-14, "1.000 ± 1.0·10⁻¹⁴"),
        ] {
            assert_eq!(plus_minus(value, error), text);
        }
    }

    #[test]
    fn errors_stand_in_the_last_two_digits() {
        assert_eq!(with_error(-5.481_23, 0.001_27), "−5.4812(13)");
        assert_eq!(with_error(1234.0, 25.0), "1234(25)");
        assert_eq!(with_error(-0.04, 3.5), "0.0(35)");
        assert_eq!(with_error(1.5, 0.0), "1.50000");
        assert_eq!(with_error(-8.3e-7, 3.5e-6), "−0.8(35)·10⁻⁶");
        assert_eq!(with_error(2.5e-4, 1.2e-5), "2.50(12)·10⁻⁴");
        assert_eq!(with_error(0.0012, 0.0005), "0.00120(50)");
        assert_eq!(with_error(1.5, 1e-14), "1.50000 ± 1.0·10⁻¹⁴");
    }
}
