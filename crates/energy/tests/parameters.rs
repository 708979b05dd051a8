//! Parameters and directions: what is refused, with which words, and fields that vary over the body.

use nastic_energy::catalogue::{self, Inputs};
use nastic_energy::{
    EnergyTerm, FiberTension, Field, MaterialPoint, MooneyRivlin, NeoHooke, NeoHookeIsochoric, PointBatch, Response,
    Slots, TransverseMooneyRivlin, Want, check,
};
use nastic_tensor::{Kinematics, Mat3, Tangent, Vec3};

const HERE: MaterialPoint = MaterialPoint { cell: 0, point: 0 };

#[test]
fn signs_that_polyconvexity_needs() {
    let message = |e: nastic_energy::EnergyError| e.to_string();
    assert_eq!(
        message(MooneyRivlin::new(0.0, 1.0, 1.0).unwrap_err()),
        "mooney_rivlin: mu1 = 0e0, but it must be positive"
    );
    assert_eq!(
        message(MooneyRivlin::new(1.0, -1.0, 1.0).unwrap_err()),
        "mooney_rivlin: mu2 = -1e0, but it must not be negative: the law would lose its polyconvexity"
    );
    assert_eq!(
        message(NeoHooke::new(Field::cells(vec![1.0, 2.0, f64::INFINITY]), 0.0).unwrap_err()),
        "neo_hooke: mu = inf in cell 2, but it must be a finite number"
    );
    assert!(MooneyRivlin::new(1.0, 0.0, 0.0).is_ok());
    assert!(NeoHooke::new(1.0, 0.0).is_ok());
    assert!(NeoHookeIsochoric::new(1.0, 0.0).is_err());
    assert!(TransverseMooneyRivlin::new(1.0, 0.0, -0.1, 1.0, Vec3::x()).is_err());
}

#[test]
fn directions_have_length_one() {
    let error = FiberTension::along(Vec3::new(1.0, 1.0, 0.0)).unwrap_err().to_string();
    assert_eq!(
        error,
        "fiber_tension: direction = [1.0, 1.0, 0.0] has length 1.4142135623730951, not 1; the unit vector along it is \
         [0.7071067811865475, 0.7071067811865475, 0.0]"
    );
    let error = FiberTension::along(Vec3::zeros()).unwrap_err().to_string();
    assert!(error.ends_with("has length 0, not 1; it has no direction"), "{error}");
    let field = Field::points(vec![Vec3::x(), Vec3::y() * 1.001]);
    let error = TransverseMooneyRivlin::new(1.0, 1.0, 1.0, 1.0, field).unwrap_err().to_string();
    assert!(error.contains("fiber = [0.0, 1.001, 0.0] at quadrature point 1 has length 1.0"), "{error}");
    assert!(FiberTension::along(Vec3::new(f64::NAN, 0.0, 0.0)).is_err());
}

/// Printed digits are good enough, and the rest state is still free of stress.
#[test]
fn eight_digits_of_a_direction_are_enough() {
    let printed = Vec3::new(0.26726124, 0.53452248, 0.80178373);
    let law = TransverseMooneyRivlin::new(1e5, 2e4, 3e5, 1e6, printed).unwrap();
    assert!((law.direction(HERE).unwrap().norm() - 1.0).abs() < 1e-15);
    check::rest(&law, HERE).unwrap();
}

#[test]
fn engineering_constants_without_a_polyconvex_law_are_refused() {
    let error = MooneyRivlin::from_young_poisson(1.0, 0.25, 0.5).unwrap_err().to_string();
    assert!(error.contains("take a share above 0.5"), "{error}");
    assert!(MooneyRivlin::from_young_poisson(1.0, 0.25, 0.501).is_ok());
    let error = MooneyRivlin::from_young_poisson(1.0, 0.3, 0.249).unwrap_err().to_string();
    assert!(error.contains("take a share above 0.25"), "{error}");
    assert!(MooneyRivlin::from_young_poisson(1.0, 0.3, 0.251).is_ok());
    let error = MooneyRivlin::from_shear_bulk(Field::cells(vec![1.0, 3.0]), 2.0, 0.9).unwrap_err().to_string();
    assert!(error.starts_with("mooney_rivlin: mu3 = ") && error.contains(" in cell 1 "), "{error}");
    assert!(error.contains("no share below 1 is enough"), "{error}");
    for share in [0.0, 1.0, f64::NAN] {
        assert!(MooneyRivlin::from_shear_bulk(1.0, 10.0, share).is_err());
    }
    for nu in [-1.0, 0.5, 0.6] {
        assert!(NeoHookeIsochoric::from_young_poisson(1.0, nu).is_err());
    }
    assert!(NeoHooke::from_young_poisson(1.0, -0.1).unwrap_err().to_string().contains("neo_hooke_isochoric"));
    assert!(NeoHooke::from_shear_bulk(3.0, 1.9).unwrap_err().to_string().contains("2/3 of the shear modulus"));
}

