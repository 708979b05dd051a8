//! Costs and contributions of one's own that say they span ranks, in problems of one body over ranks, which are threads here: what one process finds.

use crate::ranks::{Outcome, apart, bar, on, part, valued};
use nastic_control::{
    ControlError, ControlSmoothness, Cost, CostContext, CostPoint, Metric, Partials, Reduced, Space, Target, Tracking,
};
use nastic_energy::{FiberTension, Magnet, NeoHooke, Slot};
use nastic_fem::{Contribution, ContributionPoint, ControlPoint, Demand, Inadmissible, Instant, Need, Solid, Sums};
use nastic_linear::SparseMatrix;
use nastic_mesh::CellKind;
use nastic_opt::Problem;
use nastic_tensor::Vec3;
use std::sync::Arc;

const RANKS: [(usize, bool); 3] = [(1, false), (2, false), (3, true)];

/// `1/2 sum_a |u_a|^2` over the nodes a.
#[derive(Debug)]
struct Stillness;

/// It at one displacement: that of the nodes that belong to the rank, of others zero.
#[derive(Debug)]
struct Moved {
    value: f64,
    u: Vec<f64>,
}

impl Cost for Stillness {
    fn name(&self) -> &str {
        "stillness"
    }

    fn spans_ranks(&self) -> bool {
        true
    }

    fn at(&self, at: &CostContext) -> Result<Arc<dyn CostPoint>, ControlError> {
        let mut u = at.u.to_vec();
        let owned = at.solid.discretization().over_ranks().map_or(usize::MAX, |(part, _)| part.owned());
        u.iter_mut().skip(owned.saturating_mul(3)).for_each(|u| *u = 0.0);
        let value = at.solid.model().unknowns().total(0.5 * u.iter().map(|u| u * u).sum::<f64>());
        Ok(Arc::new(Moved { value, u }))
    }
}

impl CostPoint for Moved {
    fn value(&self) -> f64 {
        self.value
    }

    fn add_partials(&self, out: &mut Partials) -> Result<(), ControlError> {
        out.u.iter_mut().zip(&self.u).for_each(|(d, u)| *d += u);
        Ok(())
    }
}

/// A wind with a speed at five points of its own, which moves nothing.
#[derive(Debug)]
struct Wind {
    slots: [Slot; 1],
    points: Vec<ControlPoint>,
}

impl Wind {
    fn new() -> Self {
        let point = |k: usize| ControlPoint { position: [0.2 * k as f64, 0.1, 0.3], weight: 0.1 + 0.02 * k as f64 };
        Wind { slots: [Slot::design("speed", "m/s", 0.0)], points: (0..5).map(point).collect() }
    }
}

impl Contribution for Wind {
    fn name(&self) -> &str {
        "wind"
    }

    fn slots(&self) -> &[Slot] {
        &self.slots
    }

    fn control_points(&self) -> &[ControlPoint] {
        &self.points
    }

    fn stores_energy(&self) -> bool {
        true
    }

    fn spans_ranks(&self) -> bool {
        true
    }

    fn at<'a>(&'a self, _: &Instant, _: Need) -> Result<Box<dyn ContributionPoint + 'a>, Inadmissible> {
        Ok(Box::new(self))
    }
}

impl ContributionPoint for &Wind {
    fn add_residual(&self, _: &Instant, _: Demand, _: &mut Sums) -> Result<(), Inadmissible> {
        Ok(())
    }

    fn add_tangent(&self, _: &Instant, _: &mut SparseMatrix) -> Result<(), Inadmissible> {
        Ok(())
    }

    fn add_tangent_product(&self, _: &Instant, _: &[f64], _: &mut [f64]) -> Result<bool, Inadmissible> {
        Ok(true)
    }
}

fn body(solid: Solid) -> Outcome<Solid> {
    Ok(solid.material("body", NeoHooke::new(1e5, 1e6)?)?.clamp("x-")?)
}

