//! Contacts and colliders on the device are those on the CPU, to the bit, as they come and go.

#[path = "common/gpu.rs"]
mod gpu;
#[path = "common/twin.rs"]
mod twin;

use gpu::{Needs, trial};
use incise_mesh::{Model, Surface, TriangleId, build_model};
use incise_pbd_gpu::{Above, Collider, Contact, Context, GpuBackend, Schedule, SolverParams};
use std::process::ExitCode;
use twin::{Dice, SCHEDULES, Twin, busy};

/// So many contacts anywhere, whether it makes sense or not; some have more neighbors than there are colors.
fn contacts(surface: &Surface, dice: &mut Dice, count: usize) -> Vec<Contact> {
    let topology = surface.topology();
    let vertices: Vec<_> = topology.vertices().collect();
    let triangles: Vec<TriangleId> = topology.triangles().collect();
    let mut out = Vec::new();
    while out.len() < count {
        let v = vertices[if dice.below(2) == 0 {
            3
        } else {
            dice.below(vertices.len())
        }];
        let corners = topology.triangle(triangles[dice.below(triangles.len())]);
        let mut part = || dice.part();
        let (a, b) = (part() / 2.0, part() / 2.0);
        let normal = [part() - 0.5, part() - 0.5, part() - 0.5];
        let norm = normal.iter().map(|c| c * c).sum::<f32>().sqrt();
        let above = if part() < 0.25 {
            Above::Plane {
                height: part() - 0.5,
            }
        } else {
            Above::Triangle {
                corners,
                weights: [a, b, 1.0 - a - b],
            }
        };
        if !corners.contains(&v) && norm > 0.1 {
            out.push(Contact {
                vertex: v,
                above,
                normal: normal.map(|c| c / norm),
                gap: 0.02 * part(),
                rise: 0.1 * part(),
            });
        }
    }
    out
}

/// One of each kind, in some frames; all of them reach into a ball of 0.5 m.
fn colliders(frame: u32) -> Vec<Collider> {
    let all = [
        Collider::Plane {
            point: [0.0, -0.45, 0.0],
            normal: [0.1, 1.0, 0.0],
        },
        Collider::Sphere {
            center: [0.6, 0.0, 0.1],
            radius: 0.2,
        },
        Collider::Capsule {
            ends: [[-0.5, -0.5, 0.5], [-0.5, 0.5, 0.4]],
            radius: 0.15,
        },
        Collider::Box {
            center: [0.0, 0.1, -0.6],
            half: [0.3, 0.1, 0.2],
            axes: [[1.0, 0.2, 0.0], [0.0, 1.0, 0.5]],
        },
    ];
    all[..[0, 4, 4, 2, 1, 0][frame as usize % 6]].to_vec()
}

fn equal(context: Context, model: Model, schedule: Schedule) {
    let mut gpu = GpuBackend::on(context).expect("a device");
    let (material, params) = busy();
    let mut dice = Dice::new(5);
    let mut twin = Twin::add(&mut gpu, build_model(model), &material, schedule);
    for frame in 0..12 {
        let iterations = 1 + frame % 2;
        let params = SolverParams {
            iterations,
            ..params
        };
        // None at first and in between, then more than there was room for.
        let count = [0, 5, 40, 0, 200, 3][frame as usize % 6];
        let list = contacts(&twin.on_cpu, &mut dice, count);
        twin.cpu.set_contacts(&list).expect("vertices of the body");
        twin.solver
            .set_contacts(&list)
            .expect("vertices of the body");
        let list = colliders(frame);
        twin.cpu.set_colliders(&list).expect("sound ones");
        twin.solver.set_colliders(&list).expect("sound ones");
        twin.step(&mut gpu, &params);
        let projected = twin.cpu.stats().contact_projections;
        assert_eq!(projected > 0, count > 0, "{projected} of {count}");
        twin.assert_equal(&mut gpu, &format!("in frame {frame}"));
    }
}

fn main() -> ExitCode {
    let mut trials = Vec::new();
    for model in [Model::Sphere80, Model::Sphere768] {
        for schedule in SCHEDULES {
            let name = format!("{} by {}", model.name(), schedule.name());
            trials.push(trial(&name, Needs::Strict, move |context| {
                equal(context, model, schedule);
            }));
        }
    }
    gpu::run(trials)
}
