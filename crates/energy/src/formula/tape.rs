use std::collections::BTreeMap;

use super::graph::{Graph, Id, Node, Sign};
use super::number::Number;

/// A number of a tape by its register.
type Register = u16;

/// Registers at most: evaluations keep them on the stack.
const MOST_REGISTERS: usize = 512;
/// The first ones hold the invariants.
const INPUTS: usize = 4;

/// One operation on registers.
#[derive(Clone, Copy, Debug)]
struct Instruction {
    code: Code,
    a: Register,
    b: Register,
    to: Register,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Code {
    Constant(f64),
    /// An invariant, which has its register.
    Input,
    Parameter,
    Negate,
    Add,
    Subtract,
    Multiply,
    /// `c (a + s)`
    Affine(f64, f64),
    /// `a + c (b + s)`
    AddAffine(f64, f64),
    Power,
    Square,
    Cube,
    Inverse,
    Whole(i32),
    ThirdRoot,
    Minimum,
    Maximum,
    Less,
    LessOrEqual,
    Exp,
    Log,
    Sqrt,
    Sin,
    Cos,
    Abs,
}

/// Why an operation has no value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fault {
    /// What was bounded.
    pub measure: &'static str,
    /// What was found.
    pub value: f64,
    /// What it has to stay beyond.
    pub limit: f64,
}

/// Nodes of a graph as a flat program on few registers: the values that are asked for, each intermediate one computed once.
#[derive(Clone, Debug, Default)]
pub struct Tape {
    code: Vec<Instruction>,
    outputs: Vec<Register>,
    registers: usize,
    safe: bool,
}

impl Tape {
    /// The program that computes these nodes; `None` where it takes too many registers.
    pub fn new(graph: &Graph, outputs: &[Id]) -> Option<Self> {
        let order = needed(graph, outputs);
        let mut last: BTreeMap<Id, usize> = BTreeMap::new();
        for (at, &id) in order.iter().enumerate() {
            last.insert(id, at);
            instruction(graph, id).1.into_iter().flatten().for_each(|a| _ = last.insert(a, at));
        }
        outputs.iter().for_each(|id| _ = last.insert(*id, usize::MAX));
        let safe = order.iter().all(|&id| is_safe(graph, id));
        let mut tape = Tape { safe, registers: INPUTS, ..Tape::default() };
        let mut held: BTreeMap<Id, Register> = BTreeMap::new();
        let mut free: Vec<Register> = Vec::new();
        for (at, &id) in order.iter().enumerate() {
            let (code, operands) = instruction(graph, id);
            if let (Code::Input, Node::Invariant(invariant)) = (code, graph.node(id)) {
                held.insert(id, invariant as Register);
                continue;
            }
            let register = |id: Option<Id>| id.and_then(|id| held.get(&id).copied()).unwrap_or(0);
            let (a, b) = match graph.node(id) {
                Node::Parameter(k) => (k, 0),
                _ => (register(operands[0]), register(operands[1])),
            };
            for operand in operands.into_iter().flatten() {
                let is_done = last.get(&operand) == Some(&at) && !matches!(graph.node(operand), Node::Invariant(_));
                if is_done && let Some(done) = held.remove(&operand) {
                    free.push(done);
                }
            }
            let to = match free.pop() {
                Some(register) => register,
                None => {
                    tape.registers += 1;
                    Register::try_from(tape.registers - 1).ok()?
                }
            };
            held.insert(id, to);
            tape.code.push(Instruction { code, a, b, to });
        }
        tape.outputs = outputs.iter().map(|id| held.get(id).copied()).collect::<Option<_>>()?;
        (tape.registers <= MOST_REGISTERS).then_some(tape)
    }

    /// Whether it has finite values for every deformation with `J > 0`, large exponents apart.
    pub fn is_safe(&self) -> bool {
        self.safe
    }

    /// The values of the outputs for these invariants and parameters.
    #[inline]
    pub fn evaluate<N: Number, const OUT: usize>(&self, inputs: [N; INPUTS], parameters: &[N]) -> [N; OUT] {
        match self.registers {
            ..=8 => self.run::<N, 8, OUT>(inputs, parameters),
            9..=24 => self.run::<N, 24, OUT>(inputs, parameters),
            25..=96 => self.run::<N, 96, OUT>(inputs, parameters),
            _ => self.run::<N, MOST_REGISTERS, OUT>(inputs, parameters),
        }
    }

