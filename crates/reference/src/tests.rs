//! Derivatives against differences, one constraint at a time and together.

use super::edge::{Edge, edge};
use super::hinge::{Hinge, hinge};
use super::matrix::System;
use super::measure::{Kind, Measure, energy_hessian};
use super::model::{Constraints, Model, Plane};
use super::objective::Objective;
use super::volume::{Piece, Volumes};
use nalgebra::{Rotation3, Vector3};
use std::f64::consts::{PI, TAU};

const SCALES: [f64; 3] = [1.0, 0.05, 0.001];
const FOLDED: f64 = PI - 1e-3;
const ANGLES: [f64; 9] = [0.0, 1e-6, -1e-3, 0.3, 0.7, -1.5, 2.5, FOLDED, -FOLDED];

fn tilt() -> Rotation3<f64> {
    Rotation3::from_euler_angles(0.4, 1.1, -0.3)
}

/// A skew hinge that is bent by `angle`, edges of about `scale`.
fn hinge_points(angle: f64, scale: f64) -> [Vector3<f64>; 4] {
    let (sin, cos) = angle.sin_cos();
    let points = [
        Vector3::new(0.1, 0.0, 0.0),
        Vector3::new(1.2, 0.0, 0.0),
        Vector3::new(0.4, 0.9, 0.0),
        Vector3::new(0.8, -1.2 * cos, -1.2 * sin),
    ];
    points.map(|p| tilt() * p * scale)
}

fn edge_points(scale: f64) -> [Vector3<f64>; 2] {
    [Vector3::new(0.1, 0.2, -0.4), Vector3::new(0.9, -0.3, 0.5)].map(|p| p * scale)
}

/// Gradient and second derivatives against central differences of value and gradient.
fn check_derivatives<const N: usize>(
    of: impl Fn(&[Vector3<f64>; N]) -> Option<Measure<N>>,
    points: [Vector3<f64>; N],
    scale: f64,
) {
    let at = of(&points).unwrap();
    let step = 1e-5 * scale;
    let largest = (at.gradient.iter()).fold(0.0, |far: f64, g| far.max(g.amax()));
    let blocks = at.hessian.as_flattened();
    let steepest = blocks.iter().fold(0.0, |far: f64, b| far.max(b.amax()));
    for j in 0..N {
        for k in 0..3 {
            let moved = |by: f64| {
                let mut points = points;
                points[j][k] += by;
                of(&points).unwrap()
            };
            let (up, down) = (moved(step), moved(-step));
            let mut change = up.value - down.value;
            change -= TAU * (change / TAU).round();
            let slope = change / (2.0 * step);
            let off = (slope - at.gradient[j][k]).abs() / largest;
            assert!(off < 1e-6, "gradient {j} {k}: off by {off:e}");
            for i in 0..N {
                let slope = (up.gradient[i] - down.gradient[i]) / (2.0 * step);
                let off = (slope - at.hessian[i][j].column(k)).amax() / steepest;
                assert!(off < 1e-6, "Hessian {i} {j} {k}: off by {off:e}");
            }
        }
    }
}

#[test]
fn derivatives_are_those_of_differences_at_every_scale() {
    for scale in SCALES {
        check_derivatives(edge, edge_points(scale), scale);
        for angle in ANGLES {
            let points = hinge_points(angle, scale);
            assert!(
                (hinge(&points).unwrap().value - angle).abs() < 1e-12,
                "the angle itself"
            );
            check_derivatives(hinge, points, scale);
        }
    }
}

#[test]
fn a_needle_of_a_triangle_has_its_derivatives_too() {
    let mut points = hinge_points(0.8, 1.0);
    // A height of 1e-3 of the edge, so differences have to be as much finer.
    let foot = points[0] + (points[1] - points[0]) * 0.4;
    points[2] = foot + (points[2] - foot) * 1e-3;
    check_derivatives(hinge, points, 1e-3);
    points[2] = foot;
    assert_eq!(hinge(&points), None, "no normal, no angle");
    assert_eq!(edge(&[foot, foot]), None, "no length, no direction");
}

