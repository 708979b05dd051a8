//! Pictures: what hides what, which colour means what, and what is refused.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)] // clippy.toml frees test functions, not their helpers

use nastic_io::WriteError;
use nastic_mesh::{CellKind, Mesh, RawMesh, box_mesh, rectangle};
use nastic_picture::{Appearance, Body, Colour, Field, Picture, Sheet, View};

pub struct Pixels {
    width: usize,
    height: usize,
    bytes: Vec<u8>,
}

impl Pixels {
    pub fn at(&self, x: usize, y: usize) -> [u8; 3] {
        let at = 3 * (y * self.width + x);
        [self.bytes[at], self.bytes[at + 1], self.bytes[at + 2]]
    }

    /// The middle of the room for bodies when there is no colour bar.
    pub fn middle(&self) -> [u8; 3] {
        self.at(self.width / 2, (self.height as f64 * 0.485) as usize)
    }
}

/// Writes a picture and decodes it again.
pub fn pixels(picture: &Picture) -> Pixels {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("picture.png");
    picture.write(&path).unwrap();
    let decoder = png::Decoder::new(std::io::BufReader::new(std::fs::File::open(&path).unwrap()));
    let mut reader = decoder.read_info().unwrap();
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut bytes).unwrap();
    assert_eq!(info.color_type, png::ColorType::Rgb);
    Pixels { width: info.width as usize, height: info.height as usize, bytes }
}

pub fn cube(kind: CellKind) -> Mesh {
    box_mesh([1.0, 1.0, 1.0], [2, 2, 2], kind).unwrap()
}

fn moved(mesh: &Mesh, by: [f64; 3]) -> Vec<[f64; 3]> {
    mesh.points().iter().map(|p| std::array::from_fn(|i| p[i] + by[i])).collect()
}

/// A body without a legend and without element lines, so that pixels are surface.
pub fn bare(mesh: &Mesh, appearance: Appearance) -> Body {
    Body::new("", mesh.clone()).appearance(appearance).lines(false)
}

pub fn from_the_front() -> Picture {
    Picture::new("").size(400, 300).view(View::From([0.0, -1.0, 0.0]))
}

fn is_red([r, g, b]: [u8; 3]) -> bool {
    u32::from(r) > 2 * u32::from(g.max(b))
}

fn is_blue([r, g, b]: [u8; 3]) -> bool {
    b > r.saturating_add(40) && b > g
}

#[test]
fn what_is_nearer_hides_what_is_farther_whatever_the_order() {
    let mesh = cube(CellKind::Hex8);
    let near = || bare(&mesh, Appearance::Solid(Colour::RED));
    let far = || bare(&mesh, Appearance::Solid(Colour::BLUE)).at(moved(&mesh, [0.0, 2.0, 0.0]));
    assert!(is_red(pixels(&from_the_front().body(near()).body(far())).middle()));
    assert!(is_red(pixels(&from_the_front().body(far()).body(near())).middle()));
    let behind = from_the_front().view(View::From([0.0, 1.0, 0.0]));
    assert!(is_blue(pixels(&behind.body(near()).body(far())).middle()));
}

#[test]
fn a_body_hides_its_own_far_side() {
    // Two loose cubes of one body, one value each.
    let mut raw = RawMesh::new("two");
    for cube in 0..2 {
        let unit = CellKind::Hex8.reference_nodes();
        raw.points.extend(unit.iter().map(|xi| [xi[0], xi[1] + 4.0 * f64::from(cube), xi[2]]));
        raw.push(CellKind::Hex8, &std::array::from_fn::<u32, 8, _>(|node| 8 * cube + node as u32), &[]);
    }
    let mesh = Mesh::build(raw).unwrap();
    let body = || bare(&mesh, Appearance::Field(Field::at_cells("m", "", vec![1.0, -1.0])));
    for (eye, near_is_red) in [([0.0, -1.0, 0.0], true), ([0.0, 1.0, 0.0], false)] {
        let image = pixels(&from_the_front().view(View::From(eye)).body(body()));
        let pixel = image.at((27 + 400 - 75) / 2, 145);
        assert!(if near_is_red { is_red(pixel) } else { is_blue(pixel) }, "{eye:?}: {pixel:?}");
    }
}

