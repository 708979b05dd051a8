//! Figures for print: what they show, and what is refused.

#![allow(clippy::unwrap_used)] // a test may

use crate::common;

use common::{BAR, CaseDirectory, code, text};
use std::path::Path;

fn shipped(name: &str) -> String {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/cases").join(name).display().to_string()
}

/// The figure as SVG.
fn figure(place: &CaseDirectory, arguments: &[&str]) -> String {
    let output = place.nastic(&[&["figure", "out", "--out", "figures/a.svg"], arguments].concat());
    assert_eq!((code(&output), text(&output.stdout).trim()), (0, "figures/a.svg"), "{}", text(&output.stderr));
    std::fs::read_to_string(place.path("figures/a.svg")).unwrap()
}

fn refusal(place: &CaseDirectory, arguments: &[&str]) -> String {
    let output = place.nastic(&[&["figure", "out"], arguments].concat());
    assert_eq!(code(&output), 2, "{arguments:?}");
    assert!(!place.path("out/figure.png").exists());
    text(&output.stderr)
}

#[test]
fn a_figure_shows_a_state_and_nothing_of_the_run() {
    let place = CaseDirectory::new(BAR);
    assert_eq!(code(&place.nastic(&["solve", "case.json", "--out", "out", "--quiet"])), 0);
    let svg = figure(&place, &[]);
    assert!(svg.contains("tension [kPa]") && svg.contains(">equilibrium</text>"), "{svg}");
    assert!(figure(&place, &["--field", "|u|"]).contains("displacement |u| ["));
    assert!(svg.contains("stop-color=\"#ffffff\""));
    assert!(figure(&place, &["--field", "none"]) != svg && !figure(&place, &["--field", "none"]).contains("tension"));
    let along = figure(&place, &["--field", "displacement.x", "--range", "-1e-3,2e-3"]);
    assert!(along.contains(">-1</text>") && along.contains("displacement x [mm]"), "{along}");
    for (field, label) in [
        ("nodal_mises", "von Mises stress ["),
        ("cauchy_stress.xx", "Cauchy stress xx ["),
        ("|reaction|", "|force of the supports| ["),
        ("green_strain.xz", "Green-Lagrange strain xz<"),
        ("nodal_cauchy_stress.zz", "Cauchy stress zz ["),
    ] {
        assert!(figure(&place, &["--field", field]).contains(label), "{field}");
    }
    assert!(figure(&place, &["--field", "cauchy_stress.xx", "--size", "800x500"]).contains("viewBox=\"0 0 800 500\""));
    let kept = figure(&place, &["--clip", "x<0.05", "--view", "0,-1,0"]);
    assert!(kept != figure(&place, &["--clip", "x>0.05", "--view", "0,-1,0"]));
    assert_eq!(kept, figure(&place, &["--clip", "2,0,0<0.1", "--view", "0,-1,0"]));
    assert!(refusal(&place, &["--state", "optimum"]).contains("there is no state \"optimum\"; there is: start"));
    assert!(refusal(&place, &["--field", "presure"]).contains("there is: |u|, none, |displacement| displacement.x .."));
    assert!(refusal(&place, &["--path", "tip"]).contains("this run wrote no motion.csv"));
    assert!(refusal(&place, &["--clip", "x=3"]).contains("a plane is what is kept"));
    for (plane, keeps) in [("x<1", "all"), ("x>1", "nothing"), ("0,0,2<-1", "nothing")] {
        let error = refusal(&place, &["--clip", plane]);
        assert!(error.contains(&format!("this plane leaves {keeps} of the body")), "{error}");
    }
    assert!(refusal(&place, &["--range", "5,1"]).contains("the first end is the lower one: 1,5"));
    assert!(refusal(&place, &["--size", "3x3"]).contains("320x200"));
    assert!(refusal(&place, &["--range", "3"]).contains("2 numbers"));
    let output = place.nastic(&["figure", "out", "--out", "a.jpg"]);
    assert!(text(&output.stderr).contains(".png or .svg"), "{}", text(&output.stderr));
}

