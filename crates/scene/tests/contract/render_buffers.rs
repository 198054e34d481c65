//! Render buffers follow bodies through motion, cuts and undo.

use incise_mesh::{RenderBuffers, RenderParams, Surface, icosphere};
use incise_pbd_gpu::Material;
use incise_scene::{BladeId, BodyId, BufferChange, Scene, SceneParams};

/// Returns the corners of all triangles of the skin and of the caps, sorted.
fn triangles(buffers: &RenderBuffers) -> [Vec<[[[u32; 3]; 2]; 3]>; 2] {
    [buffers.skin_indices(), buffers.cap_indices()].map(|indices| {
        let bits = |values: &[[f32; 3]], i: u32| values[i as usize].map(f32::to_bits);
        let corner = |i: u32| [bits(buffers.positions(), i), bits(buffers.normals(), i)];
        let triangles = indices.as_chunks::<3>().0.iter();
        let mut triangles: Vec<_> = triangles.map(|t| t.map(corner)).collect();
        for corners in &mut triangles {
            let first = (0..3).min_by_key(|&i| corners[i]).unwrap_or(0);
            corners.rotate_left(first);
        }
        triangles.sort_unstable();
        triangles
    })
}

/// Checks that buffers that followed a surface have the triangles of new ones.
fn assert_follows(buffers: &RenderBuffers, surface: &Surface) {
    let new = RenderBuffers::new(surface, RenderParams::default());
    let positions = |[skin, cap]: [Vec<[[[u32; 3]; 2]; 3]>; 2]| {
        [skin, cap].map(|part| {
            let corners = part.into_iter();
            corners.map(|t| t.map(|[p, _]| p)).collect::<Vec<_>>()
        })
    };
    let [followed, new] = [buffers, &new].map(|buffers| positions(triangles(buffers)));
    assert_eq!(followed, new, "the triangles of new buffers");
}

fn edge(x: f32, y: f32) -> [[f32; 3]; 2] {
    [[x, y, -2.0], [x, y, 2.0]]
}

/// Returns a scene with a falling ball and blades beside it, at some heights.
fn scene(heights: &[f32]) -> (Scene, BodyId, Vec<BladeId>) {
    let mut scene = Scene::new(SceneParams::default());
    let id = scene
        .add_body(icosphere(4, 0.5), &Material::default())
        .unwrap();
    let blades = heights.iter().map(|&y| scene.add_blade(edge(-2.0, y)));
    let blades = blades.collect();
    scene.step().unwrap();
    (scene, id, blades)
}

#[test]
fn buffers_follow_cuts_in_motion_and_their_undo() {
    let (mut scene, id, blades) = scene(&[0.2, -0.2, 0.0]);
    let surface = scene.body(id).unwrap().surface();
    let mut buffers = RenderBuffers::new(surface, RenderParams::default());
    let mut update = |scene: &mut Scene, expected| {
        let change = scene.update_render_buffers(id, &mut buffers).unwrap();
        assert_eq!(change, expected);
        assert_follows(&buffers, scene.body(id).unwrap().surface());
        buffers.clone()
    };
    scene.step().unwrap();
    let before = update(&mut scene, BufferChange::Motion);
    // A cut keeps the numbers of vertices away from it.
    scene.move_blade(blades[0], edge(2.0, 0.2)).unwrap();
    scene.step().unwrap();
    let after = update(&mut scene, BufferChange::Topology);
    let kept = before.skin_indices().iter().zip(after.skin_indices());
    let kept = kept.filter(|(a, b)| a == b).count();
    assert!(4 * kept > 3 * before.skin_indices().len(), "{kept} indices");
    assert!(!after.cap_indices().is_empty());
    update(&mut scene, BufferChange::Motion);
    // A cut that was not followed, then two cuts within a frame.
    scene.move_blade(blades[0], edge(-2.0, 0.1)).unwrap();
    scene.step().unwrap();
    scene.step().unwrap();
    update(&mut scene, BufferChange::Topology);
    scene.move_blade(blades[1], edge(2.0, -0.2)).unwrap();
    scene.move_blade(blades[2], edge(2.0, 0.0)).unwrap();
    scene.step().unwrap();
    let cuts = scene.cuts().iter().filter(|result| result.cut.is_some());
    assert_eq!(cuts.count(), 2);
    update(&mut scene, BufferChange::Topology);
    // Cut and undone between two updates: the topology is the old one.
    scene.move_blade(blades[0], edge(2.0, -0.1)).unwrap();
    scene.step().unwrap();
    let mut outcomes = scene.cuts().iter().filter_map(|result| result.cut.as_ref());
    let undo = outcomes.find_map(|(_, outcome)| outcome.undo.clone());
    scene.undo(id, undo.unwrap()).unwrap();
    update(&mut scene, BufferChange::Motion);
    // Cut, followed and undone.
    scene.move_blade(blades[0], edge(-2.0, -0.1)).unwrap();
    scene.step().unwrap();
    update(&mut scene, BufferChange::Topology);
    let mut outcomes = scene.cuts().iter().filter_map(|result| result.cut.as_ref());
    let undo = outcomes.find_map(|(_, outcome)| outcome.undo.clone());
    scene.undo(id, undo.unwrap()).unwrap();
    update(&mut scene, BufferChange::Topology);
}

#[test]
fn buffers_of_an_unknown_body_stay() {
    let (mut own, id, _) = scene(&[]);
    let (mut other, ..) = scene(&[]);
    let surface = own.body(id).unwrap().surface();
    let mut buffers = RenderBuffers::new(surface, RenderParams::default());
    let before = triangles(&buffers);
    assert!(other.update_render_buffers(id, &mut buffers).is_err());
    assert_eq!(before, triangles(&buffers));
    own.step().unwrap();
    own.update_render_buffers(id, &mut buffers).unwrap();
    assert_ne!(before, triangles(&buffers));
}
