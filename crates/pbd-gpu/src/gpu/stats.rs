//! Schedules, memory use and statistics of the GPU backend.

/// Division of a body's step into dispatches.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Schedule {
    /// One workgroup runs all substeps of a frame, with displacements in workgroup memory.
    ///
    /// All such bodies share one dispatch.
    WholeBody,
    /// One dispatch per pass over all such bodies, for bodies that do not fit in a workgroup.
    ///
    /// A layer of patches has one dispatch, with the vertices of a patch in workgroup memory.
    /// Constraints between patches have one dispatch per color, and so have all constraints of a
    /// body that [`Solver::with_patches`](crate::Solver::with_patches) left undivided.
    Patches,
}

impl Schedule {
    /// Returns the name for tables.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::WholeBody => "whole-body",
            Self::Patches => "patches",
        }
    }
}

/// GPU memory of all bodies. Buffers grow geometrically and never shrink.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct GpuMemory {
    /// Size of the buffers \[bytes\].
    pub reserved: u64,
    /// Allocated part of the buffers \[bytes\], including slack for edits.
    ///
    /// The slack is a quarter, plus 32 elements per vertex range, color and patch.
    pub rented: u64,
}

/// Work of the last step, and of edits and readbacks since the step before.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct GpuStats {
    /// Bodies stepped under [`Schedule::WholeBody`].
    pub whole_bodies: u32,
    /// Bodies stepped under [`Schedule::Patches`].
    pub patch_bodies: u32,
    /// Dispatches of the step.
    pub dispatches: u32,
    /// Stretch constraints projected by the step.
    pub stretch_projections: u64,
    /// Bending constraints projected by the step.
    pub bending_projections: u64,
    /// Interior springs projected by the step.
    pub interior_spring_projections: u64,
    /// Volume constraints projected by the step.
    pub volume_projections: u64,
    /// Cells of solids projected by the step.
    pub cell_projections: u64,
    /// Kernels compiled since the last step, including those for this step.
    pub kernels_compiled: u32,
    /// Bytes uploaded since the last step, including those of this step.
    pub bytes_uploaded: u64,
    /// Bytes read back since the last step.
    pub bytes_read: u64,
    /// True if the list of dispatches was rebuilt, after a change of topology, parameters or
    /// bodies.
    pub program_built: bool,
}
