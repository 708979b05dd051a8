//! [`BeforeSurface`]: a sample of a surface with the nearest pieces of the other surface.

use super::gap::{Foot, Gap};
use super::side::Side;
use super::sliding;
use super::spin::Spin;
use super::{AREA_SHARE, SurfacesContact};
use crate::contact::law::Pressure;
use crate::contact::potential::potential_changes;
use crate::contact::rubbing::Rubbing;
use crate::contact::slots::{add_scaled, scaled};
use crate::contact::stencil::{Part, Stencil};
use nastic_tensor::Vec3;
use nastic_tensor::{HyperDual, Scalar};

/// A sample and the nearest pieces.
///
/// Its slots are points that move with the body: its position, the nodes of the pieces and, with friction, the corners of its own facets.
pub(crate) struct BeforeSurface<'a> {
    pub of: &'a SurfacesContact,
    pub side: &'a Side,
    pub near: &'a Gap,
    /// Positions of the slots.
    pub places: Vec<Vec3>,
    /// The nearest points of pieces.
    pub(super) feet: Vec<Foot<'a, f64>>,
    /// Spin of the sample's own surface.
    pub(super) spin: Spin,
    gap: f64,
    gradient: Vec<Vec3>,
}

impl<'a> BeforeSurface<'a> {
    pub fn new(of: &'a SurfacesContact, side: &'a Side, near: &'a Gap, u: &[f64]) -> Self {
        let ring: &[u32] = if of.layer.slip_speed.is_some() { &side.rings[near.sample] } else { &[] };
        let nodes = near.nodes.iter().chain(ring).map(|&node| side.node(u, node));
        let places: Vec<Vec3> = std::iter::once(side.place(u, near.sample)).chain(nodes).collect();
        let slots: Vec<[f64; 3]> = places[..=near.nodes.len()].iter().map(|x| (*x).into()).collect();
        let (distance, feet) = near.near(slots[0], &slots[1..]);
        let gradient = near.gradient(&feet).into_iter().map(Vec3::from).collect();
        let spin = Spin::new(sliding::arms(near, &places), of.layer.dim);
        BeforeSurface { of, side, near, places, feet, spin, gap: distance - of.apart(), gradient }
    }

    /// Number of the slots of the potential.
    pub fn near_slots(&self) -> usize {
        self.near.nodes.len() + 1
    }

    /// The nodes of the slots.
    fn slot_nodes(&self) -> impl Iterator<Item = u32> {
        let ring: &[u32] = if self.places.len() > self.near_slots() { &self.side.rings[self.near.sample] } else { &[] };
        self.near.nodes.iter().chain(ring).copied()
    }

    /// The positions of the slots of the potential along two changes.
    pub fn along(&self, [a, b]: [&[Vec3]; 2]) -> Vec<[HyperDual; 3]> {
        let slot = |k: usize| dual(&self.places[k], 1.0, [&a[k], &b[k]]);
        (0..self.near_slots()).map(slot).collect()
    }

    /// The gap, and the shares of the nodes of the pieces in the pressure there.
    pub fn foot<T: Scalar>(&self, slots: &[[T; 3]]) -> (T, Vec<T>) {
        let (distance, feet) = self.near.near(slots[0], &slots[1..self.near_slots()]);
        let mut shares = vec![T::of(0.0); self.near.nodes.len()];
        for Foot { nearest, between, part } in feet {
            between.iter().zip(nearest.shares).for_each(|(&node, b)| shares[node] = shares[node] + part * b);
        }
        (distance - T::of(self.of.apart()), shares)
    }

    /// The derivatives by the first `slots` slots of a function that is evaluated along two changes of them.
    pub fn gradient_of(&self, slots: usize, f: impl Fn([&[Vec3]; 2]) -> HyperDual) -> Vec<Vec3> {
        let (dim, mut by) = (self.dim(), vec![Vec3::zeros(); slots]);
        for pair in (0..dim * slots).step_by(2) {
            let along = [pair, pair + 1].map(|component| unit(dim, slots, component));
            let HyperDual([_, one, two, _]) = f([&along[0], &along[1]]);
            by[pair / dim][pair % dim] = one;
            if pair + 1 < dim * slots {
                by[(pair + 1) / dim][(pair + 1) % dim] = two;
            }
        }
        by
    }

