//! [`Gaps`]: where the samples of a surface are before an obstacle, and how far they may move.

use super::ObstacleContact;
use crate::contact::ContactLaw;
use crate::contact::pose::Pose;
use nastic_body::error::Inadmissible;
use nastic_body::instant::Instant;
use nastic_mesh::spatial::SignedDistance;
use nastic_tensor::Vec3;
use std::ops::Range;

/// Least share of its gap (with the cubic law, its gap and a depth) that a move leaves to a sample.
const MIN_GAP_SHARE: f64 = 0.1;

/// Where the samples of a contact are.
#[derive(Debug, Clone)]
pub(crate) struct Gaps {
    pub pose: Pose,
    /// Of samples their place and distance: of all but those of facets that are `far`.
    pub all: Vec<Placed>,
    /// Facets (by their place among `between`) whose samples between nodes are all beyond the layer, and how far away they are at least.
    pub far: Vec<(usize, f64)>,
    /// Those within the layer.
    pub touches: Vec<Touch>,
}

/// A sample, its place and its distance.
pub(crate) type Placed = (usize, (Vec3, f64));

/// A sample within the layer.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Touch {
    pub sample: usize,
    pub place: Vec3,
    pub distance: SignedDistance,
}

impl Gaps {
    /// Those of all samples, by their numbers, or without those of facets that are far away.
    pub fn at(of: &ObstacleContact, at: &Instant, all: bool) -> Result<Self, Inadmissible> {
        let samples = &of.with.samples;
        let mut found = Gaps {
            pose: Pose::at(at, of.with.centre),
            all: Vec::with_capacity(samples.len()),
            far: Vec::new(),
            touches: Vec::new(),
        };
        if all {
            found.add(of, at, 0..samples.len())?;
            return Ok(found);
        }
        found.add(of, at, 0..samples.at_nodes())?;
        for (k, between) in samples.between.iter().enumerate() {
            let (first, _, reach) = between.about(|node| found.all[node].1.0);
            let least = found.all[first].1.1 - reach;
            match of.with.is_lipschitz() && least >= of.layer.thickness {
                true => found.far.push((k, least)),
                false => found.add(of, at, between.samples.clone())?,
            }
        }
        Ok(found)
    }

    fn add(&mut self, of: &ObstacleContact, at: &Instant, samples: Range<usize>) -> Result<(), Inadmissible> {
        for sample in samples {
            let (place, d) = of.with.placed(&self.pose, sample, at.u);
            self.all.push((sample, (place, d)));
            if of.layer.law == ContactLaw::Log && d <= 0.0 {
                return Err(of.layer.penetrates(&place, -d));
            }
            if d < of.layer.thickness {
                let distance = of.with.signed_distance(&self.pose, sample, &place);
                self.touches.push(Touch { sample, place, distance });
            }
        }
        Ok(())
    }

    /// The samples with what they move by, in a move of the nodes by `dx`; without those far facets of which it is `safe`: their least distance, place
    /// and move of one of their nodes, and how much those of their samples differ from these at most.
    pub fn moving(
        &self,
        of: &ObstacleContact,
        u: &[f64],
        dx: impl Fn(usize) -> Vec3,
        safe: impl Fn(f64, [&Vec3; 2], [f64; 2]) -> bool,
    ) -> Vec<(Placed, Vec3)> {
        let mut all: Vec<(Placed, Vec3)> = self.all.iter().map(|here| (*here, dx(here.0))).collect();
        for &(k, least) in &self.far {
            let between = &of.with.samples.between[k];
            let (_, x, apart) = between.about(|node| self.all[node].1.0);
            let (_, way, differs) = between.about(&dx);
            if !safe(least, [&x, &way], [apart, differs]) {
                let placed = |sample| ((sample, of.with.placed(&self.pose, sample, u)), dx(sample));
                all.extend(between.samples.clone().map(placed));
            }
        }
        all
    }
}

/// How near a sample may come in a move of one `reach`: a tenth of its gap is left; the cubic law bears a depth more.
pub(super) fn floor(law: ContactLaw, d: f64, depth: f64) -> f64 {
    let sunk = if law == ContactLaw::Cubic { depth + (-d).max(0.0) } else { 0.0 };
    MIN_GAP_SHARE * (d + sunk) - sunk
}
