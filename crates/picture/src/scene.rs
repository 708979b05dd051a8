//! Bodies, projected into the picture.

use super::body::{Appearance, Body};
use super::camera::Camera;
use super::check::check;
use super::clip::{self, Plane};
use super::colour::{Colour, ColourMap};
use super::colour_range::{ColourRange, ColourValues};
use super::face::Face;
use super::picture::Picture;
use super::shade::Ground;
use super::tessellation::{Surface, SurfaceEdge, SurfacePoint};
use super::vector::{V3, dot, length, sub, unit};
use super::{frame, text};

/// A corner of a flat piece, in the picture.
#[derive(Clone, Copy, Debug)]
pub(super) struct Corner {
    /// Pixels to the right, pixels down, pixels towards the eye.
    pub at: V3,
    /// Unit normal as (right, up, towards the eye).
    pub normal: V3,
    pub value: f64,
}

/// A line on a body.
#[derive(Clone, Debug)]
pub(super) struct Stroke {
    pub points: Vec<V3>,
    pub colour: Colour,
    pub opacity: f32,
    /// Width in pixels.
    pub width: f64,
    /// Pixels it lies in front of its surface, so that this does not swallow it.
    pub lift: f64,
}

/// How a shape is filled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Fill {
    None,
    Opaque(Colour),
    Mapped,
    Glass(Colour),
}

/// A body in the picture.
#[derive(Clone, Debug)]
pub(super) struct Shape {
    pub fill: Fill,
    /// Triangles and quadrangles.
    pub pieces: Vec<Vec<Corner>>,
    pub strokes: Vec<Stroke>,
    /// Added to depths, so that coincident surfaces of two bodies do not flicker.
    pub forward: f64,
    /// Whether it is a part of a surface, which has two sides.
    pub open: bool,
}

/// Where and what the colour bar shows.
#[derive(Clone, Debug)]
pub(super) struct Bar {
    pub name: String,
    pub unit: String,
    pub map: ColourMap,
    /// Whether there are values below its lower end, and above the upper one.
    pub beyond: [bool; 2],
}

/// Everything that is drawn with depth, and what the frame needs to know.
#[derive(Clone, Debug)]
pub(super) struct Scene {
    pub camera: Camera,
    pub shapes: Vec<Shape>,
    pub bar: Option<Bar>,
    pub ground: Ground,
    /// Whether everything lies in the plane: no shading, no third axis.
    pub plane: bool,
    /// Pixels per unit of length.
    pub scale: f64,
    /// Pixels of the point whose camera coordinates are zero.
    origin: [f64; 2],
}

/// Most pieces along each side of a second-order face.
const FINENESS: usize = 4;
/// Pixels that a piece spans at least, in the mean over a body, in a picture of 1000 pixels' height: smaller ones look no rounder.
const PIECE: f64 = 14.0;

impl Scene {
    pub fn new(picture: &Picture) -> Result<Self, String> {
        check(picture)?;
        let drawn = |body: &Body, node: usize| body.part.as_ref().is_none_or(|marked| marked[node]);
        let all = if picture.framed.is_empty() { seen_points(picture) } else { picture.framed.clone() };
        let plane = picture.bodies.iter().all(|body| body.mesh.dim() == 2) && all.iter().all(|p| p[2] == 0.0);
        let camera = Camera::new(picture.view, plane, &all)?;
        let bar = bar(picture);
        let (scale, origin) = fit(picture, &camera, &all, bar.as_ref())?;
        let ground = if picture.is_plain { Ground::White } else { Ground::Shaded };
        let mut scene = Self { camera, shapes: Vec::new(), bar, ground, plane, scale, origin };
        let extent = f64::from(picture.width.max(picture.height));
        for (index, body) in picture.bodies.iter().enumerate() {
            let whole = |face: &Face| face.nodes.iter().all(|node| drawn(body, *node as usize));
            let faces: Vec<Face> = Face::all(&body.mesh).into_iter().filter(whole).collect();
            let fineness = scene.fineness(picture, body, &faces);
            let mut surface = Surface::of(body, &faces, fineness);
            if let Some(plane) = plane_of(body) {
                surface = clip::clipped(&surface, body, &plane, fineness);
            }
            let nearer = match body.appearance {
                Appearance::Glass(_) => 0.0,
                Appearance::Solid(_) | Appearance::Field(_) => 4e-3,
                Appearance::Wire(_) => 6e-3,
            };
            let forward = extent * (nearer + 2e-4 * index as f64);
            scene.shapes.push(scene.shape(body, &surface, forward, f64::from(picture.height) / 1000.0));
        }
        Ok(scene)
    }

