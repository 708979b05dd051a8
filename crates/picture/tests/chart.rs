//! Charts: where curves are drawn, that PNG and SVG agree, and what is refused.

#![allow(clippy::unwrap_used, clippy::panic)] // clippy.toml frees test functions, not their helpers

use nastic_io::WriteError;
use nastic_picture::{Chart, Colour, Curve};

fn chart() -> Chart {
    let points = [(0.0, 0.0, true), (1.0, 2.0, true), (2.0, 1.0, false), (3.0, f64::NAN, true), (4.0, 3.0, true)];
    Chart::new("A < B", "pressure (Pa)", "displacement (m)")
        .curve(Curve::new("tip y", points))
        .curve(Curve::new("middle y", [(0.0, 1.0, true), (4.0, 1.0, true)]))
        .mark(1.5, "critical")
        .dot(1.0, 2.0, "limit")
}

/// (x1, y1, x2, y2) of the lines of a colour and a width.
fn lines(svg: &str, colour: Colour, width: &str) -> Vec<[f64; 4]> {
    let [r, g, b] = colour.0;
    let look = format!("stroke=\"#{r:02x}{g:02x}{b:02x}\" stroke-width=\"{width}\"");
    let ends = |line: &str| {
        let path = line.split("d=\"M").nth(1)?.split('"').next()?.replace('L', " ");
        let numbers: Vec<f64> = path.split(' ').filter_map(|x| x.parse().ok()).collect();
        numbers.try_into().ok()
    };
    svg.lines().filter(|line| line.contains(&look)).filter_map(ends).collect()
}

#[test]
fn curves_stand_where_their_values_are() {
    let directory = tempfile::tempdir().unwrap();
    let file = directory.path().join("chart.svg");
    chart().write(&file).unwrap();
    let svg = std::fs::read_to_string(&file).unwrap();
    assert!(svg.contains("A &lt; B") && svg.contains("pressure (Pa)") && svg.contains("tip y"), "{svg}");
    assert!(svg.contains(">critical<") && svg.contains(">limit<"));
    // one solid piece: the dashed one is of short lines, and what is not finite interrupts
    let solid = lines(&svg, Colour::BLUE, "3.5");
    assert_eq!(solid.len(), 1, "{solid:?}");
    assert!(lines(&svg, Colour::BLUE, "2.0").len() > 5);
    let [x1, y1, x2, y2] = solid[0];
    let level = lines(&svg, Colour::ORANGE, "3.5")[0];
    assert!((level[0] - x1).abs() < 0.2 && (level[1] - level[3]).abs() < 0.2);
    // from (0, 0) to (1, 2) of x in 0..4, y in 0..3, the level at 1: y upwards, linear
    assert!((4.0 * (x2 - x1) / (level[2] - level[0]) - 1.0).abs() < 1e-3);
    assert!(((y1 - y2) / (y1 - level[1]) - 2.0).abs() < 1e-3 && y2 < y1);
}

/// A point beyond the curves is on the chart: with one at twice their height they are half as high.
#[test]
fn axes_cover_the_points() {
    let directory = tempfile::tempdir().unwrap();
    let piece = |chart: Chart| {
        let file = directory.path().join("chart.svg");
        chart.write(&file).unwrap();
        let [x1, y1, x2, y2] = lines(&std::fs::read_to_string(&file).unwrap(), Colour::BLUE, "3.5")[0];
        [x2 - x1, y1 - y2]
    };
    let [width, height] = piece(chart());
    let [wide, high] = piece(chart().dot(8.0, 6.0, ""));
    assert!((2.0 * wide / width - 1.0).abs() < 2e-3 && (2.0 * high / height - 1.0).abs() < 2e-3, "{wide} {high}");
}

