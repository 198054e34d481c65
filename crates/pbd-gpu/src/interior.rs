//! [`Interior`]: the inside of a solid, a lattice whose nodes are its particles.
//!
//! Nodes carry mass, motion and elasticity. Vertices of the surface have none of their own: they
//! are interpolated from the nodes, and forces on them are mapped to the nodes.

mod adopt;
mod embed;
pub(crate) mod energy;
mod follow;
mod join;
#[cfg(feature = "serde")]
mod load;
mod masses;
mod rest;
mod undo;
mod validate;

use crate::constraints::cells::{CellSet, CellState};
use crate::error::ConstraintError;
use crate::kernels::cells::{CellConstants, RESOLVED};
use crate::kernels::points::Near;
use crate::material::Solid;
use crate::particles::Pin;
use follow::EditScratch;
use incise_lattice::{Lattice, LatticeParams};
use incise_mesh::{Partition, Surface, VertexId};
use undo::EditRecords;
pub use undo::SolidState;

/// Maximum number of parts of a substep for stiffness.
const MAX_PARTS: f64 = 8.0;

/// The inside of a solid.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Interior {
    pub(crate) lattice: Lattice,
    /// Position \[m\] and inverse mass [1/kg], shape \[nodes\].
    pub(crate) positions: Vec<[f32; 4]>,
    /// Velocity [m/s], last component 0, shape \[nodes\].
    pub(crate) velocities: Vec<[f32; 4]>,
    /// Forces of cells in the last substep \[N\], which the next one repeats, shape \[nodes\].
    ///
    /// Sums depend on the order of the cells in the sweep, which a cut changes.
    pub(crate) node_forces: Vec<[f32; 4]>,
    /// Mass \[kg\], shape \[nodes\].
    pub(crate) mass: Vec<f32>,
    pub(crate) cells: CellSet,
    /// Inverse masses of vertices as pushes see them [1/kg], shape [vertex slots].
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(crate) inverse_masses: Vec<f32>,
    /// Targets of pins in the last frame.
    last_pins: Vec<Pin>,
    /// Positions of pinned vertices at the start of the frame \[m\], shape \[pins\].
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(crate) pin_starts: Vec<[f32; 3]>,
    /// Vertices that colliders may reach in the frame.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(crate) near: Vec<Near>,
    /// Mass by rest area at creation [kg/m^2].
    area_density: f64,
    /// Least mass of a node \[kg\], unless there is not enough for all.
    least_mass: f64,
    /// Mean rest length of the edges of the surface at creation \[m\].
    pub(crate) mean_rest_length: f64,
    edits: EditRecords,
    #[cfg_attr(feature = "serde", serde(skip))]
    scratch: EditScratch,
    /// Coefficients of the last frame.
    constants: CellConstants,
    /// Mean product of the inverse mass and the fraction of a cell, by volume [1/(kg m²)].
    #[cfg_attr(feature = "serde", serde(skip))]
    mean_stiff: f64,
    /// Checksum of the positions of vertices as they were embedded.
    embedded: u64,
    /// Whether the caller has set velocities of vertices.
    pub(crate) has_new_velocities: bool,
}

impl Interior {
    /// Creates the inside of a closed surface, with a total mass \[kg\].
    ///
    /// # Errors
    /// [`ConstraintError::Lattice`].
    pub(crate) fn new(
        surface: &mut Surface,
        velocities: &mut [[f32; 4]],
        solid: &Solid,
        mass: f64,
    ) -> Result<Self, ConstraintError> {
        let params = LatticeParams {
            cell_size: solid.cell_size.map(f64::from),
            cells_across: solid.cells_across,
        };
        let lattice = Lattice::build(surface, &params)?;
        let nodes = lattice.node_positions.len();
        let mut cells = CellSet::new();
        cells.resize_nodes(nodes);
        for (copy, (nodes, moments)) in (0..).zip(lattice.nodes.iter().zip(&lattice.moments)) {
            cells.insert(copy, nodes.map(VertexId), moments, &CellState::default());
        }
        let mut interior = Self {
            positions: vec![[0.0; 4]; nodes],
            velocities: vec![[0.0; 4]; nodes],
            node_forces: vec![[0.0; 4]; nodes],
            mass: vec![0.0; nodes],
            cells,
            inverse_masses: Vec::new(),
            last_pins: Vec::new(),
            pin_starts: Vec::new(),
            near: Vec::new(),
            area_density: mass / surface.lumped_rest_areas().iter().sum::<f64>(),
            least_mass: 0.0,
            mean_rest_length: surface.mean_rest_edge_length(),
            edits: EditRecords::default(),
            scratch: EditScratch::default(),
            constants: CellConstants::NONE,
            mean_stiff: 0.0,
            embedded: 0,
            has_new_velocities: false,
            lattice,
        };
        for (x, rest) in interior
            .positions
            .iter_mut()
            .zip(&interior.lattice.node_positions)
        {
            *x = embed::to_row(*rest);
        }
        interior.set_masses(surface, mass);
        let rest = surface.positions().iter().zip(surface.rest_positions());
        if rest.clone().any(|(x, rest)| x[..3] != rest[..]) {
            interior.adopt_positions(surface);
        }
        interior.embed(surface, velocities);
        Ok(interior)
    }

