//! Folds of the skin beside a cut.

use incise_cut::{CutOutcome, CutParams};
use incise_mesh::geometry::area_vector;
use incise_mesh::{HalfEdge, Surface, TopologyDelta, Vec3, VertexId};
use std::collections::{BTreeMap, BTreeSet};

/// Asserts that a cut has folded the skin nowhere, in the present shape and at rest.
///
/// A cut that snaps a vertex may do so, a known fault: see `a_snapped_vertex_folds_the_skin` in the
/// tests of `incise-cut`.
///
/// # Panics
/// If it has.
pub fn assert_no_fold_added(
    before: &Surface,
    after: &Surface,
    params: &CutParams,
    outcome: &CutOutcome,
) {
    if outcome.report.snapped_vertices > 0 {
        return;
    }
    let [present, rest] = added_folds(before, after, &outcome.delta, params.cap_material);
    assert!(
        present.is_empty() && rest.is_empty(),
        "the cut folds the skin at {present:?} in the present shape, at {rest:?} at rest"
    );
}

/// Returns the edges at which a cut has folded the skin flat: in the present shape, then at rest.
///
/// Parts of edges whose triangles faced away from each other before the cut are left out, and of
/// edges of a triangle without area. So are walls and caps, which meet in folds at tips.
fn added_folds(
    before: &Surface,
    after: &Surface,
    delta: &TopologyDelta,
    cap_material: u32,
) -> [Vec<HalfEdge>; 2] {
    let supports = supports(delta);
    let topology = after.topology();
    let is_skin = |h: HalfEdge| after.material(h.triangle()) != cap_material;
    let is_added = |h: HalfEdge, at: &dyn Fn(VertexId) -> Vec3| {
        let ends = [topology.origin(h), topology.target(h)];
        let support = ends.into_iter().flat_map(|v| support(&supports, v));
        is_skin(h) && is_skin(topology.twin(h)) && !was_sharp(before, &support.collect(), at)
    };
    let is_added_now = |&h: &HalfEdge| is_added(h, &|v| before.position(v));
    let is_added_at_rest = |&h: &HalfEdge| is_added(h, &|v| before.rest_position(v));
    [
        after.folds().filter(is_added_now).collect(),
        after.rest_folds().filter(is_added_at_rest).collect(),
    ]
}

/// Returns, for each new vertex, the vertices from before the cut between which it lies.
fn supports(delta: &TopologyDelta) -> BTreeMap<VertexId, BTreeSet<VertexId>> {
    let mut supports = BTreeMap::new();
    for added in &delta.vertices_added {
        let parents = added.origin.weights().into_iter();
        let parents = parents.filter(|(_, weight)| *weight > 0.0);
        let own = parents.flat_map(|(v, _)| support(&supports, v)).collect();
        supports.insert(added.vertex, own);
    }
    supports
}

/// Returns the support of a vertex; a vertex from before the cut is its own.
fn support(supports: &BTreeMap<VertexId, BTreeSet<VertexId>>, v: VertexId) -> BTreeSet<VertexId> {
    supports
        .get(&v)
        .cloned()
        .unwrap_or_else(|| BTreeSet::from([v]))
}

/// Returns whether a support is an edge whose triangles faced away from each other, or nowhere.
fn was_sharp(
    before: &Surface,
    support: &BTreeSet<VertexId>,
    at: &dyn Fn(VertexId) -> Vec3,
) -> bool {
    let topology = before.topology();
    let normal = |h: HalfEdge| area_vector([h, h.next(), h.prev()].map(|h| at(topology.origin(h))));
    // Over all edges, since a vertex may have several fans.
    topology.edges().any(|h| {
        let twin = topology.twin(h);
        if twin.is_null() || BTreeSet::from([topology.origin(h), topology.target(h)]) != *support {
            return false;
        }
        let normals = [h, twin].map(normal);
        normals[0].dot(&normals[1]) < 0.0 || normals.contains(&Vec3::zeros())
    })
}
