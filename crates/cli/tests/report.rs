//! The page of results in a headless Chromium: it draws the body, follows slider, keys and mouse, and complains of nothing.

#![allow(clippy::unwrap_used, clippy::panic, clippy::print_stdout)] // a test may

use crate::common;

use common::browser::Browser;
use common::{CaseDirectory, code, text};
use serde_json::Value;
use std::path::{Path, PathBuf};

/// WebDriver's codes of keys.
const LEFT: char = '\u{e012}';
const HOME: char = '\u{e011}';

/// Share of the canvas that is drawn on, and a sum over its pixels that distinguishes drawings.
const PIXELS: &str = "
    const canvas = document.getElementById('canvas');
    const copy = document.createElement('canvas');
    [copy.width, copy.height] = [canvas.width, canvas.height];
    const context = copy.getContext('2d', { willReadFrequently: true });
    context.drawImage(canvas, 0, 0);
    const data = context.getImageData(0, 0, copy.width, copy.height).data;
    let drawn = 0, sum = 0;
    for (let k = 0; k < data.length; k += 4) {
        if (data[k + 3] > 0) drawn++;
        sum = (sum + (data[k] + 3 * data[k + 1] + 7 * data[k + 2] + 11 * data[k + 3]) * (k % 8191 + 1)) % 2147483647;
    }
    return [4 * drawn / data.length, sum];";

fn pixels(browser: &Browser) -> (f64, u64) {
    let found = browser.run(PIXELS);
    (found[0].as_f64().unwrap(), found[1].as_u64().unwrap())
}

/// Runs a shipped case with a few iterations; its page.
fn page(place: &CaseDirectory, arguments: &[&str]) -> PathBuf {
    let case = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/cases").join(arguments[1]);
    let out = format!("{}_{}", arguments[0], arguments[1].trim_end_matches(".json"));
    let case = case.display().to_string();
    let mut all = vec![arguments[0], &case, "--quiet", "--out", &out];
    all.extend(&arguments[2..]);
    let output = place.nastic(&all);
    assert!([0, 4].contains(&code(&output)), "{arguments:?}: {}", text(&output.stderr));
    place.path(&out).join("report.html")
}

fn slider(browser: &Browser) -> i64 {
    let value = browser.run("return Number(document.getElementById('slider').value)");
    value.as_f64().unwrap() as i64
}

#[test]
fn an_optimisation_can_be_looked_at() {
    let Some(browser) = Browser::start() else { return };
    let place = CaseDirectory::new("{}");
    let page =
        page(&place, &["optimize", "tip_tracking.json", "--set", "optimizer/max_iterations=6", "--set", "expect={}"]);
    browser.open(&page);
    assert_eq!(browser.complaints(), Vec::<String>::new());

    let (share, optimum) = pixels(&browser);
    assert!((0.05..0.9).contains(&share), "{share} of the canvas is drawn on");
    assert_eq!(slider(&browser), 6, "start, five iterations, the optimum");

    // The slider moves the body: by its keys, and by those of the canvas.
    browser.run("document.getElementById('slider').focus()");
    browser.press(LEFT);
    assert_eq!(slider(&browser), 5);
    let (_, before) = pixels(&browser);
    assert_ne!(before, optimum);
    browser.run("document.getElementById('canvas').focus()");
    browser.press(HOME);
    assert_eq!(slider(&browser), 0);
    let (_, start) = pixels(&browser);
    assert_ne!(start, before);
    let outline = browser.run("return getComputedStyle(document.activeElement).outlineStyle");
    assert_eq!(outline, "solid", "the focus is seen");

    // The mouse turns it, the button turns it back.
    let at = browser.run(
        "document.getElementById('canvas').scrollIntoView({ block: 'center' });
         const box = document.getElementById('canvas').getBoundingClientRect();
         return [Math.round(box.x + box.width / 2), Math.round(box.y + box.height / 2)];",
    );
    let at = [at[0].as_i64().unwrap(), at[1].as_i64().unwrap()];
    browser.drag(at, [at[0] + 120, at[1] + 40]);
    let (_, turned) = pixels(&browser);
    assert_ne!(turned, start);
    browser.run("document.getElementById('home').click()");
    browser.settle();
    assert_eq!(pixels(&browser).1, start);

    // What is chosen is what is shown.
    for change in [
        "const field = document.getElementById('field'); field.value = '|u|'; field.dispatchEvent(new Event('change'))",
        "document.getElementById('show-lines').click()",
        "document.getElementById('show-target').click()",
        "const cut = document.getElementById('cut'); cut.value = 'x<'; cut.dispatchEvent(new Event('input'))",
        "const at = document.getElementById('cut-at'); at.value = 0.2; at.dispatchEvent(new Event('input'))",
    ] {
        let (_, before) = pixels(&browser);
        browser.run(change);
        browser.settle();
        assert_ne!(pixels(&browser).1, before, "{change}");
    }

    let whole = pixels(&browser).0;
    browser.run("const cut = document.getElementById('cut'); cut.value = ''; cut.dispatchEvent(new Event('input'))");
    browser.settle();
    assert!(pixels(&browser).0 > 1.5 * whole, "a fifth of the body is kept, not {whole} of {}", pixels(&browser).0);
    saves_a_picture(&browser);

    // Light and dark; a narrow window needs no sideways scrolling.
    let ground = "return getComputedStyle(document.body).backgroundColor";
    let light = browser.run(ground);
    browser.run("document.getElementById('theme').click()");
    browser.settle();
    assert_ne!(browser.run(ground), light);
    browser.resize(500, 900);
    let wide = browser.run("return document.documentElement.scrollWidth - document.documentElement.clientWidth");
    assert_eq!(wide.as_f64(), Some(0.0));
    assert!(pixels(&browser).0 > 0.03);

    // Every control has a name for those who do not see it.
    let nameless = browser.run(
        "return [...document.querySelectorAll('button, input, select, canvas[tabindex]')]
            .filter((one) => !one.getAttribute('aria-label') && !one.textContent.trim() && !one.closest('label'))
            .map((one) => one.outerHTML)",
    );
    assert_eq!(nameless, Value::Array(vec![]));
    assert_eq!(browser.complaints(), Vec::<String>::new());
}

