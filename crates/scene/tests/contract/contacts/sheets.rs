//! Sheets are touched from both sides, by bodies and by other sheets.

use super::*;
use incise_mesh::sheet;

/// Returns a horizontal sheet of 2 m at a height \[m\], its outer side up or down.
fn horizontal(cells: u32, height: f32, is_up: bool) -> Surface {
    let mut surface = sheet([2.0; 2], [cells; 2]);
    let side = if is_up { 1.0 } else { -1.0 };
    for p in surface.rest_positions_mut() {
        *p = [p[0], height, -side * p[1]];
    }
    surface
}

/// Adds a body at its rest positions.
fn add(scene: &mut Scene, surface: &Surface, material: &Material) -> BodyId {
    let corners = surface.rest_positions().to_vec();
    let topology = surface.topology();
    let faces: Vec<[u32; 3]> = (topology.triangles())
        .map(|t| topology.triangle(t).map(|v| v.0))
        .collect();
    let surface = Surface::from_triangles(&corners, &faces).unwrap();
    scene.add_body(surface, material).unwrap()
}

fn lowest(scene: &Scene, id: BodyId) -> f32 {
    let positions = scene.body(id).unwrap().surface().positions();
    positions.iter().map(|p| p[1]).fold(f32::INFINITY, f32::min)
}

#[test]
fn a_ball_and_a_sheet_rest_on_either_side_of_a_held_sheet() {
    let ball = moved(&cube_sphere(4, 0.3), [0.03, 0.4, 0.02], [1.0; 3]);
    for upper in [ball, horizontal(9, 0.1, true), horizontal(9, 0.1, false)] {
        for is_up in [true, false] {
            let mut scene = Scene::new(params([0.0, -9.81, 0.0]));
            let material = firm(1.0, 0.0);
            let held = add(&mut scene, &horizontal(8, 0.0, is_up), &material);
            pin_piece(&mut scene, held, 0);
            let id = add(&mut scene, &upper, &material);
            for _ in 0..60 {
                scene.step().unwrap();
            }
            let low = lowest(&scene, id);
            assert!(low > 0.0, "{low} m, outer side up: {is_up}");
        }
    }
}

#[test]
fn the_halves_of_a_cut_sheet_stay_in_its_plane() {
    let mut scene = Scene::new(params([0.0; 3]));
    let id = add(&mut scene, &horizontal(8, 0.0, true), &firm(1.0, 0.0));
    let blade = scene.add_blade([[-2.0, 1.0, 0.03], [2.0, 1.0, 0.04]]);
    scene
        .move_blade(blade, [[-2.0, -1.0, 0.03], [2.0, -1.0, 0.04]])
        .unwrap();
    for _ in 0..60 {
        scene.step().unwrap();
    }
    let body = scene.body(id).unwrap();
    assert_eq!(body.pieces().len(), 2, "it is cut");
    let [low, high] = height_range(body, 0);
    assert!(low > -1e-6 && high < 1e-6, "{low} to {high} m");
}

/// Regression: contacts saw the lower sheet where it had fallen to, before the ground lifted it,
/// and pressed it into the ground. Upper sheets sank until all of them were in one plane.
#[test]
fn sheets_on_sheets_keep_their_gap() {
    for (size, degrees) in [(0.1, 0.0), (2.0, 0.0), (0.1, 35.0), (2.0, 35.0)] {
        let turn = Turn::new(degrees);
        let mut scene = Scene::new(params(turn.of([0.0, -9.81, 0.0])));
        scene.colliders.push(turn.ground());
        let ids = [0.0, 1.0, 2.0, 3.0].map(|layer: f32| {
            let mut surface = horizontal(12, 0.02 * layer, true);
            for p in surface.rest_positions_mut() {
                *p = turn.of(p.map(|c| c * size / 2.0));
            }
            add(&mut scene, &surface, &Material::cloth())
        });
        for _ in 0..240 {
            scene.step().unwrap();
        }
        for (layer, id) in (0..).zip(ids) {
            let body = scene.body(id).unwrap();
            let positions = body.surface().positions().iter();
            let heights = positions.map(|p| f64::from(turn.back([p[0], p[1], p[2]])[1]));
            let mean = heights.sum::<f64>() / body.surface().positions().len() as f64;
            let gaps = mean / (0.1 * body.solver().mean_rest_length());
            let expected = f64::from(layer);
            assert!(
                (gaps - expected).abs() < 0.01 + 0.05 * expected,
                "{size} m, {degrees} degrees: layer {layer} at {gaps} gaps"
            );
        }
    }
}
