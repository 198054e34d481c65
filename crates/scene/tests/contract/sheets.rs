//! Bodies with a boundary: cloth that hangs and is cut.

use incise_mesh::{Surface, VertexId, sheet};
use incise_pbd_gpu::Material;
use incise_scene::{BladeId, BodyId, ContactParams, Scene, SceneParams};

/// Cloth of 1 m by 1 m that comes to rest.
fn cloth() -> Material {
    Material {
        damping: 4.0,
        ..Material::cloth()
    }
}

/// Returns a scene with a sheet that hangs from its upper side, and a blade to its left.
fn scene(material: &Material) -> (Scene, BodyId, BladeId) {
    let mut scene = Scene::new(SceneParams::default());
    let surface = sheet([1.0, 1.0], [16, 16]);
    let body = scene.add_body(surface, material).unwrap();
    let (solver, surface) = scene.edit(body).unwrap().solver_mut();
    let upper: Vec<VertexId> = (surface.topology().vertices())
        .filter(|&v| surface.position(v).y > 0.49)
        .collect();
    assert_eq!(upper.len(), 17, "its upper side");
    for v in upper {
        solver.pin(surface, v).unwrap();
    }
    let blade = scene.add_blade(pose(-0.7));
    (scene, body, blade)
}

/// A blade across the sheet, a third of the way up.
fn pose(x: f32) -> [[f32; 3]; 2] {
    [[x, -0.15, -1.0], [x, -0.13, 1.0]]
}

/// Steps the scene by one frame and checks the body.
fn step(scene: &mut Scene, body: BodyId, frame: u16) -> u32 {
    let cuts = scene.step().unwrap().cuts;
    let failed = scene.failed_cuts();
    assert!(failed.is_empty(), "frame {frame}: {failed:?}");
    let body = scene.body(body).unwrap();
    body.surface().validate().unwrap();
    body.solver().validate(body.surface()).unwrap();
    assert!(
        body.solver().volumes().pieces().is_empty(),
        "a sheet has no volume"
    );
    cuts
}

/// Moves the blade through the whole sheet and returns the number of cuts.
fn stroke(scene: &mut Scene, body: BodyId, blade: BladeId) -> u32 {
    let mut cuts = 0;
    for frame in 0u16..70 {
        let edge = pose(-0.7 + 0.02 * f32::from(frame));
        scene.move_blade(blade, edge).unwrap();
        cuts += step(scene, body, frame);
        if frame == 35 {
            assert_eq!(scene.body(body).unwrap().pieces(), [0], "half way");
        }
    }
    cuts
}

/// Returns the lowest and the highest y of a piece \[m\].
fn heights(surface: &Surface, piece: u32) -> [f64; 2] {
    let topology = surface.topology();
    let of_piece = topology.triangles().filter(|&t| surface.piece(t) == piece);
    let heights = of_piece.flat_map(|t| topology.triangle(t).map(|v| surface.position(v).y));
    heights.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], y| {
        [low.min(y), high.max(y)]
    })
}

#[test]
fn hanging_cloth_is_cut_in_two_step_by_step() {
    let (mut scene, body, blade) = scene(&cloth());
    let before = scene.body(body).unwrap();
    let (mass, area) = (before.solver().total_mass(), before.surface().area());
    for frame in 0..20 {
        assert_eq!(step(&mut scene, body, frame), 0);
    }
    let cuts = stroke(&mut scene, body, blade);
    assert!(cuts > 5, "{cuts} steps");
    for frame in 0..20 {
        assert_eq!(step(&mut scene, body, frame), 0);
    }
    let body = scene.body(body).unwrap();
    let surface = body.surface();
    assert_eq!(body.pieces(), [0, 1]);
    assert!((body.solver().total_mass() / mass - 1.0).abs() < 1e-5);
    assert!((surface.area() / area - 1.0).abs() < 0.05);
    assert_eq!(body.solver().pins().len(), 17);
    let [first, second] = [0, 1].map(|piece| heights(surface, piece));
    let [lower, upper] = if first[0] < second[0] {
        [first, second]
    } else {
        [second, first]
    };
    assert!(
        (upper[1] - 0.5).abs() < 1e-6,
        "the upper part hangs: {upper:?}"
    );
    assert!(
        lower[1] < upper[0],
        "the lower part falls: {lower:?} {upper:?}"
    );
}

#[test]
fn a_sheet_of_any_material_is_cut_with_contacts() {
    for material in [Material::default(), Material::shell(), Material::cloth()] {
        let (mut scene, body, blade) = scene(&material);
        scene.params.contacts = Some(ContactParams {
            self_collision: true,
            ..ContactParams::default()
        });
        stroke(&mut scene, body, blade);
        assert_eq!(scene.body(body).unwrap().pieces(), [0, 1]);
    }
}

#[test]
fn cloth_at_rest_sleeps_until_it_is_cut() {
    let (mut scene, body, blade) = scene(&cloth());
    for frame in 0..900 {
        if scene.is_asleep(body).unwrap() {
            break;
        }
        step(&mut scene, body, frame);
    }
    assert!(scene.is_asleep(body).unwrap());
    stroke(&mut scene, body, blade);
    assert!(!scene.is_asleep(body).unwrap());
    assert_eq!(scene.body(body).unwrap().pieces(), [0, 1]);
}
