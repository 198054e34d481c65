use super::coordinates::{self, COORDINATES};
use super::free_pieces::FreePieces;
use super::lanes::Row;
use super::local::LocalFactor;
use super::matrix::{Factor, MatrixInput, NO_ROW};
use super::objective::{Compliances, Objective};
use super::*;
use crate::solver::Solver;
use incise_mesh::{Vec3, icosphere};
use std::sync::Arc;

const COMPLIANCES: Compliances = Compliances {
    stretch: 0.3,
    bending: 2.0,
    interior_springs: 0.7,
};

/// A ball of several stiffnesses with springs along its diameters, and displaced points.
fn ball() -> (Solver, Surface, Vec<Vec3>) {
    let mut surface = icosphere(1, 0.5);
    let mut solver = Solver::new(&mut surface, &Material::soft_body()).unwrap();
    let vertices: Vec<VertexId> = surface.topology().vertices().collect();
    let ends: Vec<[VertexId; 2]> = vertices
        .iter()
        .zip(vertices.iter().rev())
        .map(|(&a, &b)| [a, b])
        .collect();
    solver.add_interior_springs(&surface, &ends).unwrap();
    let point = |v: &VertexId| {
        let x = surface.position(*v);
        x + Vec3::new((7.0 * x.y).sin(), (5.0 * x.z).cos(), x.x * x.y) * 0.05
    };
    let points = vertices.iter().map(point).collect();
    (solver, surface, points)
}

#[test]
fn the_gradient_is_that_of_the_value() {
    let (mut solver, _, points) = ball();
    let (_, constraints, _) = solver.step_parts();
    let objective = Objective::new(sets(constraints), COMPLIANCES);
    let evaluate = |points: &[Vec3], gradient: &mut Vec<Row>| {
        let masses = (0..).map(|i| 1.0 + 0.1 * f64::from(i));
        let rows: Vec<Row> = points.iter().map(|&x| Row::from(x)).collect();
        objective.evaluate(&rows, points.iter().copied().zip(masses), gradient)
    };
    let mut gradient = Vec::new();
    let value = evaluate(&points, &mut gradient);
    let gradient: Vec<Vec3> = gradient.into_iter().map(Vec3::from).collect();
    assert!(
        value > 0.0 && gradient.iter().any(|g| g.norm() > 1e-3),
        "all constraints are active"
    );
    let step = 1e-6;
    for i in [0, 5, 17, 41] {
        for k in 0..3 {
            let [low, high] = [-step, step].map(|by| {
                let mut moved = points.clone();
                moved[i][k] += by;
                evaluate(&moved, &mut Vec::new())
            });
            let expected = (high - low) / (2.0 * step);
            let found = gradient[i][k];
            assert!(
                (found - expected).abs() < 1e-6 * (1.0 + expected.abs()),
                "{found}, not {expected}"
            );
        }
    }
}

/// Returns the product of the inverse with a vector, for the vertices with a row.
fn solve(factor: &Factor, rows: &[u32], vector: &mut [Vec3]) {
    let mut scratch = factor.cholesky.scratch(COORDINATES).expect("memory");
    let rows = rows.iter().enumerate().filter(|&(_, &row)| row != NO_ROW);
    let rows = rows.map(|(v, &row)| (row as usize, v));
    coordinates::solve(&factor.cholesky, rows, vector, &mut scratch);
}

#[test]
fn the_factor_solves_the_assembled_matrix() {
    let (mut solver, surface, points) = ball();
    let (_, constraints, _) = solver.step_parts();
    let input = Arc::new(MatrixInput::new(&sets(constraints), &surface, COMPLIANCES));
    let factor = input.factor().expect("masses are positive");
    let mut solved = input.times(&points);
    solve(&factor, &factor.rows, &mut solved);
    for (found, expected) in solved.iter().zip(&points) {
        assert!((found - expected).norm() < 1e-12, "{found}, not {expected}");
    }
    // Translations strain nothing: only masses are left.
    let moved = input.times(&vec![Vec3::new(1.0, 2.0, 3.0); points.len()]);
    for (found, p) in moved.iter().zip(surface.positions()) {
        let expected = Vec3::new(1.0, 2.0, 3.0) / f64::from(p[3]);
        assert!((found - expected).norm() < 1e-9, "{found}, not {expected}");
    }
}

#[test]
fn a_local_factor_beside_a_current_one_is_exact() {
    let (mut solver, surface, points) = ball();
    let (_, constraints, _) = solver.step_parts();
    let input = Arc::new(MatrixInput::new(&sets(constraints), &surface, COMPLIANCES));
    let factor = input.factor().expect("masses are positive");
    let mut rows = factor.rows.clone();
    for v in [0, 3, 4, 17, 30] {
        rows[v] = NO_ROW;
    }
    let mut local = LocalFactor::new(&input, &rows).expect("a part of a positive matrix");
    for _ in 0..2 {
        let mut solved = input.times(&points);
        local.apply(&mut solved, |vector| solve(&factor, &rows, vector));
        for (found, expected) in solved.iter().zip(&points) {
            assert!((found - expected).norm() < 1e-12, "{found}, not {expected}");
        }
    }
    assert!(LocalFactor::new(&input, &factor.rows).is_none());
}

#[test]
fn a_free_piece_gets_the_translation_of_its_gradient() {
    let (mut solver, surface, points) = ball();
    let (_, constraints, _) = solver.step_parts();
    let input = Arc::new(MatrixInput::new(&sets(constraints), &surface, COMPLIANCES));
    let factor = input.factor().expect("masses are positive");
    let mut free = FreePieces::new(&input, &surface);
    // Any other inverse gives the same momentum.
    let gradient = input.times(&points);
    let mut direction = gradient.clone();
    free.apply(&mut direction, |vector| {
        for (i, x) in vector.iter_mut().enumerate() {
            *x *= 1.0 + i as f64;
        }
    });
    let masses = (0..points.len()).map(|v| input.mass(v));
    let momentum: Vec3 = direction.iter().zip(masses).map(|(d, mass)| d * mass).sum();
    let force: Vec3 = gradient.iter().sum();
    assert!((momentum - force).norm() < 1e-9, "{momentum}, not {force}");
    // The exact inverse stays as it is.
    let mut solved = gradient;
    free.apply(&mut solved, |vector| solve(&factor, &factor.rows, vector));
    for (found, expected) in solved.iter().zip(&points) {
        assert!((found - expected).norm() < 1e-12, "{found}, not {expected}");
    }
}
