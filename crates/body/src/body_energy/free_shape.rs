//! [`FreeShape`]: which part of a body's skin moves with its shape, and what stays.

use nastic_mesh::GroupNames;

/// The shape of the drawn body by the places of the nodes of its skin: the nodes of named surfaces move along the outward normal N of the drawn body, those inside follow,
///
/// ```text
/// a - R^2 laplace_S a = p  on the skin,    s = a N there,    laplace s_i = 0  inside,    s = 0  where the drawn body stays
/// ```
///
/// with one unknown p (m) a node of the skin, outwards positive; R the length of the Helmholtz filter of the surface S (natural at its edges, a = 0 where it meets what stays), without which
/// an optimiser finds shapes that depend on the mesh. The laws see `G = 1 + grad s`.
///
/// It stays, s_i = 0, where supports hold that component, where something measures from the drawn body (springs, foundations, elastic tendons, chambers of a given volume), on surfaces of
/// [`keep`](Self::keep()), and where cells outside of its regions begin. Surfaces that are neither in the skin nor kept follow, as the inside does.
///
/// **Why so.** Displacements of all nodes, filtered in the volume, would drag the other side of a wall along that is thinner than R, and tell little of where a node is; tangential
/// ones change no shape to first order, and only distort cells. One number a node of the skin is a tenth of that, s follows from it by two sparse factors, made once, and by the maximum principle
/// no node moves further than the largest a.
///
/// **Source.** T. Etling, R. Herzog, E. Loayza, G. Wachsmuth, SIAM J. Sci. Comput. 42 (2020) A1200, doi 10.1137/19M1254198 (deformations by their normal part on the skin);
/// M. Hojjat, E. Stavropoulou, K.-U. Bletzinger, Comput. Methods Appl. Mech. Eng. 268 (2014) 494-513, doi 10.1016/j.cma.2013.10.015 (nodes of a skin behind a filter).
#[derive(Debug, Clone, PartialEq)]
pub struct FreeShape {
    /// The name of the control.
    pub name: String,
    /// The surfaces that move.
    pub skin: GroupNames,
    /// The length R of the filter.
    pub filter: f64,
    /// The regions whose nodes may move.
    pub regions: GroupNames,
    /// Surfaces that stay as they are drawn.
    pub keep: Option<GroupNames>,
    /// Bound of det G, [`ShapeModes::LEAST_VOLUME`](nastic_energy::ShapeModes::LEAST_VOLUME) if `None`.
    pub least_volume: Option<f64>,
}

impl FreeShape {
    /// Its kind in case files.
    pub const KIND: &str = "free_shape";

    /// Of regions, by the normal displacement of surfaces, filtered over the length R.
    pub fn of(name: &str, regions: impl Into<GroupNames>, skin: impl Into<GroupNames>, filter: f64) -> Self {
        let (name, regions, skin) = (name.to_owned(), regions.into(), skin.into());
        FreeShape { name, skin, filter, regions, keep: None, least_volume: None }
    }

    /// With surfaces that stay as they are drawn: those of dead tractions are among them, whose force is that of the drawn area.
    #[must_use]
    pub fn keep(mut self, surfaces: impl Into<GroupNames>) -> Self {
        self.keep = Some(surfaces.into());
        self
    }

    /// With a bound of det G, from 0 to below 1.
    #[must_use]
    pub fn least_volume(mut self, least: f64) -> Self {
        self.least_volume = Some(least);
        self
    }
}