#[test]
fn glass_tints_the_ground_but_not_the_body_behind_it() {
    let mesh = cube(CellKind::Tet10);
    let solid = |y: f64| bare(&mesh, Appearance::Solid(Colour::BLUE)).at(moved(&mesh, [0.0, y, 0.0]));
    let glass = || bare(&mesh, Appearance::Glass(Colour::RED));
    let alone = pixels(&from_the_front().body(solid(2.0))).middle();
    assert_eq!(pixels(&from_the_front().body(solid(2.0)).body(glass())).middle(), alone);
    let [r, g, b] = pixels(&from_the_front().body(glass())).middle();
    assert!(r > g.saturating_add(15) && g > 150 && b > 150, "{r} {g} {b}");
    // Wire leaves the ground between its lines as it is.
    let ground = pixels(&from_the_front().body(bare(&mesh, Appearance::Wire(Colour::RED)))).at(230, 157);
    assert!(ground.iter().all(|byte| *byte > 225), "{ground:?}");
}

#[test]
fn values_become_colours_at_their_place() {
    let mesh = cube(CellKind::Hex20);
    let values: Vec<f64> = mesh.points().iter().map(|p| 2.0 * p[0] - 1.0).collect();
    let cells = (0..mesh.cells()).map(|cell| {
        let cell = mesh.cell(cell);
        cell.nodes.iter().map(|node| values[*node as usize]).sum::<f64>() / cell.nodes.len() as f64
    });
    let cells: Vec<f64> = cells.collect();
    for field in [Field::at_nodes("m", "Pa", values.clone()), Field::at_cells("m", "Pa", cells)] {
        let image = pixels(&from_the_front().body(bare(&mesh, Appearance::Field(field))));
        // The bar takes the right; the body is centred in what is left.
        let (middle, row) = ((27 + 400 - 75) / 2, 145);
        assert!(is_blue(image.at(middle - 60, row)), "{:?}", image.at(middle - 60, row));
        let [r, _, b] = image.at(middle + 60, row);
        assert!(r > b.saturating_add(80), "{r} {b}");
    }
    let broken = Field::at_nodes("m", "Pa", vec![f64::NAN; mesh.points().len()]);
    pixels(&from_the_front().body(bare(&mesh, Appearance::Field(broken))));
}

#[test]
fn faces_of_second_order_are_curved() {
    // A strip one cell wide whose middle nodes bulge upwards: the bulge is above the straight line between corners.
    let mesh = box_mesh([2.0, 0.2, 0.2], [1, 1, 1], CellKind::Hex27).unwrap();
    let bulge = |p: &[f64; 3]| [p[0], p[1], p[2] + 0.8 * p[0] * (2.0 - p[0])];
    let body = bare(&mesh, Appearance::Solid(Colour::RED)).at(mesh.points().iter().map(bulge).collect());
    let image = pixels(&from_the_front().body(body));
    let red = |x: usize| (0..image.height - 60).find(|y| is_red(image.at(x, *y))).unwrap() as f64;
    let (left, middle, quarter) = (red(40), red(200), red(120));
    // Parabola: three quarters of the height at a quarter of the length.
    let share = (left - quarter) / (left - middle);
    assert!(left - middle > 80.0 && (share - 0.75).abs() < 0.08, "{left} {quarter} {middle}");
}

#[test]
fn plane_meshes_are_seen_from_above_in_their_true_colours() {
    for kind in [CellKind::Tri3, CellKind::Tri6, CellKind::Quad4, CellKind::Quad8, CellKind::Quad9] {
        let mesh = rectangle([2.0, 1.0], [4, 2], kind).unwrap();
        let image = pixels(&Picture::new("").size(400, 300).body(bare(&mesh, Appearance::Solid(Colour::ORANGE))));
        // Beside the line between cells, which runs through the middle.
        assert_eq!(image.at(215, 130), Colour::ORANGE.0, "{kind}");
    }
}

#[test]
fn a_subtitle_that_is_too_wide_is_broken_at_a_semicolon() {
    let body = bare(&cube(CellKind::Hex8), Appearance::Solid(Colour([200, 30, 30])));
    let ink = |subtitle: &str, rows: std::ops::Range<usize>, columns: std::ops::Range<usize>| {
        let picture = pixels(&Picture::new("").subtitle(subtitle).body(body.clone()));
        rows.flat_map(|y| columns.clone().map(move |x| (x, y))).filter(|(x, y)| picture.at(*x, *y)[0] < 150).count()
    };
    let (first, second) = (82..106, 110..134);
    let long = format!("{}; {}", "m".repeat(80), "m".repeat(80));
    assert!(ink(&long, first.clone(), 0..1600) > 0 && ink(&long, second.clone(), 0..700) > 0);
    assert_eq!(ink(&long, first, 1552..1600), 0);
    assert_eq!(ink("m; m", second, 0..700), 0);
}

