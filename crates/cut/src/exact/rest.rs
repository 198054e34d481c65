//! Rest positions inside the body: of caps and walls, the same for both sides, and of tips.
//!
//! The rim at rest need not be planar. A harmonic function extends its rest positions into the cap.
//! Linear interpolation over the rim's triangulation would leave creases in the rest shape, which
//! bending constraints would keep.

use super::open::Sides;
use super::rim::Rim;
use crate::affine::AffineMap;
use incise_mesh::geometry::{round_to_f32, to_f32};
use incise_mesh::{Edit, Surface, Vec3, VertexId, VertexOrigin};
use incise_refine::{HarmonicScratch, Section, SectionMesh, interpolate_harmonic};

/// Rounding error of stored positions of a planar rim [of the largest coordinate].
const ROUNDING: f64 = 8.0 * f32::EPSILON as f64;

/// Rest positions of the points of a section mesh.
#[derive(Debug, Clone, Default)]
pub(super) struct CapRest {
    rim: Vec<[f64; 3]>,
    inner: Vec<[f32; 3]>,
    /// By coordinate, whether rest positions are their parents' mean.
    is_mean: [bool; 3],
    scratch: HarmonicScratch,
}

impl CapRest {
    /// Interpolates the rest positions of the inner points.
    ///
    /// The section's points are `vertices` on one side; those on the other have equal rest
    /// positions.
    pub(super) fn find(
        &mut self,
        surface: &Surface,
        vertices: impl Iterator<Item = VertexId>,
        mesh: &SectionMesh,
        section: &Section<'_>,
    ) {
        self.rim.clear();
        self.inner.clear();
        let mut largest = 0.0_f64;
        for v in vertices {
            let (rest, position) = (surface.rest_position(v), surface.position(v));
            largest = largest.max(rest.amax()).max(position.amax());
            self.rim.push(rest.into());
        }
        let rounding = ROUNDING * largest;
        let found = interpolate_harmonic(mesh, section, &self.rim, rounding, &mut self.scratch);
        self.is_mean = [true; 3];
        if let Some(found) = found {
            self.is_mean = found.is_affine;
            (self.inner).extend(found.values.iter().map(|&rest| to_f32(rest.into())));
        }
    }

    /// Returns the rest position of an inner point, given the mean of its parents' rest positions.
    ///
    /// It is the mean in every coordinate in which the rim at rest is affine in the plane.
    pub(super) fn position(&self, inner: usize, mean: [f32; 3]) -> [f32; 3] {
        let found = self.inner.get(inner).copied().unwrap_or(mean);
        [0, 1, 2].map(|k| if self.is_mean[k] { mean[k] } else { found[k] })
    }
}

/// Adds a vertex with the mean rest position and inverse mass of its parents, or at rest if its
/// parents are.
///
/// `rest_from_mean` may replace the mean. In a body at rest, rounding would otherwise give the
/// vertex two positions, and the vertices of coincident walls different ones.
pub(super) fn add_vertex_between(
    edit: &mut Edit<'_>,
    position: Vec3,
    origin: VertexOrigin,
    rest_from_mean: impl FnOnce([f32; 3]) -> [f32; 3],
) -> VertexId {
    let surface = edit.surface();
    let [x, y, z, w] = origin.interpolate(|v| {
        let [x, y, z] = surface.rest_positions()[v.index()];
        [x, y, z, surface.positions()[v.index()][3]]
    });
    let is_at_rest = |v: VertexId| surface.position(v) == surface.rest_position(v);
    let place = to_f32(position);
    let rest = if origin.weights().iter().all(|&(v, _)| is_at_rest(v)) {
        place
    } else {
        rest_from_mean(to_f32([x, y, z].into()))
    };
    let [x, y, z] = place;
    edit.add_vertex([x, y, z, round_to_f32(w)], rest, origin)
}

/// Fits the map from positions to rest positions around `curves`: their vertices and neighbors.
pub(super) fn fit_rest(
    surface: &Surface,
    rim: &Rim,
    sides: &Sides,
    curves: impl Iterator<Item = u32>,
) -> AffineMap {
    let topology = surface.topology();
    let mut curves: Vec<u32> = curves.collect();
    curves.sort_unstable();
    curves.dedup();
    let mut pairs = Vec::new();
    for node in curves.into_iter().flat_map(|i| rim.ring(i as usize)) {
        for side in 0..2 {
            let v = sides.vertices[node as usize][side];
            let targets = rim
                .fan(topology, sides, node, side)
                .map(|h| topology.target(h));
            let near = [v].into_iter().chain(targets);
            pairs.extend(near.map(|v| (surface.position(v), surface.rest_position(v))));
        }
    }
    AffineMap::fit(&pairs)
}
