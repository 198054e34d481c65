//! [`Lattice`]: cells with the parts of a body, their nodes, and the surface in them.

use crate::absorb::carriers;
use crate::error::LatticeError;
use crate::fragments::Fragments;
use crate::grid::{Grid, is_upper};
use crate::params::LatticeParams;
use crate::parts::Parts;
use crate::scan::{LINES, Lines, Scan};
use crate::skin::Skin;
use incise_mesh::{Aabb, Partition, Surface, Vec3, index_u32};

/// Maximum number of cells along an axis.
///
/// Scanlines then have numbers of 32 bits, and sample points take 128 MiB.
const MAX_ACROSS: u32 = 80;

/// No copy of a cell.
pub const NO_COPY: u32 = u32::MAX;

/// A lattice of cells in a closed surface at rest.
///
/// Each connected part of the body in a cell has its own copy of that cell. Copies share nodes
/// where their parts meet in a face. So nothing connects two pieces, two fingers in one cell, or
/// both sides of an incision. A small part that reaches little into its cell is carried by a
/// neighbor's copy.
#[derive(Debug, Clone, PartialEq)]
pub struct Lattice {
    /// The lattice of cells.
    pub grid: Grid,
    /// By copy, the index of its cell.
    pub cells: Vec<u32>,
    /// By copy, its nodes in the order of corners: bit k is set at the upper face of axis k.
    pub nodes: Vec<[u32; 8]>,
    /// By copy, its moments.
    pub moments: Vec<Moments>,
    /// By node, its rest position \[m\], a corner of cells.
    pub node_positions: Vec<[f64; 3]>,
    /// By node, its share of the body's volume \[m³\].
    ///
    /// Their sum is the volume of the scanlines, up to a percent off the surface's. A node of a
    /// part that reaches beyond its cell may have a small negative share.
    pub node_volumes: Vec<f64>,
    /// By vertex slot, its copy, or [`NO_COPY`] for free slots.
    pub vertex_copies: Vec<u32>,
    /// By vertex slot, the weights of its copy's nodes. They add up to 1.
    pub vertex_weights: Vec<[f32; 8]>,
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
        let skin = Skin::new(surface);
        let fragments = Fragments::new(&grid, &skin);
        let scan = Scan::new(&grid, &skin, &fragments);
        let parts = Parts::new(&grid, &skin, &fragments, &scan);
        let carriers = carriers(&grid, &skin, &fragments, &parts);
        let mut lattice = Self {
            grid,
            cells: Vec::new(),
            nodes: Vec::new(),
            moments: Vec::new(),
            node_positions: Vec::new(),
            node_volumes: Vec::new(),
            vertex_copies: Vec::new(),
            vertex_weights: Vec::new(),
        };
        let copies = lattice.add_copies(&parts, &carriers);
        lattice.add_nodes(&parts, &carriers, &copies);
        lattice.measure(&parts, &scan, &fragments, &copies);
        lattice.embed(surface, &skin, &fragments, &parts, &copies);
        lattice
    }

    /// Adds a copy for each part that carries itself. Returns the copy of each part.
    fn add_copies(&mut self, parts: &Parts, carriers: &[u32]) -> Vec<u32> {
        let mut copies = vec![NO_COPY; carriers.len()];
        for (part, &cell) in parts.cells.iter().enumerate() {
            if carriers[part] as usize == part {
                copies[part] = index_u32(self.cells.len());
                self.cells.push(cell);
            }
        }
        let carried = |part: usize| copies[carriers[part] as usize];
        (0..carriers.len()).map(carried).collect()
    }

    /// Adds the nodes of all copies.
    fn add_nodes(&mut self, parts: &Parts, carriers: &[u32], copies: &[u32]) {
        let mut corners = Partition::new(8 * self.cells.len());
        for join in &parts.joins {
            let ends = [join.low, join.high];
            if ends.iter().any(|&part| carriers[part as usize] != part) {
                continue;
            }
            let [low, high] = ends.map(|part| 8 * copies[part as usize]);
            for corner in (0..8).filter(|&corner| is_upper(corner as usize, join.axis)) {
                corners.join(low + corner, high + (corner ^ 1 << join.axis));
            }
        }
        let mut numbers = vec![NO_COPY; corners.len()];
        for (copy, &cell) in (0..).zip(&self.cells) {
            let cell = self.grid.cell(cell);
            let nodes = std::array::from_fn(|corner| {
                let own = 8 * copy + index_u32(corner);
                let number = &mut numbers[corners.find(own) as usize];
                if *number == NO_COPY {
                    *number = index_u32(self.node_positions.len());
                    self.node_positions
                        .push(self.grid.corner(cell, corner).into());
                }
                *number
            });
            self.nodes.push(nodes);
        }
    }

    /// Measures the moments of copies and the volumes of nodes along the scanlines.
    fn measure(&mut self, parts: &Parts, scan: &Scan, fragments: &Fragments, copies: &[u32]) {
        let size = self.grid.cell_size();
        let section = Lines::distance(&self.grid).powi(2) / 3.0;
        // Sums by copy: length, first and second moments [half cells].
        let mut sums = vec![[0.0; 7]; self.cells.len()];
        self.node_volumes = vec![0.0; self.node_positions.len()];
        let mut elements = parts.of_element[fragments.len() as usize..].iter();
        for (axis, spans) in scan.spans.iter().enumerate() {
            let lines = Lines::new(&self.grid, axis);
            for (span, &part) in spans.iter().zip(&mut elements) {
                let copy = copies[part as usize] as usize;
                let cell = self.grid.cell(self.cells[copy]);
                let middle = lines.point(span.line, (span.from + span.to) / 2.0);
                let weights = self.grid.weights(cell, middle);
                for (&node, weight) in self.nodes[copy].iter().zip(weights) {
                    self.node_volumes[node as usize] += weight * section * span.length();
                }
                let at = (middle - self.grid.corner(cell, 0)) * (2.0 / size) - Vec3::repeat(1.0);
                let length = span.length() * 2.0 / size;
                let width = 2.0 / f64::from(LINES);
                let sums = &mut sums[copy];
                sums[0] += length;
                for k in 0..3 {
                    let own = if k == axis { length } else { width };
                    sums[1 + k] += length * at[k];
                    sums[4 + k] += length * (at[k] * at[k] + own * own / 12.0);
                }
            }
        }
        // All scanlines of a full cell, along three axes.
        let full = f64::from(6 * LINES * LINES);
        let moments = sums.iter().map(|sums| {
            let mean = |i: usize| {
                if sums[0] > 0.0 {
                    sums[i] / sums[0]
                } else {
                    0.0
                }
            };
            Moments {
                fraction: sums[0] / full,
                center: [1, 2, 3].map(mean),
                spread: [0, 1, 2].map(|k| 3.0 * (mean(4 + k) - mean(1 + k).powi(2))),
            }
        });
        self.moments = moments.collect();
    }

    /// Finds the copy and the weights of each vertex.
    fn embed(
        &mut self,
        surface: &Surface,
        skin: &Skin,
        fragments: &Fragments,
        parts: &Parts,
        copies: &[u32],
    ) {
        let topology = surface.topology();
        let slots = topology.vertex_slots();
        self.vertex_copies = vec![NO_COPY; slots];
        self.vertex_weights = vec![[0.0; 8]; slots];
        for (triangle, &t) in (0..).zip(&skin.ids) {
            for v in topology.triangle(t) {
                if self.vertex_copies[v.index()] != NO_COPY {
                    continue;
                }
                let place = surface.rest_position(v);
                let cell = self.grid.index(self.grid.cell_at(place));
                let fragment = fragments.find(triangle, cell);
                let fragment = fragment.unwrap_or(fragments.of(triangle).start);
                let copy = copies[parts.of_element[fragment as usize] as usize];
                let cell = self.grid.cell(self.cells[copy as usize]);
                self.vertex_copies[v.index()] = copy;
                self.vertex_weights[v.index()] = self.grid.weights(cell, place).map(to_weight);
            }
        }
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

/// Rounds a weight to storage.
#[expect(
    clippy::cast_possible_truncation,
    reason = "weights have storage precision"
)]
fn to_weight(weight: f64) -> f32 {
    weight as f32
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
    let area: f64 = surface.lumped_rest_areas().iter().sum();
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
