//! Two seconds of every built-in model with a cut in the middle, on the device as on the processor: to
//! the bit on a strict device under every schedule, within rounding on any other.

use incise_cut::Sweep;
use incise_mesh::geometry::round;
use incise_mesh::{Model, Surface, Vec3, VertexId, build_model};
use incise_pbd_gpu::{Context, Material, PatchParams, Schedule, SolverParams};
use incise_scene::{BackendChoice, BackendRequest, BodyId, Scene, SceneError, SceneParams};
use incise_tests::gpu::{Needs, run, trial};
use libtest_mimic::Trial;
use std::process::ExitCode;

const FRAMES: u32 = 120;
const CUT: u32 = 60;
/// Vertices that one workgroup of every device has room for: 16 KiB of three numbers each.
const ONE_WORKGROUP: usize = 1365;

fn main() -> ExitCode {
    let mut trials: Vec<Trial> = Vec::new();
    for model in Model::ALL {
        for schedule in [Schedule::WholeBody, Schedule::Colors, Schedule::Patches] {
            if schedule == Schedule::WholeBody && model.particles() > ONE_WORKGROUP {
                continue;
            }
            let name = format!("{}_by_{}_to_the_bit", model.name(), schedule.name());
            trials.push(trial(&name, Needs::Strict, move |context| {
                to_the_bit(context, model, schedule);
            }));
        }
        let name = format!("{}_within_rounding", model.name());
        trials.push(trial(&name, Needs::AnyDevice, move |context| {
            within_rounding(context, model);
        }));
    }
    run(trials)
}

/// Ten iterations, fewer of large models: a software device is slow, and frames and cuts tell more
/// than iterations do.
fn iterations(model: Model) -> u32 {
    match model {
        Model::Armadillo => 2,
        Model::Banana => 4,
        _ => 10,
    }
}

fn params(model: Model) -> SceneParams {
    SceneParams {
        // Hollow bodies cannot carry themselves, see the README: weightless, as in the table.
        solver: SolverParams {
            gravity: [0.0; 3],
            iterations: iterations(model),
            ..SolverParams::paper()
        },
        ..SceneParams::default()
    }
}

/// A scene on the device, and the same scene on the processor.
fn scenes(context: Context, model: Model, schedule: Schedule) -> [(Scene, BodyId); 2] {
    let request = BackendRequest {
        choice: BackendChoice::Gpu,
        ..BackendRequest::default()
    };
    let device = Scene::with_context(params(model), &request, context).expect("a device");
    [device, Scene::new(params(model))].map(|mut scene| {
        scene.force_schedule(Some(schedule));
        let id = add(&mut scene, model, schedule).expect("a model is sound");
        (scene, id)
    })
}

/// A body that turns and is squeezed.
fn add(scene: &mut Scene, model: Model, schedule: Schedule) -> Result<BodyId, SceneError> {
    let (surface, material) = (build_model(model), Material::default());
    let center = surface.bounds().center();
    let id = if schedule == Schedule::Patches {
        scene.add_body_with_patches(surface, &material, &PatchParams::default())?
    } else {
        scene.add_body(surface, &material)?
    };
    let (solver, surface) = scene.edit(id)?.solver_mut();
    let vertices: Vec<VertexId> = surface.topology().vertices().collect();
    for v in vertices {
        let r = surface.position(v) - center;
        let velocity = Vec3::new(0.5 * r.z + 0.3, -0.25 * r.y, -0.5 * r.x);
        solver.set_velocity(v, round(velocity))?;
    }
    Ok(id)
}

/// Slices the body through its middle.
fn slice(scene: &mut Scene, id: BodyId) -> Result<(), SceneError> {
    scene.read(id)?;
    let bounds = scene.body(id).surface().bounds();
    let normal = Vec3::new(0.2, 1.0, 0.1);
    let sweep = Sweep::across_box(normal.into(), normal.dot(&bounds.center()), &bounds)
        .expect("the normal is finite");
    let [a, b, c, d] = sweep.corners();
    let blade = scene.add_blade([a, b]);
    scene.move_blade(blade, [d, c]);
    let stats = *scene.cut()?;
    assert_eq!(stats.cuts, 1, "{:?}", scene.refusals());
    scene.advance()?;
    Ok(())
}

fn to_the_bit(context: Context, model: Model, schedule: Schedule) {
    let [(mut device, on_device), (mut cpu, on_cpu)] = scenes(context, model, schedule);
    let used = device.gpu().zip(device.gpu_body(on_device));
    let used = used.map(|(gpu, body)| gpu.schedule(body));
    assert_eq!(
        used,
        Some(Ok(schedule)),
        "the schedule is the one to be tested"
    );
    for frame in 0..FRAMES {
        for (scene, id) in [(&mut device, on_device), (&mut cpu, on_cpu)] {
            if frame == CUT {
                slice(scene, id).expect("a frame with a cut");
            } else {
                scene.step().expect("a frame");
            }
        }
        if frame == CUT {
            compare(&mut device, on_device, &cpu, on_cpu, frame);
        }
    }
    assert!(cpu.body(on_cpu).pieces().len() > 1, "it was cut");
    compare(&mut device, on_device, &cpu, on_cpu, FRAMES);
}

/// Holds both to the same bits, in positions and velocities.
fn compare(device: &mut Scene, on_device: BodyId, cpu: &Scene, on_cpu: BodyId, frame: u32) {
    device.read(on_device).expect("a state");
    let (a, b) = (device.body(on_device), cpu.body(on_cpu));
    assert_eq!(
        a.surface().topology(),
        b.surface().topology(),
        "frame {frame}"
    );
    let bits = |v: &[f32; 4]| v.map(f32::to_bits);
    for (what, a, b) in [
        (
            "position",
            &a.surface().positions[..],
            &b.surface().positions[..],
        ),
        ("velocity", a.solver().velocities(), b.solver().velocities()),
    ] {
        let differ = a.iter().zip(b).position(|(a, b)| bits(a) != bits(b));
        assert_eq!(
            differ, None,
            "{what} of this vertex differs in frame {frame}"
        );
    }
}

/// Frames after which a device that rounds otherwise is still close.
const FEW: u32 = 3;
/// How close: so many roundings of a coordinate. A vertex is moved by a dozen constraints at most ten
/// times a frame, 360 times in all, each time rounded once or twice more or less than on the processor.
const ROUNDINGS: f32 = 360.0;

fn within_rounding(context: Context, model: Model) {
    let [(mut device, on_device), (mut cpu, on_cpu)] = scenes(context, model, Schedule::Colors);
    for _ in 0..FEW {
        device.step().expect("a frame");
        cpu.step().expect("a frame");
    }
    device.read(on_device).expect("a state");
    let of = |scene: &Scene, id: BodyId| -> Surface { scene.body(id).surface().clone() };
    let (a, b) = (of(&device, on_device), of(&cpu, on_cpu));
    let coordinates = b.positions.iter().flat_map(|p| &p[..3]);
    let size = coordinates.fold(0.0, |m: f32, c| m.max(c.abs()));
    let pairs = a.positions.iter().zip(&b.positions);
    let differences = pairs.flat_map(|(a, b)| (0..3).map(|k| (a[k] - b[k]).abs()));
    let worst = differences.fold(0.0, f32::max);
    let bound = ROUNDINGS * f32::EPSILON * size;
    assert!(worst <= bound, "{worst} is more than {bound}");
}
