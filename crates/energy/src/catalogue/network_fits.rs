//! The numbers of networks that fits find.

use super::fit_form::{FitForm, FitNumber, FitStarts, Free, NetworkShape};
use crate::network::NetworkInput::{FirstIsochoric, SecondIsochoric};

const INPUTS: &[crate::network::NetworkInput] = &[FirstIsochoric, SecondIsochoric];

const fn network(suffix: &'static str, numbers: &'static [FitNumber], units: &'static [usize]) -> FitForm {
    FitForm {
        suffix,
        named_only: true,
        network: Some(NetworkShape { inputs: INPUTS, units }),
        ..FitForm::new(numbers, FitStarts::Random)
    }
}

/// `convex_network` of one and of two layers of four units: 16 and 36 numbers.
pub const CONVEX_NETWORK_FITS: &[FitForm] = &[network("_1x4", ONE, &[4]), network("_2x4", TWO, &[4, 4])];

/// Of I1b - 3, up to R.
const fn first(name: &'static str) -> FitNumber {
    FitNumber::new(name, Free::Weight { power: 1 })
}

/// Of I2b^1.5, up to the order of R^2.
const fn second(name: &'static str) -> FitNumber {
    FitNumber::new(name, Free::Weight { power: 2 })
}

const fn weight(name: &'static str) -> FitNumber {
    FitNumber::new(name, Free::Weight { power: 0 })
}

const fn bias(name: &'static str) -> FitNumber {
    FitNumber::new(name, Free::Any)
}

/// An energy, G R.
const fn last(name: &'static str) -> FitNumber {
    FitNumber::square(name, 1.0, -1)
}

const ONE: &[FitNumber] = &[
    first("layers[0].through[0][0]"),
    second("layers[0].through[0][1]"),
    first("layers[0].through[1][0]"),
    second("layers[0].through[1][1]"),
    first("layers[0].through[2][0]"),
    second("layers[0].through[2][1]"),
    first("layers[0].through[3][0]"),
    second("layers[0].through[3][1]"),
    bias("layers[0].bias[0]"),
    bias("layers[0].bias[1]"),
    bias("layers[0].bias[2]"),
    bias("layers[0].bias[3]"),
    last("layers[1].before[0][0]"),
    last("layers[1].before[0][1]"),
    last("layers[1].before[0][2]"),
    last("layers[1].before[0][3]"),
];
const TWO: &[FitNumber] = &[
    first("layers[0].through[0][0]"),
    second("layers[0].through[0][1]"),
    first("layers[0].through[1][0]"),
    second("layers[0].through[1][1]"),
    first("layers[0].through[2][0]"),
    second("layers[0].through[2][1]"),
    first("layers[0].through[3][0]"),
    second("layers[0].through[3][1]"),
    bias("layers[0].bias[0]"),
    bias("layers[0].bias[1]"),
    bias("layers[0].bias[2]"),
    bias("layers[0].bias[3]"),
    weight("layers[1].before[0][0]"),
    weight("layers[1].before[0][1]"),
    weight("layers[1].before[0][2]"),
    weight("layers[1].before[0][3]"),
    weight("layers[1].before[1][0]"),
    weight("layers[1].before[1][1]"),
    weight("layers[1].before[1][2]"),
    weight("layers[1].before[1][3]"),
    weight("layers[1].before[2][0]"),
    weight("layers[1].before[2][1]"),
    weight("layers[1].before[2][2]"),
    weight("layers[1].before[2][3]"),
    weight("layers[1].before[3][0]"),
    weight("layers[1].before[3][1]"),
    weight("layers[1].before[3][2]"),
    weight("layers[1].before[3][3]"),
    bias("layers[1].bias[0]"),
    bias("layers[1].bias[1]"),
    bias("layers[1].bias[2]"),
    bias("layers[1].bias[3]"),
    last("layers[2].before[0][0]"),
    last("layers[2].before[0][1]"),
    last("layers[2].before[0][2]"),
    last("layers[2].before[0][3]"),
];
