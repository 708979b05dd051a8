//! Convex networks against the law `formula`, drawn at random, and what they refuse.
#![allow(clippy::unwrap_used)] // a test may

use nastic_energy::catalogue::{Inputs, material};
use nastic_energy::formula::{Expression, Invariant, Step};
use nastic_energy::network::NetworkInput::{self, *};
use nastic_energy::network::{Network, NetworkLayer};
use nastic_energy::{
    ConvexDensity, ConvexNetwork, EnergyTerm, Field, FormulaLaw, Growth, MaterialPoint, PointBatch, Slots, check,
};
use nastic_tensor::{Kinematics, Mat3, Vec3};
use std::collections::BTreeMap;

const HERE: MaterialPoint = MaterialPoint { cell: 0, point: 0 };
const SCALE: f64 = 3e4;
const BULK: f64 = 2e5;

/// Uniform numbers in [0, 1) (splitmix64).
struct Sequence(u64);

impl Sequence {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// Hidden layers of these widths, every third weight zero, those of J of either sign.
fn random_network(inputs: &[NetworkInput], widths: &[usize], random: &mut Sequence) -> Network {
    let mut layers = Vec::new();
    let mut before = 0;
    for (k, &units) in widths.iter().chain(&[1]).enumerate() {
        let weight = |random: &mut Sequence| {
            let size = if random.next() < 0.33 { 0.0 } else { random.next() };
            size / (1.0 + before as f64)
        };
        let of_input = |input: &NetworkInput, random: &mut Sequence| match input {
            Jacobian => 2.0 * random.next() - 1.0,
            _ => weight(random) + if k == widths.len() { 0.02 } else { 0.0 },
        };
        let through: Vec<Vec<f64>> =
            (0..units).map(|_| inputs.iter().map(|input| of_input(input, random)).collect()).collect();
        let weights = (0..if k == 0 { 0 } else { units }).map(|_| (0..before).map(|_| weight(random)).collect());
        let before_rows: Vec<Vec<f64>> = weights.collect();
        let bias = (0..units).map(|_| 4.0 * random.next() - 2.0).collect();
        layers.push(NetworkLayer { through, before: before_rows, bias });
        before = units;
    }
    Network { inputs: inputs.to_vec(), layers }
}

fn law(network: &Network, with_fiber: bool) -> ConvexNetwork {
    let fiber = with_fiber.then(|| Field::Uniform(Vec3::new(0.48, 0.6, 0.64)));
    ConvexNetwork::new(network, SCALE, BULK, fiber).unwrap()
}

const ISOCHORIC: &[NetworkInput] = &[FirstIsochoric, SecondIsochoric];
const WITH_FIBER: &[NetworkInput] = &[FirstIsochoric, SecondIsochoric, FiberIsochoric, AcrossIsochoric];
const COMPRESSIBLE: &[NetworkInput] = &[First, Second, Jacobian];
const COMPRESSIBLE_FIBER: &[NetworkInput] = &[First, Second, Jacobian, Fiber, Across];
const KINDS: [(&[NetworkInput], bool); 6] = [
    (ISOCHORIC, false),
    (WITH_FIBER, true),
    (&[FirstIsochoric, FiberIsochoric], true),
    (&[FirstIsochoric, AcrossIsochoric], true),
    (COMPRESSIBLE, false),
    (COMPRESSIBLE_FIBER, true),
];

#[test]
fn networks_of_one_to_three_layers_keep_the_contract() {
    let mut random = Sequence(1);
    for (inputs, with_fiber) in KINDS {
        for widths in [&[] as &[usize], &[3], &[4, 4], &[3, 1, 2]] {
            let law = law(&random_network(inputs, widths, &mut random), with_fiber);
            let name = format!("{inputs:?} {widths:?}");
            check::passive(&law, HERE).unwrap_or_else(|e| unreachable!("{name}: {e}"));
            check::convex_density(&law, HERE).unwrap_or_else(|e| unreachable!("{name}: {e}"));
            check::tension_bound(&law, HERE).unwrap_or_else(|e| unreachable!("{name}: {e}"));
            assert!(check::second_stress_change(&law, HERE, &[]).unwrap().is_some(), "{name}");
        }
    }
}

/// 10,000 networks of all kinds: convex in F, H and J at states of their own, free of stress at rest.
#[test]
fn ten_thousand_random_networks_are_convex() {
    let (mut random, states) = (Sequence(2), check::states());
    for n in 0..10_000 {
        let (inputs, with_fiber) = KINDS[n % KINDS.len()];
        let all: [&[usize]; 4] = [&[2], &[4], &[4, 4], &[3, 3, 3]];
        let widths = all[n / KINDS.len() % 4];
        let law = law(&random_network(inputs, widths, &mut random), with_fiber);
        let [a, b, c] = [0, 1, 2].map(|_| &states[(random.next() * states.len() as f64) as usize]);
        let hessian = check::hessian(&law, HERE, a.f(), b.h(), c.j());
        let least = hessian.symmetric_eigenvalues().min();
        assert!(least >= -1e-13 * hessian.norm(), "{n}: {least} {law:?}");
        let rest = check::evaluate(&law, HERE, &Kinematics::rest(), &[]);
        let stiffness = rest.tangent.0.iter().map(|c| c * c).sum::<f64>().sqrt();
        assert!(rest.energy.abs() + rest.stress.norm() < 1e-14 * stiffness, "{n}: {}", rest.stress);
    }
}

type Steps = Vec<Step>;

fn number(x: f64) -> Steps {
    vec![Step::Number(x)]
}

fn two(a: Steps, b: Steps, step: Step) -> Steps {
    [a, b, vec![step]].concat()
}

fn one(a: Steps, step: Step) -> Steps {
    [a, vec![step]].concat()
}

/// The inputs that a formula knows, each less its value at rest.
fn input(input: NetworkInput) -> Steps {
    let power = |of: Invariant, exponent: f64| two(vec![Step::Invariant(of)], number(exponent), Step::Power);
    let (j, times) = (Invariant::Jacobian, Step::Multiply);
    let (value, rest) = match input {
        FirstIsochoric => (two(power(j, -2.0 / 3.0), power(Invariant::First, 1.0), times), 3.0),
        SecondIsochoric => (two(power(j, -2.0), power(Invariant::Second, 1.5), times), 27f64.sqrt()),
        FiberIsochoric => (two(power(j, -2.0 / 3.0), power(Invariant::Fiber, 1.0), times), 1.0),
        First => (power(Invariant::First, 1.0), 3.0),
        Second => (power(Invariant::Second, 1.0), 3.0),
        Fiber => (power(Invariant::Fiber, 1.0), 1.0),
        Jacobian => (power(j, 1.0), 1.0),
        AcrossIsochoric | Across => unreachable!("no formula has |H a|^2"),
    };
    two(value, number(rest), Step::Subtract)
}

/// The network as a formula, `softplus(t) = log(1 + exp t)`, with all numbers written out.
fn formula(network: &Network) -> Steps {
    let mut before: Vec<Steps> = Vec::new();
    for (k, layer) in network.layers.iter().enumerate() {
        let is_last = k + 1 == network.layers.len();
        let unit = |row: usize| {
            let mut t = number(if is_last { 0.0 } else { layer.bias[row] });
            for (a, weight) in layer.through[row].iter().enumerate() {
                t = two(t, two(number(*weight), input(network.inputs[a]), Step::Multiply), Step::Add);
            }
            for (z, weight) in before.iter().zip(layer.before.get(row).into_iter().flatten()) {
                t = two(t, two(number(*weight), z.clone(), Step::Multiply), Step::Add);
            }
            if is_last { t } else { one(two(number(1.0), one(t, Step::Exp), Step::Add), Step::Log) }
        };
        before = (0..layer.through.len()).map(unit).collect();
    }
    before.remove(0)
}

/// `s (N - N(0) - n log J) + kappa/4 (J^2 - 1 - 2 log J)`.
fn whole(network: &Network, n: f64) -> Expression {
    let energy = formula(network);
    let j = || vec![Step::Invariant(Invariant::Jacobian)];
    let log = one(j(), Step::Log);
    let rest = value_at_rest(network);
    let shape = two(energy, number(rest), Step::Subtract);
    let shape = two(shape, two(number(n), log, Step::Multiply), Step::Subtract);
    Expression::new("network", two(two(number(SCALE), shape, Step::Multiply), elastic(), Step::Add))
}

/// `kappa/4 (J^2 - 1 - 2 log J)`
fn elastic() -> Steps {
    let j = || vec![Step::Invariant(Invariant::Jacobian)];
    let square = two(two(j(), number(2.0), Step::Power), number(1.0), Step::Subtract);
    let twice = two(number(2.0), one(j(), Step::Log), Step::Multiply);
    two(number(0.25 * BULK), two(square, twice, Step::Subtract), Step::Multiply)
}

/// N where all inputs vanish.
fn value_at_rest(network: &Network) -> f64 {
    let mut before: Vec<f64> = Vec::new();
    for (k, layer) in network.layers.iter().enumerate() {
        let is_last = k + 1 == network.layers.len();
        let sum = |row: usize| -> f64 {
            let bias = if is_last { 0.0 } else { layer.bias[row] };
            let weights = layer.before.get(row).into_iter().flatten();
            bias + weights.zip(&before).map(|(w, z)| w * z).sum::<f64>()
        };
        before = (0..layer.through.len()).map(|row| if is_last { sum(row) } else { sum(row).exp().ln_1p() }).collect();
    }
    before[0]
}

fn close(name: &str, found: &[f64], expected: &[f64]) {
    let scale = expected.iter().fold(0.0f64, |most, x| most.max(x.abs()));
    let error = found.iter().zip(expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(error <= 1e-12 * scale, "{name}: {} of {scale}", error / scale);
}

/// Value, stress, tangent, its product, and the second change of the stress: all that a formula has, to 1e-12.
#[test]
fn a_small_network_is_a_formula() {
    let mut random = Sequence(3);
    let kinds: [(&[NetworkInput], &[usize]); 4] =
        [(ISOCHORIC, &[2]), (ISOCHORIC, &[2, 2]), (COMPRESSIBLE, &[2]), (COMPRESSIBLE, &[2, 2])];
    for (inputs, widths) in kinds {
        let network = random_network(inputs, widths, &mut random);
        let own = law(&network, false);
        // the pressure at rest of the network alone, read off a law without the term that takes it away
        let n = pressure_at_rest(&network);
        let other = FormulaLaw::new(&whole(&network, n), &BTreeMap::new(), None).unwrap();
        for (at, k) in check::states().iter().enumerate() {
            let name = format!("{inputs:?} {widths:?} {at}");
            let [found, expected] = [&own as &dyn EnergyTerm, &other].map(|law| check::evaluate(law, HERE, k, &[]));
            close(&name, &[found.energy], &[expected.energy]);
            close(&name, found.stress.as_slice(), expected.stress.as_slice());
            close(&name, &found.tangent.0, &expected.tangent.0);
            let points = PointBatch { kinematics: std::slice::from_ref(k), cell: 0, first: 0 };
            let [a, b] = [0, 1].map(|_| Mat3::from_fn(|_, _| random.next() - 0.5));
            let second = |law: &dyn EnergyTerm| {
                let mut out = [Mat3::zeros()];
                law.second_stress_change(&points, Slots::none(), [&[a], &[b]], &mut out).unwrap();
                out[0]
            };
            close(&name, second(&own).as_slice(), second(&other).as_slice());
        }
    }
}

/// `n = 2 N_1 + 4 N_2 + N_J` by differences of the network's value along its inputs; zero of isochoric ones.
fn pressure_at_rest(network: &Network) -> f64 {
    let factors: Vec<f64> = network
        .inputs
        .iter()
        .map(|input| match input {
            First => 2.0,
            Second => 4.0,
            Jacobian => 1.0,
            _ => 0.0,
        })
        .collect();
    // forward through the layers, with derivatives by the combination
    let mut before: Vec<[f64; 2]> = Vec::new();
    for (k, layer) in network.layers.iter().enumerate() {
        let is_last = k + 1 == network.layers.len();
        let unit = |row: usize| {
            let own: f64 = layer.through[row].iter().zip(&factors).map(|(w, factor)| w * factor).sum();
            let weights = || layer.before.get(row).into_iter().flatten();
            let value = layer.bias[row] + weights().zip(&before).map(|(w, z)| w * z[0]).sum::<f64>();
            let slope = own + weights().zip(&before).map(|(w, z)| w * z[1]).sum::<f64>();
            if is_last { [value, slope] } else { [value.exp().ln_1p(), slope / (1.0 + (-value).exp())] }
        };
        before = (0..layer.through.len()).map(unit).collect();
    }
    before[0][1]
}

/// A network without hidden layers is Mooney-Rivlin's law in its two isochoric invariants, a neo-Hookean one in the first alone.
#[test]
fn a_network_without_hidden_layers_is_linear() {
    let linear = |weights: &[f64]| {
        let inputs = ISOCHORIC[..weights.len()].to_vec();
        let layer = NetworkLayer { through: vec![weights.to_vec()], ..NetworkLayer::default() };
        Network { inputs, layers: vec![layer] }
    };
    let law = ConvexNetwork::new(&linear(&[0.5]), 1e5, 5e5, None).unwrap();
    let other = nastic_energy::NeoHookeIsochoric::new(1e5, 5e5).unwrap();
    for k in check::states() {
        let [found, expected] = [&law as &dyn EnergyTerm, &other].map(|law| check::evaluate(law, HERE, &k, &[]));
        close("neo-Hookean", &found.tangent.0, &expected.tangent.0);
        close("neo-Hookean", &[found.energy], &[expected.energy]);
    }
    let moduli = |law: &ConvexNetwork| law.small_strain(HERE).unwrap();
    let law = ConvexNetwork::new(&linear(&[0.5, 0.2]), 1e5, 5e5, None).unwrap();
    // mu/2 x1 is one of mu; w x2 one of 3 sqrt(3) w
    assert!((moduli(&law).mu_t / (1e5 * (1.0 + 0.6 * 3f64.sqrt())) - 1.0).abs() < 1e-13);
    assert!((moduli(&law).mu_t / (1e5 * law.shear_over_scale()) - 1.0).abs() < 1e-13);
    assert!((moduli(&law).bulk() / 5e5 - 1.0).abs() < 1e-13);
}

/// Growth follows paths of positive weights; a multiple of |F|^2 in the last layer is the tension that the law bears.
#[test]
fn growth_and_tensions_follow_the_weights() {
    let layer = |through: Vec<Vec<f64>>, before: Vec<Vec<f64>>, bias: Vec<f64>| NetworkLayer { through, before, bias };
    let network = |through: Vec<f64>, before: Vec<f64>| Network {
        inputs: vec![First, Second],
        layers: vec![
            layer(vec![vec![0.3, 0.0], vec![0.0, 0.5]], vec![], vec![0.0, 0.0]),
            layer(vec![through], vec![before], vec![]),
        ],
    };
    let growth = |law: &ConvexNetwork| law.conditions(HERE).unwrap().growth;
    let of =
        |through: Vec<f64>, before: Vec<f64>| ConvexNetwork::new(&network(through, before), SCALE, BULK, None).unwrap();
    let both = of(vec![0.2, 0.0], vec![1.0, 1.0]);
    assert_eq!(growth(&both), Growth { p: 2.0, q: 2.0, r: 2.0 });
    assert!(both.conditions(HERE).unwrap().holds());
    assert!((both.fiber_limit(HERE, &Vec3::x()).unwrap() / (0.4 * SCALE) - 1.0).abs() < 1e-14);
    let first = of(vec![0.0, 0.0], vec![1.0, 0.0]);
    assert_eq!(growth(&first), Growth { p: 2.0, q: 0.0, r: 2.0 });
    assert_eq!(first.fiber_limit(HERE, &Vec3::x()), Some(0.0));
}

fn message(network: &Network, fiber: bool) -> String {
    let fiber = fiber.then(|| Field::Uniform(Vec3::x()));
    ConvexNetwork::new(network, SCALE, BULK, fiber).unwrap_err().to_string()
}

#[test]
fn what_is_no_convex_network_is_refused_with_the_entry() {
    let good = random_network(ISOCHORIC, &[2, 2], &mut Sequence(4));
    let with = |change: &dyn Fn(&mut Network)| {
        let mut network = good.clone();
        change(&mut network);
        message(&network, false)
    };
    let error = with(&|n| n.layers[1].before[1][0] = -0.25);
    assert!(error.contains("convex_network: layers[1].before[1][0] = -2.5e-1, but it must not be negative"), "{error}");
    let error = with(&|n| n.layers[0].through[0][1] = -1e-9);
    assert!(error.contains("layers[0].through[0][1] = -1e-9"), "{error}");
    let error = with(&|n| n.layers[2].through[0][0] = f64::NAN);
    assert!(error.contains("layers[2].through[0][0] is NaN: a finite number"), "{error}");
    let error = with(&|n| n.layers[0].bias[1] = f64::INFINITY);
    assert!(error.contains("layers[0].bias[1] is inf"), "{error}");
    let error = with(&|n| n.layers[1].before[0].push(0.0));
    assert!(
        error.contains("layers[1].before[0] has 3 entries, but 2 are wanted: one for each unit of the layer before"),
        "{error}"
    );
    let error = with(&|n| n.layers[1].before.clear());
    assert!(error.contains("layers[1].before has 0 entries, but 2 are wanted"), "{error}");
    let error = with(&|n| n.layers[2].through.push(vec![0.0, 0.0]));
    assert!(error.contains("layers[2].through has 2 entries, but 1 are wanted"), "{error}");
    assert!(with(&|n| n.layers[0].before = vec![vec![1.0], vec![1.0]]).contains("layers[0].before has 2 entries"));
    assert!(with(&|n| n.layers.clear()).contains("one layer at least, this has 2 and 0"));
    assert!(with(&|n| n.inputs[1] = FirstIsochoric).contains("\"I1b\" stands there twice"));
    assert!(with(&|n| n.inputs[1] = Second).contains("\"I1b\" is free of the change of volume, \"I2\" is not"));
    assert!(with(&|n| n.inputs[1] = FiberIsochoric).contains("\"I4b\" is one of a fibre, and no \"fiber\" is given"));
    assert!(message(&good, true).contains("no input of the network is one of fibres"));
    let error = with(&|n| n.layers[2] = NetworkLayer { before: vec![vec![0.0, 0.0]], ..NetworkLayer::default() });
    assert!(error.contains("no shear stiffness at rest (0e0 times its scale)"), "{error}");
    let wide = random_network(ISOCHORIC, &[257], &mut Sequence(5));
    assert!(message(&wide, false).contains("layers[0] has 257 units; at most 256"));
    // weights of J may have either sign
    let mut of_j = random_network(COMPRESSIBLE, &[2], &mut Sequence(6));
    of_j.layers[0].through[0][2] = -3.0;
    check::polyconvexity(&law(&of_j, false), HERE).unwrap();
}

/// Scale and bulk modulus are slots of the catalogue's row: W is linear in both.
#[test]
fn the_scale_is_a_slot() {
    let row = material("convex_network").unwrap();
    let inputs = row.examples().swap_remove(1);
    let term = row.parametrised(&inputs, &["bulk", "scale"]).unwrap();
    assert_eq!(term.slots().iter().map(|slot| slot.group).collect::<Vec<_>>(), ["bulk", "scale"]);
    check::actuation(&*term, HERE, &[2e6, 3e4]).unwrap();
    let without = Inputs::new();
    assert!(row.build(&without).unwrap_err().to_string().contains("convex_network needs network"));
}
