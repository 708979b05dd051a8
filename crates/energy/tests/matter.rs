//! Matter in a field: a published point of a dielectric, and all derivatives against hyper-dual numbers.

use nastic_energy::{EnergyTerm, Gradients, Matter, MooneyRivlin, PointBatch, Response, Slots, Want};
use nastic_tensor::{HyperDual, Kinematics, Mat3};

const F: [[f64; 3]; 3] = [[1.001, 0.004, 0.007], [0.002, 1.005, 0.008], [0.003, 0.006, 1.009]];

fn at() -> Gradients<f64> {
    [F[0], F[1], F[2], [1.0, 2.0, 3.0]]
}

/// Mooney-Rivlin beside an ideal dielectric at a strained point, as HyperFEM.jl has it.
#[test]
fn a_published_point() -> Result<(), Box<dyn std::error::Error>> {
    let (law, matter) = (MooneyRivlin::new(0.5, 1.0, 1.5)?, Matter::dielectric(4.0)?);
    let kinematics = [Kinematics::new(Mat3::from_fn(|i, j| F[i][j]))?];
    let batch = PointBatch { kinematics: &kinematics, cell: 0, first: 0 };
    let (mut energy, mut stress) = ([0.0], [Mat3::zeros()]);
    let want = Want { energy: true, stress: true, tangent: false };
    law.respond(
        &batch,
        Slots::none(),
        want,
        &mut Response { energy: &mut energy, stress: &mut stress, tangent: &mut [] },
    );
    let dual = matter.duals(&at());
    let total = Mat3::from_fn(|i, j| stress[0][(i, j)] + dual[i][j]);
    let displacement = dual[3].iter().map(|d| d * d).sum::<f64>().sqrt();
    let near = |found: f64, published: f64| (found / published - 1.0).abs() < 1e-9;
    let enthalpy = energy[0] + matter.enthalpy(&at());
    assert!(near(enthalpy, -27.514219755428), "{enthalpy}");
    assert!(near(total.norm(), 47.4229437), "{}", total.norm());
    assert!(near(displacement, 14.707913034885), "{displacement}");
    Ok(())
}

/// Along two changes of F and the potential's gradient: the first derivatives are those of the enthalpy, the changes those of the first, and the third are symmetric.
#[test]
fn derivatives_are_those_of_the_enthalpy() -> Result<(), Box<dyn std::error::Error>> {
    let matter = Matter::dielectric(0.7)?;
    let value = [[1.1, 0.2, -0.1], [0.05, 0.9, 0.15], [-0.2, 0.1, 1.05], [0.8, -1.3, 0.6]];
    let changes = [
        [[0.3, -0.2, 0.5], [0.1, 0.4, -0.6], [0.7, -0.1, 0.2], [0.5, 0.3, -0.9]],
        [[-0.4, 0.6, 0.1], [0.2, -0.3, 0.8], [0.1, 0.5, -0.7], [-0.2, 0.7, 0.4]],
    ];
    let dot = |a: &Gradients<f64>, b: &Gradients<f64>| {
        a.iter().flatten().zip(b.iter().flatten()).map(|(a, b)| a * b).sum::<f64>()
    };
    let numbers = |[first, second]: [&Gradients<f64>; 2]| -> Gradients<HyperDual> {
        std::array::from_fn(|i| std::array::from_fn(|c| HyperDual([value[i][c], first[i][c], second[i][c], 0.0])))
    };
    let same = |a: f64, b: f64| (a - b).abs() < 1e-13 * (1.0 + a.abs());
    let both = matter.enthalpy(&numbers([&changes[0], &changes[1]]));
    assert!(same(both.along(0), dot(&matter.duals(&value), &changes[0])));
    assert!(same(both.along(1), dot(&matter.duals(&value), &changes[1])));
    let change = matter.at(&value).change(&changes[0]);
    assert!(same(both.both(), dot(&change, &changes[1])), "{} {}", both.both(), dot(&change, &changes[1]));
    assert!(both.both().abs() > 1e-2);
    let thirds = [[0, 1], [1, 0]].map(|[a, b]| {
        let dual = matter.duals(&numbers([&changes[a], &changes[b]]));
        dot(&dual.map(|row| row.map(HyperDual::both)), &changes[0])
    });
    assert!(same(thirds[0], thirds[1]) && thirds[0].abs() > 1e-2, "{thirds:?}");
    let swapped = matter.duals(&numbers([&changes[0], &changes[0]])).map(|row| row.map(HyperDual::both));
    assert!(same(dot(&swapped, &changes[1]), thirds[0]), "{thirds:?}");
    let (j, field) = matter.true_field(&value);
    let stored = 0.35 * j * field * field;
    assert!(same(matter.enthalpy(&value), -stored));
    assert!(Matter::dielectric(-1.0).is_err() && Matter::dielectric(f64::NAN).is_err());
    Ok(())
}
