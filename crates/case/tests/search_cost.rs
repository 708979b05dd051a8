//! What the search for self-intersection takes beside a solve: prints, asserts nothing of times.
//! `cargo test --release -p nastic-case --test all search_cost -- --ignored --nocapture`

#![allow(clippy::unwrap_used)] // a test may

use nastic_case::lower::CaseProblem;
use nastic_fem::SolveOptions;
use nastic_language::syntax::Document;
use nastic_mesh::spatial::Shape;
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

/// Median of five, in seconds.
fn median<T>(mut work: impl FnMut() -> T) -> (f64, T) {
    let mut last = None;
    let mut seconds: Vec<f64> = (0..5)
        .map(|_| {
            let began = Instant::now();
            last = Some(work());
            began.elapsed().as_secs_f64()
        })
        .collect();
    seconds.sort_by(f64::total_cmp);
    (seconds[2], last.unwrap())
}

#[test]
#[ignore = "prints times, which depend on the machine"]
fn search_beside_solve() {
    for name in ["finger", "cantilever_arc"] {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../../examples/cases/{name}.json"));
        let problem = CaseProblem::lower(Document::open(&file).unwrap(), Arc::default()).unwrap();
        let member = problem.member(0);
        let controls = member.layout().to_points(&member.local(&problem.start)).unwrap();
        let (solve, state) = median(|| member.solid().solve(&controls, &SolveOptions::default()).unwrap());
        let (inertia, _) = median(|| member.solid().negative_pivots(&state).unwrap());
        let moved = |(x, u): (&[f64; 3], &[f64])| [0, 1, 2].map(|k| x[k] + u.get(k).copied().unwrap_or(0.0));
        let mesh = member.mesh();
        let at: Vec<[f64; 3]> = mesh.points().iter().zip(state.u.chunks_exact(mesh.dim())).map(moved).collect();
        let (search, found) = median(|| Shape::new(mesh, &at, None).unwrap().self_intersection());
        assert!(found.is_empty());
        let share = 100.0 * search / solve;
        println!("{name}: solve {solve:.4} s, inertia {inertia:.4} s, search {search:.4} s, {share:.1} % of the solve");
    }
}