    /// The derivatives of `f(d) (c_0 + sum_a q_a c_a)` by the slots of the potential, d the gap, q the shares of the nodes of the pieces, c numbers of the slots.
    pub fn weighed(&self, of_slots: &[f64], f: impl Fn(HyperDual) -> HyperDual) -> Vec<Vec3> {
        self.gradient_of(self.near_slots(), |along| {
            let (gap, shares) = self.foot(&self.along(along));
            let first = HyperDual::of(of_slots[0]);
            f(gap) * shares.iter().zip(&of_slots[1..]).fold(first, |sum, (q, c)| sum + *q * HyperDual::of(*c))
        })
    }

    /// The corner of facets at which it lies, if any.
    pub fn corner(&self) -> Option<usize> {
        match self.side.samples.parts(self.near.sample) {
            [(node, _)] => self.of.with.recovery.corner(*node),
            _ => None,
        }
    }

    /// A matrix of columns over the slots as a matrix over the unknowns of its nodes; missing columns and rows are zero.
    fn element_of(&self, columns: &[Vec<Vec3>], factor: f64) -> Vec<f64> {
        self.element(|[a, i], [b, j]| {
            let row = columns.get(self.dim() * b + j).and_then(|column| column.get(a));
            row.map_or(0.0, |row| factor * row[i])
        })
    }

    /// The second derivative of the potential by its slots, in columns.
    fn columns(&self, pressure: &Pressure) -> Vec<Vec<Vec3>> {
        let (dim, slots) = (self.dim(), self.near_slots());
        if !self.touches(&self.of.layer) {
            return Vec::new();
        }
        let of_pair = |pair: usize| {
            let along = [pair, pair + 1].map(|component| unit(dim, slots, component));
            potential_changes(self, pressure, [&along[0], &along[1]])
        };
        let columns: Vec<Vec<Vec3>> = (0..dim * slots).step_by(2).flat_map(of_pair).collect();
        let entry = |(a, i): (usize, usize), (b, j): (usize, usize)| columns[dim * b + j][a][i];
        let symmetric = |b: usize, j: usize, a: usize| {
            Vec3::from_fn(|i, _| if i < dim { 0.5 * (entry((a, i), (b, j)) + entry((b, j), (a, i))) } else { 0.0 })
        };
        let column = |k: usize| (0..slots).map(|a| symmetric(k / dim, k % dim, a)).collect();
        (0..dim * slots).map(column).collect()
    }
}

/// A change of one component of one of the slots; zero beyond the last.
pub(super) fn unit(dim: usize, slots: usize, component: usize) -> Vec<Vec3> {
    let mut v = vec![Vec3::zeros(); slots];
    if component < dim * slots {
        v[component / dim][component % dim] = 1.0;
    }
    v
}

/// A vector and its two changes, times `factor`.
pub(super) fn dual(x: &Vec3, factor: f64, [a, b]: [&Vec3; 2]) -> [HyperDual; 3] {
    std::array::from_fn(|i| HyperDual([x[i], factor * a[i], factor * b[i], 0.0]))
}

