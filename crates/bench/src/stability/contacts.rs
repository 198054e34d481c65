//! Contacts of pieces: a stack that comes to rest, and a ball too fast for a thin plate.

use super::case::{Case, Worst, larger};
use super::cuts::pieces;
use super::error::StressError;
use super::group::joined;
use super::measured::{Measured, Quantities, worst_of};
use super::runner::Runner;
use super::scenes::{FRAME, place};
use incise_mesh::{Bvh, Surface, Vec3, VertexId, cube_sphere, icosphere};
use incise_pbd_gpu::{InteriorSprings, Material, SolverParams, Stiffness, Volume};
use incise_scene::{BackendRequest, BodyId, ContactParams, Scene, SceneParams, SleepParams};

pub(super) const CASES: [Case; 3] = [
    Case {
        id: "contacts",
        stress: "a block cut into ten slices that lie on each other, with the default substeps",
        invariant: "time until they sleep [s]",
        bound: 60.0,
        run: |runner| worst_of(runner, 0, stack),
    },
    Case {
        id: "contacts",
        stress: "a block cut into ten slices that lie on each other, with the default substeps",
        invariant: "depth of a vertex in another piece at the end of a second, in mean edges",
        bound: 0.1,
        run: |runner| worst_of(runner, 1, stack),
    },
    Case {
        id: "tunnel",
        stress: "a ball hits a held plate of a tenth of its size by 10 of its diagonals a second",
        invariant: "vertices that pass through the plate",
        bound: 0.0,
        run: tunnel,
    },
];

/// Slices of a stack.
const SLICES: u32 = 10;

/// Longest wait for a stack to sleep \[frames\]: a second beyond the bound.
const MAX_FRAMES: u32 = 3660;