#[test]
fn runs_draw_their_figure_on_demand() {
    let place = CaseDirectory::new(BAR);
    assert_eq!(code(&place.nastic(&["solve", "case.json", "--out", "out", "--quiet", "--figure"])), 0);
    let result = std::fs::read_to_string(place.path("out/result.json")).unwrap();
    for file in ["figure.png", "figure.svg"] {
        let own = std::fs::read(place.path("out").join(file)).unwrap();
        let again = place.path("again").join(file);
        assert_eq!(code(&place.nastic(&["figure", "out", "--out", &again.display().to_string()])), 0);
        assert!(own == std::fs::read(again).unwrap() && result.contains(&format!("\"{file}\"")), "{file}");
    }
    // those of an earlier run do not stay beside new results
    assert_eq!(code(&place.nastic(&["solve", "case.json", "--out", "out", "--quiet"])), 0);
    assert!(!place.path("out/figure.svg").exists());
}

#[test]
fn chambers_have_the_colour_of_their_pressure() {
    let place = CaseDirectory::new("{}");
    let case = shipped("pneunet.json");
    assert_eq!(code(&place.nastic(&["solve", &case, "--out", "out", "--quiet", "--set", "expect={}"])), 0);
    let svg = figure(&place, &[]);
    assert!(svg.contains("pressure [kPa]"), "no pressure");
    // the only chamber: its walls have the colour of the bar's upper end, lit
    assert!(svg.contains(">0</text>") && !svg.contains("displacement"));
    assert!(figure(&place, &["--field", "mises", "--behind", ""]).contains("von Mises"));
    assert!(!figure(&place, &["--behind", ""]).contains(">target</text>") && svg.contains(">target</text>"));
    // a chamber of a list of surfaces is drawn like one of a name
    let listed = r#"actuation/0/surface=["chamber"]"#;
    let again = ["solve", &case, "--out", "out", "--quiet", "--set", "expect={}", "--set", listed];
    let again = place.nastic(&again);
    assert_eq!(code(&again), 0, "{}", text(&again.stderr));
    assert_eq!(figure(&place, &[]), svg);
}

#[test]
fn kept_iterations_are_states() {
    let place = CaseDirectory::new(BAR);
    let run = ["optimize", "case.json", "--out", "out", "--quiet", "--set", "output/every=1", "--set", "expect={}"];
    assert!([0, 4].contains(&code(&place.nastic(&run))));
    assert!(place.path("out/iteration_0001.vtu").exists());
    assert!(figure(&place, &["--state", "iteration_0001"]).contains(">iteration 0001</text>"));
    assert!(refusal(&place, &["--state", "iteration_9999"]).contains("iteration_0001"));
}

#[test]
fn motions_have_instants_and_paths() {
    let place = CaseDirectory::new("{}");
    let case = shipped("flick.json");
    let solved = place.nastic(&["solve", &case, "--out", "out", "--quiet", "--set", "expect={}"]);
    assert_eq!(code(&solved), 0, "{}", text(&solved.stderr));
    let svg = figure(&place, &["--path", "tip"]);
    // the glass is the first instant; start.vtu, the end of the motion, is not called a start
    assert!(svg.contains(">path of tip</text>") && svg.contains(">t = 0 s</text>") && !svg.contains(">start</text>"));
    let end = figure(&place, &["--state", "start"]);
    assert!(end.contains(">end of the motion</text>") && !end.contains(">equilibrium</text>"), "{end}");
    let first = figure(&place, &["--state", "motion_0001.vtu", "--behind", "motion_0000,target"]);
    assert!(first.contains(">t = 0 s</text>") && first.contains(">t = 0.01 s</text>"), "{first}");
    assert!(refusal(&place, &["--path", "top"]).contains("there is no probe \"top\"; there is: tip"));
}

/// Pixels of a PNG, three bytes each, with its width and height.
fn pixels(file: &Path) -> (Vec<u8>, usize, usize) {
    let file = std::io::BufReader::new(std::fs::File::open(file).unwrap());
    let mut reader = png::Decoder::new(file).read_info().unwrap();
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut bytes).unwrap();
    (bytes, info.width as usize, info.height as usize)
}

/// The part of pixels within columns and rows.
fn part((bytes, width, _): &(Vec<u8>, usize, usize), columns: [usize; 2], rows: [usize; 2]) -> Vec<u8> {
    let row = |y: usize| bytes[3 * (y * width + columns[0])..3 * (y * width + columns[1])].to_vec();
    (rows[0]..rows[1]).flat_map(row).collect()
}