    #[inline]
    fn run<N: Number, const R: usize, const OUT: usize>(&self, inputs: [N; INPUTS], parameters: &[N]) -> [N; OUT] {
        let mut r = [N::constant(0.0); R];
        r[..INPUTS].copy_from_slice(&inputs);
        for step in &self.code {
            r[step.to as usize] = step.value(&r, parameters);
        }
        let mut out = [N::constant(0.0); OUT];
        out.iter_mut().zip(&self.outputs).for_each(|(out, register)| *out = r[*register as usize]);
        out
    }

    /// The first operation without a finite value, in the order of evaluation.
    pub fn fault(&self, inputs: [f64; INPUTS], parameters: &[f64]) -> Option<Fault> {
        let mut r = [0.0; MOST_REGISTERS];
        r[..INPUTS].copy_from_slice(&inputs);
        for step in &self.code {
            let (a, b) = (r[step.a as usize], r[step.b as usize]);
            let value: f64 = step.value(&r, parameters);
            if !value.is_finite() {
                return Some(step.code.fault(a, b, value));
            }
            r[step.to as usize] = value;
        }
        None
    }
}

/// The nodes that the outputs are made of, operands first.
fn needed(graph: &Graph, outputs: &[Id]) -> Vec<Id> {
    let mut wanted = vec![false; graph.len()];
    let mut todo: Vec<Id> = outputs.to_vec();
    while let Some(id) = todo.pop() {
        if !std::mem::replace(&mut wanted[id as usize], true) {
            todo.extend(instruction(graph, id).1.into_iter().flatten());
        }
    }
    // Nodes are numbered behind their operands.
    (0..graph.len() as Id).filter(|&id| wanted[id as usize]).collect()
}

/// A node as `c (x + s)`: sums and products with numbers are part of the instruction.
fn affine(graph: &Graph, id: Id) -> (f64, f64, Id) {
    match graph.node(id) {
        Node::Multiply(a, b) => match graph.value(a) {
            Some(c) => {
                let (inner, s, x) = shifted(graph, b);
                if inner { (c, s, x) } else { (c, 0.0, b) }
            }
            None => (1.0, 0.0, id),
        },
        Node::Negate(a) => {
            let (inner, s, x) = shifted(graph, a);
            if inner { (-1.0, s, x) } else { (-1.0, 0.0, a) }
        }
        _ => {
            let (inner, s, x) = shifted(graph, id);
            if inner { (1.0, s, x) } else { (1.0, 0.0, id) }
        }
    }
}

/// Whether a node is `x + s`, with s and x.
fn shifted(graph: &Graph, id: Id) -> (bool, f64, Id) {
    match graph.node(id) {
        Node::Add(a, b) => match (graph.value(a), graph.value(b)) {
            (Some(s), _) => (true, s, b),
            (_, Some(s)) => (true, s, a),
            _ => (false, 0.0, id),
        },
        Node::Subtract(a, b) => match graph.value(b) {
            Some(s) => (true, -s, a),
            None => (false, 0.0, id),
        },
        _ => (false, 0.0, id),
    }
}

/// The instruction of a node, and what it takes from registers.
fn instruction(graph: &Graph, id: Id) -> (Code, [Option<Id>; 2]) {
    let (c, s, x) = affine(graph, id);
    if x != id {
        return (Code::Affine(c, s), [Some(x), None]);
    }
    let code = match graph.node(id) {
        Node::Add(a, b) => return sum(graph, a, b, 1.0),
        Node::Subtract(a, b) => return sum(graph, a, b, -1.0),
        Node::Constant(bits) => Code::Constant(f64::from_bits(bits)),
        Node::Invariant(_) => Code::Input,
        Node::Parameter(_) => Code::Parameter,
        Node::Negate(_) => Code::Negate,
        Node::Multiply(..) => Code::Multiply,
        Node::Power(..) => Code::Power,
        Node::Whole(_, 2) => Code::Square,
        Node::Whole(_, 3) => Code::Cube,
        Node::Whole(_, -1) => Code::Inverse,
        Node::Whole(_, n) => Code::Whole(n),
        Node::ThirdRoot(_) => Code::ThirdRoot,
        Node::Minimum(..) => Code::Minimum,
        Node::Maximum(..) => Code::Maximum,
        Node::Less(..) => Code::Less,
        Node::LessOrEqual(..) => Code::LessOrEqual,
        Node::Exp(_) => Code::Exp,
        Node::Log(_) => Code::Log,
        Node::Sqrt(_) => Code::Sqrt,
        Node::Sin(_) => Code::Sin,
        Node::Cos(_) => Code::Cos,
        Node::Abs(_) => Code::Abs,
    };
    (code, graph.operands(id))
}

