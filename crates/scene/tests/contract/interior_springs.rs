//! Interior springs keep a body inflated; a cut removes the springs that it crosses.

use incise_cut::CutOutcome;
use incise_mesh::{Surface, VertexId, cube_sphere};
use incise_models::{Model, build_model};
use incise_pbd_gpu::{
    Collider, InteriorSprings, Material, Solver, SolverParams, Stiffness, Volume,
};
use incise_scene::{BodyId, Scene, SceneParams};

fn with_springs(density: f32) -> Material {
    Material {
        stretch: Stiffness::Compliance(1e-4),
        bending: None,
        interior_springs: Some(InteriorSprings {
            density,
            stiffness: Stiffness::Compliance(1e-3),
        }),
        ..Material::default()
    }
}

fn weightless() -> SceneParams {
    SceneParams {
        solver: SolverParams {
            gravity: [0.0; 3],
            ..SolverParams::default()
        },
        sleep: None,
        ..SceneParams::default()
    }
}

fn ends(solver: &Solver) -> Vec<[VertexId; 2]> {
    let sets = solver.interior_springs().into_iter();
    let batches = sets.flat_map(|set| set.batches().iter().chain([set.overflow()]));
    batches
        .flat_map(|batch| batch.vertices().iter().copied())
        .collect()
}

fn piece_of(surface: &Surface, v: VertexId) -> u32 {
    surface.piece(surface.topology().outgoing(v).triangle())
}

/// Returns a ball of radius 1 m that a blade has cut at height `y`.
fn cut_ball(density: f32, y: f32) -> (Scene, BodyId) {
    let mut scene = Scene::new(weightless());
    let id = scene
        .add_body(cube_sphere(12, 1.0), &with_springs(density))
        .unwrap();
    let blade = scene.add_blade([[-2.0, y, -2.0], [-2.0, y, 2.0]]);
    scene.step().unwrap();
    scene
        .move_blade(blade, [[2.0, y, -2.0], [2.0, y, 2.0]])
        .unwrap();
    assert_eq!(scene.step().unwrap().cuts, 1, "the blade cuts");
    (scene, id)
}

#[test]
fn the_number_of_springs_follows_the_density() {
    let surface = build_model(Model::Sphere768);
    let vertices = surface.topology().vertex_count() as f32;
    for density in [0.0, 0.25, 1.0] {
        let mut scene = Scene::new(weightless());
        let id = scene
            .add_body(surface.clone(), &with_springs(density))
            .unwrap();
        scene.step().unwrap();
        let solver = scene.body(id).unwrap().solver();
        let share = ends(solver).len() as f32 / vertices;
        assert!((share - density).abs() < 0.02, "{share}, not {density}");
        let projected = solver.stats().interior_spring_projections;
        assert_eq!(projected == 0, density == 0.0, "{projected}");
    }
}

#[test]
fn a_cut_removes_crossed_springs_and_adds_springs_to_caps() {
    for density in [0.3, 1.0] {
        let (mut scene, id) = cut_ball(density, 0.1);
        let body = scene.body(id).unwrap();
        let (surface, solver) = (body.surface(), body.solver());
        solver.validate(surface).unwrap();
        let ends = ends(solver);
        let crossed = ends.iter().filter(|ends| {
            let [a, b] = ends.map(|v| surface.position(v).y - 0.1);
            a * b < -1e-6
        });
        assert_eq!(crossed.count(), 0, "nothing joins the halves");
        let pieces = ends.iter().map(|ends| ends.map(|v| piece_of(surface, v)));
        assert!(pieces.clone().all(|[a, b]| a == b));
        for half in [0, 1] {
            let own = pieces.clone().filter(|&[a, _]| a == half).count();
            let all = surface.topology().vertices();
            let vertices = all.filter(|&v| piece_of(surface, v) == half).count();
            let share = own as f32 / vertices as f32;
            // The normal of a rim vertex depends on its neighbors.
            assert!(share > 0.75 * density, "{share} a vertex of half {half}");
        }
        let undo = outcome(&scene).undo.clone().unwrap();
        scene.undo(id, undo).unwrap();
        let body = scene.body(id).unwrap();
        body.solver().validate(body.surface()).unwrap();
        let vertices = body.surface().topology().vertex_count() as f32;
        let share = self::ends(body.solver()).len() as f32 / vertices;
        assert!((share - density).abs() < 0.03, "{share} after the undo");
    }
}