    /// Pieces along each side of a body's second-order faces, by the mean size of its faces in the picture.
    fn fineness(&self, picture: &Picture, body: &Body, faces: &[Face]) -> usize {
        let size = |face: &Face| {
            let corners = &face.nodes[..face.kind.corners()];
            let [first, .., last] = corners else { return 0.0 };
            let [a, b] = [first, last].map(|node| body.positions[*node as usize]);
            self.scale * length(sub(a, b))
        };
        let mean = faces.iter().map(size).sum::<f64>() / faces.len().max(1) as f64;
        let pieces = mean / (PIECE * f64::from(picture.height) / 1000.0);
        (1..FINENESS).find(|pieces_here| pieces <= *pieces_here as f64).unwrap_or(FINENESS)
    }

    /// A point in the picture.
    pub fn place(&self, p: V3) -> V3 {
        let [right, up, near] = self.camera.see(p);
        [self.origin[0] + self.scale * right, self.origin[1] - self.scale * up, self.scale * near]
    }

    fn shape(&self, body: &Body, surface: &Surface, forward: f64, thickness: f64) -> Shape {
        let open = body.part.is_some();
        let fill = match &body.appearance {
            Appearance::Solid(colour) => Fill::Opaque(*colour),
            Appearance::Field(_) => Fill::Mapped,
            Appearance::Glass(colour) => Fill::Glass(*colour),
            Appearance::Wire(_) => Fill::None,
        };
        let corner = |point: &SurfacePoint| {
            let normal = self.camera.see(point.normal);
            // The back of a sheet is lit as its front.
            let normal = if open && normal[2] < 0.0 { normal.map(|x| -x) } else { normal };
            Corner { at: self.place(point.at), normal, value: point.value }
        };
        let pieces = surface.pieces.iter().map(|piece| piece.iter().map(corner).collect());
        let pieces = if fill == Fill::None { Vec::new() } else { pieces.collect() };
        let strokes = surface.edges.iter().filter_map(|edge| self.stroke(body, edge, thickness)).collect();
        Shape { fill, pieces, strokes, forward, open }
    }

    fn stroke(&self, body: &Body, edge: &SurfaceEdge, thickness: f64) -> Option<Stroke> {
        let (appearance, lines, open) = (&body.appearance, body.lines, body.part.is_some());
        let marked = self.is_outline(edge);
        let hidden = !self.plane && !open && edge.normals.iter().all(|normal| dot(*normal, self.camera.eye) <= 0.0);
        let (colour, opacity, width) = match appearance {
            // Seen through the body, lines of the far side only confuse.
            Appearance::Wire(_) | Appearance::Glass(_) if hidden => return None,
            Appearance::Solid(_) | Appearance::Field(_) if marked => (Colour::INK, 0.85, 1.8),
            Appearance::Solid(_) | Appearance::Field(_) if lines => (Colour::INK, 0.32, 1.0),
            Appearance::Glass(colour) if marked => (darker(*colour), 0.8, 1.6),
            Appearance::Wire(colour) if marked => (*colour, 1.0, 2.2),
            Appearance::Wire(colour) => (*colour, 0.45, 1.0),
            _ => return None,
        };
        let points = edge.points.iter().map(|p| self.place(*p)).collect();
        // Outlines of glass also show on an opaque body just in front of it: often the two nearly coincide. In print they would be a tangle on it.
        let shows_through = matches!(appearance, Appearance::Glass(_)) && (self.plane || self.ground != Ground::White);
        let lift = if shows_through { 16.0 * thickness } else { 1.5 };
        Some(Stroke { points, colour, opacity, width: width * thickness.max(0.6), lift })
    }

    /// A crease of the body, the end of a sheet, or the border between what faces the eye and what does not.
    fn is_outline(&self, edge: &SurfaceEdge) -> bool {
        const CREASE: f64 = 0.78;
        let [a, b] = edge.normals[..] else { return true };
        dot(a, b) < CREASE || (dot(a, self.camera.eye) > 0.0) != (dot(b, self.camera.eye) > 0.0)
    }
}

