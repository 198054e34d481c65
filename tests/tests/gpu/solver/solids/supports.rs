//! Pins and colliders of solids.

use super::{PARAMS, assert_equal, twins};
use incise_mesh::VertexId;
use incise_pbd_gpu::{Collider, Context, GpuBackend, GpuError, MovingCollider};
use incise_test_support::cpu_gpu_pair::DT;

/// Pins of one end that move, come and go.
pub(super) fn on_pins(context: &Context) {
    let mut gpu = GpuBackend::from_context(context.clone()).expect("a device");
    for (i, mut twin) in twins(&mut gpu).into_iter().enumerate() {
        let first: Vec<VertexId> = (twin.on_cpu.topology().vertices()).take(7).collect();
        let mut targets = Vec::new();
        for frame in 0..8_u16 {
            if frame == 2 {
                twin.read(&mut gpu);
                for &v in &first {
                    twin.edit(|surface, solver| solver.pin(surface, v).expect("a vertex"));
                    targets.push(twin.on_cpu.positions()[v.index()]);
                }
                twin.update(&mut gpu);
            }
            if frame == 6 {
                twin.read(&mut gpu);
                twin.edit(|surface, solver| solver.unpin(surface, first[3]).expect("pinned"));
                twin.update(&mut gpu);
            }
            if (3..6).contains(&frame) {
                for (v, [x, y, z, _]) in first.iter().zip(&targets) {
                    let to = [*x, y + 0.01 * f32::from(frame), *z];
                    for solver in [&mut twin.cpu, &mut twin.solver] {
                        solver.set_pin_target(*v, to).expect("pinned");
                    }
                }
            }
            twin.step(&mut gpu, &PARAMS);
            if frame != 4 {
                assert_equal(
                    &mut twin,
                    &mut gpu,
                    &format!("of body {i} in frame {frame}"),
                );
            }
        }
        gpu.remove(twin.body);
    }
}

/// The ground, and a ball, a capsule and a box that move.
fn colliders(frame: u16) -> Vec<MovingCollider> {
    let speed = if frame < 4 { 0.0 } else { 1.0 };
    let all = [
        Collider::Plane {
            point: [0.0, -0.31, 0.0],
            normal: [0.1, 1.0, 0.0],
        },
        Collider::Sphere {
            center: [0.6, 0.0, 0.1],
            radius: 0.25,
        },
        Collider::Capsule {
            ends: [[-0.5, -0.5, 0.5], [-0.5, 0.5, 0.4]],
            radius: 0.2,
        },
        Collider::Box {
            center: [0.0, 0.1, -0.6],
            half: [0.3, 0.1, 0.35],
            axes: [[1.0, 0.2, 0.0], [0.0, 1.0, 0.5]],
        },
    ];
    let count = [1, 1, 0, 1, 4, 4, 2, 0][usize::from(frame) % 8];
    let list = all.into_iter().take(count);
    list.map(|start| MovingCollider {
        start,
        velocity: [0.0, 0.2 * speed, 0.3 * speed],
    })
    .collect()
}

/// Colliders of every kind, and pins between them.
pub(super) fn on_colliders(context: &Context) {
    let mut gpu = GpuBackend::from_context(context.clone()).expect("a device");
    let mut met = 0;
    for (i, mut twin) in twins(&mut gpu).into_iter().enumerate() {
        for frame in 0..8 {
            if frame == 5 {
                twin.read(&mut gpu);
                twin.edit(|surface, solver| solver.pin(surface, VertexId(3)).expect("a vertex"));
                twin.update(&mut gpu);
            }
            let list = colliders(frame);
            for solver in [&mut twin.cpu, &mut twin.solver] {
                solver.set_colliders(&list).expect("valid colliders");
            }
            let falling = twin.cpu.momentum()[1];
            twin.step(&mut gpu, &PARAMS);
            met += u32::from(twin.cpu.momentum()[1] > falling);
            assert_equal(
                &mut twin,
                &mut gpu,
                &format!("of body {i} in frame {frame}"),
            );
        }
        gpu.remove(twin.body);
    }
    assert!(met > 3, "colliders push the bodies");
}

/// A solid with more colliders than some adapters have loop iterations for.
pub(super) fn many_colliders(gpu: &mut GpuBackend) {
    let mut twin = twins(gpu).swap_remove(1);
    let ball = Collider::Sphere {
        center: [0.0, 50.0, 0.0],
        radius: 0.1,
    };
    let still = MovingCollider {
        start: ball,
        velocity: [0.0; 3],
    };
    (twin.solver.set_colliders(&[still; 200])).expect("valid colliders");
    let step = gpu.step([(twin.body, &mut twin.solver)], DT, &PARAMS);
    let is_refused = matches!(step, Err(GpuError::LoopsTooShort { .. }));
    assert!(is_refused || step.is_ok(), "{step:?}");
    assert_eq!(
        is_refused,
        gpu.adapter().name.contains("llvmpipe"),
        "its loops end early"
    );
    gpu.remove(twin.body);
}
