//! Motion and rest state do not depend on orientation, numbering, time step and iterations.

use super::{Advance, body, edges, falling, hold, sheet, still};
use incise_mesh::{Surface, Vec3, VertexId};
use incise_pbd_gpu::{Material, Solver, Stiffness};

/// Returns a net of springs of 1 m/N that rotates at 2 rad/s, stretched by a factor.
#[must_use]
pub fn spun(stretch: f64) -> (Surface, Solver, Vec3) {
    let (points, faces) = sheet(3);
    let (mut surface, mut solver) = body(&points, &faces, &edges(1.0, 0.0));
    let center = surface.bounds().center();
    for v in surface.topology().vertices().collect::<Vec<_>>() {
        let arm = surface.position(v) - center;
        let velocity = [-2.0 * arm.y as f32, 2.0 * arm.x as f32, 0.0];
        solver.set_velocity(v, velocity).expect("a vertex");
        for k in 0..3 {
            surface.positions_mut()[v.index()][k] += ((stretch - 1.0) * arm[k]) as f32;
        }
    }
    (surface, solver, center)
}

pub(super) fn drift(advance: Advance<'_>) {
    let mut lost = |h: f32| {
        // All in tension.
        let (mut surface, mut solver, center) = spun(1.2);
        let before = solver.angular_momentum(&surface, center.into())[2];
        let frames = (0.25 / h).round() as u32;
        advance(&mut surface, &mut solver, h, &still(60), frames);
        1.0 - solver.angular_momentum(&surface, center.into())[2] / before
    };
    let [coarse, fine] = [0.01, 0.005].map(&mut lost);
    assert!(coarse.abs() > 1e-3, "it drifts by {coarse}");
    let ratio = coarse / fine;
    assert!((ratio - 2.0).abs() < 0.2, "{coarse} and {fine}");
}

pub(super) fn turned(advance: Advance<'_>) {
    let mut moved = |turn: &dyn Fn(Vec3) -> Vec3| {
        let (points, faces) = sheet(4);
        let place = |p: &[f32; 3]| {
            let p = turn(Vec3::new(p[0].into(), p[1].into(), p[2].into()));
            [p.x as f32, p.y as f32, p.z as f32]
        };
        let points: Vec<[f32; 3]> = points.iter().map(place).collect();
        let material = Material {
            bending: Some(Stiffness::Compliance(1e-1)),
            ..edges(1e-3, 0.0)
        };
        let (mut surface, mut solver) = body(&points, &faces, &material);
        let zero = turn(Vec3::zeros());
        for (i, v) in surface
            .topology()
            .vertices()
            .collect::<Vec<_>>()
            .into_iter()
            .enumerate()
        {
            let wild = [0.3, 0.5, 0.7].map(|c| (c * i as f64 * 10.0).sin());
            let velocity = turn(wild.into()) - zero;
            let velocity = [velocity.x as f32, velocity.y as f32, velocity.z as f32];
            solver.set_velocity(v, velocity).expect("a vertex");
        }
        advance(
            &mut surface,
            &mut solver,
            1.0 / 60.0,
            &still(5).with_substeps(1.0 / 60.0, 4),
            20,
        );
        surface
    };
    let plain = moved(&|p| p);
    // A turn by a right angle and one of rational numbers: no rounding of its own.
    let turn = |p: Vec3| {
        Vec3::new(0.6 * p.z - 0.8 * p.x, p.y, -0.8 * p.z - 0.6 * p.x) + Vec3::new(0.5, -1.0, 0.25)
    };
    let other = moved(&turn);
    let start = sheet(4).0;
    let mut way: f64 = 0.0;
    for v in plain.topology().vertices() {
        let off = (turn(plain.position(v)) - other.position(v)).norm();
        assert!(off < 1e-4, "{v} is {off} m off");
        let from = start[v.index()].map(f64::from);
        way = way.max((plain.position(v) - Vec3::from(from)).norm());
    }
    assert!(way > 0.1, "it moves");
}

/// Returns the rest positions of a sheet that hangs by its upper row, with permuted vertices.
fn at_rest(advance: Advance<'_>, h: f32, iterations: u32, place: impl Fn(u32) -> u32) -> Vec<Vec3> {
    const N: u32 = 4;
    let (points, faces) = sheet(N);
    let mut listed = points.clone();
    for (i, p) in (0..).zip(&points) {
        listed[place(i) as usize] = *p;
    }
    let faces: Vec<[u32; 3]> = faces.iter().map(|f| f.map(&place)).collect();
    let (mut surface, mut solver) = body(&listed, &faces, &edges(1e-2, 10.0));
    hold(&mut surface, &mut solver, (0..=N).map(&place));
    let frames = (4.0 / h).round() as u32;
    advance(&mut surface, &mut solver, h, &falling(iterations), frames);
    let all = 0..(N + 1) * (N + 1);
    all.map(|v| surface.position(VertexId(place(v)))).collect()
}

fn max_distance(one: &[Vec3], other: &[Vec3]) -> f64 {
    let pairs = one.iter().zip(other);
    pairs.map(|(a, b)| (a - b).norm()).fold(0.0, f64::max)
}

/// Multipliers belong to the directions in which they were found, and these turn while a substep is
/// solved: by as much as it falls, so rest depends on the step by its square, 1e-3 of the sheet at
/// 60 a second.
pub(super) fn rest(advance: Advance<'_>) {
    let same = |v| v;
    let mut settled = |h, iterations| at_rest(advance, h, iterations, same);
    let first = settled(1.0 / 480.0, 100);
    let sag = -1.0 - first[22].y;
    assert!(sag > 0.01, "it sags by {sag} m");
    let off = max_distance(&first, &settled(1.0 / 240.0, 100));
    assert!(off < 1e-4, "{off} m off by twice the step");
    let coarse = settled(1.0 / 60.0, 100);
    let off = max_distance(&coarse, &settled(1.0 / 60.0, 400));
    assert!(off < 1e-5, "{off} m off by four times the iterations");
    let [far, near] = [coarse, settled(1.0 / 120.0, 100)].map(|p| max_distance(&first, &p));
    assert!(
        far > 3.0 * near,
        "{far} m off at 60 and {near} m at 120 a second"
    );
}

pub(super) fn order(advance: Advance<'_>) {
    let (h, iterations) = (1.0 / 60.0, 400);
    let first = at_rest(advance, h, iterations, |v| v);
    for factor in [2, 7, 18] {
        // 25 vertices: a factor without 5 renames them.
        let renamed = at_rest(advance, h, iterations, |v| v * factor % 25);
        let off = max_distance(&first, &renamed);
        assert!(off < 1e-4, "{off} m off");
    }
}
