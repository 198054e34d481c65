//! Draws cuts that end inside. Above, they are opened by pulling at the body: five depths in one
//! ball, a curved blade, a cross, and slits in cloth. Below are a cut through a body under tension,
//! a plug, and fifty slits that cross with a section through them.
//!
//! ```sh
//! cargo run --release -p incise-cli --example incisions -- incisions.png
//! ```

use incise_cut::{CutParams, Cutter, Incision, Sweep};
use incise_mesh::geometry::to_f32;
use incise_mesh::{Surface, Vec3, VertexId, cube_sphere, icosphere, sheet};
use incise_models::scenes::Directions;
use incise_pbd_gpu::{AdapterRequest, Context, InteriorSprings, Material, Stiffness, Volume};
use incise_render::{
    Background, BodyView, Camera, Color, DrawList, FigureGrid, Offscreen, Renderer, View, Wireframe,
};
use incise_scene::{BodyId, Scene, SceneParams};
use std::error::Error;
use std::path::Path;

/// Radius of the ball \[m\].
const RADIUS: f32 = 0.5;
/// Frames in which pinned vertices move, and frames of rest after them.
const FRAMES: [u16; 2] = [30, 30];
/// Number of points of the curved blade.
const BLADE_POINTS: u8 = 25;
/// Side of a panel [pixels].
const SIDE: u32 = 320;

fn main() -> Result<(), Box<dyn Error>> {
    let file = std::env::args_os().nth(1);
    let file = file.unwrap_or_else(|| "incisions.png".into());
    let depths = [0.1, 0.2, 0.3, 0.4, 0.5];
    let parallel: Vec<Sweep> = (depths.into_iter().zip([-0.23, -0.11, 0.01, 0.13, 0.25]))
        .map(|(depth, x)| downward(&[[x, -0.7], [x, 0.7]], RADIUS - depth))
        .collect::<Result<_, _>>()?;
    let curved = downward(&s_curve(), 0.05)?;
    let cross = [[[-0.3, 0.01], [0.3, 0.01]], [[0.01, -0.3], [0.01, 0.3]]];
    let cross: Vec<Sweep> = (cross.iter())
        .map(|edge| downward(edge, 0.1))
        .collect::<Result<_, _>>()?;
    let fifty = fifty_slits()?;
    let panels = [
        (
            "(a) five depths",
            vec![ball(&parallel, bend)?],
            [14.0, 38.0],
        ),
        (
            "(b) a curved blade",
            vec![ball(&[curved], bend)?],
            [14.0, 38.0],
        ),
        ("(c) a cross", vec![ball(&cross, widen)?], [14.0, 38.0]),
        ("(d) slits in cloth", vec![cloth()?], [17.0, 11.0]),
        (
            "(e) a cut under tension",
            vec![under_tension()?],
            [14.0, 38.0],
        ),
        ("(f) a plug, lifted", vec![plug()?], [14.0, 24.0]),
        ("(g) fifty slits", vec![fifty.clone()], [14.0, 24.0]),
        ("(h) the same, one half", half(fifty)?, [0.0, 8.0]),
    ];
    let context = Context::open(&AdapterRequest::any(None))?;
    let renderer = Renderer::offscreen(context.device(), context.queue())?;
    let offscreen = Offscreen::new(&renderer, SIDE, SIDE)?;
    let mut grid = FigureGrid::new([SIDE; 2], 4, 2)?;
    grid.title(0, "incisions, opened by pulling at the sides");
    grid.title(1, "a cut in motion, a plug, and slits that cross");
    for (number, (label, surfaces, angles)) in (0..).zip(&panels) {
        let body = |surface: &Surface| {
            BodyView::from_surface(&renderer, surface, |t| {
                let is_wall = surface.material(t) == CutParams::default().cap_material;
                Some(if is_wall { WALL } else { SKIN })
            })
        };
        let bodies = (surfaces.iter().map(body)).collect::<Result<Vec<_>, _>>()?;
        let [azimuth, elevation] = angles.map(f64::to_radians);
        let corners = surfaces.iter().flat_map(|surface| {
            (surface.topology().vertices()).map(|v| surface.positions()[v.index()])
        });
        let camera = Camera::from_angles(azimuth, elevation)
            .frame(corners.map(|[x, y, z, _]| [x, y, z]), 1.0);
        let view = View {
            background: Background::Plain(Color::rgb(255, 255, 255)),
            wireframe: Some(Wireframe::default()),
            ..View::from_camera(camera)
        };
        let content = DrawList {
            bodies: &bodies.iter().collect::<Vec<_>>(),
            overlays: &[],
        };
        grid.put(
            [number % 4, number / 4],
            &offscreen.render(&renderer, &view, &content)?,
            label,
        );
    }
    context.check()?;
    grid.into_image().write_png(Path::new(&file))?;
    Ok(())
}

const SKIN: Color = Color::rgb(154, 174, 198);
const WALL: Color = Color::rgb(222, 92, 66);

