//! A scene gives the same bits on one thread and on two.

use incise_mesh::{Surface, VertexId, icosphere};
use incise_models::{Model, build_model};
use incise_pbd_gpu::{Collider, InteriorSprings, Material, SolverParams, Volume};
use incise_scene::{Scene, SceneParams};

/// Number of constraints of a color from which the solver uses several threads.
const SPREAD_FROM: usize = 1024;

/// State after a run: corners and pieces, positions, rest positions, velocities.
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
            solver: SolverParams::paper(),
            ..SceneParams::default()
        });
        scene.colliders.push(Collider::ground(-0.52));
        let id = scene
            .add_body(body.clone(), material)
            .expect("the body can be simulated");
        let largest = |scene: &Scene| {
            let stretch = scene
                .body(id)
                .expect("an id of this scene")
                .solver()
                .stretch();
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
                scene.move_blade(blade, to).expect("an id of this scene");
            }
            cuts += scene.step().expect("the body stays finite").cuts;
        }
        assert_eq!(cuts, 2, "both blades cut");
        let body = scene.body(id).expect("an id of this scene");
        let surface = body.surface();
        body.solver()
            .validate(surface)
            .expect("constraints followed");
        Bits {
            corners: surface.topology().corners().to_vec(),
            pieces: (surface.topology().triangles())
                .map(|t| surface.piece(t))
                .collect(),
            positions: bits(surface.positions()),
            rest: bits(surface.rest_positions()),
            velocities: bits(body.solver().velocities()),
        }
    })
}

fn bits<const N: usize>(values: &[[f32; N]]) -> Vec<[u32; N]> {
    values.iter().map(|v| v.map(f32::to_bits)).collect()
}

fn assert_equal_bits(body: &Surface, material: &Material) {
    let [one, two] = [1, 2].map(|threads| run(threads, body, material));
    assert!(one == two, "two threads differ from one");
}

#[test]
fn a_cut_sphere_has_the_same_bits() {
    assert_equal_bits(&icosphere(5, 0.5), &Material::default());
}

#[test]
fn the_cut_armadillo_has_the_same_bits() {
    assert_equal_bits(&build_model(Model::Armadillo), &Material::default());
}

#[test]
fn a_cut_body_with_interior_springs_has_the_same_bits() {
    let material = Material {
        volume: Some(Volume::default()),
        interior_springs: Some(InteriorSprings::default()),
        ..Material::default()
    };
    assert_equal_bits(&icosphere(5, 0.5), &material);
}
