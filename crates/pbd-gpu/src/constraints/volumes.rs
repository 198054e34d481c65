//! Volume constraints: one per closed piece that encloses a volume at rest.
//!
//! A cut gives each half the volume that it has at rest. A constraint stores only the list of the
//! vertices of its piece; kernels visit the triangles around each of them by its half-edges.

#[cfg(feature = "serde")]
mod load;

use incise_mesh::geometry::{Vec3, area_vector};
use incise_mesh::{HalfEdge, Surface, Topology, VertexId, index_u32};
use std::f64::consts::PI;

/// Maximum displacement of a vertex per projection, unless gravity moves it further in a substep,
/// relative to the rest thickness `3 |V| / A`.
///
/// The thickness is the radius of a ball, or 3/2 of that of a plate. Without a limit the gradient
/// of a nearly collapsed piece would throw its vertices away.
pub(crate) const REACH: f32 = 0.25;

/// Volume relative to the largest piece, below which a piece is a sliver that may be crushed.
const SLIVER: f32 = 1e-3;

/// Volume relative to a ball of the same area, below which it is a rounding error of a flat piece.
const FLAT: f64 = 1e-6;

/// Volume relative to the area and the largest coordinate, below which rounding of positions to 32
/// bits changes it by 6 % and more.
const UNRESOLVED: f64 = 1e-6;

/// A vertex of a closed piece, with the first half-edge of the traversal around it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct RingVertex {
    pub(crate) vertex: VertexId,
    /// An outgoing half-edge.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(crate) outgoing: HalfEdge,
    /// Range in the list of rings.
    #[cfg_attr(feature = "serde", serde(skip))]
    ring: [u32; 2],
}

impl RingVertex {
    /// Creates a spoke whose ring is not known yet.
    fn new(vertex: VertexId, outgoing: HalfEdge) -> Self {
        let ring = [0; 2];
        Self {
            vertex,
            outgoing,
            ring,
        }
    }

    /// Returns the neighbors of the vertex in order, and the first one again, of all `rings`.
    #[inline(always)]
    pub(crate) fn ring<'a>(&self, rings: &'a [VertexId]) -> &'a [VertexId] {
        let [first, end] = self.ring.map(|i| i as usize);
        &rings[first..end]
    }
}

/// The volume constraint of a piece: its rest volume times the pressure of the material.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct PieceVolume {
    pub(crate) piece: u32,
    pub(crate) rest: f32,
    /// Maximum displacement of a vertex per projection, unless gravity moves it further \[m\].
    pub(crate) reach: f32,
    /// Range in the list of spokes.
    pub(crate) first: usize,
    pub(crate) end: usize,
}

impl PieceVolume {
    /// Returns the number of the piece.
    #[must_use]
    pub fn piece(&self) -> u32 {
        self.piece
    }

    /// Returns the rest volume [m^3], negative for a cavity, whose normals point inward.
    #[must_use]
    pub fn rest(&self) -> f32 {
        self.rest
    }

    /// Returns the number of vertices of the piece.
    #[must_use]
    pub fn vertices(&self) -> usize {
        self.end - self.first
    }
}

/// Sums over the triangles and vertices of a piece.
#[derive(Debug, Clone, Copy, Default)]
struct Tally {
    /// Apex of the cones that are summed up \[m\].
    apex: Option<Vec3>,
    /// Rest volume [m^3].
    volume: f64,
    /// Rest area [m^2].
    area: f64,
    /// Largest coordinate at rest \[m\].
    extent: f64,
    /// Half-edges of its triangles minus those in the fans of its vertices; 0 unless two fans share
    /// a vertex.
    untraversed: i64,
    is_open: bool,
    /// Number of vertices; later the index of the next one in the list of spokes.
    vertices: usize,
    has_volume: bool,
}

/// The volume constraints of a body, by piece.
#[derive(Debug, Clone, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct VolumeSet {
    pub(crate) pieces: Vec<PieceVolume>,
    /// Ordered by piece, then by vertex.
    pub(crate) spokes: Vec<RingVertex>,
    /// Rings of the spokes, one after another. Traversals in every projection would take longer.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(crate) rings: Vec<VertexId>,
    /// Multipliers of the substep, shape \[pieces\].
    pub(crate) lambda: Vec<f32>,
    /// Mean displacements in the last round of the substep \[m\], shape \[pieces\].
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(crate) displacements: Vec<[f32; 3]>,
    #[cfg_attr(feature = "serde", serde(skip))]
    generation: u64,
    #[cfg_attr(feature = "serde", serde(skip))]
    tallies: Vec<Tally>,
}

impl VolumeSet {
    /// Returns the constraints, in order of pieces.
    #[must_use]
    pub fn pieces(&self) -> &[PieceVolume] {
        &self.pieces
    }

    /// Returns the least rest thickness `2 |V| / A` of the pieces that are no slivers \[m\].
    ///
    /// Infinite without pieces.
    pub(crate) fn least_thickness(&self) -> f64 {
        let volumes = self.pieces.iter().map(|piece| piece.rest.abs());
        let least = SLIVER * volumes.fold(0.0, f32::max);
        let solid = self.pieces.iter().filter(|piece| piece.rest.abs() > least);
        let thickness = solid.map(|piece| 2.0 / 3.0 * f64::from(piece.reach / REACH));
        thickness.fold(f64::INFINITY, f64::min)
    }

