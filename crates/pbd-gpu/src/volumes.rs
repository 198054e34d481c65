//! The volumes that a body's pieces enclose, each of which is one constraint.
//!
//! A piece has one if it is closed and encloses something at rest. It is a matter of that piece alone: a cut gives each
//! half the volume that it has at rest. Nothing of it is kept by edge or vertex but a list of the piece's vertices, as
//! kernels walk the surface's own half-edges.

use incise_mesh::geometry::{Vec3, area_vector};
use incise_mesh::{HalfEdge, Surface, VertexId};
use std::f64::consts::PI;

/// How far one projection may move a vertex, against the thickness of the piece at rest, `3 |V| / A`: the radius of a
/// ball, 3/2 of a plate's thickness. Where next to nothing is left of a piece, its gradient would else throw it apart.
const REACH: f64 = 0.25;

/// A volume below this part of what a ball of the same area has is the rounding of a flat piece's positions.
const FLAT: f64 = 1e-6;

/// A vertex of a closed piece, where the walk around it begins.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Spoke {
    pub(crate) vertex: VertexId,
    /// A half-edge that leaves it.
    pub(crate) outgoing: HalfEdge,
}

/// The constraint of a piece's volume: it is to stay what it is at rest, times the material's pressure.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PieceVolume {
    pub(crate) piece: u32,
    pub(crate) rest: f32,
    /// How far a projection may move a vertex \[m\].
    pub(crate) reach: f32,
    /// Its places in the list of spokes.
    pub(crate) first: usize,
    pub(crate) end: usize,
}

impl PieceVolume {
    /// The number of the piece.
    #[must_use]
    pub fn piece(&self) -> u32 {
        self.piece
    }

    /// The volume at rest [m^3]; negative of a cavity, whose normals point inward.
    #[must_use]
    pub fn rest(&self) -> f32 {
        self.rest
    }

    /// How many vertices it moves.
    #[must_use]
    pub fn vertices(&self) -> usize {
        self.end - self.first
    }
}

/// What is known of a piece before its vertices are counted.
#[derive(Debug, Clone, Copy, Default)]
struct Tally {
    /// From where cones are measured \[m\].
    apex: Option<Vec3>,
    /// [m^3]
    volume: f64,
    /// \[m^2\]
    area: f64,
    /// Half-edges of its triangles less those in the fans of its vertices: 0 unless fans meet in a vertex.
    unwalked: i64,
    is_open: bool,
    /// Its vertices; where the next one stands in the list, once they are counted.
    vertices: usize,
    has_volume: bool,
}

/// The volume constraints of a body, by piece.
#[derive(Debug, Clone, Default)]
pub struct VolumeSet {
    pub(crate) pieces: Vec<PieceVolume>,
    /// By piece, ascending vertices in each.
    pub(crate) spokes: Vec<Spoke>,
    /// Multipliers of the substep, shape \[pieces\].
    pub(crate) lambda: Vec<f32>,
    generation: u64,
    tallies: Vec<Tally>,
}

impl VolumeSet {
    /// The constraints, by piece, ascending.
    #[must_use]
    pub fn pieces(&self) -> &[PieceVolume] {
        &self.pieces
    }

    /// The multipliers that the processor's last substep ended with, shape \[pieces\]: the pressure in a piece beyond what
    /// there is at rest, times the square of the substep [kg/m]. All 0 where substeps keep none.
    #[must_use]
    pub fn multipliers(&self) -> &[f32] {
        &self.lambda
    }

    /// How often they were found.
    #[cfg(feature = "gpu")]
    pub(crate) fn generation(&self) -> u64 {
        self.generation
    }

    pub(crate) fn reset_multipliers(&mut self) {
        self.lambda.fill(0.0);
    }

    pub(crate) fn capacity(&self) -> usize {
        self.pieces.capacity()
            + self.spokes.capacity()
            + self.lambda.capacity()
            + self.tallies.capacity()
    }

    /// Has none any more.
    pub(crate) fn clear(&mut self) {
        self.generation += 1;
        self.pieces.clear();
        self.spokes.clear();
        self.lambda.clear();
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
        let nowhere = Spoke {
            vertex: VertexId::NULL,
            outgoing: HalfEdge::NULL,
        };
        self.spokes.clear();
        self.spokes.resize(first, nowhere);
        let topology = surface.topology();
        for vertex in topology.vertices() {
            let outgoing = topology.outgoing(vertex);
            let tally = &mut self.tallies[surface.piece(outgoing.triangle()) as usize];
            if tally.has_volume {
                self.spokes[tally.vertices] = Spoke { vertex, outgoing };
                tally.vertices += 1;
            }
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
            tally.unwalked += 3;
            tally.is_open |= t.half_edges().iter().any(|&h| topology.twin(h).is_null());
        }
    }

    /// Counts vertices, and half-edges around them: where fans of one vertex meet, or pieces do, a walk around it
    /// misses some.
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
                tally.unwalked -= 1;
                at = topology.twin(at.prev());
                if at == first || at.is_null() {
                    break;
                }
            }
        }
    }
}

impl Tally {
    /// The rest volume [m^3] and how far a projection may move a vertex \[m\]; none of a piece that has no volume.
    #[expect(
        clippy::cast_possible_truncation,
        reason = "computed values are rounded once to storage"
    )]
    fn rest(&self) -> Option<(f32, f32)> {
        let ball = self.area.powf(1.5) / (6.0 * PI.sqrt());
        let encloses = self.volume.abs() > FLAT * ball;
        let rest = self.volume as f32;
        let is_closed = !self.is_open && self.unwalked == 0;
        let reach = (REACH * 3.0 * self.volume.abs() / self.area) as f32;
        (is_closed && encloses && rest.is_normal() && reach.is_normal()).then_some((rest, reach))
    }
}
