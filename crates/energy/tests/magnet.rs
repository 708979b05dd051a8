//! The three magnets against what is known of rotations and stretches.

use nastic_energy::catalogue::{self, Inputs};
use nastic_energy::{EnergyTerm, Magnet, MagnetIsochoric, MagnetRotation, MaterialPoint, SlotGroup, check, magnet};
use nastic_tensor::{Kinematics, Mat3, Tangent, Vec3};

const HERE: MaterialPoint = MaterialPoint { cell: 0, point: 0 };
const CONTROLS: [f64; 6] = [0.1, -0.03, 0.05, 0.004, 0.02, -0.01];

fn vectors() -> (Vec3, Vec3) {
    (Vec3::from_column_slice(&CONTROLS[..3]), Vec3::from_column_slice(&CONTROLS[3..]))
}

fn magnets() -> [Box<dyn EnergyTerm>; 3] {
    [Box::new(Magnet::new()), Box::new(MagnetIsochoric::new()), Box::new(MagnetRotation::new())]
}

/// All three agree where the body only turns: `-(1/mu0) (Q B_r) . B_a`.
#[test]
fn turning_only() {
    let (remanence, field) = vectors();
    for q in check::rotations() {
        let expected = -(q * remanence).dot(&field) / magnet::VACUUM_PERMEABILITY;
        for magnet in magnets() {
            let found = check::evaluate(&*magnet, HERE, &Kinematics::new(q).unwrap(), &CONTROLS).energy;
            assert!((found - expected).abs() < 1e-9, "{magnet:?}: {found} against {expected}");
        }
    }
}

/// Stretch matters to `F`, a change of volume not to the isochoric part, and neither to the rotation.
#[test]
fn stretching() {
    let (remanence, field) = vectors();
    let scale = 1.0 / magnet::VACUUM_PERMEABILITY;
    let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-9, "{a} against {b}");
    let energies =
        |f: Mat3| magnets().map(|m| check::evaluate(&*m, HERE, &Kinematics::new(f).unwrap(), &CONTROLS).energy);
    for q in check::rotations() {
        let turned = -(q * remanence).dot(&field) * scale;
        let [by_f, isochoric, rotation] = energies(q * 1.5);
        close(by_f, 1.5 * turned);
        close(isochoric, turned);
        close(rotation, turned);
        let u = Mat3::new(1.4, 0.3, 0.1, 0.3, 0.8, -0.2, 0.1, -0.2, 0.6);
        let [by_f, isochoric, rotation] = energies(q * u);
        close(by_f, -(q * u * remanence).dot(&field) * scale);
        close(isochoric, by_f / u.determinant().cbrt());
        close(rotation, turned);
    }
}

#[test]
fn the_default_has_constant_stress_and_no_tangent() {
    let (remanence, field) = vectors();
    let here = check::evaluate(&Magnet::new(), HERE, &check::states()[5], &CONTROLS);
    let expected = field * remanence.transpose() * (-1.0 / magnet::VACUUM_PERMEABILITY);
    assert!((here.stress - expected).norm() < 1e-12 * expected.norm());
    assert_eq!(here.tangent, Tangent::zero());
}

#[test]
fn extreme_stretches_still_have_a_rotation() {
    let (remanence, field) = vectors();
    for q in check::rotations() {
        let f = q * Mat3::from_diagonal(&Vec3::new(1e6, 1.0, 1e-6));
        let found = check::evaluate(&MagnetRotation::new(), HERE, &Kinematics::new(f).unwrap(), &CONTROLS).energy;
        let expected = -(q * remanence).dot(&field) / magnet::VACUUM_PERMEABILITY;
        assert!((found - expected).abs() < 1e-3, "{found} against {expected}");
    }
}

#[test]
fn slots_and_permeability() {
    let magnet = Magnet::with_permeability(2.0).unwrap();
    let components: Vec<_> = magnet.slots().iter().map(|slot| (slot.group, slot.component)).collect();
    assert_eq!(components[..3], [0, 1, 2].map(|k| ("remanence", Some(k))));
    assert_eq!(components[3..], [0, 1, 2].map(|k| ("field", Some(k))));
    let groups = SlotGroup::of(magnet.slots());
    assert_eq!(
        groups.iter().map(|g| (g.name, g.first, g.len)).collect::<Vec<_>>(),
        [("remanence", 0, 3), ("field", 3, 3)]
    );
    assert!(groups.iter().all(SlotGroup::is_vector));
    let controls = [3.0, 0.0, 0.0, 5.0, 0.0, 0.0];
    assert_eq!(check::evaluate(&magnet, HERE, &Kinematics::rest(), &controls).energy, -7.5);
    assert!(Magnet::with_permeability(0.0).is_err());
    assert!(magnet.check(1, 1).is_ok());
}

#[test]
fn the_catalogue_builds_the_variant_asked_for_and_f_by_default() {
    let row = catalogue::actuation("magnet").unwrap();
    let state = &check::states()[3];
    let stress = |inputs: Inputs| check::evaluate(&row.build(&inputs).unwrap(), HERE, state, &CONTROLS).stress;
    let [by_f, isochoric, rotation] = magnets().map(|m| check::evaluate(&*m, HERE, state, &CONTROLS).stress);
    assert_eq!(stress(Inputs::new()), by_f);
    for (word, expected) in [("F", by_f), ("isochoric", isochoric), ("rotation", rotation)] {
        assert_eq!(stress(Inputs::new().choice("variant", word)), expected);
    }
    let half = stress(Inputs::new().number("mu0", 2.0 * magnet::VACUUM_PERMEABILITY));
    assert!((half * 2.0 - by_f).norm() < 1e-12 * by_f.norm());
    let error = row.build(&Inputs::new().choice("variant", "iso")).unwrap_err().to_string();
    assert!(error.contains("variant of magnet is called `iso`"), "{error}");
}
