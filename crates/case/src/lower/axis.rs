//! [`Axis`]: where the values of a swept option stand in a plot.

use crate::lower::Swept;
use nastic_language::expression::Formula;
use nastic_language::quantity::Units;

/// Where the values of an option stand.
pub struct Axis {
    /// What the axis is called.
    pub label: String,
    /// A place for every value.
    pub places: Vec<f64>,
    /// Whether the places are numbers of the values, and these their names.
    pub is_named: bool,
}

impl Axis {
    /// Numbers with one unit as they were typed, other quantities in SI; anything else side by side.
    pub fn of(option: &Swept) -> Self {
        let parts: Option<Vec<(f64, &str)>> = option.values.iter().map(|text| split(text)).collect();
        if let Some(parts) = parts
            && parts.iter().all(|(_, unit)| *unit == parts[0].1)
        {
            let label =
                if parts[0].1.is_empty() { option.label.clone() } else { format!("{} ({})", option.label, parts[0].1) };
            return Self { label, places: parts.into_iter().map(|(number, _)| number).collect(), is_named: false };
        }
        let in_si = |text: &String| Formula::parse(text.trim_matches('"'), &Units::default()).ok()?.constant();
        if let Some(places) = option.values.iter().map(in_si).collect::<Option<Vec<f64>>>() {
            return Self { label: format!("{} (SI)", option.label), places, is_named: false };
        }
        let places = (0..option.values.len()).map(|k| k as f64).collect();
        Self { label: option.label.clone(), places, is_named: true }
    }

    /// Whether the places are in the order of the values.
    fn ascends(&self) -> bool {
        self.places.windows(2).all(|pair| pair[0] < pair[1])
    }
}

/// A number and the unit behind it.
fn split(text: &str) -> Option<(f64, &str)> {
    let text = text.trim().trim_matches('"');
    let unit = text.find(|c: char| c.is_whitespace()).unwrap_or(text.len());
    let number: f64 = text[..unit].parse().ok()?;
    number.is_finite().then_some((number, text[unit..].trim()))
}

/// The times of runs in a collection: the values of the one swept option where they ascend, else the index of the run.
pub fn sweep_times(options: &[Swept], runs: usize) -> Vec<f64> {
    let swept: Vec<&Swept> = options.iter().filter(|one| one.is_swept()).collect();
    match swept.as_slice() {
        [one] if Axis::of(one).ascends() => Axis::of(one).places,
        _ => (0..runs).map(|k| k as f64).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_stand_where_their_units_put_them() {
        let axis = |text: &str| Axis::of(&Swept::read(&[format!("a/young={text}")]).unwrap()[0]);
        let same = axis("90 kPa,110 kPa");
        assert_eq!((same.label.as_str(), same.places.as_slice()), ("young (kPa)", [90.0, 110.0].as_slice()));
        let other = axis("90 kPa,0.2 MPa,0.1 MPa");
        assert_eq!((other.label.as_str(), other.places.as_slice()), ("young (SI)", [9e4, 2e5, 1e5].as_slice()));
        let names = axis("lbfgs,spectral");
        assert!(names.is_named && names.places == [0.0, 1.0]);
        assert_eq!(axis("[1,0,0],[0,1,0]").places, [0.0, 1.0]);
        assert!(!other.ascends() && same.ascends());
    }
}