#[test]
fn the_png_shows_the_same_as_the_svg() {
    let directory = tempfile::tempdir().unwrap();
    let file = directory.path().join("chart.png");
    chart().write(&file).unwrap();
    let decoder = png::Decoder::new(std::io::BufReader::new(std::fs::File::open(&file).unwrap()));
    let mut reader = decoder.read_info().unwrap();
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut bytes).unwrap();
    chart().write(directory.path().join("chart.svg")).unwrap();
    let svg = std::fs::read_to_string(directory.path().join("chart.svg")).unwrap();
    let [x1, y1, x2, y2] = lines(&svg, Colour::BLUE, "3.5")[0];
    let (x, y) = ((0.75 * x1 + 0.25 * x2) as usize, (0.75 * y1 + 0.25 * y2) as usize);
    let at = 3 * (y * info.width as usize + x);
    let far = bytes[at..at + 3].iter().zip(Colour::BLUE.0).map(|(a, b)| a.abs_diff(b)).max();
    assert!(far < Some(60), "{:?} at {x}, {y}", &bytes[at..at + 3]);
}

#[test]
fn charts_without_points_or_ending_are_refused() {
    let directory = tempfile::tempdir().unwrap();
    let empty = Chart::new("", "", "").curve(Curve::new("", [(f64::NAN, 0.0, true)]));
    for (chart, name) in [(empty, "chart.svg"), (chart(), "chart.txt")] {
        let refused = chart.write(directory.path().join(name));
        assert!(matches!(refused, Err(WriteError::Content { .. })), "{refused:?}");
    }
    // one point has axes too
    let one = Chart::new("", "", "").curve(Curve::new("", [(0.0, 0.0, true)]));
    one.write(directory.path().join("one.svg")).unwrap();
}

#[test]
fn names_that_need_more_than_a_row_have_two() {
    let directory = tempfile::tempdir().unwrap();
    let file = directory.path().join("chart.svg");
    let name = |k: usize| format!("controls/muscle_{k}/values/0 (1: 0.0196)");
    let chart = (0..4).fold(Chart::new("a", "x", "y"), |chart, k| {
        chart.curve(Curve::new(&name(k), [(0.0, k as f64, true), (1.0, 2.0, true)]))
    });
    chart.write(&file).unwrap();
    let svg = std::fs::read_to_string(&file).unwrap();
    let place = |k: usize, key: &str| -> f64 {
        let line = svg.lines().find(|line| line.contains(&name(k))).unwrap();
        line.split(&format!(" {key}=\"")).nth(1).unwrap().split('"').next().unwrap().parse().unwrap()
    };
    for k in 0..4 {
        // Letters of a monospaced face are 0.6 of their height wide.
        let right = place(k, "x") + 0.6 * place(k, "font-size") * name(k).len() as f64;
        assert!(right < 1600.0 && place(k, "y") < 1000.0, "{k}: {right}");
    }
    assert!(place(3, "y") > place(0, "y"));
}

/// Lines without dots lie under all else, go on in their colour without an entry, and the axes leave room for every row of names.
#[test]
fn lines_of_one_name_have_one_colour() {
    let directory = tempfile::tempdir().unwrap();
    let drawn = |names: &[&str]| {
        let line =
            |chart: Chart, name: &&str| chart.curve(Curve::line(name, 3.0, [(0.0, 0.0, true), (1.0, 1.0, true)]));
        let file = directory.path().join("chart.svg");
        names.iter().fold(Chart::new("", "x", "y"), line).write(&file).unwrap();
        std::fs::read_to_string(&file).unwrap()
    };
    let two = drawn(&["one", "", "other"]);
    assert_eq!([Colour::BLUE, Colour::ORANGE, Colour::GREEN].map(|colour| lines(&two, colour, "3.0").len()), [2, 1, 0]);
    assert!(!two.contains("<circle") && two.matches("<path").count() < drawn(&["one", "", "other"]).len());
    // twelve long names take three rows or more: the lines end higher
    let long = ["holzapfel_gasser_ogden_1"; 12];
    let bottom = |svg: &str| lines(svg, Colour::BLUE, "3.0")[0][1];
    let many = drawn(&long);
    assert!(bottom(&many) < bottom(&two) - 30.0 && many.matches("holzapfel").count() == 12, "{}", bottom(&many));
}
