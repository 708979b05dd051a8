//! [`Chart`]: curves over two axes.

use std::path::Path;

use nastic_io::{WriteError, write_atomically};

use super::colour::Colour;
use super::frame::{Anchor, MUTED, Mark, number, ticks};
use super::raster::Image;
use super::shade::Ground;
use super::{png, svg, text};

/// Curves over two axes with linear scales, as PNG or SVG; the same chart gives the same bytes.
///
/// ```
/// use nastic_picture::{Chart, Curve};
///
/// # let out = tempfile::tempdir()?;
/// let points = (0..20).map(|k| (f64::from(k), f64::from(k * k), k < 15));
/// Chart::new("Tip over pressure", "pressure (Pa)", "displacement (m)")
///     .curve(Curve::new("tip y", points))
///     .mark(14.5, "critical")
///     .write(out.path().join("chart.svg"))?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Chart {
    title: String,
    axes: [String; 2],
    curves: Vec<Curve>,
    lines: Vec<(f64, String)>,
    /// What stands at places of the x axis in the place of numbers.
    names: Vec<(f64, String)>,
    dots: Vec<([f64; 2], String)>,
}

/// Points joined in their order.
#[derive(Clone, Debug)]
pub struct Curve {
    label: String,
    /// x, y, and whether the curve is solid there: both ends of a dashed piece or one of them are not.
    points: Vec<(f64, f64, bool)>,
    /// Of a line without dots: its width.
    width: Option<f64>,
}

impl Curve {
    /// `(x, y, solid)`: what is not solid is dashed, with hollow dots. Points that are not finite interrupt the curve.
    pub fn new(label: &str, points: impl IntoIterator<Item = (f64, f64, bool)>) -> Self {
        Self { label: label.to_owned(), points: points.into_iter().collect(), width: None }
    }

    /// A line of this width (pixels) without dots, under all others and under lines before it.
    pub fn line(label: &str, width: f64, points: impl IntoIterator<Item = (f64, f64, bool)>) -> Self {
        Self { width: Some(width), ..Self::new(label, points) }
    }
}

const SIZE: [f64; 2] = [1600.0, 1000.0];
/// The rectangle of the axes: left, right, top, bottom.
const FIELD: [f64; 4] = [210.0, 1550.0, 150.0, 850.0];
/// Curves named in the legend, each in a colour of its own.
const NAMED: usize = Colour::DISTINCT.len();
/// Height of a row of the legend; two rows have room below the axes.
const ROW: f64 = 32.0;

impl Chart {
    /// An empty chart with the names of its axes.
    pub fn new(title: &str, x: &str, y: &str) -> Self {
        let axes = [x, y].map(str::to_owned);
        Self {
            title: title.to_owned(),
            axes,
            curves: Vec::new(),
            lines: Vec::new(),
            names: Vec::new(),
            dots: Vec::new(),
        }
    }

    /// Adds a curve; after twelve the colours repeat. One without a name goes on with the one before: it has its colour, and no entry in the legend.
    pub fn curve(mut self, curve: Curve) -> Self {
        self.curves.push(curve);
        self
    }

    /// Whether it has no curve.
    pub fn is_empty(&self) -> bool {
        self.curves.is_empty()
    }

    /// Adds a vertical line with a name.
    pub fn mark(mut self, x: f64, label: &str) -> Self {
        self.lines.push((x, label.to_owned()));
        self
    }

    /// Names a place of the x axis, which then has names alone and no numbers.
    pub fn name(mut self, x: f64, label: &str) -> Self {
        self.names.push((x, label.to_owned()));
        self
    }

    /// Adds a point with a name.
    pub fn dot(mut self, x: f64, y: f64, label: &str) -> Self {
        self.dots.push(([x, y], label.to_owned()));
        self
    }

    /// The chart as SVG; nothing without a finite point.
    pub fn svg(&self) -> Option<String> {
        Some(svg::flat(&self.title, (SIZE[0] as u32, SIZE[1] as u32), &self.marks()?))
    }

