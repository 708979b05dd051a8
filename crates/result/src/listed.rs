//! What earlier runs in a directory say that they wrote there.

use nastic_case::output_names::SWEEP;
use serde_json::Value;
use std::path::Path;

/// The files that earlier runs in a directory list as their results, these lists included.
pub fn listed(directory: &Path) -> Vec<String> {
    let mut all = Vec::new();
    for list in ["result.json", "fit.json", "sweep.json"] {
        let text = std::fs::read_to_string(directory.join(list)).unwrap_or_default();
        let earlier: Value = serde_json::from_str(&text).unwrap_or_default();
        let names = |files: &Value| {
            files.as_array().into_iter().flatten().filter_map(Value::as_str).map(str::to_owned).collect()
        };
        // somebody's own file of that name has none of this
        let of_nastic: Option<Vec<String>> = match list {
            "result.json" => earlier["versions"]["nastic"].is_string().then(|| names(&earlier["files"])),
            "fit.json" => earlier["version"].is_string().then(|| names(&earlier["files"])),
            _ => earlier["planned"].is_number().then(|| SWEEP.iter().map(|name| (*name).to_owned()).collect()),
        };
        all.extend(of_nastic.into_iter().flat_map(|files| files.into_iter().chain([list.to_owned()])));
    }
    all
}
