//! Edits a torus and undoes the edit; then checks the mesh file named as argument.
//!
//! `cargo run -p incise-mesh --example edit_torus -- scan.ply`

#![expect(clippy::print_stdout, reason = "an example shows what it computes")]

use incise_mesh::{TriangleId, check, read_mesh, torus};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut body = torus(0.4, 0.15, 48, 24);
    let whole = body.clone();
    let mut edit = body.edit(); // dropped unfinished, it leaves no trace
    edit.remove_triangle(TriangleId(2));
    let (delta, undo) = edit.finish(); // what changed, for solvers and BVHs, and its undo
    assert!(delta.vertices_removed.is_empty(), "none is left idle");
    assert_eq!(body.topology().boundary_loops().len(), 1, "a hole");
    undo.revert(&mut body)?;
    assert_eq!(body, whole, "to the bit");

    let topology = body.topology();
    let (v, e, f) = (
        topology.vertex_count(),
        topology.edges().count(),
        topology.triangle_count(),
    );
    println!("torus: {v} vertices - {e} edges + {f} triangles = 0, for its handle");
    assert_eq!(v + f, e, "Euler's formula");
    println!("{:.4} m^2, {:.4} m^3", body.area(), body.volume());
    if let Some(path) = std::env::args().nth(1) {
        let data = read_mesh(path.as_ref())?; // OBJ, PLY, STL, glTF
        let report = check(&data);
        println!("{path}: {} triangles", report.triangles);
        for warning in &report.warnings {
            println!("  {warning}");
        }
        let (surface, _) = data.into_surface()?; // or every defect, and where
        println!("  {:.4} m^3, can be cut", surface.volume());
    }
    Ok(())
}
