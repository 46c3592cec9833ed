//! Numbers as text, appended to a buffer of bytes.

/// Appends the shortest text that reads back to the same bits. It always holds a point or an
/// exponent, so that readers which try integers first still see a floating-point number.
///
/// `value` must be finite: callers check, since they can say whose number it is.
#[inline]
pub(crate) fn push_float(to: &mut Vec<u8>, value: f64) {
    to.extend_from_slice(zmij::Buffer::new().format_finite(value).as_bytes());
}

/// Appends the shortest text, and `nan`, `inf` or `-inf` where the number is not finite.
pub(crate) fn push_any_float(to: &mut Vec<u8>, value: f64) {
    if value.is_finite() {
        push_float(to, value);
    } else if value.is_nan() {
        to.extend_from_slice(b"nan");
    } else {
        to.extend_from_slice(if value > 0.0 { b"inf" } else { b"-inf" });
    }
}

/// Appends an integer without point or exponent.
#[inline]
pub(crate) fn push_integer(to: &mut Vec<u8>, value: impl itoa::Integer) {
    to.extend_from_slice(itoa::Buffer::new().format(value).as_bytes());
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn float(value: f64) -> String {
        let mut to = Vec::new();
        push_float(&mut to, value);
        String::from_utf8(to).unwrap()
    }

    #[test]
    fn whole_numbers_keep_a_point() {
        assert_eq!(float(1.0), "1.0");
        assert_eq!(float(-0.0), "-0.0");
        assert_eq!(float(864.0), "864.0");
    }

    proptest! {
        #[test]
        fn every_finite_number_reads_back_to_the_same_bits(bits in any::<u64>()) {
            let value = f64::from_bits(bits);
            prop_assume!(value.is_finite());
            let text = float(value);
            prop_assert_eq!(text.parse::<f64>().unwrap().to_bits(), bits);
            prop_assert!(text.contains(['.', 'e']), "{} would be read as an integer", text);
        }
    }
}
