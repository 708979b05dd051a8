//! A fit as a page: laws in their order, parameters with intervals, what to paste, the drawings.

use crate::html::{folded, paragraph, section, table, tiles};
use crate::number::{number, short};
use crate::plain_page::{drawing, plain_page};
use crate::record::{EstimateRecord, FitRecord, FittedLawRecord};

impl FitRecord {
    /// The page; `drawings` are SVG files.
    #[must_use]
    pub fn page(&self, drawings: &[String]) -> String {
        let title = self.title.as_ref().map_or("Laws for test data", String::as_str);
        let drawn: String = drawings.iter().map(|svg| drawing(svg)).collect();
        let laws: String = self.laws.iter().map(law).collect();
        let body = [
            section("found", "Best law", &self.found()),
            section("data", "Readings (points) and laws (curves)", &drawn),
            section("laws", "All laws, the best first", &self.order()),
            section("parameters", "Parameters", &laws),
            section("tests", "Tests", &self.tests()),
        ];
        plain_page(title, &format!("nastic {} fit", self.version), &body.concat())
    }

    fn found(&self) -> String {
        let Some(best) = self.laws.first() else { return String::new() };
        let scatter = (number(best.scatter, ""), best.scatter_unit.clone());
        let all = [
            ("law".to_owned(), best.law.clone(), format!("{} parameters", best.parameters.iter().flatten().count())),
            ("scatter of the residuals".to_owned(), scatter.0, scatter.1),
            ("points".to_owned(), best.points.to_string(), format!("of {} tests", self.tests.len())),
        ];
        let block = serde_json::to_string_pretty(&best.materials).unwrap_or_default();
        let paste = format!("<pre>{}</pre>\n", crate::html::escape(&format!("\"materials\": {block}")));
        tiles(&all) + &folded("The block of materials to paste into a case", &paste)
    }

    fn order(&self) -> String {
        let row = |one: &FittedLawRecord| {
            vec![
                one.law.clone(),
                one.parameters.iter().flatten().count().to_string(),
                format!("{} {}", number(one.scatter, ""), one.scatter_unit),
                number(one.aicc, ""),
                number(one.aicc_above_best, ""),
                number(one.bic, ""),
                format!("{} of {}", one.starts.alike, one.starts.tried),
            ]
        };
        let head = ["law", "parameters", "scatter", "AICc", "above best", "BIC", "starts that led here"];
        let tests: Vec<&str> =
            self.tests.iter().filter(|test| test.kind != "volumetric").map(|test| test.name.as_str()).collect();
        let met = |one: &FittedLawRecord| {
            let shares = one.r_squared.iter().flatten();
            std::iter::once(one.law.clone()).chain(shares.map(|(_, share)| number(*share, ""))).collect()
        };
        let met =
            table(&[&["R^2"], tests.as_slice()].concat(), &self.laws.iter().map(met).collect::<Vec<Vec<String>>>());
        let failed: String =
            self.failed.iter().map(|one| paragraph(&format!("{} could not be fitted: {}", one.law, one.why))).collect();
        table(&head, &self.laws.iter().map(row).collect::<Vec<_>>())
            + &met
            + &paragraph("AICc is Akaike's criterion, corrected for few points: 10 more than the best are decisive.")
            + &failed
    }

    fn tests(&self) -> String {
        let row = |one: &crate::record::TestRecord| {
            let fibers = one.fibers.as_ref().map_or("-", String::as_str).to_owned();
            let points = one.points.to_string();
            let fitted =
                if one.held_out { "held out".to_owned() } else { format!("weight {}", number(one.weight, "")) };
            vec![one.name.clone(), one.kind.clone(), one.response.clone(), fibers, points, fitted]
        };
        let head = ["test", "kind", "measured", "fibres", "points", "in the fit"];
        table(&head, &self.tests.iter().map(row).collect::<Vec<_>>())
    }
}

/// The parameters of a law and where it is stable.
fn law(one: &FittedLawRecord) -> String {
    let unit = |unit: &str| if unit == "1" { String::new() } else { unit.to_owned() };
    let row = |(name, estimate): (&String, &EstimateRecord)| {
        let interval = estimate
            .interval
            .as_ref()
            .map_or("not determined".to_owned(), |[low, high]| format!("{} to {}", short(*low), short(*high)));
        vec![name.clone(), number(estimate.value, ""), interval, unit(&estimate.unit)]
    };
    let parameters: Vec<Vec<String>> = one.parameters.iter().flatten().map(row).collect();
    let stable = |(kind, range): (&String, &crate::record::StableRangeRecord)| {
        let within = if range.within_data { "an end lies within the data" } else { "" };
        vec![kind.clone(), number(range.from, ""), number(range.to, ""), within.to_owned()]
    };
    let ranges: Vec<Vec<String>> = one.stable.iter().flatten().map(stable).collect();
    let content = table(&["parameter", "value", "interval of 95 %", "unit"], &parameters)
        + &table(&["stable (Drucker) in tests", "from stretch", "to", ""], &ranges);
    folded(&one.law, &content)
}
