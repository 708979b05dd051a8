//! The contracts of every control space and of every inner product of control fields.

#[path = "../../opt/tests/common/inner_product.rs"]
mod contract;

use contract::vector;
use nastic_control::{ControlEntity, ControlError, METRICS, Reduced, SPACES, Space};
use nastic_energy::{Magnet, MooneyRivlin, Turgor};
use nastic_fem::{Discretization, Solid};
use nastic_mesh::{CellKind, box_mesh};
use nastic_opt::Problem;
use std::sync::Arc;

type Outcome<T = ()> = Result<T, Box<dyn std::error::Error>>;

/// A bar with a scalar and two vector controls.
fn bar(kind: CellKind) -> Outcome<Solid> {
    let mesh = box_mesh([1.0, 0.2, 0.2], [3, 2, 1], kind)?.mapped(|x| [x[0], x[1] * (1.0 + 0.4 * x[0]), x[2]])?;
    Ok(Solid::on(Discretization::new(Arc::new(mesh))?)
        .material("body", MooneyRivlin::new(1e5, 2e4, 5e5)?)?
        .actuate("body", "turgor", Turgor::new())?
        .actuate("body", "magnet", Magnet::new())?
        .clamp("x-")?)
}

/// A scalar, an amplitude along a direction and a vector, all of one space.
fn controlled(kind: CellKind, space: Space) -> Outcome<Reduced> {
    Ok(Reduced::new(bar(kind)?)
        .control("turgor", space)?
        .control_along("magnet.field", space, [1.0, 2.0, -2.0])?
        .control("magnet.remanence", space)?)
}

/// `<to_points(a), v> = <a, control_vjp(v)>`: the derivative by the controls is the transpose of the map.
#[test]
fn the_map_to_the_points_and_its_transpose_are_adjoint() -> Outcome {
    for row in SPACES {
        for kind in [CellKind::Hex8, CellKind::Hex20, CellKind::Tet10] {
            let problem = controlled(kind, row.space)?;
            let layout = problem.layout();
            for seed in 1..4 {
                let a = vector(layout.len(), seed);
                let at_points = layout.to_points(&a)?;
                let mut v = problem.solid().controls();
                let mut left = 0.0;
                for k in 0..v.len() {
                    let values = vector(v.values(k).len(), seed + 50 + k as u64);
                    left += values.iter().zip(at_points.values(k)).map(|(v, a)| v * a).sum::<f64>();
                    v.values_mut(k).copy_from_slice(&values);
                }
                let right: f64 = layout.control_vjp(&a, &v).iter().zip(&a).map(|(d, a)| d * a).sum();
                let size = (layout.len() as f64).max(left.abs());
                assert!((left - right).abs() < 1e-12 * size, "{}, {kind}: {left:e} and {right:e}", row.name);
            }
        }
    }
    Ok(())
}

/// A field of one value has it at every point, and values between the least and the largest lie there too.
#[test]
fn constants_are_reproduced_and_bounds_kept() -> Outcome {
    for row in SPACES {
        assert_eq!(row.name, row.space.name());
        for kind in [CellKind::Hex8, CellKind::Hex27, CellKind::Tet4] {
            let problem = controlled(kind, row.space)?;
            let layout = problem.layout();
            let basis = &layout.block("turgor")?.basis;
            let constant = layout.to_points(&vec![0.75; layout.len()])?;
            assert!(constant.values(0).iter().all(|v| (v - 0.75).abs() < 1e-14), "{}, {kind}", row.name);
            let m = vector(layout.len(), 3);
            let (low, high) = m[..basis.len()].iter().fold((f64::MAX, f64::MIN), |(l, h), x| (l.min(*x), h.max(*x)));
            let varied = layout.to_points(&m)?;
            let inside = |v: &f64| low - 1e-14 <= *v && *v <= high + 1e-14;
            assert!(varied.values(0).iter().all(inside), "{}, {kind}", row.name);
            assert_eq!((basis.positions().len(), basis.entities().len()), (basis.len(), basis.len()));
        }
    }
    Ok(())
}

#[test]
fn every_inner_product_of_every_space_keeps_its_contract() -> Outcome {
    for metric in METRICS {
        for row in SPACES {
            let problem = controlled(CellKind::Hex8, row.space)?.metric((metric.make)(0.3));
            contract::keeps_its_contract(
                problem.inner_product()?.as_ref(),
                &format!("{} of {}", metric.name, row.name),
            );
        }
    }
    Ok(())
}

/// What cannot be had is an error with its type, and nothing takes its place.
#[test]
fn products_that_cannot_be_built_and_problems_without_controls_are_errors() -> Outcome {
    for length in [0.0, -1.0, f64::NAN] {
        let problem = controlled(CellKind::Hex8, Space::Node)?.metric((METRICS[1].make)(length));
        let refused = problem.inner_product().unwrap_err();
        assert!(matches!(refused.downcast_ref(), Some(ControlError::Cost { what }) if what.contains("smoothing")));
    }
    let refused = Reduced::new(bar(CellKind::Hex8)?).inner_product().unwrap_err();
    assert!(matches!(refused.downcast_ref(), Some(ControlError::NoControls { .. })), "{refused}");
    let words = refused.to_string();
    for word in [".control(NAME, Space::Cell)", "turgor", "magnet.remanence", "magnet.field"] {
        assert!(words.contains(word), "{words}");
    }
    Ok(())
}

/// Values are reported with what they belong to: the field that is constant there, of all spaces and of vectors too.
#[test]
fn values_come_with_their_entities() -> Outcome {
    for row in SPACES {
        let problem = controlled(CellKind::Hex20, row.space)?;
        let m: Vec<f64> = (0..problem.layout().len()).map(|i| i as f64).collect();
        let at_points = problem.layout().to_points(&m)?;
        for (name, unit) in [("turgor", "Pa"), ("magnet.field", "T"), ("magnet.remanence", "T")] {
            let block = problem.layout().block(name)?;
            let values = problem.values(name, &m)?;
            assert_eq!(values.unit(), unit);
            assert_eq!(values.iter().len(), block.basis.len(), "{name}, {}", row.name);
            for (k, (entity, value)) in values.iter().enumerate() {
                let first = block.first + k * block.components;
                assert_eq!(value, &m[first..first + block.components], "{name}, {entity}");
                assert_eq!(values.get(entity), Some(value));
                // Where the entity says that it is: at all points of a cell, of the region, of the body.
                if let (ControlEntity::Cell(cell), "magnet.remanence") = (entity, name) {
                    let (first, count) = problem.solid().discretization().points_of_cells()[cell as usize];
                    for q in first..first + count {
                        let stride = at_points.slots(block.targets[0].actuation);
                        assert_eq!(
                            &at_points.values(block.targets[0].actuation)[q * stride + block.targets[0].slot..][..3],
                            value
                        );
                    }
                }
            }
        }
        let first = problem.values("turgor", &m)?.iter().next().map(|(entity, _)| entity);
        let expected = match row.space {
            Space::Uniform => ControlEntity::Whole,
            Space::Region => ControlEntity::Region("body"),
            Space::Cell => ControlEntity::Cell(0),
            Space::Point => ControlEntity::Point(0),
            Space::Node => ControlEntity::Node(0),
            Space::Grid(_) => ControlEntity::GridNode(0),
        };
        assert_eq!(first, Some(expected));
        assert!(matches!(problem.values("tugor", &m), Err(ControlError::UnknownControl { .. })));
        assert!(matches!(problem.values("turgor", &m[1..]), Err(ControlError::Length { .. })));
    }
    Ok(())
}
