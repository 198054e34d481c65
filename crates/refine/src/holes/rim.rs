//! Rims of holes, the surface around them, and target lengths along them.

use crate::error::HoleError;
use incise_mesh::geometry::area_vector;
use incise_mesh::{EdgeKey, HalfEdge, Surface, Topology, Vec3, VertexId};
use rustc_hash::{FxHashMap, FxHashSet};

/// Minimum target length relative to the rim's mean edge.
///
/// Without it, one tiny edge would cause a cascade of ever smaller triangles.
const MIN_SIZE: f64 = 1.0 / 8.0;

/// The rim of a hole, in the direction of its patch: edge i runs from vertex i to vertex i + 1.
#[derive(Debug, Clone)]
pub(super) struct Rim {
    pub(super) vertices: Vec<VertexId>,
    /// The surface's boundary half-edge at each edge, in the opposite direction.
    pub(super) across: Vec<HalfEdge>,
}

impl Rim {
    /// Returns the rim along a loop of boundary half-edges.
    ///
    /// # Errors
    /// [`HoleError::OpenRim`] and [`HoleError::RepeatedVertex`].
    pub(super) fn new(topology: &Topology, boundary: &[HalfEdge]) -> Result<Self, HoleError> {
        for (i, &h) in boundary.iter().enumerate() {
            let before = boundary[(i + boundary.len() - 1) % boundary.len()];
            let is_boundary =
                |h: HalfEdge| topology.is_triangle(h.triangle()) && topology.twin(h).is_null();
            if !(is_boundary(h)
                && is_boundary(before)
                && topology.target(before) == topology.origin(h))
            {
                return Err(HoleError::OpenRim { half_edge: h });
            }
        }
        let across: Vec<HalfEdge> = boundary.iter().rev().copied().collect();
        let vertices: Vec<VertexId> = across.iter().map(|&h| topology.target(h)).collect();
        let mut sorted = vertices.clone();
        sorted.sort_unstable();
        match sorted.windows(2).find(|pair| pair[0] == pair[1]) {
            Some(pair) => Err(HoleError::RepeatedVertex { vertex: pair[0] }),
            None => Ok(Self { vertices, across }),
        }
    }

    pub(super) fn len(&self) -> usize {
        self.vertices.len()
    }

    /// Returns the unit normals of the surface's triangles at the rim, zero for one without area.
    pub(super) fn normals(&self, surface: &Surface) -> Vec<Vec3> {
        let normal = |h: &HalfEdge| unit(area_vector(surface.triangle_positions(h.triangle())));
        self.across.iter().map(normal).collect()
    }

    /// Returns the mean length of the rim's edges \[m\].
    #[expect(clippy::cast_precision_loss, reason = "far fewer than 2^53 edges")]
    pub(super) fn mean_edge(&self, surface: &Surface) -> f64 {
        let length = |&h: &HalfEdge| {
            let [a, b] = [h, h.next()].map(|h| surface.position(surface.topology().origin(h)));
            (b - a).norm()
        };
        self.across.iter().map(length).sum::<f64>() / self.len().max(1) as f64
    }
}

/// Returns the unit vector along `v`; zero stays zero.
pub(super) fn unit(v: Vec3) -> Vec3 {
    // Scaled first, because squares of the smallest coordinates underflow.
    let largest = v.amax();
    if largest > 0.0 {
        (v / largest).normalize()
    } else {
        Vec3::zeros()
    }
}

/// The triangles at the vertices of rims.
#[derive(Debug)]
pub(super) struct RimNeighborhood {
    /// Number of the rim vertex in each vertex slot, else `u32::MAX`.
    number: Vec<u32>,
    /// Start of each rim vertex in `corners`, and the end of the last.
    starts: Vec<usize>,
    /// Outgoing half-edges of the rim vertices, in slot order.
    corners: Vec<HalfEdge>,
    /// Edges between rim vertices, of the surface and of finished patches.
    edges: FxHashSet<EdgeKey>,
}

