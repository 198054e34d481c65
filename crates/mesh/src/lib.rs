//! Triangle surfaces for cutting.
//!
//! - [`Topology`]: who is whose neighbor, as a corner table with local edits.
//! - [`Surface`]: a topology with positions, rest positions, corner attributes and piece numbers,
//!   each in an array of its own.
//! - [`Edit`]: a local change in place that leaves no trace unless finished, and its [`Undo`].
//! - [`TopologyDelta`]: an edit as data, which solvers, search trees and renderers follow.
//!
//! ```
//! use incise_mesh::Surface;
//!
//! let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
//! let faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
//! let tetrahedron = Surface::from_triangles(&corners, &faces)?;
//! assert!(tetrahedron.topology().is_closed());
//! assert_eq!(tetrahedron.volume(), 1.0 / 6.0);
//! # Ok::<(), incise_mesh::TopologyError>(())
//! ```

mod check;
mod components;
mod delta;
mod edit;
pub mod geometry;
mod history;
mod ids;
mod io;
mod measure;
mod partition;
mod pieces;
mod quality;
mod shapes;
mod surface;
mod topology;

pub use check::{Defect, MeshReport, NotFit, check};
pub use delta::{AddedVertex, Origin, TopologyDelta};
pub use edit::{Edit, Undo, UndoError};
pub use geometry::{Aabb, Vec3};
pub use ids::{EdgeKey, HalfEdge, TriangleId, VertexId};
pub use io::{
    MeshData, ParseError, Place, ReadError, Warning, WriteError, read_gltf, read_mesh, read_obj,
    read_ply, read_stl, write_obj, write_ply,
};
pub use quality::{AngleStats, EdgeStats};
pub use shapes::{Model, build_model, cube_sphere, icosphere, torus};
pub use surface::{CornerAttributes, Surface};
pub use topology::{InvalidTopology, Topology, TopologyError};
