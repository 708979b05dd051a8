use super::network_fits::CONVEX_NETWORK_FITS;
use super::{Made, MaterialRow, Parameter};
use crate::ConvexNetwork;
use crate::network::NetworkInput::{
    Across, AcrossIsochoric, Fiber, FiberIsochoric, First, FirstIsochoric, Jacobian, Second, SecondIsochoric,
};
use crate::network::{ExampleLayer, NetworkInput};

pub const CONVEX_NETWORK: MaterialRow = MaterialRow {
    name: ConvexNetwork::NAME,
    about: "learned: a convex neural network of invariants, with a fibre or without",
    existence: "polyconvex; W -> inf as J -> 0; coercive where the network grows with I1 and I2",
    reinforcing: false,
    forms: &[
        &[ISOCHORIC, SCALE, BULK],
        &[WITH_FIBER, SCALE, Parameter::direction("fiber", [0.6, 0.8, 0.0]), BULK],
        &[COMPRESSIBLE, SCALE, D1],
        &[COMPRESSIBLE_WITH_FIBER, SCALE, Parameter::direction("fiber", [0.6, 0.8, 0.0]), D1],
    ],
    fit: CONVEX_NETWORK_FITS,
    make: |given| {
        let (network, scale) = (given.network("network")?, given.number("scale")?);
        let fiber = given.direction_or_none("fiber");
        Ok(Made::linear(match given.form_has("d1") {
            true => ConvexNetwork::from_d1(network, scale, given.number("d1")?, fiber)?,
            false => ConvexNetwork::new(network, scale, given.number("bulk")?, fiber)?,
        }))
    },
};

/// May stand in the file of the network.
const SCALE: Parameter = Parameter::number("scale", "Pa", 1e5).optional();
const BULK: Parameter = Parameter::number("bulk", "Pa", 1e6);
const D1: Parameter = Parameter::number("d1", "1/Pa", 2e-6);

const fn network(inputs: &'static [NetworkInput], layers: &'static [ExampleLayer]) -> Parameter {
    Parameter::network("network", inputs, layers)
}

/// Two layers.
const ISOCHORIC: Parameter = network(
    &[FirstIsochoric, SecondIsochoric],
    &[
        ExampleLayer { through: &[&[0.3, 0.0], &[0.1, 0.2]], before: &[], bias: &[-0.5, 0.2] },
        ExampleLayer { through: &[&[0.0, 0.1], &[0.2, 0.0]], before: &[&[0.7, 0.2], &[0.1, 0.5]], bias: &[0.1, -0.4] },
        ExampleLayer { through: &[&[0.2, 0.05]], before: &[&[1.1, 0.6]], bias: &[] },
    ],
);
/// One.
const WITH_FIBER: Parameter = network(
    &[FirstIsochoric, FiberIsochoric, SecondIsochoric, AcrossIsochoric],
    &[
        ExampleLayer { through: &[&[0.3, 0.4, 0.1, 0.0], &[0.0, 0.3, 0.2, 0.1]], before: &[], bias: &[-0.5, 0.2] },
        ExampleLayer { through: &[&[0.5, 0.0, 0.1, 0.0]], before: &[&[1.1, 0.6]], bias: &[0.3] },
    ],
);
const COMPRESSIBLE: Parameter = network(
    &[First, Second, Jacobian],
    &[
        ExampleLayer {
            through: &[&[0.2, 0.0, -0.4], &[0.1, 0.1, 0.2], &[0.0, 0.2, -0.1]],
            before: &[],
            bias: &[-0.5, 0.2, 0.0],
        },
        ExampleLayer { through: &[&[0.3, 0.1, -0.2]], before: &[&[0.5, 0.6, 0.2]], bias: &[] },
    ],
);
/// Three, the second of one unit.
const COMPRESSIBLE_WITH_FIBER: Parameter = network(
    &[First, Second, Jacobian, Fiber, Across],
    &[
        ExampleLayer {
            through: &[&[0.2, 0.0, -0.4, 0.1, 0.0], &[0.1, 0.1, 0.2, 0.0, 0.3]],
            before: &[],
            bias: &[-0.5, 0.2],
        },
        ExampleLayer { through: &[&[0.1, 0.0, 0.0, 0.1, 0.0]], before: &[&[0.5, 0.6]], bias: &[0.1] },
        ExampleLayer { through: &[&[0.4, 0.0, 0.1, 0.0, 0.0]], before: &[&[0.9]], bias: &[0.2] },
        ExampleLayer { through: &[&[0.3, 0.1, -0.2, 0.0, 0.0]], before: &[&[0.8]], bias: &[] },
    ],
);
