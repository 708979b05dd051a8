//! The contract checks find what they are for: a sound law with one fault at a time fails the check of that name.
#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use nastic_energy::check::{self, Violation};
use nastic_energy::{
    Block, Change, Conjugates, ConvexDensity, Curvature, EnergyError, EnergyTerm, FiberTension, MaterialPoint, Moduli,
    MooneyRivlin, NeoHooke, PointBatch, Response, Slot, Slots, TensionBound, Want,
};
use nastic_tensor::{Mat3, Tangent, Vec3, cross};

const HERE: MaterialPoint = MaterialPoint { cell: 0, point: 0 };

/// Mooney-Rivlin with something done to its answers.
struct Faulty<F>(MooneyRivlin, F);

impl<F> std::fmt::Debug for Faulty<F> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Faulty")
    }
}

impl<F: Fn(&PointBatch, Want, &mut Response) + Send + Sync> EnergyTerm for Faulty<F> {
    fn slots(&self) -> &[Slot] {
        &[]
    }

    fn stress_by_control(&self, _at: &PointBatch, _m: Slots, _out: &mut [Mat3]) {}

    fn respond(&self, at: &PointBatch, m: Slots, want: Want, out: &mut Response) {
        self.0.respond(at, m, want, out);
        (self.1)(at, want, out);
    }

    fn moduli(&self, at: MaterialPoint) -> Option<Moduli> {
        self.0.moduli(at)
    }
}

fn fails(fault: impl Fn(&PointBatch, Want, &mut Response) + Send + Sync) -> String {
    let law = Faulty(MooneyRivlin::new(1e5, 2e4, 1e6).unwrap(), fault);
    match check::passive(&law, HERE).unwrap_err() {
        Violation::Exceeds { check, .. } => check.to_owned(),
        other => panic!("{other}"),
    }
}

#[test]
fn nothing_is_found_without_a_fault() {
    let law = Faulty(MooneyRivlin::new(1e5, 2e4, 1e6).unwrap(), |_: &PointBatch, _: Want, _: &mut Response| {});
    let report = check::passive(&law, HERE).unwrap();
    assert_eq!(report.findings.len(), 10);
    assert_eq!(report.to_string().lines().count(), 10);
}

#[test]
fn overwriting() {
    let found = fails(|at, want, out| {
        if want.stress {
            out.stress[0] =
                check::evaluate(&MooneyRivlin::new(1e5, 2e4, 1e6).unwrap(), HERE, &at.kinematics[0], &[]).stress;
        }
    });
    assert_eq!(found, "adds what is wanted and nothing else");
}

#[test]
fn wrong_stress() {
    let found = fails(|at, want, out| {
        if want.stress {
            out.stress[0] += cross(at.kinematics[0].h(), at.kinematics[0].f()) * 1.0;
        }
    });
    assert_eq!(found, "P is the derivative of the energy");
}

#[test]
fn wrong_tangent() {
    let found = fails(|_, want, out| {
        if want.tangent {
            out.tangent[0].0[5] += 1e2;
        }
    });
    assert_eq!(found, "dP/dF is the derivative of P");
}

/// `c F_12^2 / 2`, with its derivatives, knows about the axes of space.
#[test]
fn not_objective() {
    let found = fails(|at, want, out| {
        let shear = at.kinematics[0].f()[(0, 1)];
        if want.energy {
            out.energy[0] += 1e3 * shear * shear / 2.0;
        }
        if want.stress {
            out.stress[0][(0, 1)] += 1e3 * shear;
        }
        if want.tangent {
            out.tangent[0].0[10] += 1e3;
        }
    });
    assert_eq!(found, "turning space turns P and keeps the energy");
}

/// A consistent extra term `w(J)`.
fn volumetric(w: fn(f64) -> [f64; 3]) -> impl Fn(&PointBatch, Want, &mut Response) + Send + Sync {
    move |at, want, out| {
        let k = &at.kinematics[0];
        let [value, first, second] = w(k.j());
        if want.energy {
            out.energy[0] += value;
        }
        if want.stress {
            out.stress[0] += k.h() * first;
        }
        if want.tangent {
            out.tangent[0].add_outer(k.h(), k.h(), second);
            out.tangent[0].add_cross(k.f(), first);
        }
    }
}

