//! The dissecting edge of a cutting tool.

use incise_cut::{CutError, Sweep};

/// A blade of a scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BladeId(pub(crate) usize);

/// A cutting edge and where it was a frame ago.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Blade {
    edge: [[f32; 3]; 2],
    previous: [[f32; 3]; 2],
    /// The piece that the blade cuts, if it is to pass through all others.
    pub only_piece: Option<u32>,
}

impl Blade {
    pub(crate) const fn new(edge: [[f32; 3]; 2]) -> Self {
        Self {
            edge,
            previous: edge,
            only_piece: None,
        }
    }

    /// Where the edge is: start and end \[m\].
    #[must_use]
    pub const fn edge(&self) -> [[f32; 3]; 2] {
        self.edge
    }

    pub(crate) fn move_to(&mut self, edge: [[f32; 3]; 2]) {
        self.edge = edge;
    }

    /// Puts the edge elsewhere without sweeping.
    pub(crate) fn jump_to(&mut self, edge: [[f32; 3]; 2]) {
        self.edge = edge;
        self.previous = edge;
    }

    /// The sweep since the last frame; none when the blade is at rest or moved along itself.
    ///
    /// # Errors
    /// [`CutError::SweepNotFinite`] when a pose is not finite.
    pub(crate) fn sweep(&self) -> Result<Option<Sweep>, CutError> {
        match Sweep::new(self.previous, self.edge) {
            Ok(sweep) => Ok(Some(sweep)),
            Err(CutError::BladeDegenerate) => Ok(None),
            Err(error) => Err(error),
        }
    }

    pub(crate) fn end_sweep(&mut self) {
        self.previous = self.edge;
    }
}