impl RimNeighborhood {
    pub(super) fn new(topology: &Topology, rims: &[Rim]) -> Self {
        let mut number = vec![u32::MAX; topology.vertex_slots()];
        let mut count = 0;
        for v in rims.iter().flat_map(|rim| &rim.vertices) {
            let own = &mut number[v.index()];
            if *own == u32::MAX {
                *own = count;
                count += 1;
            }
        }
        let mut leaving: Vec<(u32, HalfEdge)> = topology
            .triangles()
            .flat_map(|t| t.half_edges())
            .map(|h| (number[topology.origin(h).index()], h))
            .filter(|&(n, _)| n != u32::MAX)
            .collect();
        leaving.sort_unstable();
        let starts = (0..=count).map(|n| leaving.partition_point(|entry| entry.0 < n));
        let mut edges = FxHashSet::default();
        for &(_, h) in &leaving {
            let ends = [topology.origin(h), topology.target(h)];
            if ends.iter().all(|v| number[v.index()] != u32::MAX) {
                edges.insert(EdgeKey::new(ends[0], ends[1]));
            }
        }
        Self {
            starts: starts.collect(),
            corners: leaving.into_iter().map(|entry| entry.1).collect(),
            number,
            edges,
        }
    }

    /// Returns the outgoing half-edges of a rim vertex.
    pub(super) fn corners(&self, v: VertexId) -> &[HalfEdge] {
        let n = self.number[v.index()] as usize;
        &self.corners[self.starts[n]..self.starts[n + 1]]
    }

    /// Returns whether the surface or a patch has an edge between two rim vertices.
    pub(super) fn has_edge(&self, a: VertexId, b: VertexId) -> bool {
        self.edges.contains(&EdgeKey::new(a, b))
    }

    /// Adds the edge of a patch.
    pub(super) fn add_edge(&mut self, a: VertexId, b: VertexId) {
        self.edges.insert(EdgeKey::new(a, b));
    }

    /// Returns whether the surface has a triangle on these three rim vertices.
    pub(super) fn has_triangle(&self, topology: &Topology, corners: [VertexId; 3]) -> bool {
        self.corners(corners[0]).iter().any(|h| {
            let t = topology.triangle(h.triangle());
            corners.iter().all(|v| t.contains(v))
        })
    }

    /// Checks that all coordinates around the rims are finite.
    ///
    /// # Errors
    /// [`HoleError::NonFinite`].
    pub(super) fn check_finite(&self, surface: &Surface) -> Result<(), HoleError> {
        for h in &self.corners {
            for vertex in surface.topology().triangle(h.triangle()) {
                let numbers = [surface.position(vertex), surface.rest_position(vertex)];
                if !numbers.iter().flatten().all(|x| x.is_finite()) {
                    return Err(HoleError::NonFinite { vertex });
                }
            }
        }
        Ok(())
    }

    /// Checks that every rim vertex has a single fan once all `rims` are filled.
    ///
    /// # Errors
    /// [`HoleError::Pinched`].
    pub(super) fn check_fans(&self, topology: &Topology, rims: &[Rim]) -> Result<(), HoleError> {
        // The next boundary half-edge along the same rim.
        let mut following = FxHashMap::default();
        for rim in rims {
            let pairs = rim.across.iter().zip(rim.across.iter().cycle().skip(1));
            following.extend(pairs.map(|(&h, &before)| (before, h)));
        }
        for (rim, &start) in rims
            .iter()
            .flat_map(|rim| rim.across.iter().map(move |h| (rim, h)))
        {
            debug_assert!(rim.len() > 1, "a closed chain");
            let vertex = topology.origin(start);
            let (mut at, mut seen) = (start, 0);
            let closed = loop {
                seen += 1;
                let twin = topology.twin(at.prev());
                if !twin.is_null() {
                    at = twin;
                    continue;
                }
                match following.get(&at.prev()) {
                    Some(&next) if next != start => at = next,
                    next => break next.is_some(),
                }
            };
            if closed && seen != self.corners(vertex).len() {
                return Err(HoleError::Pinched { vertex });
            }
        }
        Ok(())
    }

    /// Returns the target length at each vertex of a rim \[m\].
    ///
    /// It is the mean length of the surface's edges there, Liepa's scale, times `z`.
    pub(super) fn sizes(&self, surface: &Surface, rim: &Rim, z: f64) -> Vec<f64> {
        let least = MIN_SIZE * rim.mean_edge(surface);
        let size = |&v: &VertexId| z * self.mean_edge(surface, v).max(least);
        rim.vertices.iter().map(size).collect()
    }

    /// Returns the mean length of the surface's edges at a rim vertex \[m\].
    fn mean_edge(&self, surface: &Surface, v: VertexId) -> f64 {
        let topology = surface.topology();
        let (mut sum, mut count) = (0.0, 0.0);
        for &h in self.corners(v) {
            let last = topology
                .twin(h.prev())
                .is_null()
                .then(|| topology.origin(h.prev()));
            for other in [Some(topology.target(h)), last].into_iter().flatten() {
                sum += (surface.position(other) - surface.position(v)).norm();
                count += 1.0;
            }
        }
        sum / f64::max(count, 1.0)
    }
}