/// A law whose shortcut for changes of stress forgets a part of its tangent.
#[derive(Debug)]
struct Forgetful(MooneyRivlin);

impl EnergyTerm for Forgetful {
    fn slots(&self) -> &[Slot] {
        &[]
    }

    fn stress_by_control(&self, _at: &PointBatch, _m: Slots, _out: &mut [Mat3]) {}

    fn respond(&self, at: &PointBatch, m: Slots, want: Want, out: &mut Response) {
        self.0.respond(at, m, want, out);
    }

    fn stress_change(&self, at: &PointBatch, m: Slots, change: &[Mat3], out: &mut [Mat3]) {
        self.0.stress_change(at, m, change, out);
        out[0] -= cross(at.kinematics[0].h(), &change[0]);
    }
}

#[test]
fn wrong_change_of_stress() {
    let error = check::passive(&Forgetful(MooneyRivlin::new(1e5, 2e4, 1e6).unwrap()), HERE).unwrap_err();
    assert!(
        matches!(error, Violation::Exceeds { check: "the change of P is dP/dF applied to that of F", .. }),
        "{error}"
    );
}

#[test]
fn prestress_energy_at_rest_and_wrong_moduli() {
    assert_eq!(fails(volumetric(|j| [j - 1.0, 1.0, 0.0])), "the rest state has no energy and no stress");
    assert_eq!(fails(volumetric(|_| [1.0, 0.0, 0.0])), "the rest state has no energy and no stress");
    let found = fails(volumetric(|j| [10.0 * (j - 1.0).powi(2), 20.0 * (j - 1.0), 20.0]));
    assert_eq!(found, "dP/dF at rest has the stated moduli");
}

/// Soft in volume away from rest, in a way the moduli do not see: `-c (J-1)^4`.
#[test]
fn not_elliptic() {
    let found = fails(volumetric(|j| {
        let (c, x) = (1e7, j - 1.0);
        [-c * x.powi(4), -4.0 * c * x.powi(3), -12.0 * c * x.powi(2)]
    }));
    assert_eq!(found, "the acoustic tensor is positive");
}

/// Cancels the logarithm with a term that has no value, stress or curvature at rest: nothing resists collapse.
#[test]
fn no_growth() {
    let found = fails(volumetric(|j| {
        let (c, x) = (2.8e5, j - 1.0);
        [c * (j.ln() - x + x * x / 2.0), c * (1.0 / j - 1.0 + x), c * (1.0 - 1.0 / (j * j))]
    }));
    assert_eq!(found, "the energy grows without bound as J -> 0");
}

/// A density with wrong partial derivatives, and one that is not convex: `|F|^2 |H|^2` without its mixed part.
#[derive(Debug)]
struct Product {
    mixed: bool,
}

impl ConvexDensity for Product {
    fn value(&self, _: MaterialPoint, f: &Mat3, h: &Mat3, _: f64) -> f64 {
        f.norm_squared() * h.norm_squared() / 2.0
    }

    fn first(&self, _: MaterialPoint, f: &Mat3, h: &Mat3, _: f64) -> Conjugates {
        Conjugates { f: f * h.norm_squared(), h: h * f.norm_squared(), j: 0.0 }
    }

    fn second(&self, _: MaterialPoint, f: &Mat3, h: &Mat3, _: f64) -> Curvature {
        let mut fh = Tangent::zero();
        fh.add_outer(f, h, 2.0);
        let fh = if self.mixed { Block::Full(Box::new(fh)) } else { Block::Zero };
        Curvature {
            fh,
            ..Curvature::split(Block::Isotropic(h.norm_squared()), Block::Isotropic(f.norm_squared()), 0.0)
        }
    }
}