/// Value unchanged by a motion, no force and no torque of the gradient.
fn check_invariance<const N: usize>(
    of: impl Fn(&[Vector3<f64>; N]) -> Option<Measure<N>>,
    points: [Vector3<f64>; N],
) {
    let at = of(&points).unwrap();
    let shift = Vector3::new(3.0, -1.0, 2.0) * points[1].norm();
    let moved = of(&points.map(|p| tilt() * p + shift)).unwrap();
    assert!(
        (moved.value - at.value).abs() < 1e-12 * at.value.abs().max(1.0),
        "the value of {points:?}"
    );
    let size: f64 = at.gradient.iter().map(|g| g.norm()).sum();
    let force: Vector3<f64> = at.gradient.iter().sum();
    assert!(force.norm() < 1e-12 * size, "a force on itself");
    let arms = points.iter().zip(&at.gradient);
    let torque: Vector3<f64> = arms.map(|(p, g)| p.cross(g)).sum();
    let arm = points.iter().fold(0.0, |far: f64, p| far.max(p.norm()));
    assert!(torque.norm() < 1e-12 * size * arm, "a torque on itself");
}

#[test]
fn motions_change_nothing_and_gradients_neither_push_nor_turn() {
    for scale in SCALES {
        check_invariance(edge, edge_points(scale));
        for angle in ANGLES {
            check_invariance(hinge, hinge_points(angle, scale));
        }
    }
}

/// The smallest and the largest eigenvalue of blocks.
fn spectrum<const N: usize>(blocks: &[[nalgebra::Matrix3<f64>; N]; N]) -> (f64, f64) {
    let matrix =
        nalgebra::DMatrix::from_fn(3 * N, 3 * N, |r, c| blocks[r / 3][c / 3][(r % 3, c % 3)]);
    let values = matrix.symmetric_eigenvalues();
    (values.min(), values.max())
}

fn check_clamp<K: Kind<N>, const N: usize>(points: [Vector3<f64>; N], rest: f64, indefinite: bool) {
    let measure = K::measure(&points).unwrap();
    let plain = energy_hessian(&measure, K::error(measure.value, rest));
    let mut clamped = plain;
    K::clamp(&mut clamped);
    let (least, most) = spectrum(&plain);
    assert_eq!(
        least < -1e-6 * most,
        indefinite,
        "the case is not what it is meant to be"
    );
    let (least, _) = spectrum(&clamped);
    assert!(least > -1e-12 * most, "{least:e} is left of {most:e}");
    let mut difference = plain;
    for (row, other) in difference.iter_mut().zip(&clamped) {
        for (block, other) in row.iter_mut().zip(other) {
            *block = other - *block;
        }
    }
    let (least, _) = spectrum(&difference);
    assert!(least > -1e-12 * most, "it only adds");
    let added = difference
        .as_flattened()
        .iter()
        .fold(0.0, |far: f64, b| far.max(b.amax()));
    if !indefinite {
        assert!(added < 1e-6 * most, "what is positive stays as it is");
    }
}

#[test]
fn clamping_takes_negative_eigenvalues_and_nothing_else() {
    check_clamp::<Edge, 2>(edge_points(1.0), 5.0, true);
    check_clamp::<Edge, 2>(edge_points(1.0), 0.5, false);
    check_clamp::<Hinge, 4>(hinge_points(0.8, 1.0), 0.0, true);
    check_clamp::<Hinge, 4>(hinge_points(0.8, 1.0), 0.8, false);
}

#[test]
fn angles_are_compared_the_short_way_round() {
    assert!(
        (Hinge::error(3.0, -3.0) - (6.0 - TAU)).abs() < 1e-15,
        "across pi"
    );
    assert!(
        (Hinge::error(-3.0, 3.0) - (TAU - 6.0)).abs() < 1e-15,
        "and back"
    );
}

