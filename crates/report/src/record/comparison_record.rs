//! [`ComparisonRecord`]: what `nastic compare` finds.

use crate::record::Number;

records! {
    /// How far two shapes are apart.
    ComparisonRecord {
        /// The unit of all lengths, that of the first shape's results; left out where no results say it.
        unit: String,
        /// The first shape.
        a: ComparedRecord,
        /// The second one.
        b: ComparedRecord,
        /// Distances from points of the first shape to the second one.
        a_to_b: DistancesRecord,
        /// Distances from points of the second shape to the first one.
        b_to_a: DistancesRecord,
        /// Chamfer distance: the two means, added.
        chamfer: Number,
        /// Hausdorff distance: of whole bodies that of the solids, else the largest distance of both ways from the points.
        hausdorff: Number,
        /// Of whole bodies: the Hausdorff distance is at most so much larger than said.
        hausdorff_gap: Number,
        /// Of two states of one mesh: distances between the two positions of each node.
        node_by_node: Option<NodeByNodeRecord>,
    }

    /// A shape that is compared.
    ComparedRecord {
        /// The file, or the state of the directory.
        shape: String,
        /// What was compared of it.
        of: String,
        /// How many points distances were measured from.
        points: usize,
    }

    /// Distances of points to the nearest points of a shape.
    DistancesRecord {
        /// Mean.
        mean: Number,
        /// Root of the mean square.
        rms: Number,
        /// Largest.
        largest: Number,
        /// The point that is farthest.
        from: Vec<f64>,
        /// Its nearest point.
        to: Vec<f64>,
    }

    /// Distances of nodes from where they are in another state.
    NodeByNodeRecord {
        /// Nodes compared.
        nodes: usize,
        /// Root of the mean square.
        rms: Number,
        /// Largest.
        largest: Number,
        /// The node that is farthest, from zero.
        node: usize,
    }
}