#[test]
fn densities() {
    let named = |result: Result<check::Report, Violation>| match result.unwrap_err() {
        Violation::Exceeds { check, .. } => check,
        other => panic!("{other}"),
    };
    assert_eq!(named(check::convex_density(&Product { mixed: false }, HERE)), "partial derivatives by F, H and J");
    assert_eq!(named(check::convex_density(&Product { mixed: true }, HERE)), "convex in F, H and J");
    // The chain rule is exact for mixed parts all the same.
    check::stress(&Product { mixed: true }, HERE, &[]).unwrap();
    check::tangent(&Product { mixed: true }, HERE, &[]).unwrap();
    check::stress_change(&Product { mixed: true }, HERE, &[]).unwrap();
    assert!(check::tangent(&Product { mixed: false }, HERE, &[]).is_err());
}

/// Every form of curvature block through the chain rule: `|F M|^2 + F M : H + (F M : N) J + (H : N) J + |H|^4`.
#[derive(Debug)]
struct Everything(Mat3, Mat3);

impl ConvexDensity for Everything {
    fn value(&self, _: MaterialPoint, f: &Mat3, h: &Mat3, j: f64) -> f64 {
        let Everything(m, n) = self;
        (f * m).dot(f) / 2.0 + (f * m).dot(h) + f.dot(n) * j + h.dot(n) * j + h.norm_squared().powi(2) / 4.0 + f.dot(h)
    }

    fn first(&self, _: MaterialPoint, f: &Mat3, h: &Mat3, j: f64) -> Conjugates {
        let Everything(m, n) = self;
        Conjugates { f: f * m + h * m + n * j + h, h: f * m + n * j + h * h.norm_squared() + f, j: f.dot(n) + h.dot(n) }
    }

    fn second(&self, _: MaterialPoint, _: &Mat3, h: &Mat3, _: f64) -> Curvature {
        let Everything(m, n) = self;
        let mut hh = Tangent::zero();
        hh.add_identity(h.norm_squared());
        hh.add_outer(h, h, 2.0);
        Curvature {
            ff: Block::Metric(*m),
            hh: Block::Full(Box::new(hh)),
            jj: 0.0,
            fh: Block::Metric(m + Mat3::identity()),
            fj: Some(*n),
            hj: Some(*n),
        }
    }
}

#[test]
fn every_block_goes_through_the_chain_rule() {
    let n = Mat3::new(0.3, 0.1, -0.2, 0.5, 0.9, 0.4, -0.6, 0.2, 0.7);
    let law = Everything(n.transpose() * n, n);
    check::partials(&law, HERE).unwrap();
    check::stress(&law, HERE, &[]).unwrap();
    check::tangent(&law, HERE, &[]).unwrap();
    check::stress_change(&law, HERE, &[]).unwrap();
    check::major_symmetry(&law, HERE, &[]).unwrap();
}

/// `W = F : H`, which is three times `J`: the mixed block in its cheapest form.
#[derive(Debug)]
struct ThriceVolume;

impl ConvexDensity for ThriceVolume {
    fn value(&self, _: MaterialPoint, f: &Mat3, h: &Mat3, _: f64) -> f64 {
        f.dot(h)
    }

    fn first(&self, _: MaterialPoint, f: &Mat3, h: &Mat3, _: f64) -> Conjugates {
        Conjugates { f: *h, h: *f, j: 0.0 }
    }

    fn second(&self, _: MaterialPoint, _: &Mat3, _: &Mat3, _: f64) -> Curvature {
        Curvature { fh: Block::Isotropic(1.0), ..Curvature::split(Block::Zero, Block::Zero, 0.0) }
    }

    fn third(
        &self,
        _: MaterialPoint,
        _: &Mat3,
        _: &Mat3,
        j: f64,
        along: [&Change; 2],
    ) -> Result<Conjugates, EnergyError> {
        Ok(Conjugates::third_by_j(0.0 * j, along))
    }
}

/// The mixed block in the chain rule of third derivatives.
#[test]
fn thrice_the_volume_in_third_order() {
    assert!(check::second_stress_change(&ThriceVolume, HERE, &[]).unwrap().is_some());
}