#[test]
fn the_same_picture_gives_the_same_bytes() {
    let mesh = cube(CellKind::Tet4);
    let directory = tempfile::tempdir().unwrap();
    for ending in ["png", "svg"] {
        let files = ["a", "b"].map(|name| directory.path().join(name).with_extension(ending));
        for file in &files {
            let arrows = vec![[0.1, 0.0, 0.1]; mesh.cells()];
            let body = Body::new("start", mesh.clone()).arrows(Colour::RED, arrows);
            Picture::new("T <1>").subtitle("a & b").size(640, 400).length_unit("mm").body(body).write(file).unwrap();
        }
        let [a, b] = files.map(|file| std::fs::read(file).unwrap());
        assert_eq!(a, b);
        if ending == "svg" {
            let text = String::from_utf8(a).unwrap();
            assert!(text.contains("T &lt;1&gt;") && text.contains("a &amp; b") && text.contains(" mm</text>"));
            assert!(text.ends_with("</svg>\n") && text.matches("<path").count() > 50);
            assert_eq!(text.matches("<g").count(), text.matches("</g>").count());
        }
    }
}

/// A spring to the ground leads out of the body: both its ends are in the picture.
#[test]
fn lines_outside_the_body_have_room() {
    let directory = tempfile::tempdir().unwrap();
    let file = directory.path().join("a.svg");
    let mesh = rectangle([1.0, 1.0], [2, 2], CellKind::Quad4).unwrap();
    let body = Body::new("body", mesh).polyline(Colour::GREEN, vec![[1.0, 0.5, 0.0], [6.0, 0.5, 0.0]]);
    Picture::new("").size(640, 400).body(body).write(&file).unwrap();
    let svg = std::fs::read_to_string(&file).unwrap();
    let [r, g, b] = Colour::GREEN.0;
    let look = format!("stroke=\"#{r:02x}{g:02x}{b:02x}\"");
    let line = svg.lines().find(|line| line.contains("d=\"M") && line.contains(&look)).unwrap();
    let ends: Vec<f64> =
        line.split('"').nth(1).unwrap().split(['M', 'L', ' ']).filter_map(|x| x.parse().ok()).collect();
    assert!(ends.len() == 4 && ends[2] - ends[0] > 200.0, "{line}");
    assert!(ends[0] > 0.0 && ends[2] < 640.0 && ends[1].min(ends[3]) > 0.0 && ends[1].max(ends[3]) < 400.0, "{line}");
}

#[test]
fn what_cannot_be_drawn_is_refused() {
    let mesh = cube(CellKind::Hex8);
    let directory = tempfile::tempdir().unwrap();
    let refused = |picture: &Picture, file: &str, says: &str| {
        let error = picture.write(directory.path().join(file)).unwrap_err();
        assert!(matches!(error, WriteError::Content { .. }) && error.to_string().contains(says), "{error}");
    };
    let one = |body: Body| Picture::new("").body(body);
    let body = || Body::new("beam", mesh.clone());
    refused(&Picture::new(""), "a.png", "no bodies");
    refused(&one(body()), "a.jpg", ".png or .svg");
    refused(&one(body().at(vec![[0.0; 3]; 5])), "a.png", "body \"beam\" has 5 positions where 27 are needed");
    refused(&one(body().at(vec![[f64::NAN, 0.0, 0.0]; 27])), "a.svg", "not finite, at node 0");
    refused(&one(body().at(vec![[1.0; 3]; 27])), "a.svg", "no extent");
    let field = Field::at_cells("J", "", vec![1.0; 27]);
    refused(&one(body().appearance(Appearance::Field(field))), "a.png", "27 values where 8 are needed");
    refused(&one(body().arrows(Colour::RED, vec![])), "a.png", "0 arrows where 8");
    refused(&one(body()).view(View::From([0.0; 3])), "a.png", "view is zero");
    assert_eq!(std::fs::read_dir(directory.path()).unwrap().count(), 0);
}

