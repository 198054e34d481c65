//! Triangle surfaces for cutting.
//!
//! - [`Topology`]: who is whose neighbor, as a corner table with local edits.
//! - [`Surface`]: a topology with positions, rest positions, corner attributes and piece numbers,
//!   each in an array of its own.
//! - [`Edit`]: a local change in place that leaves no trace unless finished, and its [`Undo`].
//! - [`TopologyDelta`]: an edit as data, which solvers, search trees and renderers follow.
//!
//! How `examples/edit_torus.rs` begins:
//!
//! ```
//! use incise_mesh::{TriangleId, check, read_mesh, torus};
//!
//! fn main() -> Result<(), Box<dyn std::error::Error>> {
//!     let mut body = torus(0.4, 0.15, 48, 24);
//!     let whole = body.clone();
//!     let mut edit = body.edit(); // dropped unfinished, it leaves no trace
//!     edit.remove_triangle(TriangleId(2));
//!     let (delta, undo) = edit.finish(); // what changed, for solvers and search trees, and the way back
//!     assert!(delta.vertices_removed.is_empty(), "none is left idle");
//!     assert_eq!(body.topology().boundary_loops().len(), 1, "a hole");
//!     undo.revert(&mut body)?;
//!     // and on
//! # Ok(())
//! }
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