/// What [`Inexact`] does to the third derivatives of a neo-Hookean law.
type Fault = fn(Conjugates) -> Conjugates;

#[derive(Debug)]
struct Inexact(NeoHooke, Fault);

impl ConvexDensity for Inexact {
    fn value(&self, at: MaterialPoint, f: &Mat3, h: &Mat3, j: f64) -> f64 {
        self.0.value(at, f, h, j)
    }

    fn first(&self, at: MaterialPoint, f: &Mat3, h: &Mat3, j: f64) -> Conjugates {
        self.0.first(at, f, h, j)
    }

    fn second(&self, at: MaterialPoint, f: &Mat3, h: &Mat3, j: f64) -> Curvature {
        self.0.second(at, f, h, j)
    }

    fn third(
        &self,
        at: MaterialPoint,
        f: &Mat3,
        h: &Mat3,
        j: f64,
        along: [&Change; 2],
    ) -> Result<Conjugates, EnergyError> {
        self.0.third(at, f, h, j, along).map(self.1)
    }
}

#[test]
fn third_derivatives() {
    let law = |fault: Fault| Inexact(NeoHooke::new(1e5, 4e5).unwrap(), fault);
    assert!(check::passive(&law(|third| third), HERE).is_ok());
    let faults: [Fault; 2] =
        [|third| Conjugates { j: 1.001 * third.j, ..third }, |third| Conjugates { f: Mat3::identity() * 1e2, ..third }];
    for fault in faults {
        let found = check::passive(&law(fault), HERE);
        let check = "the second change of P is the derivative of the first";
        assert!(matches!(found, Err(Violation::Exceeds { check: found, .. }) if found == check), "{found:?}");
    }
}

/// A law without third derivatives passes all other checks, and says what it lacks when it is asked.
#[test]
fn laws_without_third_derivatives_refuse() {
    let k = check::states();
    let at = PointBatch { kinematics: &k[..1], cell: 0, first: 0 };
    let refusal = |term: &dyn EnergyTerm| {
        let changes: [&[Mat3]; 2] = [&[Mat3::identity()], &[Mat3::identity()]];
        term.second_stress_change(&at, Slots::none(), changes, &mut [Mat3::zeros()]).unwrap_err().to_string()
    };
    let boastful = Boastful(NeoHooke::new(1e5, 4e5).unwrap());
    assert!(check::second_stress_change(&boastful, HERE, &[]).unwrap().is_none());
    assert!(refusal(&boastful).ends_with(
        "Boastful gives no second derivatives of its stress; implement `ConvexDensity::third`, or do without second \
         derivatives of costs"
    ));
    let backwards = Backwards(FiberTension::along(Vec3::x()).unwrap());
    assert!(refusal(&std::sync::Arc::new(backwards)).contains("Backwards gives no second derivatives"));
}

/// An actuation whose control derivative does not change with `F`, so it says.
#[derive(Debug)]
struct Rigid(FiberTension);

impl EnergyTerm for Rigid {
    fn respond(&self, at: &PointBatch, m: Slots, want: Want, out: &mut Response) {
        self.0.respond(at, m, want, out);
    }

    fn slots(&self) -> &[Slot] {
        self.0.slots()
    }

    fn stress_by_control(&self, at: &PointBatch, m: Slots, out: &mut [Mat3]) {
        self.0.stress_by_control(at, m, out);
    }

    fn control_stress_change(
        &self,
        _: &PointBatch,
        _: Slots,
        _: &[Mat3],
        _: Slots,
        out: &mut [Mat3],
    ) -> Result<(), EnergyError> {
        out.fill(Mat3::zeros());
        Ok(())
    }
}

#[test]
fn changes_of_control_derivatives() {
    let term = Rigid(FiberTension::along(Vec3::x()).unwrap());
    assert!(matches!(
        check::actuation(&term, HERE, &[1e5]),
        Err(Violation::Exceeds { check: "the change of dP/dm is its derivative", .. })
    ));
}