impl Stencil for BeforeSurface<'_> {
    fn number(&self) -> usize {
        self.side.first + self.near.sample
    }

    fn weight(&self) -> f64 {
        AREA_SHARE * self.side.samples.weights[self.near.sample]
    }

    fn gap(&self) -> f64 {
        self.gap
    }

    fn gradient(&self) -> &Vec<Vec3> {
        &self.gradient
    }

    fn push_gradient(&self, pressure: &Pressure) -> Vec<Vec3> {
        scaled(self.gradient.clone(), pressure.slope)
    }

    fn second(&self, a: &Vec<Vec3>, b: &Vec<Vec3>) -> [Vec<Vec3>; 3] {
        let slots = self.along([a, b]);
        let by = self.near.gradient(&self.near.near(slots[0], &slots[1..]).1);
        let part = |which: usize| by.iter().map(|by| Vec3::from_fn(|i, _| by[i].0[which])).collect();
        [1, 2, 3].map(part)
    }

    fn slots(&self, of: impl Fn(usize) -> f64, _: &[Vec3; 2]) -> Vec<Vec3> {
        let dim = self.dim();
        let own = self.side.samples.of(self.near.sample, dim, &of);
        let at = |node: u32| Vec3::from_fn(|i, _| if i < dim { of(dim * node as usize + i) } else { 0.0 });
        std::iter::once(own).chain(self.slot_nodes().map(at)).collect()
    }

    fn of_pose(_: &Vec<Vec3>) -> [Vec3; 2] {
        [Vec3::zeros(); 2]
    }

    /// On the first surface: force and moment on the nodes of the pieces are the opposite of those on the sample's side.
    fn resultant(&self, forces: &Vec<Vec3>, u: &[f64], pivot: &Vec3) -> [Vec3; 2] {
        let on_own = match &self.of.with.sides[..] {
            [first, _] if std::ptr::eq(first, self.side) => 1.0,
            [_, _] => -1.0,
            _ => 0.0,
        };
        let mut sum = [Vec3::zeros(); 2];
        for (&node, force) in self.near.nodes.iter().zip(&forces[1..]) {
            let (arm, force) = (self.side.node(u, node) - pivot, on_own * force);
            sum[0] += force;
            sum[1] += arm.cross(&force);
        }
        sum
    }

    fn dim(&self) -> usize {
        self.of.layer.dim
    }

    fn parts(&self) -> impl Iterator<Item = Part> {
        let own = self.side.samples.parts(self.near.sample).iter();
        let nodes = self.slot_nodes().zip(1..).map(|(node, slot)| Part { node, slot, share: 1.0 });
        own.map(|&(node, share)| Part { node, slot: 0, share }).chain(nodes)
    }

    /// In the symmetric approximation of a general matrix the tangent of friction is its derivative by velocities alone.
    fn tangent(&self, pressure: &Pressure, friction: Option<&Rubbing<'_, Self>>) -> (Vec<f64>, Option<Vec<f64>>) {
        let weight = self.weight();
        let mut element = self.element_of(&self.columns(pressure), weight);
        let Some(friction) = friction else { return (element, None) };
        let strength = weight * friction.coulomb.coefficient;
        let of_friction = self.element_of(&sliding::columns(friction), strength);
        element.iter_mut().zip(&of_friction).for_each(|(entry, more)| *entry += more);
        let mut aside = self.tangent_by_velocity(friction, strength);
        aside.iter_mut().zip(of_friction).for_each(|(entry, whole)| *entry -= whole);
        (element, Some(aside))
    }

    fn tangent_by_velocity(&self, friction: &Rubbing<'_, Self>, factor: f64) -> Vec<f64> {
        let (dim, slots) = (self.dim(), self.places.len());
        let column = |component: usize| friction.by_velocity(&unit(dim, slots, component), 1.0);
        self.element_of(&(0..dim * slots).map(column).collect::<Vec<_>>(), friction.coulomb.rate * factor)
    }

    fn change(&self, pressure: &Pressure, friction: Option<&Rubbing<'_, Self>>, along: &Vec<Vec3>) -> Vec<Vec3> {
        let [potential, _] = potential_changes(self, pressure, [along, along]);
        let mut change = match friction {
            Some(friction) => scaled(sliding::change(friction, along), friction.coulomb.coefficient),
            None => vec![Vec3::zeros(); potential.len()],
        };
        add_scaled(&mut change, &potential, 1.0);
        scaled(change, self.weight())
    }
}