/// `a + sign b`, in which one of them may be affine.
fn sum(graph: &Graph, a: Id, b: Id, sign: f64) -> (Code, [Option<Id>; 2]) {
    let (c, s, x) = affine(graph, b);
    if x != b {
        return (Code::AddAffine(sign * c, s), [Some(a), Some(x)]);
    }
    let (c, s, x) = affine(graph, a);
    match (x != a, sign > 0.0) {
        (true, true) => (Code::AddAffine(c, s), [Some(b), Some(x)]),
        (_, true) => (Code::Add, [Some(a), Some(b)]),
        (_, false) => (Code::Subtract, [Some(a), Some(b)]),
    }
}

/// Whether a node has a finite value wherever its operands have.
fn is_safe(graph: &Graph, id: Id) -> bool {
    match graph.node(id) {
        Node::Whole(a, n) => n > 0 || graph.sign(a) == Sign::Positive,
        Node::Power(a, b) => graph.sign(a) == Sign::Positive && graph.value(b).is_some(),
        Node::Log(a) => graph.sign(a) == Sign::Positive,
        Node::Sqrt(a) => graph.sign(a) >= Sign::NotNegative,
        Node::Exp(_) => false,
        _ => true,
    }
}

impl Instruction {
    #[inline(always)]
    fn value<N: Number>(&self, r: &[N], parameters: &[N]) -> N {
        let a = r[self.a as usize];
        match self.code {
            Code::Constant(x) => N::constant(x),
            Code::Input => a,
            Code::Parameter => parameters[self.a as usize],
            Code::Negate => -a,
            Code::Add => a + r[self.b as usize],
            Code::Subtract => a - r[self.b as usize],
            Code::Multiply => a * r[self.b as usize],
            Code::Affine(c, s) => N::constant(c) * (a + N::constant(s)),
            Code::AddAffine(c, s) => a + N::constant(c) * (r[self.b as usize] + N::constant(s)),
            Code::Square => a * a,
            Code::Cube => a * a * a,
            Code::Inverse => a.apply(|x| 1.0 / x, |_, y| [-y * y, 2.0 * y * y * y]),
            Code::Whole(n) => {
                let power = |x: f64, m: i32, c: i32| if c == 0 { 0.0 } else { f64::from(c) * x.powi(m) };
                a.apply(|x| x.powi(n), |x, _| [power(x, n - 1, n), power(x, n - 2, n * (n - 1))])
            }
            Code::ThirdRoot => a.apply(f64::cbrt, |x, y| [y / (3.0 * x), -2.0 * y / (9.0 * x * x)]),
            Code::Exp => a.apply(f64::exp, |_, y| [y, y]),
            Code::Log => a.apply(f64::ln, |x, _| [1.0 / x, -1.0 / (x * x)]),
            Code::Sqrt => a.apply(f64::sqrt, |x, y| [0.5 / y, -0.25 / (x * y)]),
            Code::Sin => a.apply(f64::sin, |x, y| [x.cos(), -y]),
            Code::Cos => a.apply(f64::cos, |x, y| [-x.sin(), -y]),
            Code::Abs => a.select(a, |x, _| x < 0.0, -a, a),
            Code::Minimum => a.select(r[self.b as usize], |x, y| x < y, a, r[self.b as usize]),
            Code::Maximum => a.select(r[self.b as usize], |x, y| y < x, a, r[self.b as usize]),
            Code::Less => a.select(r[self.b as usize], |x, y| x < y, N::constant(1.0), N::constant(0.0)),
            Code::LessOrEqual => a.select(r[self.b as usize], |x, y| x <= y, N::constant(1.0), N::constant(0.0)),
            Code::Power => a.power(r[self.b as usize]),
        }
    }
}

impl Code {
    fn fault(self, a: f64, b: f64, value: f64) -> Fault {
        match self {
            Code::Log => Fault { measure: "what the energy takes a logarithm of", value: a, limit: 0.0 },
            Code::Sqrt => Fault { measure: "what the energy takes a square root of", value: a, limit: 0.0 },
            Code::Inverse | Code::Whole(_) if a == 0.0 => {
                Fault { measure: "what the energy divides by", value: a, limit: 0.0 }
            }
            Code::Power if a <= 0.0 => Fault { measure: "the base of a power in the energy", value: a, limit: 0.0 },
            Code::Exp => Fault { measure: "the exponent of exp in the energy", value: a, limit: f64::MAX.ln() },
            Code::Power => Fault { measure: "an exponent in the energy", value: b, limit: f64::MAX.ln() },
            _ => Fault { measure: "a value in the energy", value, limit: f64::MAX },
        }
    }
}
