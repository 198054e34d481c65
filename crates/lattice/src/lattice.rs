//! [`Lattice`]: cells with the parts of a body, their nodes, and the surface in them.

use crate::content::Content;
use crate::divided::Divided;
use crate::error::LatticeError;
use crate::grid::Grid;
use crate::params::LatticeParams;
use crate::parts::Parts;
use incise_mesh::{Aabb, Surface, Vec3};
use std::collections::BTreeMap;

/// Maximum number of cells along an axis.
///
/// Scanlines then have numbers of 32 bits, and sample points take 128 MiB.
pub(crate) const MAX_ACROSS: u32 = 80;

/// No copy of a cell.
pub const NO_COPY: u32 = u32::MAX;

/// A lattice of cells in a closed surface at rest.
///
/// Each connected part of the body in a cell has its own copy of that cell. Copies share nodes
/// where their parts meet in a face. So nothing connects two pieces, two fingers in one cell, or
/// both sides of an incision. A small part that reaches little into its cell is carried by a
/// neighbor's copy.
///
/// Changes free copies and nodes, and use them again, the lowest first. Lattices are equal if they
/// have the same numbers, also of free copies and nodes.
///
/// With the feature `serde`, `finish_load` must follow its `Deserialize`.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Lattice {
    /// The lattice of cells.
    pub grid: Grid,
    /// By copy, the index of its cell, or [`NO_COPY`] for a free copy.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub cells: Vec<u32>,
    /// By copy, its nodes in the order of corners: bit k is set at the upper face of axis k.
    pub nodes: Vec<[u32; 8]>,
    /// By copy, its moments.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub moments: Vec<Moments>,
    /// By node, its rest position \[m\], a corner of cells; 0 for a free node.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub node_positions: Vec<[f64; 3]>,
    /// By node, its share of the body's volume \[m³\].
    ///
    /// Their sum is the volume of the scanlines, up to a percent off the surface's. A node of a
    /// part that reaches beyond its cell may have a small negative share.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub node_volumes: Vec<f64>,
    /// By vertex slot, its copy, or [`NO_COPY`] for free slots.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub vertex_copies: Vec<u32>,
    /// By vertex slot, the weights of its copy's nodes. They add up to 1.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub vertex_weights: Vec<[f32; 8]>,
    pub(crate) state: State,
}

/// The parts of the body that the copies stand for, by which the lattice follows edits.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct State {
    pub(crate) content: Content,
    pub(crate) parts: Parts,
    /// Cells with several parts.
    #[cfg_attr(feature = "serde", serde(with = "crate::pairs"))]
    pub(crate) divided: BTreeMap<u32, Divided>,
    /// By copy, the shares of its corners in its volume \[m³\].
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(crate) corner_volumes: Vec<[f64; 8]>,
    /// By node, the number of copies with it.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(crate) node_users: Vec<u32>,
    /// Unused copies, a stack, so that an undo takes back the numbers that its edit freed.
    pub(crate) free_copies: Vec<u32>,
    /// Unused nodes, a stack as well.
    pub(crate) free_nodes: Vec<u32>,
}

/// Moments of the part of a body in a copy.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Moments {
    /// Its volume \[cells\].
    pub fraction: f64,
    /// Its centroid from the cell's center \[half cells\].
    pub center: [f64; 3],
    /// Mean squares from the centroid along the axes \[those of a full cell\].
    pub spread: [f64; 3],
}

impl Lattice {
    /// Builds the lattice of a closed surface at rest.
    ///
    /// # Errors
    /// [`LatticeError`] for surfaces with a boundary or without a volume, and for cell sizes that
    /// are not positive or far too small.
    pub fn build(surface: &Surface, params: &LatticeParams) -> Result<Self, LatticeError> {
        let grid = grid_of(surface, params)?;
        Ok(Self::in_grid(surface, grid))
    }

    /// Builds the lattice of a closed surface at rest in given cells.
    ///
    /// The surface must lie in the cells. Vertices outside of them are in the nearest one.
    #[must_use]
    pub fn in_grid(surface: &Surface, grid: Grid) -> Self {
        let mut lattice = Self {
            grid,
            cells: Vec::new(),
            nodes: Vec::new(),
            moments: Vec::new(),
            node_positions: Vec::new(),
            node_volumes: Vec::new(),
            vertex_copies: Vec::new(),
            vertex_weights: Vec::new(),
            state: State {
                content: Content::new(&grid),
                parts: Parts::new(grid.cell_count()),
                divided: BTreeMap::new(),
                corner_volumes: Vec::new(),
                node_users: Vec::new(),
                free_copies: Vec::new(),
                free_nodes: Vec::new(),
            },
        };
        lattice.add_all(surface);
        lattice
    }

    /// Returns whether a copy is used, that is not free.
    #[must_use]
    pub fn is_copy(&self, copy: u32) -> bool {
        self.cells
            .get(copy as usize)
            .is_some_and(|&cell| cell != NO_COPY)
    }

    /// Returns whether a node is used, that is not free.
    #[must_use]
    pub fn is_node(&self, node: u32) -> bool {
        self.state
            .node_users
            .get(node as usize)
            .is_some_and(|&count| count > 0)
    }

    /// Returns the position of a vertex slot, given those of all nodes \[m\].
    #[must_use]
    pub fn embedded(&self, slot: usize, nodes: &[[f64; 3]]) -> Vec3 {
        let copy = self.vertex_copies[slot];
        let weights = self.vertex_weights[slot].iter();
        let own = self.nodes.get(copy as usize).into_iter().flatten();
        own.zip(weights)
            .map(|(&node, &weight)| Vec3::from(nodes[node as usize]) * f64::from(weight))
            .sum()
    }
}

/// Returns the grid around a surface at rest.
fn grid_of(surface: &Surface, params: &LatticeParams) -> Result<Grid, LatticeError> {
    let topology = surface.topology();
    let open = topology.triangles().find(|t| {
        let edges = t.half_edges().into_iter();
        edges
            .map(|h| topology.twin(h))
            .any(incise_mesh::HalfEdge::is_null)
    });
    if let Some(triangle) = open {
        return Err(LatticeError::Open { triangle });
    }
    let volume = surface.rest_volume_of(topology.triangles());
    if volume <= 0.0 || volume.is_nan() {
        return Err(LatticeError::NoVolume);
    }
    let bounds = Aabb::around(
        topology
            .vertices()
            .map(|v| surface.rest_positions()[v.index()]),
    );
    let sides = [0, 1, 2].map(|k| f64::from(bounds.max[k]) - f64::from(bounds.min[k]));
    let longest = sides[0].max(sides[1]).max(sides[2]);
    let size = match params.cell_size {
        Some(size) => size,
        None => {
            let area: f64 = surface.lumped_rest_areas().iter().sum();
            let thickness = 2.0 * volume / area;
            (thickness / 3.0).max(longest / f64::from(params.cells_across.max(1)))
        }
    };
    if size.is_nan() || size <= 0.0 {
        return Err(LatticeError::CellSize { size });
    }
    let across = crate::grid::ceil_to_u32(longest / size);
    if across > MAX_ACROSS {
        return Err(LatticeError::TooManyCells {
            size,
            across,
            limit: MAX_ACROSS,
        });
    }
    Ok(Grid::around(&bounds, size))
}
