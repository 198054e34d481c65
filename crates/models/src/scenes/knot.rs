//! A rope with a knot that is pulled tight.

use super::{Grouping, ScriptedScene, grouped, pin, solids, sprung, weightless};
use incise_mesh::geometry::to_f32;
use incise_mesh::{Surface, Vec3, VertexId};
use incise_scene::{BackendRequest, ContactParams, Scene, SceneError, SceneParams};

/// Vertices of a ring.
const SIDES: u32 = 6;
/// Distance that each end is pulled \[m\].
const DISTANCE: f64 = 0.7;
/// Speed of each end [m/s].
const SPEED: f64 = 0.5;

/// A rope of rings of vertices.
#[derive(Debug, Clone, Copy)]
pub struct Rope {
    /// Number of rings.
    pub rings: usize,
    /// Distance between neighboring rings at rest \[m\].
    pub spacing: f64,
}

impl Rope {
    /// Radius of the rope \[m\].
    pub const RADIUS: f64 = 0.012;

    /// Returns the centers of all rings \[m\].
    #[must_use]
    pub fn centers(self, surface: &Surface) -> Vec<Vec3> {
        let sides = SIDES as usize;
        let center = |ring: usize| {
            let own = (ring * sides..(ring + 1) * sides).map(VertexId::from_index);
            own.map(|v| surface.position(v)).sum::<Vec3>() / f64::from(SIDES)
        };
        (0..self.rings).map(center).collect()
    }
}

/// Returns points of Shastri's polynomial trefoil `(t^3 - 3 t, t^4 - 4 t^2, t^5 - 10 t)`, flattened
/// and of about 2.7 m, at equal distances.
fn trefoil(points: u32) -> Vec<Vec3> {
    let at = |t: f64| {
        let flat = 0.2 * (t.powi(5) - 10.0 * t);
        Vec3::new(t.powi(3) - 3.0 * t, t.powi(4) - 4.0 * t * t, flat) * 0.1
    };
    let fine: Vec<Vec3> = (-2000..=2000)
        .map(|i| at(2.05 * f64::from(i) / 2000.0))
        .collect();
    let steps = || fine.windows(2).map(|ends| (ends[1] - ends[0]).norm());
    let spacing = steps().sum::<f64>() / f64::from(points - 1);
    let (mut curve, mut since) = (vec![fine[0]], 0.0);
    for (step, &p) in steps().zip(&fine[1..]) {
        since += step;
        if since >= spacing {
            curve.push(p);
            since -= spacing;
        }
    }
    curve
}

/// Builds a weightless rope with an open trefoil knot that is pulled at both ends.
///
/// # Errors
/// As [`Scene::with_backend`].
pub fn knot(backend: &BackendRequest) -> Result<(ScriptedScene, Rope), SceneError> {
    let curve = trefoil(220);
    let surface = solids::tube(&curve, Rope::RADIUS, SIDES);
    let params = SceneParams {
        contacts: Some(ContactParams {
            self_collision: true,
            ..ContactParams::default()
        }),
        ..weightless()
    };
    let (material, grouping) = (sprung(), Grouping::Bodies);
    let (mut scene, parts) = grouped(backend, params, &[surface], grouping, &material)?;
    let (first, last) = (curve[0], curve[curve.len() - 1]);
    let along = (last - first).normalize();
    let mut ends: Vec<(VertexId, Vec3, Vec3)> = Vec::new();
    for (end, way) in [(first, -along), (last, along)] {
        let pinned = pin(&mut scene, parts[0], |p| {
            (p - end).norm() < 1.1 * Rope::RADIUS
        })?;
        let surface = scene.body(parts[0].body)?.surface();
        ends.extend(pinned.into_iter().map(|v| (v, surface.position(v), way)));
    }
    let body = parts[0].body;
    let pull = move |scene: &mut Scene, frame: u32| {
        let pulled = (SPEED * f64::from(frame + 1) / 60.0).min(DISTANCE);
        for &(v, from, way) in &ends {
            scene.set_pin_target(body, v, to_f32(from + way * pulled))?;
        }
        Ok(())
    };
    let rope = Rope {
        rings: curve.len(),
        spacing: (curve[1] - curve[0]).norm(),
    };
    Ok((ScriptedScene::new(scene, pull), rope))
}
