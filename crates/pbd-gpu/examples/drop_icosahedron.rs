//! Drops an icosahedron on the ground and prints height, energy and edge error ten times a second.
//!
//! `cargo run -p incise-pbd-gpu --example drop_icosahedron`

#![expect(clippy::print_stdout, reason = "an example shows what it computes")]

use incise_mesh::icosphere;
use incise_pbd_gpu::{Collider, Density, Material, Solver, SolverParams};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut body = icosphere(0, 0.5);
    let mut solver = Solver::new(&mut body, &Material::default())?;
    let ground = [Collider::ground(-2.0).into()];
    solver.set_colliders(&ground)?;
    let params = SolverParams::default();
    solver.step(&mut body, 1.0 / 60.0, &params)?; // a frame
    assert!(body.bounds().center().y < 0.0, "it falls");

    let mut heavier = icosphere(0, 0.5);
    let material = Material {
        density: Density::Volume(1000.0),
        ..Material::default()
    };
    let mut solver = Solver::new(&mut heavier, &material)?;
    solver.set_colliders(&ground)?;
    println!("mass {:.1} kg", solver.total_mass());
    for frame in 0..120 {
        if frame % 6 == 0 {
            println!(
                "{:.1} s: lowest {:.3} m, {:.3} J, edge error {:.1e}",
                f64::from(frame) / 60.0,
                heavier.bounds().min[1],
                solver.kinetic_energy(),
                solver.stretch_error(&heavier)
            );
        }
        solver.step(&mut heavier, 1.0 / 60.0, &params)?;
    }
    assert!(solver.stretch_error(&heavier) < 0.01, "it keeps its shape");
    Ok(())
}
