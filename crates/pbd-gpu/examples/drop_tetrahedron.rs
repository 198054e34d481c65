//! Drops a tetrahedron on the ground and prints where it is ten times a second.

use incise_mesh::Surface;
use incise_pbd_gpu::{Density, Material, Solver, SolverParams};

#[expect(clippy::print_stdout, reason = "an example shows what it computes")]
fn main() -> Result<(), Box<dyn std::error::Error>> {
    let corners = [
        [0.0, 1.0, 0.0],
        [1.0, 1.2, 0.0],
        [0.0, 2.0, 0.1],
        [0.1, 1.1, 1.0],
    ];
    let faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
    let mut body = Surface::from_triangles(&corners, &faces)?;
    let material = Material {
        density: Density::Volume(1000.0),
        ..Material::default()
    };
    let mut solver = Solver::new(&mut body, &material)?;
    let params = SolverParams {
        ground: Some(0.0),
        ..SolverParams::default()
    };
    println!("mass {:.1} kg", solver.total_mass());
    for frame in 0..120 {
        if frame % 6 == 0 {
            println!(
                "{:.1} s: lowest {:.3} m, {:.3} J, edges off by {:.1e}",
                f64::from(frame) / 60.0,
                body.bounds().min[1],
                solver.kinetic_energy(),
                solver.stretch_error(&body)
            );
        }
        solver.step(&mut body, 1.0 / 60.0, &params)?;
    }
    Ok(())
}
