//! Repair of mesh data, and its conversion to a surface.

use super::gaps::gap;
use super::links::{Fans, Links};
use super::weld::Weld;
use super::{Defect, NotCuttable};
use crate::geometry::{Aabb, to_f64};
use crate::ids::{HalfEdge, TriangleId, VertexId};
use crate::io::{MeshData, Warning};
use crate::quality::EdgeStats;
use crate::surface::{CornerAttributes, Domain, Surface};
use crate::topology::Topology;

/// The repairs to make beyond those of [`MeshData::into_surface`]. The default is none.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct RepairParams {
    /// Whether to accept boundaries, see [`MeshData::into_open_surface`].
    pub allow_boundaries: bool,
    /// Whether to separate sheets and bodies that share edges, see [`MeshData::repair`].
    pub separate_sheets: bool,
}

/// Repaired mesh data.
pub(super) struct Repaired {
    /// Vertex of the data for each vertex.
    pub(super) vertices: Vec<u32>,
    pub(super) triangles: Vec<[u32; 3]>,
    /// Triangle of the data for each triangle.
    pub(super) sources: Vec<u32>,
    /// Whether each triangle was flipped.
    pub(super) flipped: Vec<bool>,
    /// Twin of each half-edge; empty if triangles have moved since.
    pub(super) twins: Vec<HalfEdge>,
    /// Number of edges with one triangle.
    open_edges: usize,
    pub(super) warnings: Vec<Warning>,
    /// Defects that remain; the other fields form a surface only if there are none.
    pub(super) defects: Vec<Defect>,
}

impl MeshData {
    /// Converts the mesh to a surface at rest that can be cut, and returns all warnings.
    ///
    /// Whatever has a unique repair is repaired: duplicate or collapsed triangles, orientations,
    /// and parts that touch in a point or that the file keeps separate. Corner attributes and
    /// materials are kept.
    ///
    /// # Errors
    /// [`NotCuttable`] if the mesh has boundaries, edges of more than two triangles, one-sided
    /// components or components without volume.
    pub fn into_surface(self) -> Result<(Surface, Vec<Warning>), NotCuttable> {
        self.repair(RepairParams::default())
    }

    /// Converts a mesh that may have boundaries, like [`Self::into_surface`].
    ///
    /// Vertices at which holes touch stay whole, because filling the holes makes them manifold.
    /// Closed components without volume are removed. A mesh without boundaries is treated as by
    /// [`Self::into_surface`].
    ///
    /// # Errors
    /// [`NotCuttable`] if the mesh has edges of more than two triangles or one-sided components, or
    /// has no boundary and components without volume.
    pub fn into_open_surface(self) -> Result<(Surface, Vec<Warning>), NotCuttable> {
        self.repair(RepairParams {
            allow_boundaries: true,
            ..RepairParams::default()
        })
    }

    /// Converts the mesh to a surface at rest, with the repairs of `params`.
    ///
    /// The separation of sheets adds these repairs to those of [`Self::into_surface`]:
    /// - Of two triangles with the same corners and opposite orientations one is removed, unless
    ///   they are a wall between two bodies.
    /// - Edges of more than two triangles are split. The triangles are sorted around the edge by
    ///   exact predicates and paired so that each pair encloses material.
    /// - Sheets that end at other triangles, and walls within a closed surface, are detached. They
    ///   have a boundary there, and closed surfaces stay closed.
    /// - Closed components without volume are removed if others remain.
    /// - If closed components remain, a negative sum of their volumes flips the whole mesh.
    ///
    /// Each repair is a [`Warning`]. The result depends on the data alone. A mesh that needs no
    /// separation has the same result without it.
    ///
    /// # Errors
    /// [`NotCuttable`] if the mesh has one-sided patches, edges at which closed surfaces can be
    /// separated in several ways, boundaries unless allowed, or no boundary and components without
    /// volume.
    pub fn repair(self, params: RepairParams) -> Result<(Surface, Vec<Warning>), NotCuttable> {
        let mut repaired = repair(&self, params);
        if !repaired.defects.is_empty() {
            return Err(NotCuttable {
                defects: repaired.defects,
            });
        }
        let positions: Vec<[f32; 3]> = repaired
            .vertices
            .iter()
            .map(|&v| self.positions[v as usize])
            .collect();
        let (count, triangles) = (positions.len(), &repaired.triangles);
        let twins = std::mem::take(&mut repaired.twins);
        let topology = if twins.is_empty() {
            Topology::from_triangles(count, triangles)
        } else {
            Topology::from_twins(count, triangles, twins)
        };
        let topology = topology.expect("a mesh without defects is an oriented manifold");
        let mut surface = Surface::from_topology(topology, &positions, triangles);
        surface.origin = self.origin;
        let corners = repaired.corners();
        surface.corners = CornerAttributes {
            uv: gather(&self.corners.uv, &corners),
            normal: gather(&self.corners.normal, &corners),
        };
        surface.channels = (self.channels.iter())
            .map(|channel| match channel.domain() {
                Domain::Vertex => channel.gather(repaired.vertices.iter().map(|&v| v as usize)),
                Domain::Corner => channel.gather(corners.iter().copied()),
            })
            .collect();
        for (t, &source) in repaired.sources.iter().enumerate() {
            match self.materials.get(source as usize) {
                None | Some(0) => {}
                Some(&material) => surface.set_material(TriangleId::from_index(t), material),
            }
        }
        let mut warnings = self.warnings;
        warnings.extend(repaired.warnings);
        Ok((surface, warnings))
    }
}

