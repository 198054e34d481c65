//! Contacts and colliders on the GPU match the CPU bit for bit while they come and go.

use incise_mesh::{Surface, TriangleId, VertexId};
use incise_models::{Model, build_model};
use incise_pbd_gpu::{
    Collider, Contact, ContactKind, Context, FrictionAnchor, GpuBackend, LoadRatio, Material,
    MovingCollider, Schedule, Solver, SolverParams, SupportedSide, Volume,
};
use incise_test_support::cpu_gpu_pair::{CpuGpuPair, with_most_features};
use incise_test_support::random::Random;

const CARRIED: [SupportedSide; 4] = [
    SupportedSide::Neither,
    SupportedSide::First,
    SupportedSide::Second,
    SupportedSide::Upper,
];

/// Returns random contacts, in which one vertex has more contacts than there are colors.
fn contacts(surface: &Surface, random: &mut Random, count: usize) -> Vec<Contact> {
    let topology = surface.topology();
    let vertices: Vec<_> = topology.vertices().collect();
    let triangles: Vec<TriangleId> = topology.triangles().collect();
    let mut out = Vec::new();
    while out.len() < count {
        let v = vertices[if random.below(2) == 0 {
            3
        } else {
            random.below(vertices.len())
        }];
        let corners = topology.triangle(triangles[random.below(triangles.len())]);
        let mut part = || random.fraction();
        let (a, b) = (part() / 2.0, part() / 2.0);
        let normal = [part() - 0.5, part() - 0.5, part() - 0.5];
        let norm = normal.iter().map(|c| c * c).sum::<f32>().sqrt();
        let normal = normal.map(|c| c / norm);
        let [p, q, r] = corners;
        let contact = match random.below(4) {
            0 => Contact::plane(v, normal, random.fraction() - 0.5),
            1 => Contact::edge_edge([[v, p], [q, r]], normal, 0.05 * a),
            2 => Contact {
                kind: ContactKind::VertexPoint,
                ..Contact::vertex_face(v, corners, 0.05 * b)
            },
            _ => Contact::vertex_face(v, corners, 0.05 * b),
        };
        if !corners.contains(&v) && norm > 0.1 {
            out.push(Contact {
                gap_rate: match contact.kind {
                    ContactKind::Plane => 0.1 * random.fraction(),
                    _ => 0.0,
                },
                friction: random.fraction(),
                carried: CARRIED[random.below(4)],
                held: (random.below(2) == 0).then(|| FrictionAnchor {
                    weights: [1.0, -a, -b, a + b - 1.0],
                    at: normal.map(|c| 0.01 * c),
                }),
                ..contact
            });
        }
    }
    out
}

/// Returns the colliders of a frame: none, or one of each kind, all within a ball of 0.5 m.
fn colliders(frame: u32) -> Vec<MovingCollider> {
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
    let count = [0, 4, 4, 2, 1, 0][frame as usize % 6];
    // At rest in the first half.
    let speed = if frame < 6 { 0.0 } else { 0.7 };
    let list = all.into_iter().take(count);
    list.map(|start| MovingCollider {
        start,
        velocity: [speed, -speed, 0.3 * speed],
    })
    .collect()
}

/// Contacts and colliders of every kind, and a state that is collected late.
pub(crate) fn to_the_bit(context: Context) {
    equal(context.clone(), Model::Sphere80, Schedule::WholeBody);
    equal(context.clone(), Model::Sphere768, Schedule::Patches);
    later_contacts_stay(context);
}

fn equal(context: Context, model: Model, schedule: Schedule) {
    let mut gpu = GpuBackend::from_context(context).expect("a device");
    let (material, params) = with_most_features();
    let mut random = Random::new(5);
    // Crushed to less than half: it regains its volume faster in impacts.
    let material = Material {
        volume: Some(Volume::default()),
        ..material
    };
    let mut surface = build_model(model);
    surface.positions_mut().iter_mut().for_each(|p| p[1] *= 0.3);
    let mut twin = CpuGpuPair::add(&mut gpu, surface, &material, schedule);
    for frame in 0..12 {
        let iterations = 1 + frame % 2;
        let params = SolverParams {
            iterations,
            ..params
        };
        // None at first and in between, then more than there was room for.
        let count = [0, 5, 40, 0, 200, 3][frame as usize % 6];
        let mut list = contacts(&twin.on_cpu, &mut random, count);
        // One round, eight and 24.
        let [closing, load] = [[0.0, 0.0], [100.0, 0.0], [0.0, 1e9]][frame as usize % 3];
        let press = LoadRatio { load, closing };
        list.iter_mut().for_each(|c| c.press = press);
        twin.cpu.set_contacts(&list).expect("vertices of the body");
        twin.solver
            .set_contacts(&list)
            .expect("vertices of the body");
        let list = colliders(frame);
        twin.cpu.set_colliders(&list).expect("valid colliders");
        twin.solver.set_colliders(&list).expect("valid colliders");
        twin.step(&mut gpu, &params);
        let projected = twin.cpu.stats().contact_projections;
        assert_eq!(projected > 0, count > 0, "{projected} of {count}");
        twin.assert_equal(&mut gpu, &format!("in frame {frame}"));
        let [expected, found] = [&twin.cpu, &twin.solver].map(held);
        assert_eq!(found, expected, "contacts of frame {frame}");
        assert!(count < 200 || !found.is_empty(), "none of {count} is held");
    }
}

/// Returns where friction held the contacts of a solver.
fn held(solver: &Solver) -> Vec<([VertexId; 4], FrictionAnchor)> {
    solver.contacts().held().collect()
}

/// A state that is collected late does not replace contacts that were set meanwhile.
fn later_contacts_stay(context: Context) {
    let mut gpu = GpuBackend::from_context(context).expect("a device");
    let (material, params) = with_most_features();
    let mut random = Random::new(6);
    let model = build_model(Model::Sphere80);
    let mut twin = CpuGpuPair::add(&mut gpu, model, &material, Schedule::WholeBody);
    gpu.prefetch(twin.body).expect("a known body");
    for _ in 0..2 {
        let list = contacts(&twin.on_cpu, &mut random, 40);
        let list: Vec<_> = list
            .into_iter()
            .map(|c| Contact { held: None, ..c })
            .collect();
        twin.cpu.set_contacts(&list).expect("vertices of the body");
        twin.solver
            .set_contacts(&list)
            .expect("vertices of the body");
        twin.step(&mut gpu, &params);
    }
    while !(gpu.collect(twin.body, &mut twin.on_gpu, &mut twin.solver)).expect("a state") {}
    assert!(held(&twin.solver).is_empty(), "contacts of the first frame");
    twin.assert_equal(&mut gpu, "after the second frame");
    assert_eq!(held(&twin.solver), held(&twin.cpu), "of the last frame");
}
