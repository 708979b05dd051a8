//! Test data whose stresses are in another unit.

#![allow(clippy::unwrap_used)] // a test may

use crate::common;

use common::Heard;
use nastic_run::console::Console;
use nastic_run::run::fit;

/// Stresses in MPa that the head of the column calls Pa.
#[test]
fn test_data_in_another_unit() {
    let told = |unit: &str| {
        let directory = tempfile::tempdir().unwrap();
        let rows: String = [1.2, 1.5, 2.0f64].iter().map(|l| format!("{l},{}\n", 0.1 * (l - l.powi(-2)))).collect();
        let text = format!("stretch,nominal_stress [{unit}]\n{rows}");
        std::fs::write(directory.path().join("bar.csv"), text).unwrap();
        let data = r#"{ "nastic_fit": 1, "tests": [ { "kind": "uniaxial", "file": "bar.csv" } ], "laws": ["neo_hooke_isochoric"], "bulk": "1 GPa" }"#;
        let file = directory.path().join("data.json");
        std::fs::write(&file, data).unwrap();
        let heard = Heard::default();
        fit(&file, Some(directory.path().join("out")), &Console::new(heard.clone())).unwrap();
        let said = heard.text();
        said.lines().filter(|line| line.contains("WARNING")).map(str::to_owned).collect::<Vec<_>>()
    };
    let wrong = told("Pa");
    assert!(
        wrong.len() == 1 && wrong[0].contains("about 0.3 Pa") && wrong[0].contains("is a factor of 1e+06 missing?"),
        "{wrong:?}"
    );
    assert!(told("MPa").is_empty());
}