/// Distance from the origin, in diagonals, beyond which a mesh should be moved to the origin.
const FAR: f64 = 10.0;
/// Spacing of 32-bit coordinates there, relative to the mean edge, that may merge vertices.
const COARSE: f64 = 1.0 / 64.0;

/// Returns the spacing of 32-bit coordinates at the mesh \[m\], if it may have merged vertices.
pub(super) fn rounding(data: &MeshData) -> Option<f64> {
    let corners = data.triangles.iter().flatten();
    let bounds = Aabb::around(corners.map(|&v| data.positions[v as usize]));
    let reach = bounds.center().amax();
    let apart = reach * f64::from(f32::EPSILON);
    let corners = |t: &[u32; 3]| t.map(|v| to_f64(data.positions[v as usize]));
    let edges = EdgeStats::from_triangles(data.triangles.iter().map(corners));
    (reach > FAR * bounds.diagonal() && apart > COARSE * edges.mean).then_some(apart)
}

/// Returns whether two corners are the same vertex.
pub(super) fn is_collapsed(t: &[u32; 3]) -> bool {
    t[0] == t[1] || t[1] == t[2] || t[2] == t[0]
}

/// Repairs a mesh and collects the remaining defects.
pub(super) fn repair(data: &MeshData, params: RepairParams) -> Repaired {
    let attempt = |weld, separate| Repaired::attempt(data, weld, params, separate);
    let welded = attempt(Weld::everything(data), false);
    if welded.defects.is_empty() {
        return welded;
    }
    let in_contact = welded
        .defects
        .iter()
        .any(|d| matches!(d, Defect::NonManifoldEdge { .. }));
    let mut torn = None;
    if in_contact {
        for weld in [
            Weld::within_parts,
            Weld::within_components,
            Weld::except_closed_components,
        ] {
            let apart = weld(data).map(|weld| attempt(weld, false));
            let Some(apart) = apart.filter(|apart| apart.defects.is_empty()) else {
                continue;
            };
            // Without common indices in the file, every triangle would be a sheet.
            let is_torn = apart.open_edges > welded.open_edges;
            if !is_torn || !params.separate_sheets {
                return apart;
            }
            torn.get_or_insert(apart);
        }
    }
    if params.separate_sheets {
        let weld = Weld::except_closed_components(data);
        let weld = weld.unwrap_or_else(|| Weld::everything(data));
        let separated = attempt(weld, true);
        return match torn {
            Some(torn) if !separated.defects.is_empty() => torn,
            _ => separated,
        };
    }
    welded
}

