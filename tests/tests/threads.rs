//! A scene gives the same bits on one thread and on two.

use incise_mesh::{Model, Surface, VertexId, build_model, icosphere};
use incise_pbd_gpu::{Material, SolverParams, Struts, Volume};
use incise_scene::{Scene, SceneParams};

/// The solver spreads colors of at least this many constraints over threads.
const SPREAD_FROM: usize = 1024;

/// What a run leaves: corners and pieces, positions, rest positions, velocities.
#[derive(Debug, PartialEq, Eq)]
struct Bits {
    corners: Vec<VertexId>,
    pieces: Vec<u32>,
    positions: Vec<[u32; 4]>,
    rest: Vec<[u32; 3]>,
    velocities: Vec<[u32; 4]>,
}

/// Drops a body on the ground and cuts it twice on the way.
fn run(threads: usize, body: &Surface, material: &Material) -> Bits {
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .expect("threads can be started");
    pool.install(|| {
        let mut scene = Scene::new(SceneParams {
            solver: SolverParams {
                ground: Some(-0.52),
                ..SolverParams::paper()
            },
            ..SceneParams::default()
        });
        let id = scene
            .add_body(body.clone(), material)
            .expect("the body can be simulated");
        let largest = |scene: &Scene| {
            let stretch = scene.body(id).solver().stretch();
            stretch.batches().iter().map(|b| b.len()).max()
        };
        assert!(
            largest(&scene) >= Some(SPREAD_FROM),
            "the body is too small to be spread over threads"
        );
        let blades = [
            ([[-2.0, 0.07, -2.0], [-2.0, 0.11, 2.0]], 4.0),
            ([[-2.0, -2.0, 0.03], [-2.0, 2.0, -0.05]], 4.0),
        ]
        .map(|(edge, way): ([[f32; 3]; 2], f32)| (scene.add_blade(edge), edge, way));
        let mut cuts = 0;
        for frame in 0..9 {
            if let Some(&(blade, edge, way)) = blades.get(frame / 3)
                && frame % 3 == 1
            {
                let to = edge.map(|[x, y, z]| [x + way, y, z]);
                scene.move_blade(blade, to);
            }
            cuts += scene.step().expect("the body stays finite").cuts;
        }
        assert_eq!(cuts, 2, "both blades cut");
        let body = scene.body(id);
        let surface = body.surface();
        body.solver()
            .validate(surface)
            .expect("constraints followed");
        Bits {
            corners: surface.topology().corners().to_vec(),
            pieces: (surface.topology().triangles())
                .map(|t| surface.piece(t))
                .collect(),
            positions: bits(&surface.positions),
            rest: bits(&surface.rest),
            velocities: bits(body.solver().velocities()),
        }
    })
}

fn bits<const N: usize>(values: &[[f32; N]]) -> Vec<[u32; N]> {
    values.iter().map(|v| v.map(f32::to_bits)).collect()
}

fn is_alike(body: &Surface, material: &Material) {
    let [one, two] = [1, 2].map(|threads| run(threads, body, material));
    assert!(one == two, "two threads differ from one");
}

#[test]
fn a_sphere_is_cut_alike_on_one_thread_and_two() {
    is_alike(&icosphere(5, 0.5), &Material::default());
}

#[test]
fn the_armadillo_is_cut_alike_on_one_thread_and_two() {
    is_alike(&build_model(Model::Armadillo), &Material::default());
}

#[test]
fn a_body_with_an_inside_is_cut_alike_on_one_thread_and_two() {
    let material = Material {
        volume: Some(Volume::default()),
        struts: Some(Struts::default()),
        ..Material::default()
    };
    is_alike(&icosphere(5, 0.5), &material);
}