/// `C10 (I1' - 3) + C01 (I2' - 3) + (J-1)^2 / D1` has the shear modulus 2 (C10 + C01) and the bulk modulus 2 / D1; where the volume
/// stays, its energy is C10 (I1 - 3) + C01 (I2 - 3).
#[test]
fn coefficients_of_rubber_keep_their_moduli_and_their_energy_at_constant_volume() {
    let sheared = Kinematics::new(Mat3::new(1.3, 0.4, 0.0, 0.0, 0.8, -0.2, 0.0, 0.0, 1.0 / 1.04)).unwrap();
    assert!((sheared.j() - 1.0).abs() < 1e-15);
    let c = sheared.f().transpose() * sheared.f();
    let (i1, i2) = (c.trace(), 0.5 * (c.trace().powi(2) - (c * c).trace()));
    let (c10, c01, d1) = (4e4, 1e4, 3e-6);
    let laws: [(&str, f64); 3] = [("neo_hooke", 0.0), ("neo_hooke_isochoric", 0.0), ("mooney_rivlin", c01)];
    for (name, c01) in laws {
        let mut inputs = Inputs::new().number("c10", c10).number("d1", d1);
        if name == "mooney_rivlin" {
            inputs = inputs.number("c01", c01);
        }
        let law = catalogue::material(name).unwrap().build(&inputs).unwrap();
        let moduli = law.moduli(HERE).unwrap();
        let near = |found: f64, wanted: f64| assert!((found / wanted - 1.0).abs() < 1e-13, "{name}: {found} {wanted}");
        near(moduli.mu_t, 2.0 * (c10 + c01));
        near(moduli.bulk(), 2.0 / d1);
        near(check::evaluate(&*law, HERE, &sheared, &[]).energy, c10 * (i1 - 3.0) + c01 * (i2 - 3.0));
    }
}

#[test]
fn coefficients_of_rubber_out_of_range_are_refused() {
    let message = |made: Result<MooneyRivlin, nastic_energy::EnergyError>| made.unwrap_err().to_string();
    let error = message(MooneyRivlin::from_c10_c01_d1(1.0, 0.5, 0.0));
    assert!(error.contains("d1 = 0e0") && error.contains("0 would be incompressible"), "{error}");
    assert!(MooneyRivlin::from_c10_c01_d1(1.0, 0.5, 0.5).is_ok(), "the largest D1, 3 / (2 + 4)");
    let error = message(MooneyRivlin::from_c10_c01_d1(1.0, 0.5, Field::cells(vec![0.1, 0.51])));
    assert!(error.contains("d1 = 5.1e-1 in cell 1"), "{error}");
    let error = NeoHooke::from_c10_d1(1.0, 1.51).unwrap_err().to_string();
    assert!(error.contains("at most 3 / (2 C10)") && error.contains("neo_hooke_isochoric"), "{error}");
    assert!(NeoHooke::from_c10_d1(1.0, 1.5).is_ok() && NeoHookeIsochoric::from_c10_d1(1.0, 1.51).is_ok());
    assert!(NeoHookeIsochoric::from_c10_d1(0.0, 1.0).unwrap_err().to_string().contains("c10 = 0e0"));
    assert!(message(MooneyRivlin::from_c10_c01_d1(1.0, -0.1, 0.1)).contains("c01 = -1e-1"));
}