/// Returns the bits of one half 0.5 s after the cut, with the other half pushed or not.
fn other_half(pushed: bool) -> Vec<[u32; 4]> {
    let (mut scene, id) = cut_ball(1.0, 0.1);
    // The energy budget of a body is common to its pieces.
    scene.params.solver.conserve = false;
    let (solver, surface) = scene.edit(id).unwrap().solver_mut();
    let all = surface.topology().vertices();
    let first = piece_of(surface, VertexId(0));
    let (near, far): (Vec<_>, Vec<_>) = all.partition(|&v| piece_of(surface, v) == first);
    if pushed {
        for v in near {
            solver.set_velocity(v, [0.5, 1.0, 0.0]).unwrap();
        }
    }
    for _ in 0..30 {
        scene.step().unwrap();
    }
    let positions = scene.body(id).unwrap().surface().positions();
    far.iter()
        .map(|v| positions[v.index()].map(f32::to_bits))
        .collect()
}

#[test]
fn no_spring_connects_the_halves() {
    assert!(other_half(true) == other_half(false));
}

/// Returns the minimum relative volume of a soft body's pieces on the ground after 3 s.
///
/// The first value is before a vertical cut, the second after it.
fn kept_volume(model: Model, material: &Material) -> [f64; 2] {
    let surface = build_model(model);
    let params = SceneParams {
        solver: SolverParams::default(),
        ..weightless()
    };
    let mut scene = Scene::new(params);
    scene
        .colliders
        .push(Collider::ground(surface.bounds().min[1]));
    let id = scene.add_body(surface, material).unwrap();
    let blade = scene.add_blade([[0.0, -9.0, -9.0], [0.0, 9.0, -9.0]]);
    let mut kept = [f64::INFINITY; 2];
    for kept in &mut kept {
        for _ in 0..180 {
            scene.step().unwrap();
        }
        let body = scene.body(id).unwrap();
        let volumes = body.surface().piece_volumes();
        for piece in body.pieces() {
            let all = body.surface().topology().triangles();
            let rest =
                (body.surface()).rest_volume_of(all.filter(|&t| body.surface().piece(t) == piece));
            *kept = kept.min(volumes[piece as usize] / rest);
        }
        scene
            .move_blade(blade, [[0.0, -9.0, 9.0], [0.0, 9.0, 9.0]])
            .unwrap();
    }
    assert!(scene.body(id).unwrap().pieces().len() > 1, "it is cut");
    kept
}

#[test]
fn a_body_with_springs_does_not_deflate_before_and_after_a_cut() {
    let soft = Material {
        stretch: Stiffness::Compliance(1e-2),
        ..with_springs(1.0)
    };
    let inflated = Material {
        volume: Some(Volume::default()),
        ..soft
    };
    let limp = Material {
        interior_springs: None,
        ..soft
    };
    let with = kept_volume(Model::Sphere768, &soft);
    let both = kept_volume(Model::Sphere768, &inflated);
    let without = kept_volume(Model::Sphere768, &limp);
    assert!(with.into_iter().all(|kept| kept > 0.9), "{with:?}");
    assert!(
        both.into_iter().all(|kept| (kept - 1.0).abs() < 0.01),
        "{both:?}"
    );
    assert!(
        without.into_iter().all(|kept| kept < 0.8),
        "without springs the body deflates: {without:?}"
    );
}

/// Returns the change of the last frame's first cut.
fn outcome(scene: &Scene) -> &CutOutcome {
    let mut cuts = scene.cuts().iter();
    &cuts.find_map(|sweep| sweep.cut.as_ref()).unwrap().1
}
