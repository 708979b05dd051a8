use std::collections::BTreeMap;

use super::expression::{Expression, Invariant, Step};

/// A node by its number.
pub type Id = u32;

/// Nodes of a formula and its derivatives at most: far beyond any law that is published, milliseconds to differentiate.
pub const MOST_NODES: usize = 50_000;

/// An operation on earlier nodes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Node {
    /// The bits of a number.
    Constant(u64),
    Invariant(Invariant),
    /// One that varies over the body.
    Parameter(u16),
    Negate(Id),
    Add(Id, Id),
    Subtract(Id, Id),
    Multiply(Id, Id),
    Power(Id, Id),
    /// A whole power.
    Whole(Id, i32),
    /// The third root of a positive number.
    ThirdRoot(Id),
    Minimum(Id, Id),
    Maximum(Id, Id),
    Less(Id, Id),
    LessOrEqual(Id, Id),
    Exp(Id),
    Log(Id),
    Sqrt(Id),
    Sin(Id),
    Cos(Id),
    Abs(Id),
}

/// What is known of a node's sign whatever the deformation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Sign {
    Unknown,
    NotNegative,
    Positive,
}

/// A formula and its derivatives with common subexpressions kept once.
#[derive(Clone, Debug, Default)]
pub struct Graph {
    nodes: Vec<Node>,
    signs: Vec<Sign>,
    known: BTreeMap<Node, Id>,
    derivatives: BTreeMap<(Id, Invariant), Id>,
}

impl Graph {
    /// The node of a formula; `None` where the steps are none, or too many. `value` is what a parameter is.
    pub fn of(&mut self, expression: &Expression, value: impl Fn(&str) -> Option<Node>) -> Option<Id> {
        let mut stack: Vec<Id> = Vec::new();
        for step in &expression.steps {
            let id = match step {
                Step::Number(x) => self.constant(*x),
                Step::Invariant(invariant) => self.push(Node::Invariant(*invariant)),
                Step::Parameter(name) => self.push(value(name)?),
                Step::Negate | Step::Exp | Step::Log | Step::Sqrt | Step::Sin | Step::Cos | Step::Abs => {
                    let a = stack.pop()?;
                    self.unary(step, a)?
                }
                _ => {
                    let (b, a) = (stack.pop()?, stack.pop()?);
                    self.binary(step, a, b)?
                }
            };
            if self.nodes.len() > MOST_NODES {
                return None;
            }
            stack.push(id);
        }
        let whole = stack.pop()?;
        stack.is_empty().then_some(whole)
    }

    fn unary(&mut self, step: &Step, a: Id) -> Option<Id> {
        Some(match step {
            Step::Negate => self.negate(a),
            Step::Exp => self.function(Node::Exp, f64::exp, a),
            Step::Log => self.function(Node::Log, f64::ln, a),
            Step::Sqrt => self.function(Node::Sqrt, f64::sqrt, a),
            Step::Sin => self.function(Node::Sin, f64::sin, a),
            Step::Cos => self.function(Node::Cos, f64::cos, a),
            Step::Abs => self.function(Node::Abs, f64::abs, a),
            _ => return None,
        })
    }

    fn binary(&mut self, step: &Step, a: Id, b: Id) -> Option<Id> {
        Some(match step {
            Step::Add => self.add(a, b),
            Step::Subtract => self.subtract(a, b),
            Step::Multiply => self.multiply(a, b),
            Step::Divide => self.divide(a, b),
            Step::Power => self.power(a, b),
            Step::Minimum => self.of_two(Node::Minimum, f64::min, a, b),
            Step::Maximum => self.of_two(Node::Maximum, f64::max, a, b),
            Step::Less => self.less(a, b),
            Step::LessOrEqual => self.of_two(Node::LessOrEqual, |a, b| f64::from(u8::from(a <= b)), a, b),
            _ => return None,
        })
    }

    pub fn node(&self, id: Id) -> Node {
        self.nodes[id as usize]
    }

    pub fn len(&self) -> usize {
        self.nodes.len()
    }

    pub fn sign(&self, id: Id) -> Sign {
        self.signs[id as usize]
    }

