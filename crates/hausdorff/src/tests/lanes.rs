//! The elementary functions on every instruction set that runs here, against the standard library.

use super::super::lanes::{InstructionSet, Lanes, Task};

#[derive(Clone, Copy)]
enum Function {
    Rsqrt,
    Exp2,
    Log2,
}

struct Apply<'a>(Function, &'a mut [f64]);

impl Task for Apply<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Lanes>(self, s: S) {
        for x in S::as_mut_simd_f64s(self.1).0 {
            *x = match self.0 {
                Function::Rsqrt => s.rsqrt(*x),
                Function::Exp2 => s.exp2(*x),
                Function::Log2 => s.log2(*x),
            };
        }
    }
}

/// Largest relative error over arguments lo, ..., hi.
fn error(instructions: InstructionSet, f: Function, exact: fn(f64) -> f64, arguments: impl Fn(f64) -> f64) -> f64 {
    let n = 1 << 14;
    let x: Vec<f64> = (0..n).map(|k| arguments((k as f64 + 0.37) / n as f64)).collect();
    let mut y = x.clone();
    instructions.run(Apply(f, &mut y));
    x.iter().zip(&y).map(|(&x, y)| ((y - exact(x)) / exact(x)).abs()).fold(0.0, f64::max)
}

#[test]
fn elementary_functions_are_accurate() {
    for instructions in InstructionSet::all() {
        let e = |f, exact: fn(f64) -> f64, arguments: fn(f64) -> f64| error(instructions, f, exact, arguments);
        assert!(
            e(Function::Rsqrt, |x| 1.0 / x.sqrt(), |t| 1e-300 * 1e300f64.powf(2.0 * t)) < 1e-15,
            "{instructions:?}"
        );
        assert!(e(Function::Rsqrt, |x| 1.0 / x.sqrt(), |t| 1.0 + 3.0 * t) < 1e-15, "{instructions:?}");
        assert!(e(Function::Exp2, f64::exp2, |t| -960.0 + 1900.0 * t) < 5e-15, "{instructions:?}");
        assert!(e(Function::Exp2, f64::exp2, |t| -1.0 + 2.0 * t) < 5e-15, "{instructions:?}");
        assert!(e(Function::Log2, f64::log2, |t| 1e300f64.powf(t)) < 1e-15, "{instructions:?}");
        assert!(e(Function::Log2, |x| (x - 1.0).ln_1p() / std::f64::consts::LN_2, |t| 1.0 + t.powi(8)) < 1e-15);
    }
}

#[test]
fn whole_powers_and_the_least_argument() {
    for instructions in InstructionSet::all() {
        let mut x = [-960.0, -1.0, 0.0, 1.0, 2.0, 10.0, 512.0, 1000.0];
        let exact = x.map(f64::exp2);
        instructions.run(Apply(Function::Exp2, &mut x));
        for (x, exact) in x.iter().zip(exact) {
            super::close(*x, exact, 5e-15);
        }
        let mut below = [-961.0, -1000.0, -1022.5, -1074.0, -1e4, -1e6, -1e9, -1e12];
        instructions.run(Apply(Function::Exp2, &mut below));
        assert!(below.iter().all(|&x| (0.0..=2.0 * (-960f64).exp2()).contains(&x)), "{below:?}");
        let mut one = [1.0; 8];
        instructions.run(Apply(Function::Log2, &mut one));
        assert_eq!(one, [0.0; 8]);
    }
}