#[test]
fn a_single_cell_far_from_the_origin_is_drawn() {
    let mut raw = RawMesh::new("one");
    raw.points = vec![[1e3, 0.0, 0.0], [1e3 + 1e-3, 0.0, 0.0], [1e3, 1e-3, 0.0], [1e3, 0.0, 1e-3]];
    raw.push(CellKind::Tet4, &[0, 1, 2, 3], &[]);
    let mesh = Mesh::build(raw).unwrap();
    let image = pixels(&Picture::new("").size(400, 300).body(bare(&mesh, Appearance::Solid(Colour::RED))));
    let red = (0..240).flat_map(|y| (0..300).map(move |x| (x, y))).filter(|(x, y)| is_red(image.at(*x, *y))).count();
    assert!(red > 2000, "{red}");
}

/// Small faces are cut into fewer pieces: a body of many cells needs no more of them than one of few.
#[test]
fn pieces_are_no_smaller_than_the_picture_shows() {
    let directory = tempfile::tempdir().unwrap();
    let pieces = |cells: usize| {
        let mesh = box_mesh([1.0, 0.25, 0.25], [4 * cells, cells, cells], CellKind::Hex20).unwrap();
        let body = Body::new("bar", mesh).appearance(Appearance::Solid(Colour::BLUE)).lines(false);
        let path = directory.path().join("bar.svg");
        Picture::new("bar").body(body).write(&path).unwrap();
        let seen = std::fs::read_to_string(path).unwrap().matches("stroke-width=\".7\"").count();
        // Faces that face the eye, of each of three sides at most.
        seen as f64 / (cells * cells) as f64
    };
    let (few, many) = (pieces(1), pieces(16));
    assert!(few >= 4.0 * many && many >= 4.0, "{few} and {many} pieces for each face of the end");
}

#[test]
fn sheets_put_pictures_side_by_side() {
    let directory = tempfile::tempdir().unwrap();
    let of = |length: f64, title: &str| {
        let mesh = box_mesh([length, 0.2, 0.2], [4, 1, 1], CellKind::Hex8).unwrap();
        Picture::new(title).body(Body::new("bar", mesh))
    };
    let size = |bytes: &[u8]| [16, 20].map(|at| u32::from_be_bytes(bytes[at..at + 4].try_into().unwrap()));
    let alone = Sheet::new(vec![of(1.0, "one")]);
    assert_eq!(alone.png().unwrap(), of(1.0, "one").png().unwrap(), "one picture is as by itself");
    for (count, expected) in [(1, [1600, 1000]), (2, [2000, 625]), (3, [2000, 1250]), (5, [3000, 1250])] {
        let sheet = Sheet::new((0..count).map(|k| of(1.0 + f64::from(k), &format!("number {k}"))).collect());
        assert_eq!(size(&sheet.png().unwrap()), expected, "{count}");
        let path = directory.path().join("sheet.svg");
        sheet.write(&path).unwrap();
        let text = std::fs::read_to_string(&path).unwrap();
        assert!((0..count).all(|k| text.contains(&format!("number {k}"))), "every title");
    }
    assert!(Sheet::new(vec![]).png().unwrap_err().to_string().contains("no pictures"));
}

#[test]
fn a_part_of_a_surface_is_drawn_from_both_sides() {
    let mesh = box_mesh([1.0, 1.0, 1.0], [2, 2, 2], CellKind::Hex8).unwrap();
    let part = |axis: usize, at: f64| -> Vec<bool> { mesh.points().iter().map(|p| p[axis] == at).collect() };
    let drawn = |marked: Vec<bool>, eye: [f64; 3]| {
        let body = Body::new("", mesh.clone()).appearance(Appearance::Solid(Colour::RED)).lines(false).part(marked);
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("part.svg");
        Picture::new("part").view(View::From(eye)).body(body).write(&path).unwrap();
        std::fs::read_to_string(path).unwrap().matches("stroke-width=\".7\"").count()
    };
    let (front, back) = (drawn(part(0, 1.0), [1.0, 0.3, 0.2]), drawn(part(0, 1.0), [-1.0, 0.3, 0.2]));
    let whole = drawn(vec![true; mesh.points().len()], [1.0, 0.3, 0.2]);
    assert!(front > 0 && front == back && whole == 6 * front, "{front}, {back} of {whole}");
    let refused = Picture::new("").body(Body::new("", mesh.clone()).part(vec![true])).png().unwrap_err().to_string();
    assert!(refused.contains("1 marks where 27"), "{refused}");
}
