//! The JSON Schema: complete, valid, and in agreement with the reader.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use nastic_language::catalogue::Catalogue;
use nastic_language::schema::{Case, json_schema};
use nastic_language::syntax::Document;
use serde_json::{Value, json};
use std::io::Write;
use std::process::{Command, Stdio};

const CASES: [&str; 3] =
    [include_str!("cases/complete.json"), include_str!("cases/magnets.json"), include_str!("cases/scenarios.json")];

fn document(text: &str) -> Document {
    Document::parse("case.json", text).unwrap()
}

#[test]
fn every_reference_is_defined_and_every_key_described() {
    let schema = json_schema(&Catalogue::standard());
    let text = schema.to_string();
    for part in text.split("#/$defs/").skip(1) {
        let name = part.split('"').next().unwrap();
        assert!(schema["$defs"][name].is_object(), "{name}");
    }
    for (name, part) in schema["$defs"].as_object().unwrap() {
        for (key, property) in part["properties"].as_object().into_iter().flatten() {
            let fixed = property.get("const").is_some();
            assert!(fixed || property["description"].as_str().is_some_and(|text| !text.is_empty()), "{name}.{key}");
        }
    }
}

#[test]
fn costs_and_phi_are_those_of_the_catalogues() {
    let schema = json_schema(&Catalogue::standard());
    let costs = schema["properties"]["costs"]["items"]["oneOf"].as_array().unwrap();
    let kind = |one: &Value| {
        // Costs without a block of their own stand in place.
        let name = one["$ref"].as_str().map(|path| path.strip_prefix("#/$defs/").unwrap());
        let one = name.map_or(one, |name| &schema["$defs"][name]);
        one["properties"]["kind"]["const"].as_str().unwrap().to_owned()
    };
    let mut kinds: Vec<String> = costs.iter().map(kind).collect();
    // Costs of a motion are not costs of a state.
    let of_motions = ["control_rate", "kinetic_energy", "actuation_work"];
    // a prior is a key of its control
    let of_states = nastic_control::COSTS.iter().map(|row| row.name).filter(|name| *name != "prior");
    let mut names: Vec<&str> = of_states.chain(of_motions).collect();
    kinds.sort_unstable();
    names.sort_unstable();
    assert_eq!(kinds, names);
    let phis = schema["$defs"]["SmoothedHausdorff"]["properties"]["phi"]["oneOf"].as_array().unwrap();
    let phis: Vec<&str> = phis.iter().map(|one| one["required"][0].as_str().unwrap()).collect();
    assert_eq!(phis, nastic_control::PHIS.iter().map(|row| row.name).collect::<Vec<_>>());
}

#[test]
fn required_keys_defaults_and_units_are_told() {
    let schema = json_schema(&Catalogue::standard());
    assert_eq!(schema["$schema"], "https://json-schema.org/draft/2020-12/schema");
    assert_eq!(schema["required"], json!(["nastic", "mesh", "materials"]));
    assert_eq!(schema["additionalProperties"], false);
    let message = |key: &str| schema["$defs"]["Control"]["properties"][key]["description"].as_str().unwrap().to_owned();
    for (key, sign) in [
        ("start", "A positive tension lengthens"),
        ("lower", "contracts below zero"),
        ("upper", "lengthens above zero"),
    ] {
        assert!(message(key).contains(sign), "{key}: {}", message(key));
    }
    let optimizer = &schema["$defs"]["Optimizer"]["properties"];
    assert_eq!(optimizer["method"]["default"], "lbfgs");
    assert_eq!(optimizer["tolerance"]["default"], 1e-4);
    assert_eq!(optimizer["max_iterations"]["default"], 100);
    let eps = &schema["$defs"]["Inverse"]["properties"]["eps"]["description"];
    assert_eq!(eps, "eps [a length (m, mm, um, cm, km), positive]");
    let laws = schema["$defs"]["Material"]["oneOf"].as_array().unwrap();
    for law in nastic_energy::catalogue::materials() {
        let forms = laws.iter().filter(|one| one["properties"]["law"]["const"] == law.name).count();
        assert_eq!(forms, law.forms.len(), "{}", law.name);
    }
}

