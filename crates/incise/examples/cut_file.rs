//! Reads a mesh file, cuts it by a plane and writes each piece to a file of its own.
//!
//! `cargo run -p incise --example cut_file -- bunny.obj`; without a file it cuts a sphere.

#![expect(clippy::print_stdout, reason = "an example prints its results")]

use incise::prelude::*;
use std::path::PathBuf;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let path = match std::env::args_os().nth(1) {
        Some(path) => PathBuf::from(path),
        None => {
            let path = PathBuf::from("sphere.obj");
            write_obj(&path, &icosphere(3, 0.5))?;
            path
        }
    };
    let (mut surface, warnings) = read_mesh(&path)?.into_surface()?;
    for warning in warnings {
        println!("{}: {warning}", path.display());
    }
    let mut cutter = Cutter::new(&surface);
    let center = surface.bounds().center();
    let plane = Sweep::from_plane([0.0, 1.0, 0.2], center.y, &surface.bounds())?;
    let outcome = cutter.cut(&mut surface, &plane, &CutParams::default())?;
    println!(
        "{} triangles hit, {} in caps",
        outcome.report.hits,
        outcome.cap.len()
    );
    for (number, piece) in surface.extract_pieces() {
        let file = PathBuf::from(format!("piece_{number}.obj"));
        write_obj(&file, &piece)?;
        println!("{}", file.display());
    }
    Ok(())
}
