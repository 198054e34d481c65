//! Completes and validates a loaded [`Lattice`].
//!
//! Files hold the parts of cells, and the numbers of parts, copies and nodes, which depend on
//! earlier edits. All else follows from these, the surface and the grid, and is found again.

use crate::body::Body;
use crate::cell::NONE;
use crate::copies::carried_sums;
use crate::embed::to_weight;
use crate::error::InvalidLattice;
use crate::grid::{Grid, is_upper};
use crate::lattice::{Lattice, MAX_ACROSS, State};
use crate::measures::Sums;
use incise_mesh::{Surface, VertexId};

/// Maximum number of parts of a cell that no triangle in it bounds, by piece.
///
/// A piece passes through a cell along each of 48 scanlines once. Twice that is never reached.
const MAX_SPANS_PER_PIECE: usize = 96;

/// Returns an error of an array.
fn invalid<T>(array: &'static str) -> Result<T, InvalidLattice> {
    Err(InvalidLattice::Array { array })
}

impl Lattice {
    /// Completes and validates a lattice that was read with serde, for its valid surface.
    ///
    /// The lattice then equals the saved one, and follows edits with the same bits. It must have
    /// followed all edits of the surface, and have no more cells along an axis than
    /// [`Self::build`] allows. Takes time in proportion to both, most of it for the triangles in
    /// cells and scanlines.
    ///
    /// # Errors
    /// [`InvalidLattice`] if it is not a lattice of the surface. It must not be used then.
    pub fn finish_load(&mut self, surface: &Surface) -> Result<(), InvalidLattice> {
        if !is_valid_grid(&self.grid) {
            return Err(InvalidLattice::Grid);
        }
        let grid = self.grid;
        self.state.content.finish_load(&Body::new(surface, &grid))?;
        let order = self.state.parts.finish_load(&grid)?;
        self.state.check_cells(surface, &order)?;
        self.load_copies(&order)?;
        self.load_nodes(&order)?;
        self.load_vertices(surface)
    }

    /// Finds cells and moments of copies, and the free ones.
    fn load_copies(&mut self, order: &[u32]) -> Result<(), InvalidLattice> {
        let Self { grid, state, .. } = self;
        let count = self.nodes.len();
        self.cells.clear();
        self.cells.resize(count, NONE);
        self.moments.clear();
        self.moments.resize(count, Sums::EMPTY.moments());
        state.corner_volumes.clear();
        state.corner_volumes.resize(count, [0.0; 8]);
        let mut carried = Vec::new();
        for &part in order
            .iter()
            .filter(|&&part| state.parts.carries_itself(part))
        {
            let own = state.parts.get(part);
            let i = own.copy as usize;
            if self.cells.get(i) != Some(&NONE) {
                return invalid("copies of parts");
            }
            self.cells[i] = own.cell;
            let sums = carried_sums(grid, &state.parts, part, &mut carried);
            let (moments, volumes) = (sums.moments(), sums.corner_volumes(grid.cell_size()));
            let mut numbers = moments.center.iter().chain(&moments.spread).chain(&volumes);
            if !moments.fraction.is_finite() || !numbers.all(|number| number.is_finite()) {
                return invalid("moments of parts");
            }
            self.moments[i] = moments;
            state.corner_volumes[i] = volumes;
        }
        let copies = (0..).zip(&self.cells);
        let free = copies.filter(|own| *own.1 == NONE).map(|own| own.0);
        if !are_same(free.clone(), &state.free_copies) {
            return invalid("free copies");
        }
        for copy in free {
            if self.nodes[copy as usize] != [NONE; 8] {
                return invalid("nodes of free copies");
            }
        }
        Ok(())
    }

    /// Finds positions and volumes of nodes.
    fn load_nodes(&mut self, order: &[u32]) -> Result<(), InvalidLattice> {
        let Self { grid, state, .. } = self;
        let [nx, ny, _] = grid.counts().map(|count| count + 1);
        let used = self.nodes.iter().flatten().filter(|&&node| node != NONE);
        let used_count = used.clone().count();
        let last = used.chain(&state.free_nodes).max();
        let count = last.map_or(0, |&node| node as usize + 1);
        if count > used_count + state.free_nodes.len() {
            return invalid("nodes of copies");
        }
        self.node_positions.clear();
        self.node_positions.resize(count, [0.0; 3]);
        self.node_volumes.clear();
        self.node_volumes.resize(count, 0.0);
        state.node_users.clear();
        state.node_users.resize(count, 0);
        let mut corner_of = vec![NONE; count];
        // In the order in which edits add up volumes.
        for &part in order
            .iter()
            .filter(|&&part| state.parts.carries_itself(part))
        {
            let own = state.parts.get(part);
            let copy = own.copy as usize;
            let cell = grid.cell(own.cell);
            for (corner, &node) in self.nodes[copy].iter().enumerate() {
                let i = node as usize;
                let at = [0, 1, 2].map(|k| cell[k] + u32::from(is_upper(corner, k)));
                let index = (at[2] * ny + at[1]) * nx + at[0];
                let Some(known) = corner_of.get_mut(i) else {
                    return invalid("nodes of copies");
                };
                if *known == NONE {
                    *known = index;
                    self.node_positions[i] = grid.corner(at, 0).into();
                    self.node_volumes[i] = std::iter::empty::<f64>().sum();
                } else if *known != index {
                    return invalid("nodes of copies");
                }
                self.node_volumes[i] += state.corner_volumes[copy][corner];
                state.node_users[i] += 1;
            }
        }
        let users = (0..).zip(&state.node_users);
        let free = users.filter(|own| *own.1 == 0).map(|own| own.0);
        if !are_same(free, &state.free_nodes) {
            return invalid("free nodes");
        }
        let mut numbers = self
            .node_positions
            .iter()
            .flatten()
            .chain(&self.node_volumes);
        if !numbers.all(|number| number.is_finite()) {
            return invalid("moments of parts");
        }
        Ok(())
    }

