//! An independent reference: Dirichlet energy by triangle, and a dense solver.

use incise_refine::SectionMesh;
use nalgebra::DMatrix;

/// Returns the gradients of a triangle's three hat functions, and its area.
fn gradients([p, q, r]: [[f64; 2]; 3]) -> ([[f64; 2]; 3], f64) {
    let doubled = (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
    let across = |a: [f64; 2], b: [f64; 2]| [(a[1] - b[1]) / doubled, (b[0] - a[0]) / doubled];
    (
        [across(q, r), across(r, p), across(p, q)],
        doubled.abs() / 2.0,
    )
}

fn place(mesh: &SectionMesh, points: &[[f64; 2]], v: u32) -> [f64; 2] {
    match (v as usize).checked_sub(points.len()) {
        None => points[v as usize],
        Some(i) => mesh.steiner_points[i].position,
    }
}

/// Returns the Dirichlet energy: the integral of the squared gradients.
pub(crate) fn energy(
    mesh: &SectionMesh,
    points: &[[f64; 2]],
    values: &[[f64; 3]],
    inner: &[[f64; 3]],
) -> f64 {
    let mut sum = 0.0;
    for &t in &mesh.triangles {
        let (slopes, area) = gradients(t.map(|v| place(mesh, points, v)));
        let of = t.map(|v| match (v as usize).checked_sub(points.len()) {
            None => values[v as usize],
            Some(i) => inner[i],
        });
        let slope = |k: usize, axis: usize| -> f64 {
            let pairs = of.iter().zip(&slopes);
            pairs.map(|(value, slope)| value[k] * slope[axis]).sum()
        };
        let squares = [0, 1, 2].map(|k| slope(k, 0).powi(2) + slope(k, 1).powi(2));
        sum += area * squares.iter().sum::<f64>();
    }
    sum
}

/// Returns the values of minimum energy.
pub(crate) fn solve(mesh: &SectionMesh, points: &[[f64; 2]], values: &[[f64; 3]]) -> Vec<[f64; 3]> {
    let (n, unknowns) = (points.len(), mesh.steiner_points.len());
    let mut matrix = DMatrix::<f64>::zeros(unknowns, unknowns);
    let mut right = DMatrix::<f64>::zeros(unknowns, 3);
    for &t in &mesh.triangles {
        let (slopes, area) = gradients(t.map(|v| place(mesh, points, v)));
        for (i, &v) in t.iter().enumerate() {
            let Some(row) = (v as usize).checked_sub(n) else {
                continue;
            };
            for (j, &w) in t.iter().enumerate() {
                let entry = area * (slopes[i][0] * slopes[j][0] + slopes[i][1] * slopes[j][1]);
                match (w as usize).checked_sub(n) {
                    Some(column) => matrix[(row, column)] += entry,
                    None => {
                        for k in 0..3 {
                            right[(row, k)] -= entry * values[w as usize][k];
                        }
                    }
                }
            }
        }
    }
    let found = matrix.cholesky().unwrap().solve(&right);
    (0..unknowns)
        .map(|i| [0, 1, 2].map(|k| found[(i, k)]))
        .collect()
}
