use super::expression::Invariant;
use super::graph::{Graph, Id, Node};

impl Graph {
    /// The derivative of a node by an invariant. Of `min`, `max`, `abs` and comparisons it is that of the branch which holds.
    ///
    /// Nodes stand behind their operands, so one pass in their order differentiates without recursion.
    pub fn derivative(&mut self, of: Id, by: Invariant) -> Id {
        let mut todo = vec![of];
        while let Some(&id) = todo.last() {
            if self.known_derivative((id, by)).is_some() {
                todo.pop();
                continue;
            }
            let waiting = self.operands(id).into_iter().flatten().filter(|a| self.known_derivative((*a, by)).is_none());
            let waiting: Vec<Id> = waiting.collect();
            if waiting.is_empty() {
                todo.pop();
                let slope = self.chain(id, by);
                self.keep_derivative((id, by), slope);
            }
            todo.extend(waiting);
        }
        self.known_derivative((of, by)).unwrap_or(of)
    }

    /// What a node takes.
    pub fn operands(&self, id: Id) -> [Option<Id>; 2] {
        match self.node(id) {
            Node::Constant(_) | Node::Invariant(_) | Node::Parameter(_) => [None, None],
            Node::Negate(a)
            | Node::Whole(a, _)
            | Node::ThirdRoot(a)
            | Node::Exp(a)
            | Node::Log(a)
            | Node::Sqrt(a)
            | Node::Sin(a)
            | Node::Cos(a)
            | Node::Abs(a) => [Some(a), None],
            Node::Add(a, b)
            | Node::Subtract(a, b)
            | Node::Multiply(a, b)
            | Node::Power(a, b)
            | Node::Minimum(a, b)
            | Node::Maximum(a, b)
            | Node::Less(a, b)
            | Node::LessOrEqual(a, b) => [Some(a), Some(b)],
        }
    }

    /// The derivative of a node from those of its operands.
    fn chain(&mut self, id: Id, by: Invariant) -> Id {
        let slope = |graph: &mut Self, a: Id| graph.known_derivative((a, by)).unwrap_or(a);
        let node = self.node(id);
        match node {
            Node::Constant(_) | Node::Parameter(_) | Node::Less(..) | Node::LessOrEqual(..) => self.constant(0.0),
            Node::Invariant(own) => self.constant(f64::from(u8::from(own == by))),
            Node::Negate(a) => {
                let da = slope(self, a);
                self.negate(da)
            }
            Node::Add(a, b) => {
                let (da, db) = (slope(self, a), slope(self, b));
                self.add(da, db)
            }
            Node::Subtract(a, b) => {
                let (da, db) = (slope(self, a), slope(self, b));
                self.subtract(da, db)
            }
            Node::Multiply(a, b) => {
                let (da, db) = (slope(self, a), slope(self, b));
                let (left, right) = (self.multiply(da, b), self.multiply(a, db));
                self.add(left, right)
            }
            Node::Power(a, b) => {
                let (da, db) = (slope(self, a), slope(self, b));
                self.power_slope(id, a, b, da, db)
            }
            Node::Minimum(a, b) | Node::Maximum(a, b) => {
                let (da, db) = (slope(self, a), slope(self, b));
                let least = matches!(node, Node::Minimum(..));
                let (a, b) = if least { (a, b) } else { (b, a) };
                self.choose(a, b, da, db)
            }
            Node::Whole(a, _)
            | Node::ThirdRoot(a)
            | Node::Exp(a)
            | Node::Log(a)
            | Node::Sqrt(a)
            | Node::Sin(a)
            | Node::Cos(a)
            | Node::Abs(a) => {
                let da = slope(self, a);
                if self.value(da) == Some(0.0) {
                    return da;
                }
                let outer = self.outer_slope(id, a);
                self.multiply(outer, da)
            }
        }
    }

    /// The derivative of a function of one operand by that operand.
    fn outer_slope(&mut self, id: Id, a: Id) -> Id {
        match self.node(id) {
            Node::Whole(_, n) => {
                let (factor, rest) = (self.constant(f64::from(n)), self.whole(a, n - 1));
                self.multiply(factor, rest)
            }
            // (a^(1/3))' = (a^(1/3))^(-2) / 3
            Node::ThirdRoot(_) => {
                let (factor, rest) = (self.constant(1.0 / 3.0), self.whole(id, -2));
                self.multiply(factor, rest)
            }
            Node::Exp(_) => id,
            Node::Log(_) => self.whole(a, -1),
            Node::Sqrt(_) => {
                let (factor, rest) = (self.constant(0.5), self.whole(id, -1));
                self.multiply(factor, rest)
            }
            Node::Sin(_) => self.function(Node::Cos, f64::cos, a),
            Node::Cos(_) => {
                let sine = self.function(Node::Sin, f64::sin, a);
                self.negate(sine)
            }
            // |a|' = (0 < a) - (a < 0)
            _ => {
                let zero = self.constant(0.0);
                let (above, below) = (self.less(zero, a), self.less(a, zero));
                self.subtract(above, below)
            }
        }
    }

    /// `(a^b)' = b a^(b-1) a' + a^b log(a) b'`.
    fn power_slope(&mut self, id: Id, a: Id, b: Id, da: Id, db: Id) -> Id {
        let one = self.constant(1.0);
        let less = self.subtract(b, one);
        let lower = self.power(a, less);
        let by_base = self.multiply(b, lower);
        let left = self.multiply(by_base, da);
        if self.value(db) == Some(0.0) {
            return left;
        }
        let log = self.function(Node::Log, f64::ln, a);
        let by_exponent = self.multiply(id, log);
        let right = self.multiply(by_exponent, db);
        self.add(left, right)
    }

    /// `da` where `a < b`, else `db`.
    fn choose(&mut self, a: Id, b: Id, da: Id, db: Id) -> Id {
        let one = self.constant(1.0);
        let first = self.less(a, b);
        let second = self.subtract(one, first);
        let (left, right) = (self.multiply(first, da), self.multiply(second, db));
        self.add(left, right)
    }
}
