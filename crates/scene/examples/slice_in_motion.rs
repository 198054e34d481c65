//! Drops a sphere onto the ground, slices it while it falls, and prints what the frame of the cut
//! did, the pieces, and how low they lie in the end. A shell without pressure crumples on impact, so
//! volumes are those at the cut.
//!
//! `cargo run -p incise-scene --example slice_in_motion`

use incise_mesh::{Model, build_model};
use incise_pbd_gpu::{Material, SolverParams};
use incise_scene::{Scene, SceneError, SceneParams};

/// A blade's edge, level, left of the sphere and right of it \[m\].
const LEFT: [[f32; 3]; 2] = [[-2.0, 0.1, -2.0], [-2.0, 0.1, 2.0]];
const RIGHT: [[f32; 3]; 2] = [[2.0, 0.1, -2.0], [2.0, 0.1, 2.0]];

#[expect(clippy::print_stdout, reason = "an example shows what it computes")]
fn main() -> Result<(), SceneError> {
    let mut scene = Scene::new(SceneParams {
        // The sphere, of radius 0.5 m, begins 1 m above the ground.
        solver: SolverParams {
            ground: Some(-1.5),
            ..SolverParams::default()
        },
        ..SceneParams::default()
    });
    let body = scene.add_body(build_model(Model::Sphere768), &Material::default())?;
    let blade = scene.add_blade(LEFT);
    println!("volume {:.4} m^3", scene.body(body).surface().volume());
    for frame in 0..120 {
        if frame == 8 {
            scene.move_blade(blade, RIGHT);
        }
        let stats = *scene.step()?;
        if stats.cuts > 0 {
            println!("frame {frame}: {stats:#?}");
            let body = scene.body(body);
            let volumes = body.surface().piece_volumes();
            for piece in body.pieces() {
                println!("piece {piece}: {:.4} m^3", volumes[piece as usize]);
            }
        }
    }
    let low = scene.body(body).surface().bounds().min;
    println!("after 2 s the lowest point is at {:.4} m", low[1]);
    Ok(())
}
