//! 231 plane cuts of which an independent boolean library says what comes out. The table lies in a folder
//! beside the workspace, like the meshes.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// The folder of meshes and tables beside the workspace; it need not be there.
#[must_use]
pub fn shared_folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared")
}

/// A row of the table: the plane `normal . x = d`, then the positive and the negative side.
#[derive(Debug, Clone, Copy)]
pub struct Reference {
    /// The number of the plane among those of its mesh.
    pub plane: usize,
    /// Of any length.
    pub normal: [f64; 3],
    /// Along the normal, times its length.
    pub d: f64,
    /// \[m^3\].
    pub volume: [f64; 2],
    /// \[m^2\].
    pub section_area: f64,
    /// Closed surfaces.
    pub components: [usize; 2],
    /// Such that vertices - edges + triangles are 2 - 2 genus.
    pub genus: [i64; 2],
}

/// The rows by mesh, whose path is relative to [`shared_folder`]; nothing without the table.
///
/// # Panics
/// When the table is there and is not as it should be.
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
