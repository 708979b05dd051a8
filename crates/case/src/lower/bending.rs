//! How much too stiff, or too soft, first-order hexahedra and quadrilaterals are in bending.

use super::elements::Elastic;
use nastic_fem::Formulation;
use nastic_mesh::Column;

/// A part of the body bends where it is so many times as long as thick.
const SLENDER: f64 = 5.0;

/// A cell in the plane in which it is stiffest.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bending {
    /// Stiffness against bending over that of the body.
    pub factor: f64,
    /// Extent of the cell along the body.
    pub length: f64,
    /// Thickness of the body there.
    pub thickness: f64,
    /// Cells over the thickness.
    pub layers: usize,
    /// Whether the shear strain contributes most of it.
    pub by_shear: bool,
}

impl Bending {
    /// Of a fully integrated first-order cell with these columns; `None` where the body is not slender in any plane.
    ///
    /// Bent with curvature k, a body of thickness T stores E' k^2 T^3 / 24 per length. The displacements that a cell of length a and
    /// thickness t can have, u = k x y and v constant, add the shear strain k x and suppress the contraction over t:
    ///
    /// `factor = 1 + G/E' (a/T)^2 + (C/E' - 1) (t/T)^2`,
    ///
    /// G/E' = 1 / (2 (1 + nu)), C/E' - 1 = nu^2 / (1 - nu^2) of a bar (the width contracts freely), G/E' = (1 - nu) / 2, C/E' - 1 =
    /// nu^2 / (1 - 2 nu) in plane strain and of a sheet, whose width may hinder it from curving across. More cells over the thickness do not help against the shear, shorter ones do.
    ///
    /// With the mean dilatation what changes over the thickness of a cell is resisted by its shape alone, which is too little: `C/E' - 1 =
    /// 1 / (2 (1 + nu)) - 1` of a bar, `2 (1 - nu) / 3 - 1` of a sheet and `(1 - nu) / 2 - 1` in plane strain, all negative.
    ///
    /// Source for one cell over the thickness: Cook, Malkus, Plesha, Witt, Concepts and Applications of Finite Element
    /// Analysis, 4th ed. (2002), section 3.6; MacNeal, Finite Elements: Their Design and Performance (1994), chapter 6.
    pub fn worst(columns: &[Column], elastic: Elastic, formulation: Formulation) -> Option<Self> {
        let nu = elastic.poisson();
        let axes = 0..columns.len();
        let planes = axes.clone().flat_map(|i| axes.clone().filter(move |&j| i != j).map(move |j| (i, j)));
        let slender = planes.filter(|&(i, j)| columns[i].length >= SLENDER * columns[j].length);
        let bent = slender.map(|(i, j)| {
            let (along, over) = (&columns[i], &columns[j]);
            let mut width = axes.clone().filter(|&k| k != i && k != j);
            let curves_across = width.any(|k| columns[k].length < SLENDER * over.length);
            let shear = if curves_across { 0.5 / (1.0 + nu) } else { 0.5 * (1.0 - nu) };
            let contraction = match (formulation, curves_across) {
                (Formulation::MeanDilatation, true) => 0.5 / (1.0 + nu) - 1.0,
                (Formulation::MeanDilatation, false) if columns.len() == 2 => 0.5 * (1.0 - nu) - 1.0,
                (Formulation::MeanDilatation, false) => 2.0 * (1.0 - nu) / 3.0 - 1.0,
                (_, true) => nu * nu / (1.0 - nu * nu),
                (_, false) => nu * nu / (1.0 - 2.0 * nu),
            };
            let square = |extent: f64| (extent / over.length).powi(2);
            let (shear, contraction) = (shear * square(along.extent), contraction * square(over.extent));
            let (factor, by_shear) = (1.0 + shear + contraction, shear >= contraction && shear + contraction > 0.0);
            Self { factor, length: along.extent, thickness: over.length, layers: over.cells, by_shear }
        });
        bent.max_by(|a, b| a.error().total_cmp(&b.error()))
    }

    /// How many times too stiff, or too soft.
    pub fn error(&self) -> f64 {
        self.factor.max(1.0 / self.factor)
    }
}
