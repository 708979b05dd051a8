//! The JSON Schema of results.

use crate::record::nullable::NULLABLE;
use crate::record::{
    ComparisonRecord, EigenvectorsRecord, ErrorRecord, FitRecord, RunRecord, SweepRecord, TrialRecord,
};
use schemars::SchemaGenerator;
use serde_json::Value;

impl RunRecord {
    /// The JSON Schema of results.
    #[must_use]
    pub fn schema() -> Value {
        let mut generator = SchemaGenerator::default();
        // what other files hold: history.jsonl, sweep.json, spectrum.json, fit.json, `compare --json`, errors
        generator.subschema_for::<TrialRecord>();
        generator.subschema_for::<SweepRecord>();
        generator.subschema_for::<EigenvectorsRecord>();
        generator.subschema_for::<FitRecord>();
        generator.subschema_for::<ComparisonRecord>();
        generator.subschema_for::<ErrorRecord>();
        let mut schema = generator.into_root_schema_for::<Self>().to_value();
        tidy(&mut schema);
        schema
    }
}

/// Takes away defaults, which stand for keys that are left out, and null where no value is ever that.
fn tidy(schema: &mut Value) {
    match schema {
        Value::Object(entries) => {
            let is_nullable = entries.shift_remove(NULLABLE).is_some();
            if entries.get("default").is_some_and(|default| !default.is_object() || !entries.contains_key("properties"))
            {
                entries.shift_remove("default");
            }
            if let (false, Some(Value::Array(kinds))) = (is_nullable, entries.get_mut("type")) {
                kinds.retain(|kind| kind != "null");
                if let [one] = kinds.as_slice() {
                    let one = one.clone();
                    entries.insert("type".to_owned(), one);
                }
            }
            if let (false, Some(Value::Array(choices))) = (is_nullable, entries.get_mut("anyOf")) {
                choices.retain(|choice| choice["type"] != "null");
            }
            entries.values_mut().for_each(tidy);
        }
        Value::Array(list) => list.iter_mut().for_each(tidy),
        _ => {}
    }
}
