//! Signed distances of obstacles: closed forms, derivatives to the third order, rounded edges.

use nastic_mesh::spatial::{Obstacle, SignedDistance};
use nastic_mesh::{CellKind, box_mesh};

type Outcome = Result<(), Box<dyn std::error::Error>>;

const PLACES: [[f64; 3]; 5] =
    [[1.3, 0.2, 0.4], [1.4, 1.7, 0.45], [1.5, 1.6, 1.8], [-0.7, -0.4, 0.3], [0.4, -0.9, -0.6]];

fn shapes() -> Result<Vec<(&'static str, Obstacle)>, Box<dyn std::error::Error>> {
    let solid = Obstacle::solid(&box_mesh([1.0; 3], [2, 1, 1], CellKind::Hex8)?)?;
    Ok(vec![
        ("half-space", Obstacle::half_space([0.0, 0.1, 0.0], [1.0, 2.0, -0.5])),
        ("sphere", Obstacle::sphere([0.3, 0.4, 0.5], 0.6)),
        ("capsule", Obstacle::capsule([0.1, 0.2, 0.3], [0.8, 0.9, 0.2], 0.25)),
        ("box", Obstacle::aligned_box([0.0; 3], [1.0; 3])),
        ("rounded box", Obstacle::aligned_box([0.0; 3], [1.0; 3]).rounded(0.1)),
        ("solid", solid.clone()),
        ("rounded solid", solid.rounded(0.1)),
    ])
}

/// Differences of fourth order.
fn difference(at: impl Fn(f64) -> [f64; 3]) -> [f64; 3] {
    const H: f64 = 1e-3;
    let [a, b, c, d] = [1.0, -1.0, 2.0, -2.0].map(|s| at(s * H));
    std::array::from_fn(|i| (8.0 * (a[i] - b[i]) - (c[i] - d[i])) / (12.0 * H))
}

fn largest(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter().zip(&b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

#[test]
fn derivatives_agree_with_differences_outside_of_every_shape() -> Outcome {
    let (v, w) = ([0.3, -0.5, 0.2], [-0.1, 0.4, 0.6]);
    for (name, shape) in shapes()? {
        for x in PLACES {
            let at = |s: f64| -> SignedDistance { shape.at(&std::array::from_fn(|i| x[i] + s * v[i])) };
            let here = at(0.0);
            let slope = difference(|s| [at(s).value; 3])[0];
            let along: f64 = here.gradient.iter().zip(&v).map(|(n, v)| n * v).sum();
            assert!((slope - along).abs() < 1e-9, "{name} {x:?}: {slope} {along}");
            assert!(largest(difference(|s| at(s).gradient), here.second(&v)) < 1e-8, "{name} {x:?}");
            assert!(largest(difference(|s| at(s).second(&w)), here.third(v, w)) < 1e-7, "{name} {x:?}");
            let product = here.hessian() * nalgebra::Vector3::from(v);
            assert!(largest(product.into(), here.second(&v)) < 1e-14, "{name} {x:?}");
        }
    }
    Ok(())
}

/// A rounded box keeps its faces and loses its corners; a rounded solid grows.
#[test]
fn rounding_keeps_a_box_and_grows_a_solid() -> Outcome {
    let find = |wanted: &str| shapes().map(|all| all.into_iter().find(|(name, _)| *name == wanted).map(|(_, s)| s));
    let (sharp, round) = (find("box")?.ok_or("box")?, find("rounded box")?.ok_or("rounded")?);
    let (plain, grown) = (find("solid")?.ok_or("solid")?, find("rounded solid")?.ok_or("grown")?);
    let (face, corner) = ([1.3, 0.5, 0.5], [1.3; 3]);
    assert!((round.distance(&face) - sharp.distance(&face)).abs() < 1e-15);
    let cut = 0.1 * (3f64.sqrt() - 1.0);
    assert!((round.distance(&corner) - sharp.distance(&corner) - cut).abs() < 1e-14);
    for x in PLACES {
        assert!((plain.distance(&x) - grown.distance(&x) - 0.1).abs() < 1e-14);
    }
    for (wrong, words) in [
        (sharp.clone().rounded(0.5), "more than half of its shortest side"),
        (sharp.rounded(-0.1), "rounding radius -0.1"),
        (Obstacle::sphere([0.0; 3], 0.0), "radius 0"),
    ] {
        let refused = wrong.check(3).err().ok_or(words)?.to_string();
        assert!(refused.contains(words), "{refused}");
    }
    Ok(())
}

/// Whatever its length: squares of these overflow or vanish.
#[test]
fn normals_of_any_length_are_directions() {
    for length in [1e-300, 1.0, 1e300] {
        let floor = Obstacle::half_space([0.0, 0.0, 0.5], [0.0, 3.0 * length, 4.0 * length]);
        floor.check(3).unwrap();
        assert!((floor.distance(&[0.0, 1.0, 2.0]) - 1.8).abs() < 1e-15);
    }
    for normal in [[0.0; 3], [f64::NAN, 0.0, 1.0], [f64::INFINITY, 0.0, 0.0]] {
        let error = Obstacle::half_space([0.0; 3], normal).check(3).unwrap_err().to_string();
        assert!(error.contains("normal of a half-space is zero or not finite"), "{error}");
    }
}
