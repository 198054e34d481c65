//! A frame of touching bodies and their render buffers allocates nothing once warm.

use incise_mesh::{RenderBuffers, RenderParams, Surface, cube_sphere};
use incise_pbd_gpu::{Collider, SolverParams};
use incise_scene::{ContactParams, Scene, SceneParams};
use incise_test_support::materials::firm;
use incise_test_support::process::in_own_process;
use stats_alloc::{INSTRUMENTED_SYSTEM, StatsAlloc};
use std::alloc::System;
use std::num::NonZeroUsize;

#[global_allocator]
static GLOBAL: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

fn allocations() -> usize {
    let stats = GLOBAL.stats();
    stats.allocations + stats.reallocations
}

fn block(y: f32) -> Surface {
    let mut surface = cube_sphere(4, 1.0);
    let to_block = |p: [f32; 3]| {
        let largest = p.iter().fold(0.0_f32, |a, c| a.max(c.abs()));
        let [px, py, pz] = p.map(|c| 0.2 * c / largest);
        [px, py + y, pz]
    };
    for p in surface.rest_positions_mut() {
        *p = to_block(*p);
    }
    for p in surface.positions_mut() {
        let [x, y, z] = to_block([p[0], p[1], p[2]]);
        *p = [x, y, z, p[3]];
    }
    surface
}

#[test]
fn touching_bodies_are_stepped_without_allocation() {
    let name = "allocations::touching_bodies_are_stepped_without_allocation";
    in_own_process(name, step_touching_bodies);
}

fn step_touching_bodies() {
    let mut scene = Scene::new(SceneParams {
        solver: SolverParams {
            threads: NonZeroUsize::new(1),
            ..SolverParams::default()
        },
        contacts: Some(ContactParams::default()),
        sleep: None,
        ..SceneParams::default()
    });
    scene.colliders.push(Collider::ground(0.0));
    let mut buffers = Vec::new();
    for i in 0_u8..4 {
        let body = block(0.21 + 0.42 * f32::from(i));
        buffers.push(RenderBuffers::new(&body, RenderParams::default()));
        scene.add_body(body, &firm(0.7, 1.0)).unwrap();
    }
    let ids: Vec<_> = scene.bodies().collect();
    for _ in 0..300 {
        scene.step().unwrap();
    }
    // The test harness may allocate once meanwhile, frames would in every window.
    let mut contacts = 0;
    let windows: Vec<usize> = (0..4)
        .map(|_| {
            let before = allocations();
            for _ in 0..20 {
                contacts += scene.step().unwrap().contacts;
                for (&id, buffers) in ids.iter().zip(&mut buffers) {
                    scene.update_render_buffers(id, buffers).unwrap();
                }
            }
            allocations() - before
        })
        .collect();
    assert!(contacts > 1000, "{contacts} contacts");
    assert!(windows.contains(&0), "{windows:?} allocations in 20 frames");
}