impl Repaired {
    fn attempt(data: &MeshData, weld: Weld, params: RepairParams, separate: bool) -> Self {
        let mut out = Self {
            vertices: weld.vertices,
            triangles: Vec::new(),
            sources: Vec::new(),
            flipped: Vec::new(),
            twins: Vec::new(),
            open_edges: 0,
            warnings: Vec::new(),
            defects: Vec::new(),
        };
        out.keep_distinct(&weld.triangles);
        if separate {
            out.remove_back_sides();
        }
        if out.triangles.is_empty() {
            out.defects.push(Defect::Empty);
            return out;
        }
        let is_crowded = |d: &Defect| matches!(d, Defect::NonManifoldEdge { .. });
        let mut links = Links::new(&out.triangles);
        if separate {
            out.orient(&links);
            if out.defects.is_empty() {
                // Half-edges of flipped triangles have moved.
                links = Links::new(&out.triangles);
                out.separate_sheets(data, &links);
                links = Links::new(&out.triangles);
            }
        }
        if !out.defects.iter().any(is_crowded) {
            out.find_bad_edges(data, &links);
        }
        if !separate && !out.defects.iter().any(is_crowded) {
            out.orient(&links);
            if out.flipped.contains(&true) {
                links = Links::new(&out.triangles);
            }
        }
        let all = out.defects.len();
        if params.allow_boundaries {
            for defect in &out.defects {
                if let &Defect::OpenEdge {
                    count,
                    gap: Some(gap),
                    ..
                } = defect
                {
                    out.warnings.push(Warning::NearlyMeeting { count, gap });
                }
            }
            out.defects
                .retain(|d| !matches!(d, Defect::OpenEdge { .. }));
        }
        let is_open = out.defects.len() < all;
        if out.defects.is_empty() {
            out.split_vertices(&links, is_open);
            let remove_flat = is_open || params.separate_sheets;
            let volume = out.check_volumes(data, is_open, remove_flat);
            if volume < 0.0 && (!is_open || params.separate_sheets) {
                out.invert();
            }
            out.remove_unused_vertices();
        }
        out.warnings.extend(weld.warning);
        out
    }

    fn find_bad_edges(&mut self, data: &MeshData, links: &Links) {
        if links.edges().all(|edge| edge.len() == 2) {
            return;
        }
        let counts = links.edge_counts(&self.triangles);
        self.open_edges = counts.open;
        let first = |bad: fn(usize) -> bool| {
            let (key, _) = links.edges().find(|edge| bad(edge.len()))?[0];
            let [a, b] = key.vertices().map(|v| self.vertices[v.index()]);
            Some((VertexId(a), VertexId(b), data.file_position(a)))
        };
        let nonmanifold = first(|n| n > 2).map(|(a, b, at)| Defect::NonManifoldEdge {
            a,
            b,
            at,
            count: counts.nonmanifold,
            rounding: rounding(data),
        });
        let open = first(|n| n == 1).map(|(a, b, at)| Defect::OpenEdge {
            a,
            b,
            at,
            count: counts.open,
            gap: gap(links, |v| {
                data.positions[self.vertices[v as usize] as usize]
            }),
        });
        self.defects.extend(nonmanifold);
        self.defects.extend(open);
    }

    /// Gives each fan of triangles around a vertex its own vertex.
    ///
    /// Fans around holes that touch at the vertex count as one.
    fn split_vertices(&mut self, links: &Links, is_open: bool) {
        self.twins = links.twins();
        let mut fans = Fans::of_manifold(&self.twins);
        if is_open {
            let topology = Topology::from_triangles(self.vertices.len(), &self.triangles)
                .expect("edges have two triangles at most, wound the same way");
            for rim in topology.boundary_loops() {
                for (i, h) in rim.iter().enumerate() {
                    fans.join(h.next(), rim[(i + 1) % rim.len()]);
                }
            }
        }
        let copies = fans.split(&mut self.triangles, self.vertices.len());
        let vertices = copies.iter().map(|&v| self.vertices[v as usize]);
        let mut originals: Vec<u32> = vertices.collect();
        self.vertices.extend_from_slice(&originals);
        originals.sort_unstable();
        originals.dedup();
        if let Some(&first) = originals.first() {
            self.warnings.push(Warning::VerticesSplit {
                vertex: VertexId(first),
                count: originals.len(),
            });
        }
    }

    fn remove_unused_vertices(&mut self) {
        let mut new = vec![u32::MAX; self.vertices.len()];
        for &v in self.triangles.iter().flatten() {
            new[v as usize] = 0;
        }
        for (new, next) in new.iter_mut().filter(|new| **new == 0).zip(0..) {
            *new = next;
        }
        for v in self.triangles.iter_mut().flatten() {
            *v = new[*v as usize];
        }
        let mut new = new.iter();
        self.vertices
            .retain(|_| new.next().is_some_and(|&new| new != u32::MAX));
    }

    /// Returns the corner in the mesh of each corner of the repaired triangles.
    fn corners(&self) -> Vec<usize> {
        let triangles = self.sources.iter().zip(&self.flipped);
        let corners = triangles.flat_map(|(&t, &flipped)| {
            let order = if flipped { [0, 2, 1] } else { [0, 1, 2] };
            order.map(|k| 3 * t as usize + k)
        });
        corners.collect()
    }
}

/// Returns the values of the given corners; none if there are no values.
fn gather<T: Copy>(values: &[T], corners: &[usize]) -> Vec<T> {
    let values = |&corner: &usize| values.get(corner).copied();
    corners.iter().filter_map(values).collect()
}
