//! What the device was asked to do.

/// How a body's step is cut into dispatches.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Schedule {
    /// One workgroup runs all substeps of a frame, with the displacements in its own memory. All such
    /// bodies share one dispatch.
    WholeBody,
    /// One dispatch a color, over all such bodies; small colors and the overflow share one.
    Colors,
    /// As [`Schedule::Colors`] for constraints between patches; those within the patches of a layer
    /// take one dispatch, with a patch's vertices in a workgroup's memory. For bodies made by
    /// [`Solver::with_patches`](crate::Solver::with_patches).
    Patches,
}

impl Schedule {
    /// A name for tables.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::WholeBody => "whole-body",
            Self::Colors => "colors",
            Self::Patches => "patches",
        }
    }
}

/// Device memory of all bodies. Room is made geometrically and kept: that of a removed body goes to the
/// next ones.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct GpuMemory {
    /// Bytes of the buffers that bodies lie in.
    pub reserved: u64,
    /// Bytes of these that bodies have, room for edits included: a quarter of what they hold, and 32
    /// elements a vertex range, color and patch.
    pub rented: u64,
}

/// What the device was asked to do by the last step, and since the one before it.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct GpuStats {
    /// Bodies stepped under [`Schedule::WholeBody`].
    pub whole_bodies: u32,
    /// Bodies stepped under [`Schedule::Colors`].
    pub color_bodies: u32,
    /// Bodies stepped under [`Schedule::Patches`].
    pub patch_bodies: u32,
    /// Dispatches of the step.
    pub dispatches: u32,
    /// Stretch constraints projected by the step.
    pub stretch_projections: u64,
    /// Bending constraints projected by the step.
    pub bending_projections: u64,
    /// Struts projected by the step.
    pub strut_projections: u64,
    /// Volume constraints projected by the step.
    pub volume_projections: u64,
    /// Kernels compiled since the last step, for this one included: each when a body first needs it.
    pub kernels_compiled: u32,
    /// Bytes sent to the device for edits and parameters since the last step, those of this step
    /// included.
    pub bytes_uploaded: u64,
    /// Bytes brought back from the device since the last step.
    pub bytes_read: u64,
    /// Whether the list of dispatches was made anew: topology, parameters or the choice of bodies
    /// changed.
    pub program_built: bool,
}
