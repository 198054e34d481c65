//! Reads a mesh file and prints what it is; without a file it inspects one of the built-in models.
//!
//! `cargo run -p incise-mesh --example inspect_mesh -- bunny.obj`

use incise_mesh::{MeshData, Model, Surface, build_model, check, read_mesh};
use std::path::Path;

#[expect(clippy::print_stdout, reason = "an example shows what it computes")]
fn main() -> Result<(), Box<dyn std::error::Error>> {
    let surface = match std::env::args().nth(1) {
        Some(path) => {
            let data: MeshData = read_mesh(Path::new(&path))?;
            let report = check(&data);
            println!(
                "{path}: {} vertices, {} triangles, {}closed, {}manifold",
                report.vertices,
                report.triangles,
                if report.closed { "" } else { "not " },
                if report.manifold { "" } else { "not " },
            );
            let (surface, warnings) = data.into_surface()?;
            for warning in warnings {
                println!("repaired: {warning}");
            }
            surface
        }
        None => {
            println!("{}:", Model::Bunny.name());
            build_model(Model::Bunny)
        }
    };
    print(&surface);
    Ok(())
}

#[expect(clippy::print_stdout, reason = "an example shows what it computes")]
fn print(surface: &Surface) {
    let topology = surface.topology();
    println!(
        "{} particles, {} vertices as a renderer counts them, {} triangles, {} edges",
        topology.vertex_count(),
        surface.seam_split_vertices(),
        topology.triangle_count(),
        topology.edges().count()
    );
    let bounds = surface.bounds();
    println!("box {:?} to {:?} m", bounds.min, bounds.max);
    println!(
        "area {:.4} m^2, mean edge {:.4} m",
        surface.area(),
        surface.mean_edge_length()
    );
    for (piece, volume) in surface.piece_volumes().into_iter().enumerate() {
        println!("piece {piece}: {volume:.5} m^3");
    }
    // Neighbors are one array look-up away.
    let valence = |v| topology.outgoing_fan(v).count();
    if let Some(v) = topology.vertices().max_by_key(|&v| valence(v)) {
        println!("most neighbors: {v} with {}", valence(v));
    }
}
