//! Annotations: title, legend, colour bar, axes, scale of lengths, arrows. Drawn last.

use super::arrows;
use super::body::Appearance;
use super::colour::Colour;
use super::path::NamedPath;
use super::picture::Picture;
use super::polylines::{self, DASH, GAP};
use super::scene::{Bar, Scene};
use super::vector::{V3, unit};

/// Where a text touches its point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Anchor {
    Start,
    Middle,
    End,
}

/// A flat thing in the picture, in pixels.
#[derive(Clone, Debug)]
pub(super) enum Mark {
    Line {
        from: [f64; 2],
        to: [f64; 2],
        width: f64,
        colour: Colour,
    },
    Polygon {
        points: Vec<[f64; 2]>,
        colour: Colour,
        opacity: f32,
    },
    /// `at` is the middle of the text's height.
    Text {
        at: [f64; 2],
        anchor: Anchor,
        height: f64,
        bold: bool,
        colour: Colour,
        text: String,
    },
}

pub(super) struct Frame {
    pub marks: Vec<Mark>,
}

impl Frame {
    pub fn new(picture: &Picture, scene: &Scene) -> Self {
        let unit = f64::from(picture.height) / 1000.0;
        let size = [f64::from(picture.width), f64::from(picture.height)];
        let mut layout = Layout { marks: Vec::new(), unit, size };
        if !picture.is_plain {
            layout.title(&picture.title, &picture.subtitle);
        }
        layout.legend(picture, scene);
        if let Some(bar) = &scene.bar {
            layout.bar(bar);
        }
        layout.axes(scene);
        layout.ruler(scene, &picture.length_unit);
        layout.vectors(picture, scene);
        layout.marks.extend(polylines::marks(picture, scene, unit));
        layout.marks.extend(arrows::marks(picture, scene, unit));
        Self { marks: layout.marks }
    }
}

