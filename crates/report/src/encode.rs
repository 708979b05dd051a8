//! Arrays of numbers as text: base64 of integers of 16 or 32 bits, little-endian.

use nastic_io::base64;
use serde_json::{Value, json};

/// The integer of a value that is not finite.
const NONE: u16 = u16::MAX;
/// The integer of the largest value.
const MOST: f64 = 65534.0;

/// Numbers, `components` at a time, rounded to 65535 steps between the least and the largest of each component:
/// x = low + (high - low) q / 65534, q = 65535 where there is no finite value. The error is at most 8e-6 of the range.
pub(crate) fn quantised(values: &[f64], components: usize) -> Value {
    let (mut low, mut high) = (vec![f64::INFINITY; components], vec![f64::NEG_INFINITY; components]);
    for tuple in values.chunks_exact(components) {
        for (k, x) in tuple.iter().enumerate().filter(|(_, x)| x.is_finite()) {
            (low[k], high[k]) = (low[k].min(*x), high[k].max(*x));
        }
    }
    for k in 0..components {
        if low[k] > high[k] {
            (low[k], high[k]) = (0.0, 0.0);
        }
    }
    let mut bytes = Vec::with_capacity(2 * values.len());
    for tuple in values.chunks_exact(components) {
        for (k, x) in tuple.iter().enumerate() {
            let range = high[k] - low[k];
            let share = if range > 0.0 { (x - low[k]) / range } else { 0.0 };
            let q = if x.is_finite() { (share.clamp(0.0, 1.0) * MOST).round() as u16 } else { NONE };
            bytes.extend(q.to_le_bytes());
        }
    }
    json!({ "low": low, "high": high, "data": base64(&bytes) })
}

/// Indices.
pub(crate) fn indices(values: impl IntoIterator<Item = u32>) -> Value {
    let bytes: Vec<u8> = values.into_iter().flat_map(u32::to_le_bytes).collect();
    Value::from(base64(&bytes))
}

/// Bytes that an encoded array takes in the page.
pub(crate) fn size(array: &Value) -> usize {
    array["data"].as_str().or(array.as_str()).map_or(0, str::len)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantised_values_come_back_within_a_step() {
        let array = quantised(&[-1.0, 5.0, 2.0, 5.0, 0.0, f64::NAN], 2);
        assert_eq!(array["low"], json!([-1.0, 5.0]));
        assert_eq!(array["high"], json!([2.0, 5.0]));
        // 0, 65534, 21844.67 and, constant, 0 and none: little-endian pairs.
        assert_eq!(array["data"], base64(&[0, 0, 0, 0, 0xfe, 0xff, 0, 0, 0x55, 0x55, 0xff, 0xff]));
    }
}