/// Shipped cases and how much of them is run here; scripts/slow.sh holds the pages of the full runs to the same size.
const CASES: [&[&str]; 9] = [
    &["solve", "arch.json", "--path"],
    &["solve", "arch.json", "--modes", "3"],
    &["solve", "reference.json"],
    &["optimize", "finger.json"],
    &["solve", "petal.json"],
    &["optimize", "robust_turgor.json"],
    &["optimize", "t_two_loads.json"],
    &["optimize", "tip_tracking.json"],
    &["solve", "finger.json"],
];

#[test]
fn every_kind_of_page_opens_without_a_network() {
    let Some(browser) = Browser::start() else { return };
    let place = CaseDirectory::new("{}");
    for arguments in CASES {
        let mut all = arguments.to_vec();
        all.extend(["--set", "expect={}"]);
        if arguments[0] == "optimize" {
            all.extend(["--set", "optimizer/max_iterations=1", "--set", "optimizer/starts=1"]);
        }
        let page = page(&place, &all);
        let size = std::fs::metadata(&page).unwrap().len();
        assert!(size < 5_000_000, "{arguments:?}: {size} bytes");
        browser.open(&page);
        assert_eq!(browser.complaints(), Vec::<String>::new(), "{arguments:?}");
        let (share, _) = pixels(&browser);
        assert!((0.002..0.95).contains(&share), "{arguments:?}: {share} of the canvas is drawn on");
        let loaded = browser.run("return performance.getEntriesByType('resource').map((one) => one.name)");
        let foreign = loaded.as_array().unwrap().iter().filter(|name| !name.as_str().unwrap().starts_with("data:"));
        assert_eq!(foreign.count(), 0, "{arguments:?}: {loaded}");
        let empty = browser.run(
            "return [...document.querySelectorAll('section, .plot, table tbody')]
                .filter((one) => !one.textContent.trim() && !one.querySelector('svg, canvas')).map((one) => one.id)",
        );
        assert_eq!(empty, Value::Array(vec![]), "{arguments:?}");
    }
}

/// The button saves a PNG on white ground, three times as fine as the view, and leaves the view as it was.
fn saves_a_picture(browser: &Browser) {
    let before = pixels(browser);
    browser.run(
        "HTMLAnchorElement.prototype.click = function () { window.saved = [this.download, this.href]; };
         document.getElementById('save').click();",
    );
    browser.settle();
    let saved = browser.run("return window.saved");
    assert!(
        saved[0].as_str().unwrap().ends_with(".png")
            && saved[1].as_str().unwrap().starts_with("data:image/png;base64,")
    );
    browser.run(
        "window.copy = new Image();
         window.copy.src = window.saved[1];",
    );
    browser.settle();
    let found = browser.run(
        "const canvas = document.createElement('canvas');
         [canvas.width, canvas.height] = [window.copy.naturalWidth, window.copy.naturalHeight];
         const context = canvas.getContext('2d');
         context.drawImage(window.copy, 0, 0);
         const data = context.getImageData(0, 0, canvas.width, canvas.height).data;
         let inked = 0;
         for (let k = 0; k < data.length; k += 4) if (data[k] < 250) inked++;
         const stage = document.getElementById('canvas').parentElement;
         return [canvas.width / stage.clientWidth, [...data.slice(0, 4)], 4 * inked / data.length];",
    );
    assert_eq!(found[0].as_f64(), Some(3.0));
    assert_eq!(found[1], serde_json::json!([255, 255, 255, 255]));
    let inked = found[2].as_f64().unwrap();
    assert!(inked > 0.5 * before.0, "{inked} of the picture, {} of the view", before.0);
    assert_eq!(pixels(browser), before);
}

#[test]
fn a_page_is_made_again_from_its_folder_and_left_out_on_demand() {
    let place = CaseDirectory::new(common::BAR);
    let output = place.nastic(&["solve", "case.json", "--out", "out", "--quiet"]);
    assert_eq!(code(&output), 0);
    let first = std::fs::read(place.path("out/report.html")).unwrap();
    let output = place.nastic(&["report", "out", "--out", "elsewhere/page.html"]);
    assert_eq!((code(&output), text(&output.stdout).trim()), (0, "elsewhere/page.html"), "{}", text(&output.stderr));
    assert!(std::fs::read(place.path("elsewhere/page.html")).unwrap() == first);
    // An old page does not stay beside new results.
    assert_eq!(code(&place.nastic(&["solve", "case.json", "--out", "out", "--quiet", "--no-report"])), 0);
    assert!(!place.path("out/report.html").exists());
    assert_eq!(code(&place.nastic(&["report", "out"])), 0);
    assert!(place.path("out/report.html").exists());
    let output = place.nastic(&["report", "nowhere"]);
    assert_eq!(code(&output), 2);
    assert!(text(&output.stderr).contains("nowhere has no result.json"), "{}", text(&output.stderr));
    std::fs::write(place.path("out/result.json"), "{").unwrap();
    let output = place.nastic(&["report", "out"]);
    assert_eq!(code(&output), 2);
    assert!(text(&output.stderr).contains("result.json: not JSON"), "{}", text(&output.stderr));
}
