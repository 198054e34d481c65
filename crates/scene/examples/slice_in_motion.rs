//! Cuts a falling sphere, drops the pieces onto the ground and prints how they come to rest.
//!
//! `cargo run -p incise-scene --example slice_in_motion`

#![expect(clippy::print_stdout, reason = "an example prints its results")]

use incise_mesh::icosphere;
use incise_pbd_gpu::{Collider, Material, Volume};
use incise_scene::{ContactParams, Scene, SceneError, SceneParams};

fn main() -> Result<(), SceneError> {
    let mut scene = Scene::new(SceneParams::default());
    let body = scene.add_body(icosphere(3, 0.5), &Material::default())?;
    let blade = scene.add_blade([[-2.0, 0.1, -2.0], [-2.0, 0.1, 2.0]]);
    scene.step()?;
    scene.move_blade(blade, [[2.0, 0.1, -2.0], [2.0, 0.1, 2.0]])?;
    println!("{} cut", scene.step()?.cuts);
    println!("{} pieces", scene.body(body)?.pieces().len());

    let params = SceneParams {
        contacts: Some(ContactParams::default()),
        ..SceneParams::default()
    };
    // A volume constraint keeps the pieces in shape.
    let material = Material {
        volume: Some(Volume::default()),
        ..Material::default()
    };
    let mut scene = Scene::new(params);
    // The center starts 1.5 m above the ground.
    scene.colliders.push(Collider::ground(-1.5));
    let body = scene.add_body(icosphere(3, 0.5), &material)?;
    let blade = scene.add_blade([[-2.0, 0.1, -2.0], [-2.0, 0.1, 2.0]]);
    for frame in 0..120 {
        if frame == 8 {
            scene.move_blade(blade, [[2.0, 0.1, -2.0], [2.0, 0.1, 2.0]])?;
        }
        let stats = scene.step()?;
        if stats.cuts > 0 {
            println!("frame {frame}: {} triangles hit", stats.hit_triangles);
        }
    }
    let surface = scene.body(body)?.surface();
    for (piece, volume) in surface.piece_volumes().iter().enumerate() {
        println!("piece {piece}: {volume:.4} m^3");
    }
    let bounds = surface.bounds();
    println!("after 2 s the lowest point is at {:.4} m", bounds.min[1]);
    Ok(())
}