/// What stands before a name of the legend.
enum Swatch<'a> {
    Body(&'a Appearance),
    Path(&'a NamedPath),
}

struct Layout {
    marks: Vec<Mark>,
    /// Pixels per thousandth of the height.
    unit: f64,
    size: [f64; 2],
}

/// Of what stands back behind the rest.
pub(super) const MUTED: Colour = Colour([92, 100, 112]);

impl Layout {
    fn text(&mut self, at: [f64; 2], anchor: Anchor, height: f64, bold: bool, colour: Colour, text: &str) {
        let height = height * self.unit;
        self.marks.push(Mark::Text { at, anchor, height, bold, colour, text: text.to_owned() });
    }

    fn line(&mut self, from: [f64; 2], to: [f64; 2], width: f64, colour: Colour) {
        let width = (width * self.unit).max(1.0);
        self.marks.push(Mark::Line { from, to, width, colour });
    }

    fn rectangle(&mut self, low: [f64; 2], high: [f64; 2], colour: Colour, opacity: f32) {
        let points = vec![low, [high[0], low[1]], high, [low[0], high[1]]];
        self.marks.push(Mark::Polygon { points, colour, opacity });
    }

    fn title(&mut self, title: &str, subtitle: &str) {
        let u = self.unit;
        self.text([48.0 * u, 56.0 * u], Anchor::Start, 32.0, true, Colour::INK, title);
        for (k, line) in self.fitting(subtitle).iter().enumerate() {
            self.text([48.0 * u, (94.0 + 28.0 * k as f64) * u], Anchor::Start, 24.0, false, MUTED, line);
        }
    }

    /// What stands between the semicolons of a subtitle, in as few lines as fit into the picture.
    fn fitting(&self, subtitle: &str) -> Vec<String> {
        let room = self.size[0] - 96.0 * self.unit;
        let wide = |text: &str| super::text::width(text.trim_end(), 24.0 * self.unit);
        let mut lines: Vec<String> = Vec::new();
        for part in subtitle.split_inclusive("; ") {
            match lines.last_mut() {
                Some(line) if wide(&format!("{line}{part}")) <= room => line.push_str(part),
                _ => lines.push(part.to_owned()),
            }
        }
        lines
    }

    /// What bodies and paths are called, in as few rows from the bottom as leave room for the scale of lengths.
    fn legend(&mut self, picture: &Picture, scene: &Scene) {
        let u = self.unit;
        let most = self.size[0] - 470.0 * u;
        let mut at = [48.0 * u, self.size[1] - 50.0 * u];
        let bodies = picture.bodies.iter().map(|body| (&body.label, Swatch::Body(&body.appearance)));
        let paths = picture.paths.iter().map(|path| (&path.label, Swatch::Path(path)));
        for (label, swatch) in bodies.chain(paths).filter(|(label, _)| !label.is_empty()) {
            let wide = 46.0 * u + super::text::width(label, 24.0 * u);
            if at[0] + wide > most && at[0] > 48.0 * u {
                at = [48.0 * u, at[1] - 36.0 * u];
            }
            self.swatch(at, &swatch, scene);
            self.text([at[0] + 46.0 * u, at[1]], Anchor::Start, 24.0, false, Colour::INK, label);
            at[0] += wide + 40.0 * u;
        }
    }

    fn swatch(&mut self, [x, y]: [f64; 2], swatch: &Swatch<'_>, scene: &Scene) {
        let u = self.unit;
        let (low, high) = ([x, y - 11.0 * u], [x + 34.0 * u, y + 11.0 * u]);
        match (swatch, &scene.bar) {
            (Swatch::Path(path), _) if path.is_dashed => {
                let line = [[low[0], y], [high[0], y]];
                for [from, to] in polylines::dashes(&line, [DASH * u, GAP * u]) {
                    self.line(from, to, 3.5, path.colour);
                }
            }
            (Swatch::Path(path), _) => self.line([low[0], y], [high[0], y], 3.5, path.colour),
            (Swatch::Body(Appearance::Solid(colour)), _) => self.rectangle(low, high, *colour, 1.0),
            (Swatch::Body(Appearance::Field(_)), Some(bar)) => self.gradient(low, high, bar, false),
            (Swatch::Body(Appearance::Field(_)), None) => {}
            (Swatch::Body(Appearance::Glass(colour)), _) => {
                self.rectangle(low, high, *colour, 0.3);
                self.outline(low, high, *colour);
            }
            (Swatch::Body(Appearance::Wire(colour)), _) => self.outline(low, high, *colour),
        }
    }

    fn outline(&mut self, low: [f64; 2], high: [f64; 2], colour: Colour) {
        let corners = [low, [high[0], low[1]], high, [low[0], high[1]]];
        for k in 0..4 {
            self.line(corners[k], corners[(k + 1) % 4], 1.5, colour);
        }
    }

    /// Slices of the colour map: left to right, or bottom to top.
    fn gradient(&mut self, low: [f64; 2], high: [f64; 2], bar: &Bar, upright: bool) {
        const SLICES: usize = 96;
        for k in 0..SLICES {
            let share = |k: usize| k as f64 / SLICES as f64;
            let value = bar.map.low + (bar.map.high - bar.map.low) * (share(k) + 0.5 / SLICES as f64);
            let colour = bar.map.colour(value);
            let along = |axis: usize, share: f64| low[axis] + (high[axis] - low[axis]) * share;
            if upright {
                let (bottom, top) = (along(1, 1.0 - share(k)), along(1, 1.0 - share(k + 1)));
                self.rectangle([low[0], top.floor()], [high[0], bottom.ceil()], colour, 1.0);
            } else {
                self.rectangle([along(0, share(k)), low[1]], [along(0, share(k + 1)).ceil(), high[1]], colour, 1.0);
            }
        }
    }

    fn bar(&mut self, bar: &Bar) {
        let u = self.unit;
        let low = [self.size[0] - 206.0 * u, 0.5 * self.size[1] - 230.0 * u];
        let high = [low[0] + 30.0 * u, 0.5 * self.size[1] + 230.0 * u];
        let (_, factor) = prefix(bar);
        let label = bar_label(bar);
        let right = self.size[0] - 40.0 * u;
        // Above the bar, kept inside the picture.
        let wide = super::text::width(&label, 24.0 * u);
        self.text([right.min(low[0] + wide), low[1] - 40.0 * u], Anchor::End, 24.0, false, Colour::INK, &label);
        self.gradient(low, high, bar, true);
        self.bar_outline(low, high, bar);
        let (from, to) = (bar.map.low * factor, bar.map.high * factor);
        let ticks = with_ends(ticks(from, to), from, to);
        for (tick, text) in ticks.iter().zip(distinct(&ticks)) {
            let share = if to > from { (*tick - from) / (to - from) } else { 0.5 };
            let y = high[1] + (low[1] - high[1]) * share;
            self.line([high[0], y], [high[0] + 8.0 * u, y], 1.5, MUTED);
            self.text([high[0] + 16.0 * u, y], Anchor::Start, 20.0, false, Colour::INK, &text);
        }
    }

    /// The outline of the bar, with a point at an end beyond which there are values: these have the colour of the end.
    fn bar_outline(&mut self, low: [f64; 2], high: [f64; 2], bar: &Bar) {
        let tip = 22.0 * self.unit;
        let [below, above] = bar.beyond;
        let middle = 0.5 * (low[0] + high[0]);
        let mut corners = vec![low];
        if above {
            let points = vec![low, [middle, low[1] - tip], [high[0], low[1]]];
            self.marks.push(Mark::Polygon { points, colour: bar.map.colour(bar.map.high), opacity: 1.0 });
            corners.push([middle, low[1] - tip]);
        }
        corners.extend([[high[0], low[1]], high]);
        if below {
            let points = vec![[low[0], high[1]], [middle, high[1] + tip], high];
            self.marks.push(Mark::Polygon { points, colour: bar.map.colour(bar.map.low), opacity: 1.0 });
            corners.push([middle, high[1] + tip]);
        }
        corners.push([low[0], high[1]]);
        for k in 0..corners.len() {
            self.line(corners[k], corners[(k + 1) % corners.len()], 1.5, MUTED);
        }
    }

    fn axes(&mut self, scene: &Scene) {
        let u = self.unit;
        let centre = [self.size[0] - 110.0 * u, self.size[1] - 90.0 * u];
        let axes = [
            ([1.0, 0.0, 0.0], "x", Colour([200, 60, 54])),
            ([0.0, 1.0, 0.0], "y", Colour([52, 140, 80])),
            ([0.0, 0.0, 1.0], "z", Colour([48, 98, 190])),
        ];
        let mut seen: Vec<(V3, &str, Colour)> =
            axes.iter().map(|(axis, name, colour)| (scene.camera.see(*axis), *name, *colour)).collect();
        // What points away is drawn first.
        seen.sort_by(|a, b| a.0[2].total_cmp(&b.0[2]));
        for (axis, name, colour) in seen {
            let reach = axis[0].hypot(axis[1]);
            if reach < 0.12 {
                continue;
            }
            let end = [centre[0] + 50.0 * u * axis[0], centre[1] - 50.0 * u * axis[1]];
            self.marks.extend(arrows::arrow(centre, end, 4.0 * u, colour));
            let past = 18.0 / (50.0 * reach);
            let label = [end[0] + (end[0] - centre[0]) * past, end[1] + (end[1] - centre[1]) * past];
            self.text(label, Anchor::Middle, 20.0, true, colour, name);
        }
    }

    /// Arrows of one length, from the right upper corner downwards, shortened as they point to the eye or away.
    fn vectors(&mut self, picture: &Picture, scene: &Scene) {
        let u = self.unit;
        for (k, (label, colour, vector)) in picture.vectors.iter().enumerate() {
            let Some(direction) = unit(*vector) else { continue };
            let seen = scene.camera.see(direction);
            let centre = [self.size[0] - 110.0 * u, (100.0 + 150.0 * k as f64) * u];
            let half = [45.0 * u * seen[0], -45.0 * u * seen[1]];
            let (from, to) = ([centre[0] - half[0], centre[1] - half[1]], [centre[0] + half[0], centre[1] + half[1]]);
            let reach = seen[0].hypot(seen[1]);
            self.marks.extend(arrows::arrow(from, to, 5.0 * u, *colour));
            let name = match reach < 0.3 {
                false => label.clone(),
                true if seen[2] > 0.0 => format!("{label} (to the eye)"),
                true => format!("{label} (from the eye)"),
            };
            self.text([centre[0], centre[1] + 66.0 * u], Anchor::Middle, 20.0, true, *colour, &name);
        }
    }

    /// A length of the bodies' own size.
    fn ruler(&mut self, scene: &Scene, unit: &str) {
        let u = self.unit;
        let Some(length) = round_down(180.0 * u / scene.scale) else { return };
        let pixels = length * scene.scale;
        let y = self.size[1] - 62.0 * u;
        let right = self.size[0] - 240.0 * u;
        let left = right - pixels;
        self.line([left, y], [right, y], 2.0, MUTED);
        for x in [left, right] {
            self.line([x, y - 7.0 * u], [x, y + 7.0 * u], 2.0, MUTED);
        }
        let text = format!("{} {unit}", number(length));
        self.text([0.5 * (left + right), y - 22.0 * u], Anchor::Middle, 20.0, false, MUTED, &text);
    }
}

/// 1, 2 or 5 times a power of ten, at most `length`.
fn round_down(length: f64) -> Option<f64> {
    let power = 10_f64.powf(length.log10().floor());
    let factor = [5.0, 2.0, 1.0].into_iter().find(|factor| factor * power <= length)?;
    Some(factor * power).filter(|length| length.is_finite() && *length > 0.0)
}

/// Round numbers within a range, four to eight of them; one if the range is a point.
pub(super) fn ticks(low: f64, high: f64) -> Vec<f64> {
    let Some(step) = round_down((high - low) / 3.0) else { return vec![low] };
    let step = if (high - low) / step > 8.0 { 2.0 * step } else { step };
    let first = (low / step - 1e-9).ceil() as i64;
    let last = (high / step + 1e-9).floor() as i64;
    (first..=last).map(|k| k as f64 * step).collect()
}

/// The ends of the range too, to three digits, where no round number stands close by.
fn with_ends(mut ticks: Vec<f64>, low: f64, high: f64) -> Vec<f64> {
    for end in [low, high] {
        if ticks.iter().all(|tick| (tick - end).abs() > 0.06 * (high - low)) {
            ticks.push(end);
        }
    }
    ticks
}

/// What stands above the bar.
pub(super) fn bar_label(bar: &Bar) -> String {
    if bar.unit.is_empty() { bar.name.clone() } else { format!("{} [{}{}]", bar.name, prefix(bar).0, bar.unit) }
}

/// A thousandfold of SI that makes the numbers short, for units that take one.
fn prefix(bar: &Bar) -> (&'static str, f64) {
    let most = bar.map.low.abs().max(bar.map.high.abs());
    let takes = ["Pa", "N", "T", "J", "m", "N/m"].contains(&bar.unit.as_str());
    match most {
        _ if !takes || most == 0.0 => ("", 1.0),
        most if most >= 2e6 => ("M", 1e-6),
        most if most >= 2e3 => ("k", 1e-3),
        most if most < 2e-5 => ("u", 1e6),
        most if most < 0.2 => ("m", 1e3),
        _ => ("", 1.0),
    }
}

/// A number for people: up to four digits, no trailing zeros.
pub(super) fn number(value: f64) -> String {
    to_digits(value, MIN_DIGITS)
}

/// Numbers with as few digits as tell them apart.
fn distinct(numbers: &[f64]) -> Vec<String> {
    let at = |digits: i32| -> Vec<String> { numbers.iter().map(|value| to_digits(*value, digits)).collect() };
    let differ = |texts: &Vec<String>| (1..texts.len()).all(|k| !texts[..k].contains(&texts[k]));
    (MIN_DIGITS..MAX_DIGITS).map(at).find(differ).unwrap_or_else(|| at(MAX_DIGITS))
}

/// Digits behind the first one, and how many tell numbers apart at most.
const MIN_DIGITS: i32 = 3;
const MAX_DIGITS: i32 = 9;

fn to_digits(value: f64, digits: i32) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    if !(1e-4..1e6).contains(&value.abs()) {
        let text = format!("{value:.0$e}", digits as usize);
        let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
        let short =
            if mantissa.contains('.') { mantissa.trim_end_matches('0').trim_end_matches('.') } else { mantissa };
        return format!("{short}e{exponent}");
    }
    let digits = (digits - value.abs().log10().floor() as i32).clamp(0, 9) as usize;
    let text = format!("{value:.digits$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_inside() {
        assert_eq!(ticks(-400.0, 190.0), [-400.0, -300.0, -200.0, -100.0, 0.0, 100.0]);
        assert_eq!(ticks(0.0, 1.0), [0.0, 0.2, 0.4, 0.6000000000000001, 0.8, 1.0]);
        assert_eq!(ticks(3.0, 3.0), [3.0]);
        for (low, high) in [(0.0, 0.37), (-1.0, 9.0), (-8e-9, 2e-9), (1.0, 1.9)] {
            let found = ticks(low, high);
            assert!((4..=9).contains(&found.len()), "{low} {high}: {found:?}");
        }
    }

    #[test]
    fn numbers_are_short() {
        let texts = [0.0, 0.2, -150.0, 0.30000000000000004, 1e7, 2.5e-6, 123456.0].map(number);
        assert_eq!(texts, ["0", "0.2", "-150", "0.3", "1e7", "2.5e-6", "123456"]);
    }

    #[test]
    fn numbers_of_a_bar_differ() {
        assert_eq!(distinct(&[0.9998, 1.0, 1.0005, 1.001]), ["0.9998", "1", "1.0005", "1.001"]);
        assert_eq!(distinct(&[2.0, 3.0, 3.0]), ["2", "3", "3"]);
    }
}