#[test]
fn fields_are_combined_value_by_value() {
    let shear = Field::cells(vec![1e5, 2e5, 3e5]);
    let law = MooneyRivlin::from_shear_bulk(shear, 1e6, Field::cells(vec![0.5, 0.6, 0.7])).unwrap();
    let limit = |cell| law.fiber_limit(MaterialPoint { cell, point: 99 }, &Vec3::x()).unwrap();
    assert!((limit(0) - 5e4).abs() < 1e-9 && (limit(1) - 1.2e5).abs() < 1e-9 && (limit(2) - 2.1e5).abs() < 1e-9);
    let mixed = MooneyRivlin::from_shear_bulk(Field::cells(vec![1.0; 3]), Field::points(vec![9.0; 24]), 0.5);
    assert_eq!(
        mixed.unwrap_err().to_string(),
        "mooney_rivlin: shear and bulk must be given alike: shear has 3 values per cell, bulk has 24 per quadrature \
         point; sample both per cell, or both per quadrature point"
    );
}

/// One call over a cell's points gives each point its own parameters and its own control value.
#[test]
fn a_batch_is_its_points() {
    let (cell, first) = (1, 3);
    let states: Vec<Kinematics> = check::states().into_iter().take(4).collect();
    let per_point: Vec<f64> = (0..7).map(|n| 1e5 * (1 + n) as f64).collect();
    let fibers: Vec<Vec3> = (0..7).map(|n| Vec3::new((n as f64).cos(), (n as f64).sin(), 0.0)).collect();
    let isotropic = MooneyRivlin::new(Field::points(per_point), Field::cells(vec![1e4, 2e4]), 1e6).unwrap();
    let transverse = TransverseMooneyRivlin::new(1e5, 2e4, 3e5, 1e6, Field::points(fibers.clone())).unwrap();
    let laws: [&dyn EnergyTerm; 2] = [&isotropic, &transverse];
    let tension = FiberTension::along_field(Field::points(fibers)).unwrap();
    let controls = [1e4, -2e5, 5e4, 0.0];

    let (mut energy, mut stress, mut tangent) = ([0.0; 4], [Mat3::zeros(); 4], [Tangent::zero(); 4]);
    let mut out = Response { energy: &mut energy, stress: &mut stress, tangent: &mut tangent };
    let points = PointBatch { kinematics: &states, cell, first };
    laws.iter().for_each(|law| law.respond(&points, Slots::none(), Want::ALL, &mut out));
    tension.respond(&points, Slots::by_point(&controls, 1), Want::ALL, &mut out);

    for (q, k) in states.iter().enumerate() {
        let at = MaterialPoint { cell, point: first + q };
        let mut expected = check::evaluate(&tension, at, k, &controls[q..=q]);
        for law in laws {
            let passive = check::evaluate(law, at, k, &[]);
            expected.energy += passive.energy;
            expected.stress += passive.stress;
            expected.tangent.add(&passive.tangent);
        }
        assert!((energy[q] - expected.energy).abs() < 1e-9 * energy[q].abs());
        assert!((stress[q] - expected.stress).norm() < 1e-9 * stress[q].norm());
        let error = tangent[q].0.iter().zip(&expected.tangent.0).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(error < 1e-5);
        for law in laws {
            let (here, other) =
                (check::evaluate(law, at, k, &[]), check::evaluate(law, MaterialPoint { cell: 0, point: 0 }, k, &[]));
            assert!((other.stress - here.stress).norm() > 1e3, "the place makes no difference");
        }
    }
    laws.iter().for_each(|law| law.check(2, 7).unwrap());
    tension.check(2, 7).unwrap();
    assert!(isotropic.check(2, 8).is_err() && isotropic.check(3, 7).is_err() && tension.check(2, 6).is_err());
}

/// An actuation that nobody drives is at rest, also where it stands as a passive term.
#[test]
fn an_undriven_actuation_does_nothing() {
    let tension = FiberTension::along(Vec3::x()).unwrap();
    let here = check::evaluate(&tension, HERE, &check::states()[0], &[]);
    assert_eq!((here.energy, here.stress, here.tangent), (0.0, Mat3::zeros(), Tangent::zero()));
}
