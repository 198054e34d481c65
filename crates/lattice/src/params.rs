//! [`LatticeParams`]: the size of a lattice's cells.

/// The size of a lattice's cells.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LatticeParams {
    /// Length of a cell's edges \[m\]; `None` for a third of the body's thickness.
    ///
    /// The thickness is twice its volume by its area: that of a plate, and a third of a ball's
    /// diameter.
    pub cell_size: Option<f64>,
    /// Maximum number of cells along the longest side of the body, which enlarges cells.
    pub cells_across: u32,
}

impl Default for LatticeParams {
    fn default() -> Self {
        Self {
            cell_size: None,
            cells_across: 16,
        }
    }
}