    /// Writes a PNG or an SVG, by the ending of the name.
    ///
    /// # Errors
    ///
    /// [`WriteError::System`]; [`WriteError::Content`] for another ending, or without a finite point.
    pub fn write(&self, path: impl AsRef<Path>) -> Result<(), WriteError> {
        let path = path.as_ref();
        let bad = |what: &str, advice: &str| WriteError::Content {
            file: path.to_owned(),
            what: what.to_owned(),
            advice: advice.to_owned(),
        };
        let marks = self.marks().ok_or_else(|| bad("the chart has no finite point", "add a curve"))?;
        match path.extension().and_then(|ending| ending.to_str()) {
            Some("svg") => {
                let [width, height] = SIZE.map(|size| size as u32);
                let text = svg::flat(&self.title, (width, height), &marks);
                write_atomically(path, |out| out.write_all(text.as_bytes()))
            }
            Some("png") => {
                let [width, height] = SIZE.map(|size| size as usize);
                let row = |y: usize| vec![Ground::Shaded.at(y as f64 / SIZE[1]).linear(); width];
                let mut image = Image { width, height, pixels: (0..height).flat_map(row).collect() };
                text::draw(&mut image, &marks);
                let bytes = png::encode(&image).map_err(|error| bad(&error.to_string(), "use .svg"))?;
                write_atomically(path, |out| out.write_all(&bytes))
            }
            _ => Err(bad("the ending of the name is not known", "use .png or .svg")),
        }
    }

    fn marks(&self) -> Option<Vec<Mark>> {
        let points = || self.curves.iter().flat_map(|curve| &curve.points);
        let finite = |values: &mut dyn Iterator<Item = f64>| {
            let range = |(low, high): (f64, f64), x: f64| (low.min(x), high.max(x));
            let (low, high) = values.filter(|x| x.is_finite()).fold((f64::INFINITY, f64::NEG_INFINITY), range);
            (low <= high).then(|| Axis::around(low, high))
        };
        let dots = |axis: usize| self.dots.iter().map(move |(at, _)| at[axis]);
        let x = finite(&mut points().map(|p| p.0).chain(self.lines.iter().map(|line| line.0)).chain(dots(0)))?;
        let y = finite(&mut points().map(|p| p.1).chain(dots(1)))?;
        let rows = rows(&self.curves);
        let [left, right, top, bottom] = FIELD;
        let field = [left, right, top, bottom - ROW * (rows.len().max(2) - 2) as f64];
        let mut drawing = Drawing { x, y, field, marks: Vec::new() };
        drawing.frame(self);
        for (x, name) in &self.lines {
            drawing.vertical(*x, name);
        }
        let coloured = coloured(&self.curves);
        let (lines, dotted): (Vec<_>, Vec<_>) = coloured.into_iter().partition(|(curve, _)| curve.width.is_some());
        for (curve, colour) in lines.into_iter().rev().chain(dotted) {
            drawing.curve(curve, colour);
        }
        for (at, name) in &self.dots {
            drawing.named_dot(*at, name);
        }
        drawing.legend(&rows);
        Some(drawing.marks)
    }
}

/// Curves with their colours.
fn coloured(curves: &[Curve]) -> Vec<(&Curve, Colour)> {
    let mut named = 0;
    let of = |curve: &'_ Curve| {
        named += usize::from(!curve.label.is_empty());
        Colour::DISTINCT[named.saturating_sub(1) % NAMED]
    };
    let colours: Vec<Colour> = curves.iter().map(of).collect();
    curves.iter().zip(colours).collect()
}

/// The entries of the legend in as many rows as they take.
fn rows(curves: &[Curve]) -> Vec<Vec<(&Curve, Colour)>> {
    let named = coloured(curves).into_iter().filter(|(curve, _)| !curve.label.is_empty()).take(NAMED);
    let (mut rows, mut right): (Vec<Vec<_>>, f64) = (Vec::new(), f64::INFINITY);
    for entry in named {
        let wide = entry_width(entry.0);
        if right + wide > SIZE[0] {
            rows.push(Vec::new());
            right = FIELD[0];
        }
        right += wide;
        if let Some(row) = rows.last_mut() {
            row.push(entry);
        }
    }
    rows
}

