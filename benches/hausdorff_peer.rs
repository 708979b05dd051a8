//! One JSON line for each number of points: smoothed Hausdorff sums on the problem of `bent_skins`, value and gradient,
//! with the keys of the Python script it is compared with.
//!
//! `cargo bench --bench hausdorff_peer -- n=10000 phi=exp alpha=60 grad=1 reps=5` (several n: `n=1000,10000`); threads
//! are set by `RAYON_NUM_THREADS`; `tolerance=1e-9` and `tolerance=0` (all pairs) replace 1e-10. Up to 1e5 points
//! the line also has the errors against the direct sum, unless `check=0`.

#![allow(clippy::print_stdout)] // programs talk, libraries do not

mod bent_skins;

use bent_skins::BentSkins;
use nastic::hausdorff::Summation;
use std::error::Error;
use std::hint::black_box;
use std::time::Instant;

/// Beyond this the direct sum takes minutes.
const DIRECT_UP_TO: usize = 100_000;

struct Options {
    sizes: Vec<usize>,
    phi: String,
    alpha: f64,
    gradient: bool,
    repetitions: usize,
    summation: Summation,
    check: bool,
}

impl Options {
    fn read(arguments: impl Iterator<Item = String>) -> Result<Self, Box<dyn Error>> {
        let mut options = Self {
            sizes: vec![1_000, 10_000, 100_000, 1_000_000],
            phi: "exp".to_owned(),
            alpha: 60.0,
            gradient: true,
            repetitions: 5,
            summation: Summation::default(),
            check: true,
        };
        // Cargo adds `--bench`.
        for argument in arguments.filter(|argument| !argument.starts_with("--")) {
            match argument.split_once('=') {
                Some(("n", sizes)) => options.sizes = sizes.split(',').map(str::parse).collect::<Result<_, _>>()?,
                Some(("phi", name)) => options.phi = name.to_owned(),
                Some(("alpha", alpha)) => options.alpha = alpha.parse()?,
                Some(("grad", flag)) => options.gradient = flag == "1",
                Some(("reps", count)) => options.repetitions = count.parse::<usize>()?.max(1),
                Some(("tolerance", "0")) => options.summation = Summation::Direct,
                Some(("tolerance", value)) => options.summation = Summation::Truncated { tolerance: value.parse()? },
                Some(("check", flag)) => options.check = flag == "1",
                _ => return Err(format!("{argument}: see the head of benches/hausdorff_peer.rs").into()),
            }
        }
        Ok(options)
    }
}

fn norm<'a>(vectors: impl IntoIterator<Item = &'a [f64; 3]>) -> f64 {
    vectors.into_iter().flatten().map(|x| x * x).sum::<f64>().sqrt()
}

fn main() -> Result<(), Box<dyn Error>> {
    let options = Options::read(std::env::args().skip(1))?;
    let phi = BentSkins::phi(&options.phi).ok_or("phi is one of exp, rat, smooth")?;
    for &n in &options.sizes {
        let problem = BentSkins::new(n, phi, options.alpha)?;
        let mut seconds = Vec::new();
        let run = || -> Result<_, Box<dyn Error>> {
            Ok(if options.gradient {
                let (value, gradient) = problem.value_and_gradient(options.summation)?;
                (value, Some(gradient))
            } else {
                (problem.value(options.summation)?, None)
            })
        };
        let (value, gradient) = run()?;
        for _ in 0..options.repetitions {
            let start = Instant::now();
            black_box(run()?);
            seconds.push(start.elapsed().as_secs_f64());
        }
        seconds.sort_by(f64::total_cmp);
        let counts = problem.pairs(options.summation)?.counts();
        let mut line = format!(
            r#"{{"peer":"nastic","n":{n},"phi":"{}","alpha":{},"value":{value:?},"median_s":{:.6},"min_s":{:.6}"#,
            options.phi,
            options.alpha,
            seconds[seconds.len() / 2],
            seconds[0],
        );
        line += &format!(r#","summed":{:.4}"#, counts.summed / counts.all);
        if let Some(gradient) = &gradient {
            line += &format!(r#","grad_norm":{:?}"#, norm(gradient));
        }
        if options.check && n <= DIRECT_UP_TO {
            let (exact, exact_gradient) = problem.value_and_gradient(Summation::Direct)?;
            line += &format!(r#","value_error":{:.1e}"#, ((value - exact) / exact).abs());
            if let Some(gradient) = &gradient {
                let apart = |(a, b): (&[f64; 3], &[f64; 3])| std::array::from_fn(|d| a[d] - b[d]);
                let apart: Vec<[f64; 3]> = gradient.iter().zip(&exact_gradient).map(apart).collect();
                line += &format!(r#","grad_error":{:.1e}"#, norm(&apart) / norm(&exact_gradient));
            }
        }
        println!("{line}}}");
    }
    Ok(())
}
