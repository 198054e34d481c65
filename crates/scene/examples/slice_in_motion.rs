//! Slices a sphere while it falls, lets the pieces fall onto the ground, and prints what the frame of the cut did and how the
//! pieces lie in the end.
//!
//! `cargo run -p incise-scene --example slice_in_motion`

#![expect(clippy::print_stdout, reason = "an example shows what it computes")]

use incise_mesh::{Model, build_model};
use incise_pbd_gpu::{Material, Volume};
use incise_scene::{ContactParams, Scene, SceneError, SceneParams};

fn main() -> Result<(), SceneError> {
    let mut scene = Scene::new(SceneParams::default());
    let body = scene.add_body(build_model(Model::Sphere768), &Material::default())?;
    let blade = scene.add_blade([[-2.0, 0.1, -2.0], [-2.0, 0.1, 2.0]]); // left of it
    scene.step()?;
    scene.move_blade(blade, [[2.0, 0.1, -2.0], [2.0, 0.1, 2.0]]); // and right of it
    println!("{:?}", scene.step()?);
    assert_eq!(scene.body(body).pieces().len(), 2, "in motion");

    let mut params = SceneParams {
        contacts: Some(ContactParams::default()),
        ..SceneParams::default()
    };
    // The sphere, of radius 0.5 m, begins 1 m above the ground, and its pieces keep their volumes.
    params.solver.ground = Some(-1.5);
    let material = Material {
        volume: Some(Volume::default()),
        ..Material::default()
    };
    let mut scene = Scene::new(params);
    let body = scene.add_body(build_model(Model::Sphere768), &material)?;
    let blade = scene.add_blade([[-2.0, 0.1, -2.0], [-2.0, 0.1, 2.0]]);
    for frame in 0..120 {
        if frame == 8 {
            scene.move_blade(blade, [[2.0, 0.1, -2.0], [2.0, 0.1, 2.0]]);
        }
        let stats = scene.step()?;
        if stats.cuts > 0 {
            println!("frame {frame}: {} triangles hit", stats.hits);
        }
    }
    let surface = scene.body(body).surface();
    for (piece, volume) in surface.piece_volumes().iter().enumerate() {
        println!("piece {piece}: {volume:.4} m^3");
    }
    let low = surface.bounds().min;
    println!("after 2 s the lowest point is at {:.4} m", low[1]);
    Ok(())
}
