//! The figure of incisions: cuts that end inside, opened by pulling at the body.

use super::figure::{ColoredSurface, Facts, FigureError, Panel, Row, letter};
use super::slice::{against, color};
use incise_cut::{CutParams, Cutter, Sweep};
use incise_mesh::{Surface, Vec3, VertexId, cube_sphere, sheet};
use incise_pbd_gpu::{InteriorSprings, Material, Stiffness, Volume};
use incise_scene::{Scene, SceneError, SceneParams};

/// Radius of the ball \[m\].
const RADIUS: f32 = 0.5;
/// Frames in which pinned vertices move, and frames of rest after them.
const FRAMES: [u16; 2] = [30, 30];
/// Number of points of the curved blade.
const BLADE_POINTS: u8 = 25;

/// Returns the incisions of a ball and of a cloth.
pub(super) fn incisions() -> Result<Vec<Row>, FigureError> {
    let from_above = against(Vec3::new(0.25, 0.8, 1.0));
    let depths = [0.1, 0.2, 0.3, 0.4, 0.5];
    let parallel: Vec<Sweep> = (depths.into_iter().zip([-0.23, -0.11, 0.01, 0.13, 0.25]))
        .map(|(depth, x)| downward(&[[x, -0.7], [x, 0.7]], RADIUS - depth))
        .collect::<Result<_, _>>()?;
    let curved = downward(&s_curve(), 0.05)?;
    let cross = [[[-0.3, 0.01], [0.3, 0.01]], [[0.01, -0.3], [0.01, 0.3]]];
    let cross: Vec<Sweep> = (cross.iter())
        .map(|edge| downward(edge, 0.1))
        .collect::<Result<_, _>>()?;
    let panels = [
        ("five depths", ball(&parallel, bend)?, from_above),
        ("a curved blade", ball(&[curved], bend)?, from_above),
        ("a cross", ball(&cross, widen)?, from_above),
        (
            "slits in cloth",
            cloth()?,
            against(Vec3::new(0.3, 0.2, 1.0)),
        ),
    ];
    let panels = panels.into_iter().enumerate();
    let panels = panels.map(|(i, (name, surface, camera))| {
        let shown = ColoredSurface::new(surface, |surface, t| Some(color(surface, t)));
        let camera = camera.frame(shown.corners(), 1.0);
        let facts = Facts {
            method: Some("exact"),
            ..Facts::default()
        };
        Panel::from_surfaces(
            format!("({}) {name}", letter(i)),
            camera,
            vec![shown],
            facts,
        )
    });
    Ok(vec![Row {
        title: "incisions, opened by pulling at the sides".to_owned(),
        panels: panels.collect(),
    }])
}

/// Returns the sweep of a blade, given by its x and z, from above the ball down to a height \[m\].
fn downward(edge: &[[f32; 2]], height: f32) -> Result<Sweep, FigureError> {
    let pose = |y: f32| edge.iter().map(|&[x, z]| [x, y, z]).collect::<Vec<_>>();
    Ok(Sweep::strip(&pose(2.0 * RADIUS), &pose(height))?)
}

/// Returns x and z of a blade that is curved like an S \[m\].
fn s_curve() -> Vec<[f32; 2]> {
    let points = (0..BLADE_POINTS).map(|i| {
        let part = f32::from(i) / f32::from(BLADE_POINTS - 1);
        let angle = (part - 0.5) * std::f32::consts::TAU;
        [0.16 * angle.sin(), (part - 0.5) * 1.4]
    });
    points.collect()
}

/// Returns a soft ball with incisions after its pinned vertices have moved.
fn ball(sweeps: &[Sweep], target: fn(Vec3) -> Option<Vec3>) -> Result<Surface, FigureError> {
    let material = Material {
        stretch: Stiffness::Compliance(1e-4),
        volume: Some(Volume::default()),
        interior_springs: Some(InteriorSprings {
            density: 1.0,
            stiffness: Stiffness::Compliance(1e-3),
        }),
        damping: 4.0,
        ..Material::default()
    };
    pulled(cube_sphere(16, RADIUS.into()), sweeps, &material, target)
}

/// Returns a cloth with staggered slits after its sides have moved apart.
fn cloth() -> Result<Surface, FigureError> {
    let mut sweeps = Vec::new();
    for (column, x) in (0u8..).zip([-0.3, -0.18, -0.06, 0.06, 0.18, 0.3]) {
        let heights: &[f32] = match column % 2 {
            0 => &[-0.3, 0.0, 0.3],
            _ => &[-0.15, 0.15],
        };
        for y in heights {
            let edge = |z: f32| [[x, y - 0.11, z], [x, y + 0.11, z]];
            sweeps.push(Sweep::new(edge(-0.1), edge(0.1))?);
        }
    }
    let material = Material {
        stretch: Stiffness::Compliance(1e-4),
        damping: 4.0,
        ..Material::cloth()
    };
    pulled(sheet([1.0, 1.0], [24, 24]), &sweeps, &material, apart)
}

/// Cuts a surface, moves some of its vertices to their targets, and lets the rest follow.
fn pulled(
    mut surface: Surface,
    sweeps: &[Sweep],
    material: &Material,
    target: fn(Vec3) -> Option<Vec3>,
) -> Result<Surface, FigureError> {
    let mut cutter = Cutter::new(&surface);
    for sweep in sweeps {
        let _ = cutter.incise(&mut surface, sweep, &CutParams::default())?;
    }
    let mut scene = Scene::new(SceneParams::default());
    scene.params.solver.gravity = [0.0; 3];
    let pins: Vec<(VertexId, Vec3, Vec3)> = (surface.topology().vertices())
        .filter_map(|v| {
            let at = surface.position(v);
            Some((v, at, target(at)?))
        })
        .collect();
    let body = scene.add_body(surface, material)?;
    let (solver, surface) = scene.edit(body)?.solver_mut();
    for &(v, ..) in &pins {
        solver.pin(surface, v).map_err(SceneError::from)?;
    }
    let [moving, resting] = FRAMES;
    for frame in 1..=moving + resting {
        let part = f64::from(frame.min(moving)) / f64::from(moving);
        for &(v, from, to) in &pins {
            let at = incise_mesh::geometry::to_f32(from + (to - from) * part);
            scene.set_pin_target(body, v, at)?;
        }
        scene.step()?;
    }
    scene.read_back(body)?;
    Ok(scene.remove_body(body)?.surface().clone())
}

/// Returns the target of a vertex at the left or right end of the ball: the ends turn down \[m\].
fn bend(at: Vec3) -> Option<Vec3> {
    if at.x.abs() < 0.4 {
        return None;
    }
    let (sine, cosine) = (0.4 * at.x.signum()).sin_cos();
    let center = Vec3::new(0.1 * at.x.signum(), -0.4, 0.0);
    let from = at - center;
    let turned = Vec3::new(
        from.x * cosine + from.y * sine,
        from.y * cosine - from.x * sine,
        from.z,
    );
    Some(center + turned)
}

/// Returns the target of a vertex near the equator of the ball: away from the axis \[m\].
fn widen(at: Vec3) -> Option<Vec3> {
    (at.y.abs() < 0.1).then(|| Vec3::new(1.18 * at.x, at.y, 1.18 * at.z))
}

/// Returns the target of a vertex at the left or right side of the cloth \[m\].
fn apart(at: Vec3) -> Option<Vec3> {
    (at.x.abs() > 0.49).then(|| Vec3::new(1.15 * at.x, at.y, at.z))
}
