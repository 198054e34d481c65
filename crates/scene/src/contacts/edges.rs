//! [`SharpEdge`]: an edge whose contacts with others the vertices of both would miss.
//!
//! [`super::edge_pairs`] tests the pairs of near ones. On smooth surfaces vertices and triangles
//! suffice; only convex edges whose normals have a cosine of at most [`MAX_COSINE`] are tested.

use incise_mesh::{Aabb, HalfEdge, Surface, Vec3, VertexId};

/// Maximum cosine between the normals beside a sharp edge: 30 degrees.
const MAX_COSINE: f64 = 0.87;

/// Maximum sine by which a direction may leave the normal cone of an edge.
const CONE_TOLERANCE: f64 = 0.2;

/// Minimum fraction of an edge between a contact and an end.
const END: f64 = 1e-3;

/// Minimum squared sine between two edges.
const MIN_SQUARED_SINE: f64 = 1e-3;

/// The distance between the lines of two edges.
#[derive(Debug, Clone, Copy)]
pub(super) struct EdgeDistance {
    /// Unit normal towards the first edge.
    pub(super) normal: Vec3,
    /// Distance along the normal \[m\].
    pub(super) distance: f64,
    /// The nearest points [fractions of the edges].
    pub(super) fractions: [f64; 2],
    /// Whether the nearest points of the lines are inside of both edges.
    pub(super) is_crossing: bool,
}

/// A convex edge between two triangles.
#[derive(Debug, Clone, Copy)]
pub(super) struct SharpEdge {
    pub(super) half_edge: HalfEdge,
    pub(super) ends: [VertexId; 2],
    at: [Vec3; 2],
    /// Unit vectors within both triangles, away from the edge.
    inward: [Vec3; 2],
}

impl SharpEdge {
    /// Returns the edge of a half-edge, if it is the first one of a sharp edge.
    pub(super) fn new(surface: &Surface, h: HalfEdge) -> Option<Self> {
        let topology = surface.topology();
        let twin = topology.twin(h);
        if twin.is_null() || twin.index() < h.index() {
            return None;
        }
        let ends = [topology.origin(h), topology.target(h)];
        let at = ends.map(|v| surface.position(v));
        let along = at[1] - at[0];
        let into = [h, twin].map(|h| surface.position(topology.origin(h.prev())) - at[0]);
        if is_smooth([along.cross(&into[0]), into[1].cross(&along)]) {
            return None;
        }
        let along = along.try_normalize(0.0)?;
        let mut inward = [Vec3::zeros(); 2];
        for (inward, into) in inward.iter_mut().zip(into) {
            *inward = (into - along * into.dot(&along)).try_normalize(0.0)?;
        }
        // The normals of both triangles; they turn around the edge.
        let normals = [along.cross(&inward[0]), inward[1].cross(&along)];
        let is_convex = normals[0].dot(&inward[1]) < 0.0;
        let is_sharp = normals[0].dot(&normals[1]) <= MAX_COSINE;
        (is_convex && is_sharp).then_some(Self {
            half_edge: h,
            ends,
            at,
            inward,
        })
    }

    /// Returns the length \[m\].
    pub(super) fn length(&self) -> f64 {
        (self.at[1] - self.at[0]).norm()
    }

    /// Returns a box around the edge.
    pub(super) fn bounds(surface: &Surface, h: HalfEdge) -> Aabb {
        let topology = surface.topology();
        let mut bounds = Aabb::default();
        for v in [topology.origin(h), topology.target(h)] {
            for k in 0..3 {
                let c = surface.positions()[v.index()][k];
                bounds.min[k] = bounds.min[k].min(c);
                bounds.max[k] = bounds.max[k].max(c);
            }
        }
        bounds
    }

    /// Returns the distance from another edge, on the side of the `known` normal.
    ///
    /// Without a known normal the side is that of the other edge's surface. `None` unless the
    /// nearest points of both lines are within a `slide` of them \[m\] and face each other.
    pub(super) fn distance(
        &self,
        other: &Self,
        known: Option<Vec3>,
        slide: f64,
    ) -> Option<EdgeDistance> {
        let [a, b] = [self, other].map(|edge| edge.at[1] - edge.at[0]);
        let between = self.at[0] - other.at[0];
        let across = a.cross(&b);
        let square = across.norm_squared();
        if square <= MIN_SQUARED_SINE * a.norm_squared() * b.norm_squared() {
            return None;
        }
        let (aa, bb, ab) = (a.dot(&a), b.dot(&b), a.dot(&b));
        let (first, second) = (a.dot(&between), b.dot(&between));
        let s = (ab * second - first * bb) / square;
        let t = (aa * second - ab * first) / square;
        // At an end the contacts of its vertex act.
        let is_crossing = [s, t].iter().all(|c| (END..1.0 - END).contains(c));
        let is_beyond = |c: f64, square: f64| f64::max(-c, c - 1.0) * square.sqrt() > slide;
        if !is_crossing && (is_beyond(s, aa) || is_beyond(t, bb)) {
            return None;
        }
        let known = known.filter(|_| is_crossing);
        let outward = known.unwrap_or_else(|| -(other.inward[0] + other.inward[1]));
        let normal = across * (across.dot(&outward).signum() / square.sqrt());
        let faces = |edge: &Self, normal: Vec3| {
            let mut inward = edge.inward.iter();
            inward.all(|inward| inward.dot(&normal) <= CONE_TOLERANCE)
        };
        (faces(other, normal) && faces(self, -normal)).then(|| EdgeDistance {
            normal,
            distance: normal.dot(&between),
            fractions: [s, t],
            is_crossing,
        })
    }
}

/// Returns whether two area normals have more than [`MAX_COSINE`], beyond rounding.
///
/// Most edges of a surface are smooth, and need neither roots nor divisions.
fn is_smooth([a, b]: [Vec3; 2]) -> bool {
    let product = a.dot(&b);
    let limit = MAX_COSINE.powi(2) * (1.0 + 1e-9);
    product > 0.0 && product.powi(2) > limit * a.norm_squared() * b.norm_squared()
}

/// A sharp edge that may touch others within the frame.
#[derive(Debug, Clone, Copy)]
pub(super) struct MovingEdge {
    /// Index of its body in the scene.
    pub(super) body: u32,
    /// Index of its piece in the broad phase.
    pub(super) piece: u32,
    pub(super) edge: SharpEdge,
    /// Minimum distance of other surfaces from its piece \[m\].
    pub(super) thickness: f64,
    /// Distance within which it searches others \[m\].
    pub(super) reach: f64,
    /// Box around the edge, grown by `reach`.
    pub(super) bounds: Aabb,
}

impl MovingEdge {
    /// Returns its body and half-edge, which identify it.
    pub(super) fn key(&self) -> (u32, HalfEdge) {
        (self.body, self.edge.half_edge)
    }
}
