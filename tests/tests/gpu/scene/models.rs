//! Half a second of models with a cut in between, on the GPU and on the CPU.
//!
//! The bits are equal on a strict adapter in every schedule, and within rounding on any other.

use incise_cut::Sweep;
use incise_mesh::geometry::to_f32;
use incise_mesh::{Surface, Vec3, VertexId};
use incise_models::{Model, build_model};
use incise_pbd_gpu::{Context, Material, PatchParams, Schedule, SolverParams};
use incise_scene::{BackendChoice, BackendRequest, BodyId, Scene, SceneError, SceneParams};
use incise_test_support::cpu_gpu_pair::SCHEDULES;
use incise_test_support::gpu::on_every_adapter;

const FRAMES: u32 = 30;
const CUT: u32 = 15;

/// The models of the fast test: two of one workgroup, one of many patches.
const FEW_MODELS: [(Model, Schedule); 3] = [
    (Model::Sphere80, Schedule::WholeBody),
    (Model::Bunny, Schedule::WholeBody),
    (Model::Octopus, Schedule::Patches),
];

/// A few models on a strict adapter, and the distance from the CPU on any other.
pub(crate) fn few(context: Context) {
    for (model, schedule) in FEW_MODELS {
        to_the_bit(context.clone(), model, schedule);
    }
    on_every_adapter(|context| within_rounding(context, Model::Bunny));
}

/// All models in every schedule that they support.
pub(crate) fn all(context: Context) {
    for model in Model::ALL {
        for schedule in SCHEDULES {
            if schedule == Schedule::Patches || model.particles() <= ONE_WORKGROUP {
                to_the_bit(context.clone(), model, schedule);
            }
        }
        on_every_adapter(|context| within_rounding(context, model));
    }
}

/// Vertices that fit in the 16 KiB of workgroup memory of every adapter.
const ONE_WORKGROUP: usize = 1365;

/// Returns ten iterations, and fewer for large models, because software adapters are slow.
fn iterations(model: Model) -> u32 {
    match model {
        Model::Armadillo => 2,
        Model::Banana => 4,
        _ => 10,
    }
}

fn params(model: Model) -> SceneParams {
    SceneParams {
        // Without gravity as in the table, since hollow bodies collapse.
        solver: SolverParams {
            gravity: [0.0; 3],
            iterations: iterations(model),
            ..SolverParams::paper()
        },
        ..SceneParams::default()
    }
}

/// Returns a scene on the GPU and the same scene on the CPU.
fn scenes(context: Context, model: Model, schedule: Schedule) -> [(Scene, BodyId); 2] {
    let request = BackendRequest {
        choice: BackendChoice::Gpu,
        ..BackendRequest::default()
    };
    let gpu = Scene::with_context(params(model), &request, context).expect("a device");
    [gpu, Scene::new(params(model))].map(|mut scene| {
        scene.force_schedule(Some(schedule));
        let id = add(&mut scene, model, schedule).expect("a valid model");
        (scene, id)
    })
}

/// Adds a rotating, compressed body.
fn add(scene: &mut Scene, model: Model, schedule: Schedule) -> Result<BodyId, SceneError> {
    let (surface, material) = (build_model(model), Material::default());
    let center = surface.bounds().center();
    let patches = (schedule == Schedule::Patches).then(PatchParams::default);
    let id = scene.add_body_with_patches(surface, &material, patches.as_ref())?;
    let (solver, surface) = scene.edit(id)?.solver_mut();
    let vertices: Vec<VertexId> = surface.topology().vertices().collect();
    for v in vertices {
        let r = surface.position(v) - center;
        let velocity = Vec3::new(0.5 * r.z + 0.3, -0.25 * r.y, -0.5 * r.x);
        solver.set_velocity(v, to_f32(velocity))?;
    }
    Ok(id)
}

