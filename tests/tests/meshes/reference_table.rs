//! Reads the table of 231 plane cuts with the results of an independent boolean library.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Returns the folder of meshes and tables beside the workspace, which may not exist.
pub(crate) fn shared_folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared")
}

/// Returns the files of a folder in the order of their names; none without the folder.
pub(crate) fn files(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let mut out: Vec<PathBuf> = entries.map(|entry| entry.path()).collect();
    out.sort_unstable();
    out
}

/// A row of the table: the plane `normal . x = d`, then results of the positive and negative side.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Reference {
    /// Index of the plane among those of the mesh.
    pub(crate) plane: usize,
    /// Normal of any length.
    pub(crate) normal: [f64; 3],
    /// Offset of the plane, scaled by the length of the normal.
    pub(crate) d: f64,
    /// Volume [m^3].
    pub(crate) volume: [f64; 2],
    /// Area of the section [m^2].
    pub(crate) section_area: f64,
    /// Number of closed surfaces.
    pub(crate) components: [usize; 2],
    /// Genus: vertices - edges + triangles = 2 - 2 genus.
    pub(crate) genus: [i64; 2],
}

/// Returns the rows by path of the mesh in [`shared_folder`], or none without the table.
pub(crate) fn reference_cuts() -> BTreeMap<String, Vec<Reference>> {
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
