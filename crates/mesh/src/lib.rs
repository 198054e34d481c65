#![doc = include_str!("../README.md")]

mod box_scan;
mod bucket_sort;
mod bvh;
#[cfg(feature = "io")]
mod check;
mod components;
mod delta;
mod edit;
pub mod geometry;
mod history;
mod ids;
#[cfg(feature = "io")]
mod io;
mod lineage;
mod measure;
mod partition;
mod pieces;
mod quality;
mod render_buffers;
#[cfg(feature = "serde")]
mod save;
mod shapes;
mod surface;
mod topology;

pub use box_scan::BoxScan;
pub use bvh::{Bvh, InvalidBvh, MotionBounds, MovingPoint, NearestPoint, RayHit, SurfaceEdits};
#[cfg(feature = "io")]
pub use check::{Defect, MeshReport, NotCuttable, RepairParams, RepairedCounts, check, check_with};
pub use delta::{AddedVertex, TopologyDelta, VertexOrigin};
pub use edit::{EdgeError, Edit, Undo, UndoError};
pub use geometry::{Aabb, Vec3};
pub use ids::{EdgeKey, HalfEdge, TriangleId, VertexId, index_u32};
#[cfg(feature = "gltf")]
pub use io::{AnimatedSurface, read_gltf, write_glb, write_glb_animation, write_glb_to};
#[cfg(feature = "io")]
pub use io::{
    MeshData, ParseError, ReadError, SourceLocation, Warning, WriteError, nearby_origin, read_mesh,
    read_obj, read_ply, read_stl, write_obj, write_obj_to, write_ply, write_stl,
};
pub use lineage::Lineage;
pub use partition::Partition;
pub use quality::{AngleStats, EdgeStats};
pub use render_buffers::{RenderBuffers, RenderParams};
#[cfg(feature = "serde")]
pub use save::{
    Archive, ArchiveError, FORMAT_VERSION, FileKind, ProgramVersion, read_archive, write_archive,
};
pub use shapes::{cube_sphere, cuboid, icosphere, sheet, torus};
pub use surface::{
    AttributeLengthError, Blend, Channel, ChannelError, CornerAttributes, CornerValues, Domain,
    InvalidSurface, MAX_WIDTH, Surface, TriangleCorners,
};
pub use topology::{InvalidTopology, Topology, TopologyError};
