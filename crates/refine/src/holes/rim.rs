//! Rims, and what the surface looks like around them.

use super::HoleError;
use incise_mesh::geometry::area_vector;
use incise_mesh::{EdgeKey, HalfEdge, Surface, Topology, Vec3, VertexId};
use rustc_hash::{FxHashMap, FxHashSet};

/// Edges along a rim shorter than this part of its mean do not make triangles smaller: a rim with one
/// tiny edge would get a cascade of ever smaller ones.
const SHORTEST: f64 = 1.0 / 8.0;

/// A hole's rim in the direction of the patch: its edge i runs from vertex i to vertex i + 1.
#[derive(Debug, Clone)]
pub(super) struct Rim {
    pub(super) vertices: Vec<VertexId>,
    /// The surface's half-edge across each edge.
    pub(super) across: Vec<HalfEdge>,
}

impl Rim {
    /// The rim along a loop of boundary half-edges.
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

    /// Unit normals of the triangles across, zero of one without area.
    pub(super) fn normals(&self, surface: &Surface) -> Vec<Vec3> {
        let normal = |h: &HalfEdge| unit(area_vector(surface.triangle_positions(h.triangle())));
        self.across.iter().map(normal).collect()
    }

    /// The mean length of the rim's edges \[m\].
    #[expect(clippy::cast_precision_loss, reason = "far fewer than 2^53 edges")]
    pub(super) fn mean_edge(&self, surface: &Surface) -> f64 {
        let length = |&h: &HalfEdge| {
            let [a, b] = [h, h.next()].map(|h| surface.position(surface.topology().origin(h)));
            (b - a).norm()
        };
        self.across.iter().map(length).sum::<f64>() / self.len().max(1) as f64
    }
}

/// The vector of length 1 along `v`; zero stays zero.
pub(super) fn unit(v: Vec3) -> Vec3 {
    // Scaled first: squares of the smallest coordinates are no longer numbers of 64 bits.
    let largest = v.amax();
    if largest > 0.0 {
        (v / largest).normalize()
    } else {
        Vec3::zeros()
    }
}

/// The triangles at the vertices of rims.
#[derive(Debug)]
pub(super) struct Surroundings {
    /// By vertex slot the number of a rim vertex, else `u32::MAX`.
    number: Vec<u32>,
    starts: Vec<usize>,
    /// Half-edges that leave the rim vertices, vertex after vertex, in slot order.
    corners: Vec<HalfEdge>,
    /// Edges between rim vertices, those of patches too once they are there.
    joined: FxHashSet<EdgeKey>,
}

impl Surroundings {
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
        let mut joined = FxHashSet::default();
        for &(_, h) in &leaving {
            let ends = [topology.origin(h), topology.target(h)];
            if ends.iter().all(|v| number[v.index()] != u32::MAX) {
                joined.insert(EdgeKey::new(ends[0], ends[1]));
            }
        }
        Self {
            starts: starts.collect(),
            corners: leaving.into_iter().map(|entry| entry.1).collect(),
            number,
            joined,
        }
    }

    /// The half-edges that leave a rim vertex.
    pub(super) fn corners(&self, v: VertexId) -> &[HalfEdge] {
        let n = self.number[v.index()] as usize;
        &self.corners[self.starts[n]..self.starts[n + 1]]
    }

    /// Whether the surface or a patch has an edge between two rim vertices.
    pub(super) fn are_joined(&self, a: VertexId, b: VertexId) -> bool {
        self.joined.contains(&EdgeKey::new(a, b))
    }

    /// Notes the edge of a patch.
    pub(super) fn join(&mut self, a: VertexId, b: VertexId) {
        self.joined.insert(EdgeKey::new(a, b));
    }

    /// Whether the surface has a triangle on these three rim vertices.
    pub(super) fn has_triangle(&self, topology: &Topology, corners: [VertexId; 3]) -> bool {
        self.corners(corners[0]).iter().any(|h| {
            let t = topology.triangle(h.triangle());
            corners.iter().all(|v| t.contains(v))
        })
    }

    /// Looks for coordinates that are not finite.
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

    /// Looks for vertices around which patches on all `rims` would leave more than one fan.
    ///
    /// # Errors
    /// [`HoleError::Pinched`].
    pub(super) fn check_fans(&self, topology: &Topology, rims: &[Rim]) -> Result<(), HoleError> {
        // Of every boundary half-edge the one that leaves its target along the same rim.
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

    /// How long edges are to be at each vertex of a rim \[m\]: the mean length of the surface's edges
    /// there times `z`, the scale of Liepa's refinement.
    pub(super) fn sizes(&self, surface: &Surface, rim: &Rim, z: f64) -> Vec<f64> {
        let least = SHORTEST * rim.mean_edge(surface);
        let size = |&v: &VertexId| z * self.mean_edge(surface, v).max(least);
        rim.vertices.iter().map(size).collect()
    }

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