/// The points of everything that is drawn.
pub(super) fn seen_points(picture: &Picture) -> Vec<V3> {
    let of = |body: &'_ Body| -> Vec<V3> {
        let drawn = |node: usize| body.part.as_ref().is_none_or(|marked| marked[node]);
        let own = body.positions.iter().enumerate().filter(|(node, _)| drawn(*node));
        let kept = |at: &V3| plane_of(body).map_or(*at, |plane| plane.kept(*at));
        own.map(|(_, at)| kept(at))
            .chain(body.polylines.iter().flat_map(|(_, points)| points.iter().copied()))
            .collect()
    };
    let paths = picture.paths.iter().flat_map(|path| path.points.iter().copied());
    picture.bodies.iter().flat_map(of).chain(paths).collect()
}

fn darker(colour: Colour) -> Colour {
    Colour(colour.0.map(|byte| (f64::from(byte) * 0.68) as u8))
}

/// One bar for all fields: the first one's name, everyone's range unless one is given.
fn bar(picture: &Picture) -> Option<Bar> {
    let fields = || {
        picture
            .bodies
            .iter()
            .filter_map(|body| if let Appearance::Field(field) = &body.appearance { Some(field) } else { None })
    };
    let first = fields().next()?;
    let mut values = ColourValues::default();
    picture.bodies.iter().for_each(|body| values.add(body));
    let given = fields().find_map(|field| field.range);
    let (range, of_others) = match given {
        Some((low, high)) => {
            let beyond = values.beyond(low, high);
            (ColourRange { low, high, beyond }, fields().fold([false; 2], |all, field| either(all, field.beyond)))
        }
        None => (values.range().unwrap_or(ColourRange { low: 0.0, high: 0.0, beyond: [false; 2] }), [false; 2]),
    };
    let ColourRange { low, high, beyond } = range;
    let (low, high) = if low <= high && low.is_finite() && high.is_finite() { (low, high) } else { (0.0, 0.0) };
    // rounding is no field
    let is_uniform = given.is_none() && high - low <= 1e-6 * low.abs().max(high.abs());
    let (low, high) = if is_uniform { (0.5 * (low + high), 0.5 * (low + high)) } else { (low, high) };
    let beyond = either(beyond, of_others);
    Some(Bar { name: first.name.clone(), unit: first.unit.clone(), map: ColourMap::over(low, high), beyond })
}

fn either(a: [bool; 2], b: [bool; 2]) -> [bool; 2] {
    [a[0] || b[0], a[1] || b[1]]
}

/// The plane that a body is cut by; its normal was checked.
fn plane_of(body: &Body) -> Option<Plane> {
    let (normal, offset) = body.plane?;
    let direction = unit(normal)?;
    Some(Plane { normal: direction, offset: offset / length(normal) })
}

/// Room for title, legend and colour bar, in pixels: left, right, top, bottom.
fn margins(picture: &Picture, bar: Option<&Bar>) -> [f64; 4] {
    let unit = f64::from(picture.height) / 1000.0;
    let (side, top) = if picture.is_plain { (50.0, 50.0) } else { (90.0, 120.0) };
    let label = |bar: &Bar| text::width(&frame::bar_label(bar), 24.0 * unit) + 70.0 * unit;
    let right = bar.map_or(side * unit, |bar| label(bar).max(250.0 * unit));
    [side * unit, right, top * unit, 150.0 * unit]
}

/// Pixels per length, and the pixel of camera coordinates zero, so that everything is inside the margins.
fn fit(picture: &Picture, camera: &Camera, positions: &[V3], bar: Option<&Bar>) -> Result<(f64, [f64; 2]), String> {
    let seen = positions.iter().map(|p| camera.see(*p));
    let none = ([f64::MAX; 2], [f64::MIN; 2]);
    let (low, high) = seen.fold(none, |(low, high), p| {
        (std::array::from_fn(|k| f64::min(low[k], p[k])), std::array::from_fn(|k| f64::max(high[k], p[k])))
    });
    let [left, right, top, bottom] = margins(picture, bar);
    let room = [f64::from(picture.width) - left - right, f64::from(picture.height) - top - bottom];
    let size = [high[0] - low[0], high[1] - low[1]];
    let scale = (room[0] / size[0]).min(room[1] / size[1]);
    if !scale.is_finite() || scale <= 0.0 {
        return Err("the bodies have no extent that could be drawn".to_owned());
    }
    let middle = [left + 0.5 * room[0], top + 0.5 * room[1]];
    let origin = [middle[0] - scale * 0.5 * (low[0] + high[0]), middle[1] + scale * 0.5 * (low[1] + high[1])];
    Ok((scale, origin))
}
