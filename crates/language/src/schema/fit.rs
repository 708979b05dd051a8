//! Data files of `nastic fit`: what was measured, and which laws to fit.

use crate::quantity::Want;
use crate::schema::case::Case;
use crate::schema::json::Definitions;
use crate::schema::optimizer::MOST_STARTS;
use crate::schema::read::{Read, Reader};
use crate::syntax::{At, Diagnostics, Document, Node};
use nastic_fit::{Errors, Fibers, Law};
use serde_json::{Value as Json, json};

object! {
    /// Tests of a material, and the laws to fit to them.
    pub struct FitData checked by check_data {
        /// Version of the format: 1.
        pub nastic_fit: u64,
        /// For people.
        pub title: Option<String>,
        /// What was measured; at least one test that is not volumetric.
        pub tests: Vec<FitTest>,
        /// Laws to compare: names of the catalogue, Ogden's with its number of terms, as "ogden_3", Holzapfel's with its families of fibres, a network with its layers and units; all that can
        /// be fitted if left out, those with fibres where the tests show how they lay.
        pub laws: Vec<FitLaw> = vec![],
        /// The bulk modulus, where no volumetric test gives it.
        pub bulk: Option<f64> as POSITIVE_PRESSURE,
        /// What residuals are measured in: "absolute" stresses, or shares of the measured ones ("relative").
        pub errors: FitErrors = FitErrors::Absolute,
        /// Random starts of Ogden's law and of networks.
        pub starts: usize = 16,
        /// Of the random starts.
        pub seed: u64 = 1,
        /// Up to which stretch the stability of the fitted laws is examined (and down to its inverse); a quarter more than the largest one measured if
        /// left out.
        pub stable_to: Option<f64> as POSITIVE,
        /// Region of the `materials` block to paste.
        pub region: String = "body".to_owned(),
        /// For editors; not looked at.
        pub schema("$schema"): Option<String>,
    }
}

object! {
    /// One test: a CSV file with a line of column names and units.
    pub struct FitTest checked by check_test {
        /// How the material was deformed.
        pub kind: FitKind,
        /// CSV file, relative to this one.
        pub file: String,
        /// Name in results; that of the file if left out.
        pub name: Option<String>,
        /// Weight of each of its squared residuals.
        pub weight: f64 as POSITIVE = 1.0,
        /// Whether it takes no part in the fit, which is then judged by it.
        pub held_out: bool = false,
        /// Of a specimen with fibres: whether it was loaded along or across them.
        pub fibers: Option<FitFibers>,
        /// Of a table with a column "force": the area at rest of the cross-section that it acts on.
        pub area: Option<f64> as POSITIVE_AREA,
        /// Of a table with a column "extension": the length at rest that was extended.
        pub length: Option<f64> as POSITIVE_LENGTH,
        /// Of "inflation": thickness over radius of the balloon at rest.
        pub thickness_to_radius: Option<f64> as POSITIVE,
    }
}

choice! {
    /// A homogeneous deformation.
    pub enum FitKind {
        /// Tension or compression of a bar: stretch against stress.
        "uniaxial" => Uniaxial,
        /// Equal stretches in two directions.
        "equibiaxial" => Equibiaxial,
        /// A wide strip, "pure shear".
        "planar" => Planar,
        /// Amount of shear against shear stress.
        "simple_shear" => SimpleShear,
        /// A thin spherical balloon: stretch against pressure.
        "inflation" => Inflation,
        /// Ratio of volumes against pressure.
        "volumetric" => Volumetric,
    }
}

choice! {
    /// How a specimen lay to its fibres.
    pub enum FitFibers {
        /// Loaded along them: along one family, along the bisector of two.
        "along" => Along,
        /// Loaded across, in their plane.
        "across" => Across,
    }
}

choice! {
    /// What residuals are measured in.
    pub enum FitErrors {
        /// Pa: large stresses count most.
        "absolute" => Absolute,
        /// Shares of the measured value, or of a twentieth of the test's largest where that is more.
        "relative" => Relative,
    }
}

/// A law by its name, Ogden's with the number of terms.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct FitLaw(pub Law);

impl FitErrors {
    /// The same for the fit.
    #[must_use]
    pub fn errors(&self) -> Errors {
        match self {
            Self::Absolute => Errors::Absolute,
            Self::Relative => Errors::Relative,
        }
    }
}

impl FitFibers {
    /// The same for the fit.
    #[must_use]
    pub fn fibers(&self) -> Fibers {
        match self {
            Self::Along => Fibers::Along,
            Self::Across => Fibers::Across,
        }
    }
}

impl Read for FitLaw {
    fn read(node: &Node, at: &At, _: Want, reader: &mut Reader<'_>) -> Option<Self> {
        let laws = Law::among(reader.document.catalogue().materials().iter().copied());
        let labels: Vec<String> = laws.iter().map(|law| law.label()).collect();
        let names: Vec<&str> = labels.iter().map(String::as_str).collect();
        let found = reader.word(node, at, "law", &names)?;
        laws.into_iter().find(|law| law.label() == found).map(FitLaw)
    }

