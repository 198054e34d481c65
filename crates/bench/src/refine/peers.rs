//! What other programs need to fill the same caps.

use super::row::Row;
use crate::columns;
use crate::report::measured;
use std::io::{self, Write};

/// What stands in the columns.
const LEGEND: &str = "\
Against those that refine: the plane through the middle, z = 1. ms: incise covers the section once for both lips, triangulation and refinement; MeshLib 3.1
(fill 2D and subdivide, less divide) and CGAL 5.5 (triangulate_and_refine_hole, less clip) fill both caps one by one. x: how many times faster
than the faster of the two; x one: than half of that, one of its caps. 5%, median: of the smallest angles of triangles, degrees.
Theirs were measured another day on this kind of machine, a core of a 2-thread Xeon, on meshes of the same names and counts: run them again for a claim.
They do not snap, incise does.";

/// What was measured of a program.
#[derive(Debug, Clone, Copy)]
struct Fill {
    /// To fill and refine, less to cut \[ms\].
    ms: f64,
    /// The 5th percentile and the median of the smallest angles of cap triangles \[degrees\].
    angles: [f64; 2],
}

/// Filling by others.
#[derive(Debug, Clone, Copy)]
struct Peers {
    model: &'static str,
    mesh_lib: Fill,
    cgal: Fill,
}

/// One core, quiet: medians of 15 or more runs for the bunny and the armadillo, the fastest run for the others
/// and for CGAL's clip.
const PEERS: [Peers; 5] = [
    peers(
        "Sphere768",
        [0.788 - 0.304, 7.28, 41.0],
        [7.53 - 2.59, 16.7, 39.8],
    ),
    peers(
        "Bunny",
        [1.18 - 0.55, 6.92, 42.4],
        [12.8 - 5.36, 22.0, 39.8],
    ),
    peers(
        "Octopus",
        [1.46 - 0.971, 5.18, 40.6],
        [14.1 - 7.49, 12.9, 40.1],
    ),
    peers(
        "Banana",
        [4.86 - 2.61, 11.5, 44.6],
        [39.2 - 13.1, 24.5, 40.4],
    ),
    peers(
        "Armadillo",
        [12.0 - 7.6, 21.1, 44.4],
        [81.5 - 65.9, 27.1, 40.5],
    ),
];

const fn peers(model: &'static str, mesh_lib: [f64; 3], cgal: [f64; 3]) -> Peers {
    const fn fill([ms, low, middle]: [f64; 3]) -> Fill {
        Fill {
            ms,
            angles: [low, middle],
        }
    }
    Peers {
        model,
        mesh_lib: fill(mesh_lib),
        cgal: fill(cgal),
    }
}

/// The table, where one of the rows can be compared.
pub(super) fn print(rows: &[Row], out: &mut impl Write) -> io::Result<()> {
    let cells: Vec<[String; 12]> = rows.iter().filter_map(line).collect();
    if cells.is_empty() {
        return Ok(());
    }
    let names = [
        "model", "ms", "MeshLib", "CGAL", "x", "x one", "5%", "MeshLib", "CGAL", "median",
        "MeshLib", "CGAL",
    ];
    let cells: Vec<_> = [names.map(str::to_owned)]
        .into_iter()
        .chain(cells)
        .collect();
    write!(out, "\n{}", columns::columns(&cells, 1))?;
    writeln!(out, "{LEGEND}")
}

/// A row beside the same of others: only models from files are the ones they had.
fn line(row: &Row) -> Option<[String; 12]> {
    if row.planes != "middle" || row.level != 1.0 || row.covers == 0 || row.source == "built-in" {
        return None;
    }
    let Peers { mesh_lib, cgal, .. } = PEERS.iter().find(|peers| peers.model == row.model)?;
    let ms = row.triangulation_ms + row.refinement_ms;
    let times = mesh_lib.ms.min(cgal.ms) / ms;
    Some([
        row.model.clone(),
        measured(ms, 3),
        measured(mesh_lib.ms, 2),
        measured(cgal.ms, 2),
        measured(times, 1),
        measured(times / 2.0, 1),
        measured(row.angle_5, 1),
        measured(mesh_lib.angles[0], 1),
        measured(cgal.angles[0], 1),
        measured(row.angle_median, 1),
        measured(mesh_lib.angles[1], 1),
        measured(cgal.angles[1], 1),
    ])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_same_caps_are_compared() {
        let row = Row {
            model: "Bunny".to_owned(),
            source: "bunny_1500.obj".to_owned(),
            planes: "middle",
            level: 1.0,
            covers: 1,
            triangulation_ms: 0.05,
            refinement_ms: 0.055,
            ..Row::default()
        };
        let cells = line(&row).unwrap();
        // 1.18 - 0.55 ms are 6 times 0.105.
        assert_eq!(cells[..6], ["Bunny", "0.105", "0.63", "7.44", "6.0", "3.0"]);
        for other in [
            Row {
                model: "Sphere20".to_owned(),
                ..row.clone()
            },
            Row {
                source: "built-in".to_owned(),
                ..row.clone()
            },
            Row {
                planes: "seeded",
                ..row.clone()
            },
            Row {
                level: 2.0,
                ..row.clone()
            },
            Row { covers: 0, ..row },
        ] {
            assert!(line(&other).is_none(), "{other:?}");
        }
    }
}