#[test]
fn thrice_the_volume() {
    for k in check::states() {
        let here = check::evaluate(&ThriceVolume, HERE, &k, &[]);
        assert!((here.energy - 3.0 * k.j()).abs() < 1e-13 * k.j());
        assert!((here.stress - k.h() * 3.0).norm() < 1e-13 * k.h().norm());
        let mut expected = Tangent::zero();
        expected.add_cross(k.f(), 3.0);
        let error = here.tangent.0.iter().zip(&expected.0).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(error < 1e-14);
    }
}

/// A limit stated too high.
#[derive(Debug)]
struct Boastful(NeoHooke);

impl ConvexDensity for Boastful {
    fn value(&self, at: MaterialPoint, f: &Mat3, h: &Mat3, j: f64) -> f64 {
        self.0.value(at, f, h, j)
    }

    fn first(&self, at: MaterialPoint, f: &Mat3, h: &Mat3, j: f64) -> Conjugates {
        self.0.first(at, f, h, j)
    }

    fn second(&self, at: MaterialPoint, f: &Mat3, h: &Mat3, j: f64) -> Curvature {
        self.0.second(at, f, h, j)
    }

    fn tension_bound(&self, at: MaterialPoint) -> Option<TensionBound> {
        self.0.tension_bound(at).map(|_| TensionBound::isotropic(1.001e5))
    }
}

#[test]
fn a_tension_bound_that_is_too_high() {
    let law = NeoHooke::new(1e5, 4e5).unwrap();
    assert!(check::tension_bound(&law, HERE).unwrap().is_some());
    assert!(check::tension_bound(&Boastful(law), HERE).is_err());
}

/// A tension with the wrong sign in its control derivative.
#[derive(Debug)]
struct Backwards(FiberTension);

impl EnergyTerm for Backwards {
    fn respond(&self, at: &PointBatch, m: Slots, want: Want, out: &mut Response) {
        self.0.respond(at, m, want, out);
    }

    fn slots(&self) -> &[Slot] {
        self.0.slots()
    }

    fn stress_by_control(&self, at: &PointBatch, m: Slots, out: &mut [Mat3]) {
        self.0.stress_by_control(at, m, out);
        out.iter_mut().for_each(|p| *p = -*p);
    }
}

#[test]
fn control_derivatives() {
    let term = Backwards(FiberTension::along(Vec3::x()).unwrap());
    assert!(matches!(
        check::actuation(&term, HERE, &[1e5]),
        Err(Violation::Exceeds { check: "dP/dm is the derivative of P", .. })
    ));
    assert!(matches!(check::actuation(&term, HERE, &[]), Err(Violation::Controls { expected: 1, found: 0, .. })));
    assert!(check::drives(&term, HERE, &[1.0], &Mat3::identity()).unwrap() < 0.0);
}

/// A neo-Hookean law without the term that takes the stress at rest away: all its derivatives are right.
#[derive(Debug)]
struct StressedAtRest(NeoHooke);

impl ConvexDensity for StressedAtRest {
    fn value(&self, at: MaterialPoint, f: &Mat3, h: &Mat3, j: f64) -> f64 {
        self.0.value(at, f, h, j) + 1e3 * (j - 1.0)
    }

    fn first(&self, at: MaterialPoint, f: &Mat3, h: &Mat3, j: f64) -> Conjugates {
        let first = self.0.first(at, f, h, j);
        Conjugates { j: first.j + 1e3, ..first }
    }

    fn second(&self, at: MaterialPoint, f: &Mat3, h: &Mat3, j: f64) -> Curvature {
        self.0.second(at, f, h, j)
    }
}

#[test]
fn the_complete_check_finds_stress_at_rest() {
    let law = NeoHooke::new(1e5, 4e5).unwrap();
    let report = check::law(&law, HERE).unwrap();
    assert_eq!(report.findings.len(), 14, "{report}");
    let law = StressedAtRest(law);
    assert!(check::convex_density(&law, HERE).is_ok(), "the partial derivatives alone do not show it");
    let found = check::law(&law, HERE).unwrap_err();
    assert!(matches!(found, Violation::Exceeds { check: "the rest state has no energy and no stress", .. }), "{found}");
}