    fn schema(_: Want, definitions: &mut Definitions) -> Json {
        let laws = Law::among(definitions.catalogue.materials().iter().copied());
        json!({ "enum": laws.into_iter().map(Law::label).collect::<Vec<_>>() })
    }
}

fn check_data(data: &FitData, reader: &mut Reader<'_>) {
    if data.nastic_fit != 1 {
        reader.complain_at(&data.at.key("nastic_fit"), "the version of the format is 1");
    }
    if data.starts > MOST_STARTS {
        reader.complain_at(&data.at.key("starts"), format!("{} starts; at most {MOST_STARTS}", data.starts));
    }
    let volumetric = data.tests.iter().filter(|test| test.kind == FitKind::Volumetric).count();
    if volumetric < data.tests.len() && data.tests.iter().all(|test| test.held_out || test.kind == FitKind::Volumetric)
    {
        reader.complain_at(&data.at.key("tests"), "all tests are \"held_out\": at least one is to be fitted");
    }
    if volumetric == data.tests.len() {
        reader.complain_at(
            &data.at.key("tests"),
            "a test that is not \"volumetric\" is wanted: volumetric ones give the bulk modulus alone",
        );
    }
    match (volumetric > 0, data.bulk.is_some()) {
        (false, false) => reader.complain_at(
            &data.at,
            "missing key \"bulk\", and there is no volumetric test: the bulk modulus is wanted, as \"1 GPa\" of solid rubber, or 50 times the \
             shear modulus where a body is to be solved without locking",
        ),
        (true, true) => {
            reader.complain_at(&data.at.key("bulk"), "the volumetric tests give the bulk modulus: leave out one of both");
        }
        _ => {}
    }
    let shaped = || data.tests.iter().enumerate().filter(|(_, test)| test.kind != FitKind::Volumetric);
    let with_fibers = data.laws.iter().find(|law| law.0.has_fibers());
    if with_fibers.is_some() || shaped().any(|(_, test)| test.fibers.is_some()) {
        for (k, test) in shaped().filter(|(_, test)| test.fibers.is_none()) {
            let why = match with_fibers {
                Some(law) => format!("{} has fibres", law.0.label()),
                None => "another test has it".to_owned(),
            };
            let message = match test.kind {
                FitKind::Inflation => {
                    format!("{why}, but a balloon with fibres does not stay a sphere: leave the test out")
                }
                _ => format!("missing key \"fibers\", \"along\" or \"across\": {why}"),
            };
            reader.complain_at(&data.at.key("tests").index(k), &message);
        }
    }
    if data.stable_to.is_some_and(|to| to <= 1.0) {
        reader.complain_at(&data.at.key("stable_to"), "a stretch above 1 is wanted");
    }
}

fn check_test(test: &FitTest, reader: &mut Reader<'_>) {
    if test.fibers.is_some() && matches!(test.kind, FitKind::Inflation | FitKind::Volumetric) {
        reader.complain_at(&test.at.key("fibers"), "a test of this kind takes no \"fibers\": a balloon with fibres does not stay a sphere, and volumetric tests give the bulk modulus alone");
    }
    if test.held_out && test.kind == FitKind::Volumetric {
        reader.complain_at(
            &test.at.key("held_out"),
            "a volumetric test gives the bulk modulus: leave it out, or the key",
        );
    }
    if (test.kind == FitKind::Inflation) != test.thickness_to_radius.is_some() {
        let message = match test.kind {
            FitKind::Inflation => "missing key \"thickness_to_radius\": thickness over radius of the balloon at rest",
            _ => "only a test of kind \"inflation\" has a \"thickness_to_radius\"",
        };
        reader.complain_at(&test.at, message);
    }
}

impl FitData {
    /// The laws that are compared where none are named, of those that can be fitted.
    #[must_use]
    pub fn all_laws(&self, laws: Vec<Law>) -> Vec<Law> {
        let fibers = self.tests.iter().any(|test| test.fibers.is_some());
        laws.into_iter().filter(|law| !law.is_named_only() && (fibers || !law.has_fibers())).collect()
    }

    /// Reads a data file.
    ///
    /// # Errors
    /// All problems of the file at once.
    pub fn read_document(document: &Document) -> Result<Self, Diagnostics> {
        let mut reader = Case::reader(document, crate::quantity::Units::default());
        reader.problems.extend(document.problems().iter().cloned());
        let data = <Self as Read>::read(document.root(), &At::root(), Want::ANY, &mut reader);
        Diagnostics::new(reader.problems).into_result()?;
        data.ok_or_else(Diagnostics::default)
    }
}