/// A stiff and a soft body with interior springs, and one of skin and volume only.
fn materials() -> [(&'static str, Material); 3] {
    let with = |stretch, interior_springs| Material {
        stretch: Stiffness::Compliance(stretch),
        volume: Some(Volume::default()),
        interior_springs,
        damping: 1.0,
        friction: 0.7,
        ..Material::default()
    };
    [
        (
            "stiff, with interior_springs",
            with(0.0, Some(InteriorSprings::default())),
        ),
        (
            "soft, with interior_springs",
            with(1e-4, Some(InteriorSprings::default())),
        ),
        ("skin and volume", with(1e-5, None)),
    ]
}

fn params(gravity: f32, ground: Option<f32>) -> SceneParams {
    SceneParams {
        dt: FRAME,
        solver: SolverParams {
            gravity: [0.0, gravity, 0.0],
            ground,
            ..SolverParams::default()
        },
        contacts: Some(ContactParams::default()),
        sleep: Some(SleepParams::default()),
        ..SceneParams::default()
    }
}

/// A block with sides of those lengths \[m\] and `squares` x `squares` squares each.
fn block(squares: u32, sides: [f64; 3]) -> Surface {
    let mut surface = cube_sphere(squares, 1.0);
    place(&mut surface, |p| {
        let cube = p / p.amax();
        Vec3::from(sides).component_mul(&cube) / 2.0
    });
    surface
}

fn piece_of(surface: &Surface, v: VertexId) -> u32 {
    surface.piece(surface.topology().outgoing(v).triangle())
}

/// Returns the largest depth of a vertex in another piece \[m\].
fn deepest(surface: &Surface) -> f64 {
    let bvh = Bvh::build(surface);
    let reach = surface.bounds().diagonal();
    let mut deepest = 0.0;
    for v in surface.topology().vertices() {
        let own = piece_of(surface, v);
        let others = |t| surface.piece(t) != own;
        if let Some(found) = bvh.nearest(surface, surface.position(v), reach, others) {
            deepest = larger(deepest, -found.distance);
        }
    }
    deepest
}

/// Cuts a block into slices, one a frame, and steps until they sleep.
///
/// Returns the time until then \[s\] and the depth of a vertex in another slice \[mean edges\].
fn lie(
    backend: &BackendRequest,
    squares: u32,
    material: &Material,
) -> Result<Quantities, StressError> {
    let mut surface = block(squares, [1.0, 3.0, 1.0]);
    place(&mut surface, |p| p + Vec3::new(0.0, 1.5, 0.0));
    let mut scene = Scene::with_backend(params(-9.81, Some(0.0)), backend)?;
    let body = scene.add_body(surface, material)?;
    let blade = scene.add_blade([[-9.0, 9.0, -9.0], [-9.0, 9.0, 9.0]]);
    for slice in 1..SLICES {
        // Not through the rows of vertices, which would be slices of their own.
        let y = 0.3 * slice as f32 + 0.007;
        scene.teleport_blade(blade, [[-9.0, y, -9.0], [-9.0, y, 9.0]])?;
        scene.move_blade(blade, [[9.0, y, -9.0], [9.0, y, 9.0]])?;
        scene.step()?;
    }
    scene.read_back(body)?;
    let made = pieces(scene.body(body)?.surface()).len();
    if made != SLICES as usize {
        return Err(StressError::Invariant(format!("{made} slices of {SLICES}")));
    }
    let (mut frames, mut depth) = (0, 0.0);
    while !scene.is_asleep(body)? && frames < MAX_FRAMES {
        scene.step()?;
        frames += 1;
        if frames % 60 == 0 {
            scene.read_back(body)?;
            let body = scene.body(body)?;
            let edge = body.solver().mean_rest_length();
            depth = larger(depth, deepest(body.surface()) / edge);
        }
    }
    let seconds = f64::from(frames) * f64::from(FRAME);
    Ok(vec![Some(seconds), Some(depth)])
}

fn stack(runner: &Runner) -> Result<Vec<Measured>, StressError> {
    let all = materials();
    let (kinds, squares) = runner.pick((1, 6), (all.len(), 10));
    let run = |backend: &BackendRequest, (name, material): &(&str, Material)| Measured {
        at: (*name).to_owned(),
        quantities: lie(backend, squares, material),
    };
    Ok(runner.each(&all[..kinds], run))
}

/// Pins the first piece of a body and throws the second downward.
fn set_up(scene: &mut Scene, body: BodyId, speed: f32) -> Result<(), StressError> {
    let (solver, surface) = scene.edit(body)?.solver_mut();
    let all: Vec<VertexId> = surface.topology().vertices().collect();
    for v in all {
        if piece_of(surface, v) == 0 {
            solver.pin(surface, v)?;
        } else {
            solver.set_velocity(v, [0.0, -speed, 0.0])?;
        }
    }
    Ok(())
}

/// Returns the vertices of the second piece in radii of the ball.
fn falling(surface: &Surface, scale: f64) -> Vec<Vec3> {
    let all = surface.topology().vertices();
    all.filter(|&v| piece_of(surface, v) == 1)
        .map(|v| surface.position(v) / scale)
        .collect()
}

/// Returns whether the segment from `p` to `q` goes down through the plate's middle.
fn comes_through(p: &Vec3, q: &Vec3) -> bool {
    let at = p + (q - p) * (p.y / (p.y - q.y));
    p.y > 0.0 && q.y <= 0.0 && at.x.abs() < 2.0 && at.z.abs() < 2.0
}

fn tunnel(runner: &mut Runner) -> Result<Worst, StressError> {
    let mut worst = Worst::default();
    let scales = [1.0, 1e-2, 1e2];
    for &scale in runner.pick(&scales[..1], &scales) {
        for offset in [0.0, 0.21, 0.37, 0.8] {
            let mut plate = block(8, [4.0, 0.2, 4.0]);
            let mut ball = icosphere(runner.pick(1, 3), 1.0);
            place(&mut ball, |p| p + Vec3::new(offset, 3.0, offset / 3.0));
            for part in [&mut plate, &mut ball] {
                place(part, |p| p * scale);
            }
            let speed = 10.0 * 2.0 * 3.0_f64.sqrt() * scale;
            for (name, material) in materials() {
                let run = || -> Result<f64, StressError> {
                    let mut scene = runner.scene(params(0.0, None))?;
                    let body =
                        scene.add_body(joined(&[plate.clone(), ball.clone()])?, &material)?;
                    #[expect(clippy::cast_possible_truncation, reason = "a speed of storage")]
                    set_up(&mut scene, body, speed as f32)?;
                    let mut through = 0;
                    let mut before = falling(scene.body(body)?.surface(), scale);
                    for _ in 0..60 {
                        scene.step()?;
                        scene.read_back(body)?;
                        let now = falling(scene.body(body)?.surface(), scale);
                        let ways = before.iter().zip(&now);
                        through += ways.filter(|(p, q)| comes_through(p, q)).count();
                        before = now;
                    }
                    Ok(through as f64)
                };
                let outcome = run();
                worst.judge(outcome, || {
                    format!("{name}, {offset} m aside, scale {scale}")
                });
            }
        }
    }
    Ok(worst)
}
