//! Errors of lattices.

use incise_mesh::TriangleId;

/// Why a surface gets no lattice.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LatticeError {
    /// The surface has a boundary, or nothing inside.
    #[error(
        "the surface is open at triangle {triangle} and has no inside; fill its holes, or take the \
         material of a sheet, such as cloth or shell"
    )]
    Open {
        /// A triangle at the boundary.
        triangle: TriangleId,
    },
    /// The surface has no triangles or no volume.
    #[error("the surface encloses no volume; check its orientation")]
    NoVolume,
    /// The cell size is not a positive number.
    #[error("the cell size is {size} m; it must be a positive number")]
    CellSize {
        /// The cell size \[m\].
        size: f64,
    },
    /// The body has more cells than allowed.
    #[error("cells of {size} m are {across} across the body; at most {limit} are possible")]
    TooManyCells {
        /// The cell size \[m\].
        size: f64,
        /// The number of cells along the longest axis.
        across: u32,
        /// The largest possible number.
        limit: u32,
    },
}

/// Why a lattice that was read with serde is refused.
#[cfg(feature = "serde")]
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum InvalidLattice {
    /// The cells have no size, or there are more of them than lattices may have.
    #[error("the cells have an invalid size, place or number; load a file that incise has saved")]
    Grid,
    /// An array does not match the surface or another array.
    #[error("the {array} of the lattice do not match its surface; load both as they were saved")]
    Array {
        /// The array.
        array: &'static str,
    },
    /// Triangles lie in far more cells than those of a body do.
    #[error("the triangles lie in too many cells of the lattice; build it again with larger cells")]
    TooManyEntries,
}