/// Two triangles with a hinge, one vertex held, on a plane, with multipliers.
fn small() -> (Model, Vec<Vector3<f64>>, Vec<Vector3<f64>>) {
    let x: Vec<Vector3<f64>> = hinge_points(0.4, 1.0).to_vec();
    let goal = x
        .iter()
        .map(|p| p * 1.1 + Vector3::new(0.02, -0.1, 0.03))
        .collect();
    let model = Model {
        mass: vec![0.3, 0.0, 0.7, 1.1],
        stretch: Constraints {
            vertices: vec![[0, 1], [1, 2], [2, 0], [0, 3], [3, 1]],
            rest: vec![1.0, 1.2, 0.9, 1.4, 1.3],
            compliance: 1e-3,
        },
        bending: Constraints {
            vertices: vec![[0, 1, 2, 3]],
            rest: vec![0.1],
            compliance: 0.0,
        },
        plane: Some(Plane {
            normal: Vector3::new(0.6, 0.8, 0.0),
            offset: 0.3,
        }),
        ..Model::default()
    };
    (model, x, goal)
}

/// The same as a closed piece of more volume than at rest.
fn with_volume(compressibility: f64) -> (Model, Vec<Vector3<f64>>, Vec<Vector3<f64>>) {
    let (mut model, x, goal) = small();
    let triangles = vec![[0, 1, 2], [1, 0, 3], [2, 1, 3], [0, 2, 3]];
    model.volumes = Volumes {
        pieces: vec![Piece::new(triangles, 0.05).unwrap()],
        compressibility,
        pressure: 1.2,
    };
    (model, x, goal)
}

#[test]
fn the_objective_has_the_gradient_and_matrix_of_differences() {
    for (model, x, goal) in [small(), with_volume(1e-3), with_volume(0.0)] {
        check_objective(&model, &x, goal);
    }
}

fn check_objective(model: &Model, x: &[Vector3<f64>], goal: Vec<Vector3<f64>>) {
    let mut objective = Objective::new(model, 0.1, x, goal);
    let lack = objective.update(x);
    assert!(lack > 0.0, "the hinge is rigid and bent");
    let mut system = System::new(model).unwrap();
    let gradient = objective.derivatives(x, &mut system, false);
    let scale = gradient.iter().fold(0.0, |far: f64, g| far.max(g.amax()));
    let step = 1e-6;
    for (v, k) in (0..4).flat_map(|v| (0..3).map(move |k| (v, k))) {
        let mut way = vec![Vector3::zeros(); 4];
        way[v][k] = if model.mass[v] > 0.0 { 1.0 } else { 0.0 };
        let moved = |by: f64| -> Vec<Vector3<f64>> {
            x.iter().zip(&way).map(|(x, way)| x + way * by).collect()
        };
        let slope = (objective.value(&moved(step)) - objective.value(&moved(-step))) / (2.0 * step);
        assert!(
            (slope - gradient[v][k]).abs() < 1e-6 * scale,
            "gradient {v} {k}"
        );
        let mut other = System::new(model).unwrap();
        let up = objective.derivatives(&moved(step), &mut other, false);
        let down = objective.derivatives(&moved(-step), &mut other, false);
        let column = system.multiply(&way, model);
        let steepest = column.iter().fold(scale, |far: f64, g| far.max(g.amax()));
        for i in 0..4 {
            let slope = (up[i] - down[i]) / (2.0 * step);
            let off = (slope - column[i]).amax();
            assert!(off < 1e-6 * steepest, "matrix {i}, {v} {k}: {off:e}");
        }
    }
}

/// Woodbury's formula against the matrix itself, made positive.
#[test]
fn a_system_with_a_dense_part_is_solved() {
    for compressibility in [1e-3, 0.0] {
        let (model, x, goal) = with_volume(compressibility);
        let objective = Objective::new(&model, 0.1, &x, goal);
        let mut system = System::new(&model).unwrap();
        let mut gradient = objective.derivatives(&x, &mut system, true);
        let mut product = System::new(&model).unwrap();
        objective.derivatives(&x, &mut product, true);
        assert!(system.factor(), "it was made positive");
        for _ in 0..2 {
            let solved = system.solve(&gradient).unwrap();
            let back = product.multiply(&solved, &model);
            let scale = gradient.iter().fold(0.0, |far: f64, g| far.max(g.amax()));
            for (v, (back, right)) in back.iter().zip(&gradient).enumerate() {
                let off = (back - right).amax() / scale;
                assert!(off < 1e-9, "vertex {v}: {off:e} at {compressibility}");
            }
            // A factor serves for other right sides.
            gradient.swap(2, 3);
        }
    }
}