    pub fn value(&self, id: Id) -> Option<f64> {
        if let Node::Constant(bits) = self.node(id) { Some(f64::from_bits(bits)) } else { None }
    }

    pub fn known_derivative(&self, of: (Id, Invariant)) -> Option<Id> {
        self.derivatives.get(&of).copied()
    }

    pub fn keep_derivative(&mut self, of: (Id, Invariant), id: Id) -> Id {
        self.derivatives.insert(of, id);
        id
    }

    pub fn constant(&mut self, x: f64) -> Id {
        // One zero: -0 and 0 are the same number.
        self.push(Node::Constant((x + 0.0).to_bits()))
    }

    pub fn negate(&mut self, a: Id) -> Id {
        match self.node(a) {
            Node::Constant(bits) => self.constant(-f64::from_bits(bits)),
            Node::Negate(inner) => inner,
            Node::Subtract(x, y) => self.subtract(y, x),
            _ => self.push(Node::Negate(a)),
        }
    }

    pub fn add(&mut self, a: Id, b: Id) -> Id {
        match (self.value(a), self.value(b)) {
            (Some(x), Some(y)) => self.constant(x + y),
            (Some(0.0), _) => b,
            (_, Some(0.0)) => a,
            _ => match (self.node(a), self.node(b)) {
                (_, Node::Negate(y)) => self.subtract(a, y),
                (Node::Negate(x), _) => self.subtract(b, x),
                _ => self.push(Node::Add(a.min(b), a.max(b))),
            },
        }
    }

    pub fn subtract(&mut self, a: Id, b: Id) -> Id {
        match (self.value(a), self.value(b)) {
            _ if a == b => self.constant(0.0),
            (Some(x), Some(y)) => self.constant(x - y),
            (Some(0.0), _) => self.negate(b),
            (_, Some(0.0)) => a,
            _ => match self.node(b) {
                Node::Negate(y) => self.add(a, y),
                _ => self.push(Node::Subtract(a, b)),
            },
        }
    }

    pub fn multiply(&mut self, a: Id, b: Id) -> Id {
        match (self.value(a), self.value(b)) {
            (Some(x), Some(y)) => self.constant(x * y),
            (Some(0.0), _) | (_, Some(0.0)) => self.constant(0.0),
            (Some(1.0), _) => b,
            (_, Some(1.0)) => a,
            (Some(-1.0), _) => self.negate(b),
            (_, Some(-1.0)) => self.negate(a),
            (None, Some(_)) => self.multiply(b, a),
            // Numbers gather in front, c (d x) = (c d) x.
            (Some(c), None) => match self.node(b) {
                Node::Multiply(d, x) if self.value(d).is_some() => {
                    let factor = self.constant(c * self.value(d).unwrap_or(1.0));
                    self.multiply(factor, x)
                }
                Node::Negate(x) => {
                    let factor = self.constant(-c);
                    self.multiply(factor, x)
                }
                _ => self.push(Node::Multiply(a, b)),
            },
            (None, None) => self.product(a, b),
        }
    }

    fn product(&mut self, a: Id, b: Id) -> Id {
        for (one, other) in [(a, b), (b, a)] {
            match self.node(one) {
                Node::Multiply(c, x) if self.value(c).is_some() => {
                    let rest = self.multiply(x, other);
                    return self.multiply(c, rest);
                }
                Node::Negate(x) => {
                    let rest = self.multiply(x, other);
                    return self.negate(rest);
                }
                _ => {}
            }
        }
        let ((x, m), (y, n)) = (self.as_power(a), self.as_power(b));
        match (x == y).then(|| m.checked_add(n)).flatten() {
            Some(power) => self.whole(x, power),
            None => self.push(Node::Multiply(a.min(b), a.max(b))),
        }
    }

    /// A node as a whole power.
    fn as_power(&self, a: Id) -> (Id, i32) {
        if let Node::Whole(x, n) = self.node(a) { (x, n) } else { (a, 1) }
    }

