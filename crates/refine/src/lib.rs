#![doc = include_str!("../README.md")]

mod edge_dictionary;
mod error;
mod harmonic;
mod holes;
mod params;
mod section_mesh;

pub use edge_dictionary::{EdgeDictionary, Flip};
pub use error::{HoleError, RefineError};
pub use harmonic::{HarmonicInterpolation, HarmonicScratch, interpolate_harmonic};
pub use holes::{FillReport, HoleParams, HoleReport, fill_hole, fill_holes};
pub use params::{ParseLevelError, RefineParams, RefinementLevel};
pub use section_mesh::{
    InvalidSectionMesh, Section, SectionMesh, SectionMeshParams, SectionMeshQuality,
    SectionMeshReport, SectionMeshScratch, SectionMeshSize, SteinerPoint, triangulate_section,
};