    /// Returns the XPBD multipliers after the last substep on the CPU, shape \[pieces\].
    ///
    /// A multiplier is the excess pressure \[Pa\] times `h^2`; all are 0 if they do not accumulate.
    #[must_use]
    pub fn multipliers(&self) -> &[f32] {
        &self.lambda
    }

    /// Returns a number that changes whenever the constraints are found again.
    #[cfg(feature = "gpu")]
    pub(crate) fn generation(&self) -> u64 {
        self.generation
    }

    /// Sets all multipliers to 0.
    pub(crate) fn reset_multipliers(&mut self) {
        self.lambda.fill(0.0);
    }

    /// Returns the allocated size in elements.
    pub(crate) fn capacity(&self) -> usize {
        self.pieces.capacity()
            + self.spokes.capacity()
            + self.rings.capacity()
            + self.lambda.capacity()
            + self.displacements.capacity()
            + self.tallies.capacity()
    }

    /// Removes all constraints.
    pub(crate) fn clear(&mut self) {
        self.generation += 1;
        self.pieces.clear();
        self.spokes.clear();
        self.rings.clear();
        self.lambda.clear();
        self.displacements.clear();
    }

    /// Finds the constraints of the surface as it is now. O(n).
    pub(crate) fn update(&mut self, surface: &Surface) {
        self.generation += 1;
        self.tally_triangles(surface);
        self.tally_vertices(surface);
        self.pieces.clear();
        let mut first = 0;
        for (piece, tally) in (0..).zip(&mut self.tallies) {
            if let Some((rest, reach)) = tally.rest() {
                let end = first + tally.vertices;
                self.pieces.push(PieceVolume {
                    piece,
                    rest,
                    reach,
                    first,
                    end,
                });
                tally.has_volume = true;
                tally.vertices = first;
                first = end;
            }
        }
        self.lambda.clear();
        self.lambda.resize(self.pieces.len(), 0.0);
        self.displacements.resize(self.pieces.len(), [0.0; 3]);
        self.spokes.clear();
        let nowhere = RingVertex::new(VertexId::NULL, HalfEdge::NULL);
        self.spokes.resize(first, nowhere);
        let topology = surface.topology();
        for vertex in topology.vertices() {
            let outgoing = topology.outgoing(vertex);
            let tally = &mut self.tallies[surface.piece(outgoing.triangle()) as usize];
            if tally.has_volume {
                self.spokes[tally.vertices] = RingVertex::new(vertex, outgoing);
                tally.vertices += 1;
            }
        }
        self.find_rings(topology);
    }

    /// Finds the rings of all spokes.
    fn find_rings(&mut self, topology: &Topology) {
        self.rings.clear();
        for spoke in &mut self.spokes {
            let first = index_u32(self.rings.len());
            self.rings.push(topology.target(spoke.outgoing));
            let mut h = spoke.outgoing;
            loop {
                let across = h.prev();
                self.rings.push(topology.origin(across));
                h = topology.twin(across);
                if h == spoke.outgoing {
                    break;
                }
            }
            spoke.ring = [first, index_u32(self.rings.len())];
        }
    }

    fn tally_triangles(&mut self, surface: &Surface) {
        let topology = surface.topology();
        self.tallies.clear();
        self.tallies
            .resize(surface.piece_bound() as usize, Tally::default());
        for t in topology.triangles() {
            let tally = &mut self.tallies[surface.piece(t) as usize];
            let corners = topology.triangle(t).map(|v| surface.rest_position(v));
            let apex = *tally.apex.get_or_insert(corners[0]);
            let normal = area_vector(corners);
            tally.volume += normal.dot(&(corners[0] - apex)) / 6.0;
            tally.area += normal.norm() / 2.0;
            let extents = corners.map(|corner| corner.amax());
            tally.extent = extents.into_iter().fold(tally.extent, f64::max);
            tally.untraversed += 3;
            tally.is_open |= t.half_edges().iter().any(|&h| topology.twin(h).is_null());
        }
    }

    /// Counts vertices and the half-edges in their fans.
    ///
    /// A vertex with several fans has half-edges that a traversal around it misses.
    fn tally_vertices(&mut self, surface: &Surface) {
        let topology = surface.topology();
        for v in topology.vertices() {
            let first = topology.outgoing(v);
            let tally = &mut self.tallies[surface.piece(first.triangle()) as usize];
            if tally.is_open {
                continue;
            }
            tally.vertices += 1;
            let mut at = first;
            loop {
                tally.untraversed -= 1;
                at = topology.twin(at.prev());
                if at == first || at.is_null() {
                    break;
                }
            }
        }
    }
}

impl Tally {
    /// Returns rest volume [m^3] and maximum displacement per projection \[m\].
    ///
    /// Returns `None` if the piece is not closed or encloses no volume.
    #[expect(
        clippy::cast_possible_truncation,
        reason = "computed values are rounded once to storage"
    )]
    fn rest(&self) -> Option<(f32, f32)> {
        let ball = self.area.powf(1.5) / (6.0 * PI.sqrt());
        let encloses = self.volume.abs() > FLAT * ball
            && self.volume.abs() > UNRESOLVED * self.area * self.extent;
        let rest = self.volume as f32;
        let is_closed = !self.is_open && self.untraversed == 0;
        let reach = (f64::from(REACH) * 3.0 * self.volume.abs() / self.area) as f32;
        (is_closed && encloses && rest.is_normal() && reach.is_normal()).then_some((rest, reach))
    }
}