    /// Returns the mass per area that vertices share [kg/m^2].
    pub(crate) fn area_density(&self) -> f64 {
        self.area_density
    }

    /// Returns the coefficients of the last frame, for which the forces at nodes are summed.
    #[cfg(feature = "gpu")]
    pub(crate) fn constants(&self) -> CellConstants {
        self.constants
    }

    /// Sets the coefficients of the forces at nodes that were read back.
    #[cfg(feature = "gpu")]
    pub(crate) fn set_constants(&mut self, constants: CellConstants) {
        self.constants = constants;
    }

    /// Returns the length of the edges of a cell \[m\].
    #[expect(clippy::cast_possible_truncation, reason = "rounded to storage")]
    pub(crate) fn cell_size(&self) -> f32 {
        self.lattice.grid.cell_size() as f32
    }

    /// Returns the coefficients of the cells in a substep of `h` \[s\].
    ///
    /// The forces that the first one repeats are those of these coefficients.
    pub(crate) fn begin_frame(&mut self, solid: &Solid, h: f32) -> CellConstants {
        let constants = self.constants_of(solid, h);
        if constants != self.constants {
            self.constants = constants;
            (self.cells).sum_forces(&mut self.node_forces, &constants, |_| true);
        }
        constants
    }

    #[expect(clippy::cast_possible_truncation, reason = "rounded to storage")]
    fn constants_of(&self, solid: &Solid, h: f32) -> CellConstants {
        let size = self.lattice.grid.cell_size();
        let square = f64::from(h) * f64::from(h);
        let [shape, volume, hourglass] = stiffness(solid, size).map(|k| (k * square) as f32);
        CellConstants {
            scale: self.derivative_scale(),
            unit: self.derivative_scale() * (4.0 * size) as f32,
            shape,
            volume,
            hourglass,
            square: square as f32,
            viscosity: solid.relaxation_time / h,
        }
    }

    /// Returns one by four cell sizes [1/m], by which modes are derivatives.
    #[expect(clippy::cast_possible_truncation, reason = "rounded to storage")]
    pub(crate) fn derivative_scale(&self) -> f32 {
        (0.25 / self.lattice.grid.cell_size()) as f32
    }

    /// Returns the number of parts of a substep of `h` \[s\] in which most of the body is
    /// [resolved](RESOLVED).
    ///
    /// At most [`MAX_PARTS`]: a stiffer body is softer than its material.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a whole number between 1 and its maximum"
    )]
    pub(crate) fn needed_parts(&self, solid: &Solid, h: f32) -> u32 {
        let [_, volume, _] = stiffness(solid, self.lattice.grid.cell_size());
        let h = f64::from(h);
        let ratio = self.mean_stiff * volume * h * h;
        let parts = (ratio / f64::from(RESOLVED)).sqrt().ceil();
        parts.clamp(1.0, MAX_PARTS) as u32
    }

    /// Begins a frame with given pins, which move from their last targets, new ones from where they
    /// are.
    pub(crate) fn begin_pins(&mut self, pins: &[Pin]) {
        let mut starts = std::mem::take(&mut self.pin_starts);
        starts.clear();
        let mut last = self.last_pins.iter().peekable();
        starts.extend(pins.iter().map(|pin| {
            while last.next_if(|other| other.vertex < pin.vertex).is_some() {}
            let known = last.next_if(|other| other.vertex == pin.vertex);
            let start = known.map(|other| other.target);
            let start = start.or_else(|| self.position(pin.vertex.index()));
            start.unwrap_or(pin.target)
        }));
        self.pin_starts = starts;
        self.last_pins.clear();
        self.last_pins.extend_from_slice(pins);
    }

    /// Returns the nodes that cells connect.
    fn pieces(&self) -> Partition {
        let mut sets = Partition::new(self.positions.len());
        for (copy, nodes) in (0..).zip(&self.lattice.nodes) {
            if self.lattice.is_copy(copy) {
                for pair in nodes.windows(2) {
                    sets.join(pair[0], pair[1]);
                }
            }
        }
        sets
    }

    /// Returns the allocated size in elements.
    pub(crate) fn capacity(&self) -> usize {
        self.positions.capacity()
            + self.velocities.capacity()
            + self.node_forces.capacity()
            + self.mass.capacity()
            + self.cells.capacity()
    }
}

/// Returns the stiffness of a full cell against changes of shape and of volume, `2 mu V` and
/// `(2 mu + 3 lambda) V` \[J\], and that of its hourglass modes [N/m].
///
/// A mode bends the cell. Where it bends as a beam of its own, with second moments `s^4 / 12`, its
/// stiffness is `4 E s / 3`. Across three or more cells a linear strain in each is the more
/// accurate one of a shear mode; 0.9 of that of the beam is between both.
pub(crate) fn stiffness(solid: &Solid, size: f64) -> [f64; 3] {
    let (young, poisson) = (
        f64::from(solid.young_modulus),
        f64::from(solid.poisson_ratio),
    );
    let volume = size * size * size;
    [
        young / (1.0 + poisson) * volume,
        young / (1.0 - 2.0 * poisson) * volume,
        1.2 * young * size,
    ]
}