/// The clamp does not move: where it is drawn, the scale of lengths, the axes and the colour bar are the same in every frame, the tip is not.
#[test]
fn frames_of_a_motion_share_view_and_range() {
    let place = CaseDirectory::new("{}");
    let case = shipped("flick.json");
    let solved = place.nastic(&["solve", &case, "--out", "out", "--quiet", "--set", "expect={}"]);
    assert_eq!(code(&solved), 0, "{}", text(&solved.stderr));
    let asked = ["figure", "out", "--frames", "--field", "mises", "--size", "800x500", "--fps", "20"];
    let drawn = place.nastic(&asked);
    assert_eq!(code(&drawn), 0, "{}", text(&drawn.stderr));
    assert_eq!(text(&drawn.stdout).trim(), "out/frames.gif");
    let frame = |k: usize| place.path("out").join(format!("frame_{k:04}.png"));
    let states = (0..).take_while(|k| place.path(&format!("out/motion_{k:04}.vtu")).exists()).count();
    assert!(states > 3 && frame(states - 1).exists() && !frame(states).exists());
    let all: Vec<_> = (0..states).map(|k| pixels(&frame(k))).collect();
    let [width, height] = [800, 500];
    assert!(all.iter().all(|(_, w, h)| [*w, *h] == [width, height]));
    // the bar with its numbers, and the axes: the right margin; the ruler: left of the axes, below the body
    let margins = |image: &_| {
        let (bar, ruler) = (part(image, [690, width], [0, height]), part(image, [550, 690], [440, height]));
        [bar, ruler].concat()
    };
    assert!(margins(&all[0]).iter().any(|byte| *byte < 128), "something stands there");
    for (k, image) in all.iter().enumerate().skip(1) {
        assert!(margins(image) == margins(&all[0]), "the margins of frame {k}");
        assert!(image.0 != all[0].0, "frame {k} shows another state");
    }
    // as an animated picture
    let mut options = gif::DecodeOptions::new();
    options.set_color_output(gif::ColorOutput::Indexed);
    let file = std::fs::File::open(place.path("out/frames.gif")).unwrap();
    let mut decoder = options.read_info(file).unwrap();
    let mut frames = 0;
    while let Some(frame) = decoder.read_next_frame().unwrap() {
        assert_eq!((frame.width, frame.height, frame.delay), (800, 500, 5));
        frames += 1;
    }
    assert_eq!((frames, decoder.repeat()), (states, gif::Repeat::Infinite));
    // a plane cuts some state; the state at rest has a velocity as the others
    for (more, refused) in [(["--clip", "x<9000"], true), (["--field", "|velocity|"], false)] {
        let found = place.nastic(&[&asked[..3], &more, &["--size", "320x200", "--out", "others"]].concat());
        assert_eq!(code(&found) != 0, refused, "{more:?}: {}", text(&found.stderr));
    }
    // again with the same bytes, fewer states leave no frame of more, and what is not nastic's stays
    let first = std::fs::read(place.path("out/frames.gif")).unwrap();
    assert_eq!(code(&place.nastic(&asked)), 0);
    assert!(std::fs::read(place.path("out/frames.gif")).unwrap() == first);
    std::fs::create_dir(place.path("mine")).unwrap();
    std::fs::write(place.path("mine/frame_0001.png"), "mine").unwrap();
    let refused = place.nastic(&[&asked[..], &["--out", "mine"]].concat());
    assert_eq!(code(&refused), 2, "{}", text(&refused.stderr));
    assert_eq!(std::fs::read_to_string(place.path("mine/frame_0001.png")).unwrap(), "mine");
    let none = refusal(&place, &["--frames", "--state", "ramp"]);
    assert!(none.contains("there is no series of states \"ramp\"; there is: motion"), "{none}");
}

/// The numbers of a column of `motion.csv`.
fn column(place: &CaseDirectory, name: &str) -> Vec<f64> {
    let text = std::fs::read_to_string(place.path("out/motion.csv")).unwrap();
    let mut lines = text.lines();
    let k = lines.next().unwrap().split(',').position(|own| own == name).unwrap();
    lines.map(|line| line.split(',').nth(k).unwrap().parse().unwrap()).collect()
}