/// Slices the body through its middle.
fn slice(scene: &mut Scene, id: BodyId) -> Result<(), SceneError> {
    scene.read_back(id)?;
    let bounds = scene
        .body(id)
        .expect("an id of this scene")
        .surface()
        .bounds();
    let normal = Vec3::new(0.2, 1.0, 0.1);
    let sweep = Sweep::from_plane(normal.into(), normal.dot(&bounds.center()), &bounds)
        .expect("the normal is finite");
    let [before, after] = sweep.ends();
    let blade = scene.add_blade(before);
    scene.move_blade(blade, after).expect("an id of this scene");
    let stats = *scene.cut()?;
    assert_eq!(stats.cuts, 1, "{:?}", scene.failed_cuts());
    scene.advance()?;
    Ok(())
}

fn to_the_bit(context: Context, model: Model, schedule: Schedule) {
    let [(mut gpu, gpu_id), (mut cpu, cpu_id)] = scenes(context, model, schedule);
    let used = gpu
        .gpu()
        .zip(gpu.gpu_body(gpu_id).expect("an id of this scene"));
    let used = used.map(|(gpu, body)| gpu.schedule(body));
    assert_eq!(
        used,
        Some(Ok(schedule)),
        "the schedule is the one to be tested"
    );
    for frame in 0..FRAMES {
        for (scene, id) in [(&mut gpu, gpu_id), (&mut cpu, cpu_id)] {
            if frame == CUT {
                slice(scene, id).expect("a frame with a cut");
            } else {
                scene.step().expect("a frame");
            }
        }
        if frame == CUT {
            compare(&mut gpu, gpu_id, &cpu, cpu_id, frame);
        }
    }
    assert!(
        cpu.body(cpu_id)
            .expect("an id of this scene")
            .pieces()
            .len()
            > 1,
        "it was cut"
    );
    compare(&mut gpu, gpu_id, &cpu, cpu_id, FRAMES);
}

/// Asserts that positions and velocities have the same bits.
fn compare(gpu: &mut Scene, gpu_id: BodyId, cpu: &Scene, cpu_id: BodyId, frame: u32) {
    gpu.read_back(gpu_id).expect("a state");
    let (a, b) = (
        gpu.body(gpu_id).expect("an id of this scene"),
        cpu.body(cpu_id).expect("an id of this scene"),
    );
    assert_eq!(
        a.surface().topology(),
        b.surface().topology(),
        "frame {frame}"
    );
    let bits = |v: &[f32; 4]| v.map(f32::to_bits);
    for (what, a, b) in [
        ("position", a.surface().positions(), b.surface().positions()),
        ("velocity", a.solver().velocities(), b.solver().velocities()),
    ] {
        let differ = a.iter().zip(b).position(|(a, b)| bits(a) != bits(b));
        assert_eq!(
            differ, None,
            "{what} of this vertex differs in frame {frame}"
        );
    }
}

/// Number of frames of the comparison on adapters with other rounding.
const FEW: u32 = 3;
/// Tolerance in roundings of a coordinate.
///
/// At most a dozen constraints move a vertex ten times a frame, 360 times in all, each with one or
/// two roundings more or less than on the CPU.
const ROUNDINGS: f32 = 360.0;

fn within_rounding(context: Context, model: Model) {
    let [(mut gpu, gpu_id), (mut cpu, cpu_id)] = scenes(context, model, Schedule::Patches);
    for _ in 0..FEW {
        gpu.step().expect("a frame");
        cpu.step().expect("a frame");
    }
    gpu.read_back(gpu_id).expect("a state");
    let of = |scene: &Scene, id: BodyId| -> Surface {
        scene
            .body(id)
            .expect("an id of this scene")
            .surface()
            .clone()
    };
    let (a, b) = (of(&gpu, gpu_id), of(&cpu, cpu_id));
    let coordinates = b.positions().iter().flat_map(|p| &p[..3]);
    let size = coordinates.fold(0.0, |m: f32, c| m.max(c.abs()));
    let pairs = a.positions().iter().zip(b.positions());
    let differences = pairs.flat_map(|(a, b)| (0..3).map(|k| (a[k] - b[k]).abs()));
    let worst = differences.fold(0.0, f32::max);
    let bound = ROUNDINGS * f32::EPSILON * size;
    assert!(worst <= bound, "{worst} is more than {bound}");
}