fn entry_width(curve: &Curve) -> f64 {
    44.0 + text::width(&curve.label, 24.0) + 36.0
}

/// The range of an axis.
#[derive(Clone, Copy)]
struct Axis {
    low: f64,
    high: f64,
}

impl Axis {
    /// With a margin; a range of one value gets a length.
    fn around(low: f64, high: f64) -> Self {
        let wide = high - low;
        let size = low.abs().max(high.abs());
        let margin = match () {
            () if wide > 1e-12 * size => 0.04 * wide,
            () if size > 0.0 => 0.5 * size,
            () => 1.0,
        };
        Axis { low: low - margin, high: high + margin }
    }

    /// Where a value stands: 0 at the low end, 1 at the high one.
    fn share(self, value: f64) -> f64 {
        (value - self.low) / (self.high - self.low)
    }
}

/// The beginning of a name that has room.
fn fitting(name: &str, room: f64) -> String {
    let is_short = |text: &str| text::width(text, 24.0) + 12.0 <= room;
    if is_short(name) {
        return name.to_owned();
    }
    let letters: Vec<char> = name.chars().collect();
    let begins = (1..letters.len()).rev().map(|count| letters[..count].iter().collect::<String>() + "..");
    begins.into_iter().find(|text| is_short(text)).unwrap_or_default()
}

struct Drawing {
    x: Axis,
    y: Axis,
    /// The rectangle of the axes: left, right, top, bottom.
    field: [f64; 4],
    marks: Vec<Mark>,
}

impl Drawing {
    fn place(&self, x: f64, y: f64) -> [f64; 2] {
        let [left, right, top, bottom] = self.field;
        [left + (right - left) * self.x.share(x), bottom + (top - bottom) * self.y.share(y)]
    }

    fn line(&mut self, from: [f64; 2], to: [f64; 2], width: f64, colour: Colour) {
        self.marks.push(Mark::Line { from, to, width, colour });
    }

    fn text(&mut self, at: [f64; 2], anchor: Anchor, bold: bool, colour: Colour, text: &str) {
        let height = if bold { 32.0 } else { 24.0 };
        self.marks.push(Mark::Text { at, anchor, height, bold, colour, text: text.to_owned() });
    }

    fn frame(&mut self, chart: &Chart) {
        let [left, right, top, bottom] = self.field;
        let grid = Colour([214, 218, 224]);
        self.text([48.0, 56.0], Anchor::Start, true, Colour::INK, &chart.title);
        let numbers = || ticks(self.x.low, self.x.high).into_iter().map(|x| (x, number(x))).collect();
        let names: Vec<(f64, String)> = if chart.names.is_empty() { numbers() } else { chart.names.clone() };
        let room = (right - left) / names.len().max(1) as f64;
        for (x, name) in names {
            let [at, _] = self.place(x, self.y.low);
            self.line([at, top], [at, bottom], 1.0, grid);
            self.text([at, bottom + 28.0], Anchor::Middle, false, Colour::INK, &fitting(&name, room));
        }
        for y in ticks(self.y.low, self.y.high) {
            let [_, at] = self.place(self.x.low, y);
            self.line([left, at], [right, at], 1.0, grid);
            self.text([left - 14.0, at], Anchor::End, false, Colour::INK, &number(y));
        }
        self.line([left, bottom], [right, bottom], 2.0, Colour::INK);
        self.line([left, top], [left, bottom], 2.0, Colour::INK);
        self.text([right, bottom + 66.0], Anchor::End, false, Colour::INK, &chart.axes[0]);
        self.text([48.0, top - 38.0], Anchor::Start, false, Colour::INK, &chart.axes[1]);
    }