/// Dashes: lines in the colour of ink.
fn dashes(svg: &str) -> usize {
    svg.matches("stroke=\"#262b33\" stroke-width=\"3.5\"").count()
}

#[test]
fn targets_that_move_are_dashed_beside_what_follows_them() {
    let place = CaseDirectory::new("{}");
    let case = shipped("arm.json");
    let solved = place.nastic(&["solve", &case, "--out", "out", "--quiet", "--figure", "--set", "expect={}"]);
    assert_eq!(code(&solved), 0, "{}", text(&solved.stderr));
    // the circle of the case, and the end face, where tensions alike leave it in the middle
    let (t, target) = (column(&place, "t"), column(&place, "circle.target.y"));
    let circle = |t: f64| 8.0 + 25.0 * (t / 0.2).min(1.0) * (2.0 * std::f64::consts::PI * t).cos();
    assert!(t.len() == 25 && t.iter().zip(&target).all(|(t, y)| (y - circle(*t)).abs() < 1e-12), "{target:?}");
    let [y, z] = ["y", "z"].map(|axis| column(&place, &format!("circle.position.{axis}")));
    assert!((y[0] - 8.0).abs() < 1e-9 && y.iter().chain(&z).all(|x| (x - 8.0).abs() < 1.0), "{y:?} {z:?}");
    let end: Vec<f64> =
        column(&place, "circle.position.x").iter().zip(column(&place, "tip.x")).map(|(x, u)| x - 150.0 - u).collect();
    assert!(end.iter().all(|gap| gap.abs() < 0.3), "{end:?}"); // the face is not plane

    let usual = std::fs::read_to_string(place.path("out/figure.svg")).unwrap();
    for label in ["path of circle", "target path"] {
        assert!(usual.contains(&format!(">{label}</text>")), "{label}");
    }
    let with_tip = figure(&place, &["--path", "tip", "--behind", "motion_0004,target"]);
    assert!(with_tip.contains(">path of tip</text>") && with_tip.contains(">target path</text>"));
    let without = figure(&place, &["--path", "tip", "--behind", "motion_0004"]);
    assert!(!without.contains("target path") && dashes(&without) == 0 && dashes(&with_tip) > 20);
    // a place that stays where it should be has no path
    let still = ["solve", &case, "--out", "out", "--quiet", "--set", "expect={}", "--set", "costs/0/target={\"y\": 8}"];
    assert_eq!(code(&place.nastic(&still)), 0);
    let drawn = figure(&place, &[]);
    assert!(!drawn.contains("path of") && !drawn.contains("target path"));
    assert!(figure(&place, &["--path", "circle"]).contains(">path of circle</text>"));
    assert!(refusal(&place, &["--path", "top"]).contains("there is no probe \"top\"; there is: tip, circle"));
}

/// Ramps have pressures of chambers. A run that fails says why, not that there is nothing to draw.
#[test]
fn runs_without_a_usual_figure_end_as_they_would() {
    let place = CaseDirectory::new("{}");
    let case = shipped("pneunet.json");
    let run = ["solve", &case, "--out", "out", "--quiet", "--set", "expect={}", "--figure"];
    let ramp = place.nastic(&[&run[..], &["--ramp", "air.volume=0:1e-7 m^3:2"]].concat());
    assert_eq!(code(&ramp), 0, "{}", text(&ramp.stderr));
    let last = figure(&place, &[]);
    assert!(last.contains(">air.volume = 1e-7 m^3</text>") || last.contains(">air.volume = 100 mm^3</text>"), "{last}");
    let svg = std::fs::read_to_string(place.path("out/figure.svg")).unwrap();
    assert!(svg.contains(">pressure [") && !svg.contains("displacement"), "{svg}");
    let place = CaseDirectory::new(BAR);
    let wild = ["solve", "case.json", "--out", "out", "--quiet", "--figure", "--set", "controls/0/start=1e9"];
    let failed = place.nastic(&[&wild[..], &["--set", "controls/0/upper=1e10"]].concat());
    assert_eq!(code(&failed), 3, "{}", text(&failed.stderr));
    assert!(!place.path("out/figure.svg").exists() && !text(&failed.stderr).contains("there is no state"));
}