/// Cost and derivative over ranks beside those of one process, at the control that `m` gives for a place.
fn assert_agrees(make: impl Fn(Solid) -> Outcome<Reduced> + Sync, m: impl Fn(usize) -> f64) -> Outcome {
    let mesh = bar(CellKind::Hex8, 1)?;
    let serial = make(Solid::new(mesh.clone())?)?;
    let m: Vec<f64> = (0..serial.layout().len()).map(m).collect();
    let (cost, derivative) = valued(&serial, &m)?;
    assert!(derivative.iter().any(|d| *d != 0.0), "nothing depends on the control");
    for (ranks, scattered) in RANKS {
        let found = on(ranks, |rank| valued(&make(part(&mesh, &rank, scattered)?)?, &m));
        let (own, own_derivative) = found[0].clone()?;
        assert!(found.iter().all(|other| *other == found[0]), "on {ranks}: not the same bits");
        let off = apart(&own_derivative, &derivative);
        assert!((own - cost).abs() < 1e-9 * cost && off < 1e-8, "on {ranks}: {own:e} {cost:e}, off by {off:e}");
    }
    Ok(())
}

#[test]
fn a_cost_of_ones_own_that_spans_ranks_has_the_derivative_of_one_process() -> Outcome {
    let still = |solid: Solid| -> Outcome<Reduced> {
        let solid = body(solid)?.actuate("body", "tension", FiberTension::along(Vec3::x())?)?;
        Ok(Reduced::new(solid).control("tension", Space::Node)?.cost(Stillness)?)
    };
    assert_agrees(still, |k| -1e4 * (1.5 + (k as f64).sin()))
}

#[test]
fn vectors_of_one_length_have_the_derivative_of_one_process() -> Outcome {
    let lifted = |solid: Solid| -> Outcome<Reduced> {
        let up = Target::position(|x| [x[0], x[1] + 0.05, x[2] + 0.3]);
        let problem = Reduced::new(body(solid)?.actuate("body", "magnet", Magnet::new())?)
            .control("magnet.remanence", Space::Node)?
            .of_length("magnet.remanence", 0.1)?;
        Ok(problem.control("magnet.field", Space::Uniform)?.cost(Tracking::surface("x+", up))?)
    };
    let nodes = bar(CellKind::Hex8, 1)?.points().len();
    assert_agrees(lifted, |k| if k < 3 * nodes { 0.1 + 0.05 * (k as f64).sin() } else { 3e-3 * (k as f64).cos() })
}

#[test]
fn fields_over_points_of_a_contribution_have_the_inner_products_of_one_process() -> Outcome {
    let mesh = bar(CellKind::Hex8, 1)?;
    let blown = |solid: Solid, metric: Metric| -> Outcome<Reduced> {
        let problem =
            Reduced::new(body(solid)?.contribution(Wind::new())?).control("wind.speed", Space::Grid([3, 1, 1]))?;
        Ok(problem.cost(ControlSmoothness::of("wind.speed", 1.0)?)?.metric(metric))
    };
    for metric in [Metric::L2, Metric::H1 { length: 0.5 }] {
        let serial = blown(Solid::new(mesh.clone())?, metric)?;
        let m: Vec<f64> = (0..serial.layout().len()).map(|k| 1.0 + (k as f64).sin()).collect();
        let (cost, product) = (serial.at(&m)?.cost(), serial.inner_product()?);
        for of_rank in on(3, |rank| {
            let own = blown(part(&mesh, &rank, false)?, metric)?;
            Ok((own.at(&m)?.cost(), own.inner_product()?.apply(&m)))
        }) {
            let (own, applied) = of_rank?;
            let off = apart(&applied, &product.apply(&m));
            assert!((own - cost).abs() < 1e-12 * cost && off < 1e-12, "{metric:?}: {own} {cost}, off by {off:e}");
        }
    }
    Ok(())
}