/// Returns the sweep of a blade, given by its x and z, from above the ball down to a height \[m\].
fn downward(edge: &[[f32; 2]], height: f32) -> Result<Sweep, Box<dyn Error>> {
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
fn ball(sweeps: &[Sweep], target: fn(Vec3) -> Option<Vec3>) -> Result<Surface, Box<dyn Error>> {
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
fn cloth() -> Result<Surface, Box<dyn Error>> {
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

/// Returns a ball that was pulled apart, and cut halfway by a blade while it was.
fn under_tension() -> Result<Surface, Box<dyn Error>> {
    let mut scene = Scene::new(SceneParams::default());
    scene.params.solver.gravity = [0.0; 3];
    let body = scene.add_body(icosphere(3, RADIUS.into()), &Material::soft_body())?;
    pull(&mut scene, body, |at| {
        (at.x.abs() > 0.4).then(|| Vec3::new(1.6 * at.x, at.y, at.z))
    })?;
    let edge = |y: f32| [[0.01, y, -1.0], [0.01, y, 1.0]];
    let blade = scene.add_blade(edge(0.7));
    for frame in 1..=30u8 {
        scene.move_blade(blade, edge(0.7 - 0.7 * f32::from(frame) / 30.0))?;
        scene.step()?;
    }
    for _ in 0..FRAMES[1] {
        scene.step()?;
    }
    scene.read_back(body)?;
    Ok(scene.remove_body(body)?.surface().clone())
}

/// Returns a ball from which a blade has cut a cone, lifted out.
fn plug() -> Result<Surface, Box<dyn Error>> {
    let mut ball = cube_sphere(16, RADIUS.into());
    let pose = |angle: f32, lift: f32| {
        let (sin, cos) = angle.sin_cos();
        [lift, lift + 1.0].map(|y| [0.01 + 0.7 * y * cos, 0.05 + y, 0.02 + 0.7 * y * sin])
    };
    let steps = |n: u8| (0..=n).map(move |i| f32::from(i) / f32::from(n));
    let inward = steps(20).map(|part| pose(0.0, 0.7 * (1.0 - part)));
    let around = steps(48).map(|part| pose(6.4 * part, 0.0));
    let (mut cutter, mut incision) = (Cutter::new(&ball), Incision::default());
    for blade in inward.chain(around) {
        let _ = cutter.advance(&mut ball, &mut incision, &blade, &CutParams::default())?;
    }
    let volumes = ball.piece_volumes();
    let smallest = (0u32..).zip(&volumes).min_by(|a, b| a.1.total_cmp(b.1));
    let smallest = smallest.map_or(0, |(piece, _)| piece);
    let own = ball.topology().triangles();
    let own = own.filter(|&t| ball.piece(t) == smallest);
    let mut vertices: Vec<VertexId> = own.flat_map(|t| ball.topology().triangle(t)).collect();
    vertices.sort_unstable();
    vertices.dedup();
    for v in vertices {
        ball.positions_mut()[v.index()][1] += 0.3;
    }
    Ok(ball)
}

/// Returns a ball of 320 triangles with fifty slits from its surface to its middle.
fn fifty_slits() -> Result<Surface, Box<dyn Error>> {
    let mut ball = icosphere(2, RADIUS.into());
    let mut random = Directions(3);
    let mut cutter = Cutter::new(&ball);
    for _ in 0..50 {
        let along = random.next_unit();
        let inward = random.next_unit().cross(&along).normalize();
        let offset = random.next_unit() * 0.05;
        let pose = |depth: f64| [-1.0, 1.0].map(|s| to_f32(offset + along * s + inward * depth));
        let sweep = Sweep::new(pose(-1.0), pose(0.05))?;
        let _ = cutter.incise(&mut ball, &sweep, &CutParams::default())?;
    }
    Ok(ball)
}

/// Returns the parts of a ball behind its middle.
fn half(mut ball: Surface) -> Result<Vec<Surface>, Box<dyn Error>> {
    const HEIGHT: f64 = 0.013;
    let sweep = Sweep::from_plane([0.0, 0.0, 1.0], HEIGHT, &ball.bounds())?;
    let _ = Cutter::new(&ball).cut(&mut ball, &sweep, &CutParams::default())?;
    let pieces = ball.extract_pieces().map(|(_, piece)| piece);
    let behind = pieces.filter(|piece| f64::from(piece.bounds().max[2]) < HEIGHT + 1e-4);
    Ok(behind.collect())
}

/// Cuts a surface, moves some of its vertices to their targets, and lets the rest follow.
fn pulled(
    mut surface: Surface,
    sweeps: &[Sweep],
    material: &Material,
    target: fn(Vec3) -> Option<Vec3>,
) -> Result<Surface, Box<dyn Error>> {
    let mut cutter = Cutter::new(&surface);
    for sweep in sweeps {
        let _ = cutter.incise(&mut surface, sweep, &CutParams::default())?;
    }
    let mut scene = Scene::new(SceneParams::default());
    scene.params.solver.gravity = [0.0; 3];
    let body = scene.add_body(surface, material)?;
    pull(&mut scene, body, target)?;
    scene.read_back(body)?;
    Ok(scene.remove_body(body)?.surface().clone())
}

/// Moves some vertices of a body to their targets, and lets the rest follow.
fn pull(
    scene: &mut Scene,
    body: BodyId,
    target: fn(Vec3) -> Option<Vec3>,
) -> Result<(), Box<dyn Error>> {
    let (solver, surface) = scene.edit(body)?.solver_mut();
    let pins: Vec<(VertexId, Vec3, Vec3)> = (surface.topology().vertices())
        .filter_map(|v| {
            let at = surface.position(v);
            Some((v, at, target(at)?))
        })
        .collect();
    for &(v, ..) in &pins {
        solver.pin(surface, v)?;
    }
    let [moving, resting] = FRAMES;
    for frame in 1..=moving + resting {
        let part = f64::from(frame.min(moving)) / f64::from(moving);
        for &(v, from, to) in &pins {
            scene.set_pin_target(body, v, to_f32(from + (to - from) * part))?;
        }
        scene.step()?;
    }
    Ok(())
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