#[test]
fn reader_and_schema_agree() {
    let mut texts: Vec<(bool, Value)> = Vec::new();
    for text in CASES {
        let case = document(text);
        Case::read(&case).unwrap_or_else(|problems| panic!("{problems}"));
        texts.push((true, case.root().to_json()));
    }
    // Other ways to write, which both must take.
    for (case, option) in [
        (0, "$schema=https://example.org/nastic.schema.json"),
        (0, "materials/0/region=[\"body\", \"tip\"]"),
        (0, "supports/0/surface=[\"clamp\", \"tip\"]"),
        (0, "loads/0/surface=[\"tip\", \"side\"]"),
        (0, "actuation/0/region=[\"body\", \"tip\"]"),
        (0, "costs/0/target_region=[\"body\", \"tip\"]"),
        (0, "units=mm"),
        (
            1,
            "materials/3={\"region\": \"skin\", \"law\": \"neo_hooke\", \"c10\": \"0.1 MPa\", \"d1\": \"0.08 / 1 MPa\"}",
        ),
        (0, "supports/0/fix=all"),
        (0, "supports/0/fix=y"),
        (0, "actuation/0/direction=-x"),
        (0, "materials/0/fiber=z"),
    ] {
        let mut other = document(CASES[case]);
        other.set(option).unwrap();
        Case::read(&other).unwrap_or_else(|problems| panic!("the reader refuses {option}: {problems}"));
        texts.push((true, other.root().to_json()));
    }
    // Mistakes of form, which both must refuse.
    for (case, option) in [
        (0, "materials/0/mu9=1"),
        (0, "materials/0/law=hooke"),
        (0, "materials/0/mu1=true"),
        (0, "optimiser={}"),
        (0, "supports/0/region=body"),
        (0, "controls/0/space=cels"),
        (0, "controls/0/uper=1"),
        (0, "costs/0/kind=hausdorff"),
        (0, "costs/0/phi=exponential"),
        (0, "costs/0/phi={}"),
        (0, "costs/0/phi/exponential/fraction=0.1"),
        (0, "costs/0/stages/0/delta=1"),
        (0, "optimizer/max_iterations=1.5"),
        (0, "optimizer/metric={\"h2\": 1}"),
        (0, "probes/0/point=[1]"),
        (0, "units/length=Pa"),
        (0, "title=5"),
        (0, "$schema=5"),
        (0, "supports/0/surface=[]"),
        (0, "supports/0/surface=[\"clamp\", \"clamp\"]"),
        (0, "materials/0/region=[5]"),
        (0, "units=Pa"),
        (1, "materials/3={\"region\": \"skin\", \"law\": \"neo_hooke\", \"c10\": 1, \"c01\": 1, \"d1\": 1}"),
        (0, "supports/0/fix=xy"),
        (0, "supports/0/fix=[\"all\"]"),
        (0, "actuation/0/direction=+w"),
        (0, "scenarios/0/set={\"mesh\": 1}"),
        (1, "actuation/0/pressure=1"),
        (1, "actuation/0/variant=f"),
        (1, "load_cases/0/nam=1"),
        (2, "mesh/file=a.msh"),
        (2, "mesh/box/element=hex9"),
        (2, "scenarios/rule=gauss"),
        (2, "scenarios/random/0/beta={\"a\": 1, \"b\": 1}"),
        (2, "risk={\"cvar\": {}}"),
    ] {
        let mut broken = document(CASES[case]);
        broken.set(option).unwrap();
        assert!(Case::read(&broken).is_err(), "the reader accepts {option}");
        texts.push((false, broken.root().to_json()));
    }
    let Some(verdicts) = validate(&texts) else {
        println!("skipped: Python with jsonschema is not installed");
        return;
    };
    for ((expected, text), verdict) in texts.iter().zip(verdicts) {
        assert_eq!(*expected, verdict, "{text}");
    }
}

const SCRIPT: &str = "
import json, sys
try:
    import jsonschema
    validator = jsonschema.Draft202012Validator
except (ImportError, AttributeError):
    sys.exit(77)
schema, cases = json.load(sys.stdin)
validator.check_schema(schema)
print(json.dumps([validator(schema).is_valid(case) for case in cases]))
";

/// What Python's jsonschema says of each text; `None` where it is not installed.
fn validate(texts: &[(bool, Value)]) -> Option<Vec<bool>> {
    let cases: Vec<&Value> = texts.iter().map(|(_, text)| text).collect();
    let input = json!([json_schema(&Catalogue::standard()), cases]).to_string();
    let mut child =
        Command::new("python3").args(["-c", SCRIPT]).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().ok()?;
    // A Python that stops early closes the pipe; its exit code shows why.
    let _ = child.stdin.take()?.write_all(input.as_bytes());
    let output = child.wait_with_output().ok()?;
    if output.status.code() == Some(77) {
        return None;
    }
    assert!(output.status.success(), "the validator failed");
    Some(serde_json::from_slice(&output.stdout).unwrap())
}