    fn vertical(&mut self, x: f64, name: &str) {
        let [at, _] = self.place(x, self.y.low);
        self.dashed([at, self.field[2]], [at, self.field[3]], 2.0, MUTED);
        let anchor = if self.x.share(x) > 0.85 { Anchor::End } else { Anchor::Start };
        let aside = if anchor == Anchor::End { -8.0 } else { 8.0 };
        self.text([at + aside, self.field[2] + 14.0], anchor, false, MUTED, name);
    }

    fn curve(&mut self, curve: &Curve, colour: Colour) {
        let finite = |p: &(f64, f64, bool)| p.0.is_finite() && p.1.is_finite();
        for pair in curve.points.windows(2).filter(|pair| pair.iter().all(finite)) {
            let [from, to] = [pair[0], pair[1]].map(|p| self.place(p.0, p.1));
            if pair[0].2 && pair[1].2 {
                self.line(from, to, curve.width.unwrap_or(3.5), colour);
            } else {
                self.dashed(from, to, curve.width.unwrap_or(2.0), colour);
            }
        }
        if curve.width.is_some() {
            return;
        }
        for point in curve.points.iter().filter(|point| finite(point)) {
            let at = self.place(point.0, point.1);
            self.disc(at, 5.5, colour);
            if !point.2 {
                self.disc(at, 3.5, Colour([250, 251, 252]));
            }
        }
    }

    fn dashed(&mut self, from: [f64; 2], to: [f64; 2], width: f64, colour: Colour) {
        const DASH: f64 = 10.0;
        let length = (to[0] - from[0]).hypot(to[1] - from[1]);
        let pieces = (length / DASH).ceil().max(1.0) as usize;
        let at = |k: usize| {
            let share = (k as f64 * DASH / length.max(1e-9)).min(1.0);
            [0, 1].map(|c| from[c] + share * (to[c] - from[c]))
        };
        (0..pieces).step_by(2).for_each(|k| self.line(at(k), at(k + 1), width, colour));
    }

    fn disc(&mut self, at: [f64; 2], radius: f64, colour: Colour) {
        let corner = |k: usize| {
            let (sin, cos) = (std::f64::consts::TAU * k as f64 / 12.0).sin_cos();
            [at[0] + radius * cos, at[1] + radius * sin]
        };
        self.marks.push(Mark::Polygon { points: (0..12).map(corner).collect(), colour, opacity: 1.0 });
    }

    fn named_dot(&mut self, [x, y]: [f64; 2], name: &str) {
        if !(x.is_finite() && y.is_finite()) {
            return;
        }
        let at = self.place(x, y);
        self.disc(at, if name.is_empty() { 6.5 } else { 9.0 }, Colour::INK);
        let anchor = if self.x.share(x) > 0.8 { Anchor::End } else { Anchor::Start };
        let aside = if anchor == Anchor::End { -16.0 } else { 16.0 };
        // Away from the middle of the chart, where curves come from.
        let aloft = if self.y.share(y) < 0.5 { 22.0 } else { -18.0 };
        self.text([at[0] + aside, at[1] + aloft], anchor, false, Colour::INK, name);
    }

    /// The names of curves below the axis.
    fn legend(&mut self, rows: &[Vec<(&Curve, Colour)>]) {
        let below = if rows.len() > 1 { 54.0 + ROW * (rows.len() - 2) as f64 } else { 40.0 };
        let mut y = SIZE[1] - below;
        for row in rows {
            let mut x = FIELD[0];
            for (curve, colour) in row {
                let is_solid = curve.width.is_none() || curve.points.iter().all(|point| point.2);
                match is_solid {
                    true => self.line([x, y], [x + 34.0, y], 5.0, *colour),
                    false => self.dashed([x, y], [x + 34.0, y], 5.0, *colour),
                }
                self.text([x + 44.0, y], Anchor::Start, false, Colour::INK, &curve.label);
                x += entry_width(curve);
            }
            y += ROW;
        }
    }
}