    /// Finds copies and weights of vertices, from the parts of the cells that hold them.
    fn load_vertices(&mut self, surface: &Surface) -> Result<(), InvalidLattice> {
        let Self { grid, state, .. } = self;
        let slots = surface.topology().vertex_slots();
        // With room for the vertices of cuts, as in a lattice that was built.
        self.vertex_copies.clear();
        self.vertex_copies.reserve(slots + slots / 4);
        self.vertex_copies.resize(slots, NONE);
        self.vertex_weights.clear();
        self.vertex_weights.reserve(slots + slots / 4);
        let cell_of = |v: VertexId| grid.index(grid.cell_at(surface.rest_position(v)));
        for (&cell, divided) in &state.divided {
            for &(v, part) in &divided.vertices {
                let copy = &mut self.vertex_copies[v.index()];
                if *copy != NONE || cell_of(v) != cell {
                    return invalid("vertices in cells with several parts");
                }
                *copy = state.parts.carrying_copy(part);
            }
        }
        for (v, copy) in (0..).map(VertexId).zip(&mut self.vertex_copies) {
            let mut weights = [0.0; 8];
            if is_used(surface, v) {
                if *copy == NONE {
                    let mut parts = state.parts.of_cell(cell_of(v));
                    let (Some(part), None) = (parts.next(), parts.next()) else {
                        return invalid("parts with vertices");
                    };
                    *copy = state.parts.carrying_copy(part);
                }
                let cell = grid.cell(self.cells[*copy as usize]);
                weights = grid.weights(cell, surface.rest_position(v)).map(to_weight);
                if !weights.iter().all(|weight| weight.is_finite()) {
                    return invalid("parts with vertices");
                }
            }
            self.vertex_weights.push(weights);
        }
        Ok(())
    }
}

impl State {
    /// Checks the parts of each cell, and where those of divided cells are.
    fn check_cells(&self, surface: &Surface, order: &[u32]) -> Result<(), InvalidLattice> {
        let parts = &self.parts;
        let cell_of = |part: u32| parts.get(part).cell;
        let spans = MAX_SPANS_PER_PIECE * (surface.piece_count() + 1);
        let mut divided = self.divided.iter();
        for own in order.chunk_by(|&a, &b| cell_of(a) == cell_of(b)) {
            let cell = cell_of(own[0]);
            if own.len() > self.content.triangles(cell).len() + spans {
                return invalid("parts");
            }
            if own.len() == 1 {
                continue;
            }
            let is_valid = divided.next().is_some_and(|(&key, divided)| {
                let is_part = |part| parts.is_in_cell(part, cell);
                key == cell && divided.is_valid(is_part, |v| is_used(surface, v))
            });
            if !is_valid {
                return invalid("cells with several parts");
            }
        }
        if divided.next().is_some() {
            return invalid("cells with several parts");
        }
        Ok(())
    }
}

/// Returns whether a grid has finite cells, and no more than lattices may have.
fn is_valid_grid(grid: &Grid) -> bool {
    let size = grid.cell_size();
    let far = grid.corner(grid.counts(), 0);
    let numbers = [
        size,
        1.0 / size,
        grid.origin().norm_squared(),
        far.norm_squared(),
    ];
    let counts = grid.counts();
    size > 0.0
        && numbers.iter().all(|number| number.is_finite())
        && counts
            .iter()
            .all(|count| (1..=MAX_ACROSS + 2).contains(count))
}

/// Returns whether a vertex is one of a triangle.
fn is_used(surface: &Surface, v: VertexId) -> bool {
    let topology = surface.topology();
    v.index() < topology.vertex_slots() && !topology.outgoing(v).is_null()
}

/// Returns whether a list has the given ascending numbers, in any order.
fn are_same(numbers: impl Iterator<Item = u32>, list: &[u32]) -> bool {
    let mut sorted = list.to_vec();
    sorted.sort_unstable();
    numbers.eq(sorted)
}