    pub fn divide(&mut self, a: Id, b: Id) -> Id {
        match (self.value(a), self.value(b)) {
            (Some(x), Some(y)) => self.constant(x / y),
            (None, Some(y)) => {
                let factor = self.constant(1.0 / y);
                self.multiply(factor, a)
            }
            _ => {
                let inverse = self.whole(b, -1);
                self.multiply(a, inverse)
            }
        }
    }

    pub fn power(&mut self, a: Id, b: Id) -> Id {
        let (base, exponent) = (self.value(a), self.value(b));
        if let (Some(x), Some(y)) = (base, exponent) {
            return self.constant(x.powf(y));
        }
        let Some(c) = exponent else { return self.push(Node::Power(a, b)) };
        let whole = |c: f64| (c == c.round() && c.abs() <= 64.0).then_some(c as i32);
        if let Some(n) = whole(c) {
            return self.whole(a, n);
        }
        match whole(3.0 * c) {
            // J^(-2/3): its derivatives share the root
            Some(n) if self.sign(a) == Sign::Positive => {
                let root = self.push(Node::ThirdRoot(a));
                self.whole(root, n)
            }
            _ => self.push(Node::Power(a, b)),
        }
    }

    /// `a^n`.
    pub fn whole(&mut self, a: Id, n: i32) -> Id {
        match (n, self.node(a)) {
            (0, _) => self.constant(1.0),
            (1, _) => a,
            (_, Node::Constant(bits)) => self.constant(f64::from_bits(bits).powi(n)),
            (_, Node::ThirdRoot(x)) if n % 3 == 0 => self.whole(x, n / 3),
            (_, Node::Whole(x, m)) if m.checked_mul(n).is_some() => self.whole(x, m * n),
            _ => self.push(Node::Whole(a, n)),
        }
    }

    pub fn function(&mut self, node: fn(Id) -> Node, value: fn(f64) -> f64, a: Id) -> Id {
        match self.value(a) {
            Some(x) => self.constant(value(x)),
            None => self.push(node(a)),
        }
    }

    /// 1 where `a < b`, else 0.
    pub fn less(&mut self, a: Id, b: Id) -> Id {
        self.of_two(Node::Less, |a, b| f64::from(u8::from(a < b)), a, b)
    }

    fn of_two(&mut self, node: fn(Id, Id) -> Node, value: fn(f64, f64) -> f64, a: Id, b: Id) -> Id {
        match (self.value(a), self.value(b)) {
            (Some(x), Some(y)) => self.constant(value(x, y)),
            _ => self.push(node(a, b)),
        }
    }

    fn push(&mut self, node: Node) -> Id {
        if let Some(&id) = self.known.get(&node) {
            return id;
        }
        let id = self.nodes.len() as Id;
        let sign = self.sign_of(node);
        self.nodes.push(node);
        self.signs.push(sign);
        self.known.insert(node, id);
        id
    }

    fn sign_of(&self, node: Node) -> Sign {
        use Sign::{NotNegative, Positive, Unknown};
        match node {
            Node::Constant(bits) => match f64::from_bits(bits) {
                x if x > 0.0 => Positive,
                0.0 => NotNegative,
                _ => Unknown,
            },
            Node::Invariant(_) | Node::Exp(_) => Positive,
            Node::Add(a, b) => match (self.sign(a), self.sign(b)) {
                (Unknown, _) | (_, Unknown) => Unknown,
                (a, b) => a.max(b),
            },
            Node::Multiply(a, b) | Node::Minimum(a, b) => self.sign(a).min(self.sign(b)),
            Node::Maximum(a, b) => self.sign(a).max(self.sign(b)),
            Node::Power(a, _) | Node::ThirdRoot(a) if self.sign(a) == Positive => Positive,
            Node::Whole(a, n) => match (self.sign(a), n % 2 == 0 && n > 0) {
                (Positive, _) => Positive,
                (_, true) => NotNegative,
                (NotNegative, false) if n > 0 => NotNegative,
                _ => Unknown,
            },
            Node::Sqrt(a) => self.sign(a).max(NotNegative),
            Node::Abs(a) => self.sign(a).max(NotNegative),
            Node::Less(..) | Node::LessOrEqual(..) => NotNegative,
            _ => Unknown,
        }
    }
}
