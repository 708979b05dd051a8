//! A comparison in words.

use crate::number::{number, short};
use crate::record::{ComparisonRecord, DistancesRecord};
use std::fmt::Write;

impl ComparisonRecord {
    /// What the terminal shows.
    #[must_use]
    pub fn text(&self) -> String {
        let unit = if self.unit.is_empty() { String::new() } else { format!(" {}", self.unit) };
        let mut out = String::new();
        for (name, side) in [("A", &self.a), ("B", &self.b)] {
            let _ = writeln!(out, "{name}: {}, {} {}", side.shape, side.points, side.of);
        }
        let _ = writeln!(out, "\n{:14} {:>12} {:>12} {:>12}", "", "mean", "rms", "largest");
        for (name, way) in [("from A to B", &self.a_to_b), ("from B to A", &self.b_to_a)] {
            let _ = writeln!(out, "{name:14} {}{unit}, at {}", row(way), place(&way.from));
        }
        if let Some(nodes) = &self.node_by_node {
            let numbers = format!("{:>12} {:>12} {:>12}", "", number(nodes.rms, ""), number(nodes.largest, ""));
            let _ = writeln!(
                out,
                "{:14} {numbers}{unit}, at node {}, of {} nodes",
                "node by node", nodes.node, nodes.nodes
            );
        }
        let _ = writeln!(out, "\nchamfer    {}{unit}, the means of both ways added", number(self.chamfer, ""));
        let proof = match *self.hausdorff_gap {
            Some(gap) => format!(" of the solids, and at most {} more", short(gap)),
            None => ", the largest of both ways".to_owned(),
        };
        let _ = writeln!(out, "Hausdorff  {}{unit}{proof}", number(self.hausdorff, ""));
        out
    }
}

fn row(way: &DistancesRecord) -> String {
    format!("{:>12} {:>12} {:>12}", number(way.mean, ""), number(way.rms, ""), number(way.largest, ""))
}

fn place(point: &[f64]) -> String {
    let words: Vec<String> = point.iter().map(|x| short(*x)).collect();
    format!("({})", words.join(", "))
}
