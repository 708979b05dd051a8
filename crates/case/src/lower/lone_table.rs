//! [`LoneTable`]: a table of test data without a data file around it.

use nastic_language::syntax::{Diagnostic, Diagnostics, Document};
use serde_json::{Map, Value};
use std::path::Path;

/// What a data file would say of its one test, as texts with units.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LoneTable {
    /// How the material was deformed; `"uniaxial"` unless it is given.
    pub kind: Option<String>,
    /// The bulk modulus.
    pub bulk: Option<String>,
    /// Area at rest of the cross-section that a force acts on.
    pub area: Option<String>,
    /// Length at rest that was extended.
    pub length: Option<String>,
    /// Laws to compare; all that can be fitted without any.
    pub laws: Vec<String>,
}

impl LoneTable {
    /// A data file as it stands, or one with a table as its only test, where the file is a CSV file.
    ///
    /// # Errors
    /// A data file that cannot be read, or that has these keys of its own; a table without a bulk modulus.
    pub fn document(&self, file: &Path) -> Result<Document, Diagnostics> {
        let complain = |path: &str, message: &str| {
            let (file, path, message) = (file.display().to_string(), path.to_owned(), message.to_owned());
            Err(Diagnostic { file, path, line: 0, column: 0, message }.into())
        };
        let is_table = file.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("csv"));
        // a plain number is of square metres, or metres
        for (option, value, example) in [("area", &self.area, "12 mm^2"), ("length", &self.length, "25 mm")] {
            if let Some(value) = value.as_ref().filter(|value| is_table && value.trim().parse::<f64>().is_ok()) {
                return complain(option, &format!("--{option} {value} has no unit: write --{option} \"{example}\""));
            }
        }
        match (is_table, self.bulk.is_some()) {
            (true, true) => Ok(self.around(file)),
            (true, false) => complain(
                "bulk",
                "a table alone has no bulk modulus: give --bulk \"1 GPa\", that of solid rubber, or about 50 times the shear modulus where a body is to be \
                 solved without locking",
            ),
            (false, _) if *self == Self::default() => Document::open(file),
            (false, _) => complain(
                "",
                "--kind, --bulk, --area, --length and --laws are of CSV files: a data file has keys of these names",
            ),
        }
    }

    fn around(&self, file: &Path) -> Document {
        let name = file.file_name().unwrap_or(file.as_os_str()).to_string_lossy();
        let kind = self.kind.as_deref().unwrap_or("uniaxial");
        let mut test = Map::from_iter([("kind".to_owned(), kind.into()), ("file".to_owned(), name.as_ref().into())]);
        let mut data = Map::from_iter([("nastic_fit".to_owned(), 1.into())]);
        let put = |object: &mut Map<String, Value>, key: &str, value: &Option<String>| {
            if let Some(value) = value {
                object.insert(key.to_owned(), value.as_str().into());
            }
        };
        put(&mut test, "area", &self.area);
        put(&mut test, "length", &self.length);
        put(&mut data, "bulk", &self.bulk);
        data.insert("tests".to_owned(), vec![Value::Object(test)].into());
        if !self.laws.is_empty() {
            data.insert("laws".to_owned(), self.laws.clone().into());
        }
        Document::from_json(&file.display().to_string(), &Value::Object(data))
    }
}
