//! Walls of an incision in contact: the slit gapes under tension and stays shut under pressure.

use super::case::{Case, Worst, larger};
use super::error::StressError;
use super::runner::Runner;
use super::scenes::FRAME;
use incise_cut::{CutParams, Cutter, Sweep};
use incise_mesh::geometry::area_vector;
use incise_mesh::{Bvh, Surface, TriangleId, VertexId, cube_sphere};
use incise_pbd_gpu::{InteriorSprings, Material, SolverParams, Stiffness, Volume};
use incise_scene::{BodyId, ContactParams, Scene, SceneParams};

pub(super) const CASES: [Case; 2] = [
    Case {
        id: "gaping",
        stress: "a ball slit to its center, pulled apart across the slit by a tenth of its size",
        invariant: "missing width of the slit up to a mean edge, or depth of a wall in the other, \
                    in mean edges",
        bound: 0.1,
        run: |runner| pulled(runner, 0.1, |slit| larger(1.0 - slit.width, slit.depth)),
    },
    Case {
        id: "pressed",
        stress: "a ball slit to its center, pressed across the slit by a tenth of its size",
        invariant: "depth of a wall in the other, in mean edges",
        bound: 0.1,
        run: |runner| pulled(runner, -0.1, |slit| slit.depth),
    },
];

/// Frames in which the ends of the ball move, and as many after them.
const FRAMES: u16 = 60;

/// Radius of the ball \[m\].
const RADIUS: f64 = 0.5;

/// Minimum cosine between a wall's normal and the way to a vertex that is not beside the wall.
const MIN_COSINE: f64 = 0.7;

/// The state of a slit \[mean edges\].
struct Slit {
    /// Largest distance of a vertex from the other wall.
    width: f64,
    /// Largest depth of a vertex behind the other wall.
    depth: f64,
}

/// A soft and a firm body.
fn materials() -> [(&'static str, Material); 2] {
    let with = |compliance| Material {
        stretch: Stiffness::Compliance(compliance),
        volume: Some(Volume::default()),
        interior_springs: Some(InteriorSprings {
            density: 1.0,
            stiffness: Stiffness::Compliance(compliance),
        }),
        damping: 4.0,
        ..Material::default()
    };
    [("soft", with(1e-4)), ("firm", with(1e-5))]
}

/// Pulls the ends of slit balls apart, or together for a negative distance \[m\].
fn pulled(
    runner: &mut Runner,
    distance: f32,
    value: fn(&Slit) -> f64,
) -> Result<Worst, StressError> {
    let mut worst = Worst::default();
    let all = materials();
    for (name, material) in runner.pick(&all[..1], &all) {
        let run = || -> Result<Slit, StressError> {
            let (mut scene, body) = slit_ball(runner, material)?;
            pull(&mut scene, body, distance)?;
            scene.read_back(body)?;
            let body = scene.body(body)?;
            Ok(measure(body.surface(), body.solver().mean_rest_length()))
        };
        worst.judge(run().map(|slit| value(&slit)), || (*name).to_owned());
    }
    Ok(worst)
}

/// Returns a weightless ball that is slit from above to its center, across the x axis.
fn slit_ball(runner: &Runner, material: &Material) -> Result<(Scene, BodyId), StressError> {
    let mut ball = cube_sphere(12, RADIUS);
    let pose = |y: f32| [[0.01, y, -0.7], [0.01, y, 0.7]];
    let sweep = Sweep::new(pose(0.7), pose(0.005))?;
    let mut cutter = Cutter::new(&ball);
    let outcome = cutter.incise(&mut ball, &sweep, &CutParams::default())?;
    if outcome.is_miss() {
        return Err(StressError::Invariant("the slit misses".to_owned()));
    }
    let mut scene = runner.scene(SceneParams {
        dt: FRAME,
        solver: SolverParams {
            gravity: [0.0; 3],
            ..SolverParams::default()
        },
        contacts: Some(ContactParams {
            self_collision: true,
            ..ContactParams::default()
        }),
        ..SceneParams::default()
    })?;
    let body = scene.add_body(ball, material)?;
    Ok((scene, body))
}

/// Moves both ends of the ball by half the distance \[m\], then holds them.
fn pull(scene: &mut Scene, body: BodyId, distance: f32) -> Result<(), StressError> {
    let (solver, surface) = scene.edit(body)?.solver_mut();
    let ends: Vec<VertexId> = (surface.topology().vertices())
        .filter(|&v| surface.position(v).x.abs() > 0.8 * RADIUS)
        .collect();
    for &v in &ends {
        solver.pin(surface, v)?;
    }
    let start: Vec<[f32; 4]> = ends
        .iter()
        .map(|v| surface.positions()[v.index()])
        .collect();
    for frame in 1..=2 * FRAMES {
        let part = f32::from(frame.min(FRAMES)) / f32::from(FRAMES);
        for (&v, &[x, y, z, _]) in ends.iter().zip(&start) {
            let x = x + 0.5 * distance * x.signum() * part;
            scene.set_pin_target(body, v, [x, y, z])?;
        }
        scene.step()?;
    }
    Ok(())
}

/// Measures the slit relative to the length of an edge \[m\].
///
/// A vertex's distance from the other wall is that along the normal there, so that walls may slide.
/// Vertices beside the other wall are left out.
fn measure(surface: &Surface, edge: f64) -> Slit {
    let topology = surface.topology();
    let cap = CutParams::default().cap_material;
    // Walls at rest face along x, towards each other.
    let wall_of = |t: TriangleId| {
        let [a, b, c] = topology.triangle(t).map(|v| surface.rest_position(v));
        (surface.material(t) == cap).then(|| (b - a).cross(&(c - a)).x > 0.0)
    };
    let bvh = Bvh::build(surface);
    let mut slit = Slit {
        width: 0.0,
        depth: 0.0,
    };
    for v in topology.vertices() {
        let mut walls = topology
            .outgoing_fan(v)
            .filter_map(|h| wall_of(h.triangle()));
        let Some(own) = walls.next() else { continue };
        // Vertices of the tip are on both.
        if walls.any(|wall| wall != own) {
            continue;
        }
        let other = |t: TriangleId| wall_of(t) == Some(!own);
        let at = surface.position(v);
        let Some(found) = bvh.nearest(surface, at, 4.0 * edge, other) else {
            continue;
        };
        let normal = area_vector(surface.triangle_positions(found.triangle)).normalize();
        let is_beside = normal.dot(&(at - found.point)).abs() < MIN_COSINE * found.distance.abs();
        if !is_beside {
            slit.width = larger(slit.width, found.distance / edge);
            slit.depth = larger(slit.depth, -found.distance / edge);
        }
    }
    slit
}
