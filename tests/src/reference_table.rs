//! Reads a table of 231 plane cuts with the results of an independent boolean library.
//!
//! Table and meshes are in a folder beside the workspace.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Returns the folder of meshes and tables beside the workspace, which may not exist.
#[must_use]
pub fn shared_folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared")
}

/// A row of the table: the plane `normal . x = d`, then results of the positive and negative side.
#[derive(Debug, Clone, Copy)]
pub struct Reference {
    /// Index of the plane among those of the mesh.
    pub plane: usize,
    /// Normal of any length.
    pub normal: [f64; 3],
    /// Offset of the plane, scaled by the length of the normal.
    pub d: f64,
    /// Volume [m^3].
    pub volume: [f64; 2],
    /// Area of the section [m^2].
    pub section_area: f64,
    /// Number of closed surfaces.
    pub components: [usize; 2],
    /// Genus: vertices - edges + triangles = 2 - 2 genus.
    pub genus: [i64; 2],
}

/// Returns the rows by path of the mesh in [`shared_folder`], or none without the table.
///
/// # Panics
/// If the table is malformed.
#[must_use]
pub fn reference_cuts() -> BTreeMap<String, Vec<Reference>> {
    let table = std::fs::read_to_string(shared_folder().join("reference/cuts.csv"));
    let mut out: BTreeMap<String, Vec<Reference>> = BTreeMap::new();
    for line in table.unwrap_or_default().lines().skip(1) {
        let cells: Vec<&str> = line.split(',').collect();
        let number = |i: usize| -> f64 { cells[i].parse().expect("a number") };
        let count = |i: usize| -> usize { cells[i].parse().expect("a count") };
        let genus = |i: usize| -> i64 { cells[i].parse().expect("a genus") };
        out.entry(cells[0].to_owned()).or_default().push(Reference {
            plane: count(1),
            normal: [number(2), number(3), number(4)],
            d: number(5),
            volume: [number(6), number(7)],
            section_area: number(8),
            components: [count(9), count(10)],
            genus: [genus(11), genus(12)],
        });
    }
    out
}
