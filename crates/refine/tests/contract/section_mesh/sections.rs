//! Section fixtures, and checks of the invariants of every section mesh.

use incise_mesh::index_u32;
use incise_refine::{
    RefineError, Section, SectionMesh, SectionMeshParams, SectionMeshScratch, SectionMeshSize,
    triangulate_section,
};
use robust::{Coord, orient2d};

/// Points and loops of a section.
#[derive(Debug, Clone, Default)]
pub(crate) struct Shape {
    pub(crate) points: Vec<[f64; 2]>,
    pub(crate) loops: Vec<Vec<u32>>,
}

impl Shape {
    pub(crate) fn add(&mut self, points: impl IntoIterator<Item = [f64; 2]>) {
        let first = index_u32(self.points.len());
        self.points.extend(points);
        self.loops
            .push((first..index_u32(self.points.len())).collect());
    }

    pub(crate) fn section(&self) -> Section<'_> {
        Section {
            points: &self.points,
            loops: &self.loops,
        }
    }

    pub(crate) fn loop_points(&self, i: usize) -> Vec<[f64; 2]> {
        self.loops[i]
            .iter()
            .map(|&v| self.points[v as usize])
            .collect()
    }

    pub(crate) fn area(&self) -> f64 {
        (0..self.loops.len())
            .map(|i| polygon_area(&self.loop_points(i)))
            .sum()
    }

    pub(crate) fn extent(&self) -> f64 {
        self.points
            .iter()
            .flatten()
            .fold(0.0, |m: f64, x| m.max(x.abs()))
    }

    pub(crate) fn map(mut self, f: impl Fn([f64; 2]) -> [f64; 2]) -> Self {
        for p in &mut self.points {
            *p = f(*p);
        }
        self
    }
}

/// Pseudorandom edges of a surrounding surface.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RandomEdges {
    pub(crate) salt: u32,
    /// Share of the pairs that have an edge, in quarters.
    pub(crate) quarters: u32,
}

impl RandomEdges {
    pub(crate) fn has_edge(self, a: u32, b: u32) -> bool {
        let low = a.min(b).wrapping_mul(0x9e37_79b9);
        let hash = low
            .wrapping_add(a.max(b) ^ self.salt)
            .wrapping_mul(0x85eb_ca6b);
        hash >> 30 < self.quarters
    }
}

/// Checks that no inner edge between two points of the section is an edge of the surface.
pub(crate) fn check_no_duplicate_edges(
    shape: &Shape,
    mesh: &SectionMesh,
    has_edge: impl Fn(u32, u32) -> bool,
) {
    let n = index_u32(shape.points.len());
    let mut rim = std::collections::HashSet::new();
    for corners in &shape.loops {
        for i in 0..corners.len() {
            rim.insert([corners[i], corners[(i + 1) % corners.len()]]);
        }
    }
    for &[a, b, c] in &mesh.triangles {
        for [v, w] in [[a, b], [b, c], [c, a]] {
            let is_rim = rim.contains(&[v, w]) || rim.contains(&[w, v]);
            assert!(v >= n || w >= n || is_rim || !has_edge(v, w), "{v} {w}");
        }
    }
}

pub(crate) fn cross(o: [f64; 2], a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - o[0]) * (b[1] - o[1]) - (a[1] - o[1]) * (b[0] - o[0])
}

/// Returns a number with the exact sign of a triangle's orientation.
fn turn(p: [[f64; 2]; 3]) -> f64 {
    let [a, b, c] = p.map(|[x, y]| Coord { x, y });
    orient2d(a, b, c)
}

pub(crate) fn polygon_area(p: &[[f64; 2]]) -> f64 {
    (1..p.len() - 1)
        .map(|i| cross(p[0], p[i], p[i + 1]) / 2.0)
        .sum()
}

pub(crate) fn corners(shape: &Shape, mesh: &SectionMesh, t: [u32; 3]) -> [[f64; 2]; 3] {
    t.map(|v| {
        let v = v as usize;
        let n = shape.points.len();
        if v < n {
            shape.points[v]
        } else {
            mesh.steiner_points[v - n].position
        }
    })
}

pub(crate) fn run(shape: &Shape, length: Option<f64>) -> Result<SectionMesh, RefineError> {
    run_with_edges(shape, length, |_, _| false)
}

pub(crate) fn run_with_edges(
    shape: &Shape,
    length: Option<f64>,
    has_edge: impl Fn(u32, u32) -> bool,
) -> Result<SectionMesh, RefineError> {
    let params = SectionMeshParams {
        size: length.map_or(SectionMeshSize::Any, SectionMeshSize::Uniform),
        grading: 0.0,
        ..SectionMeshParams::default()
    };
    triangulate_section(
        &shape.section(),
        &params,
        has_edge,
        &mut SectionMeshScratch::default(),
    )
}

/// Checks the invariants that hold for any loops.
pub(crate) fn check_any(shape: &Shape, mesh: &SectionMesh) {
    let tolerance = 1e-12 * shape.extent();
    if let Err(fault) = mesh.validate(&shape.section(), tolerance) {
        panic!("{fault}: {shape:?}");
    }
    let signed: f64 = mesh
        .triangles
        .iter()
        .map(|&t| polygon_area(&corners(shape, mesh, t)))
        .sum();
    let size = shape.extent().powi(2) * shape.points.len() as f64;
    assert!(
        (signed - shape.area()).abs() <= 1e-12 * size,
        "signed area {signed}, the loops' {}",
        shape.area()
    );
}

/// Checks the invariants that hold for disjoint loops with the right orientation.
pub(crate) fn check_clean(shape: &Shape, mesh: &SectionMesh) {
    check_any(shape, mesh);
    let area = shape.area();
    let mut sum = 0.0;
    for &t in &mesh.triangles {
        let p = corners(shape, mesh, t);
        let part = polygon_area(&p);
        // Exact, because the area of a nearly straight corner vanishes in rounded differences.
        assert!(turn(p) > 0.0, "triangle {t:?} has area {part}");
        sum += part;
    }
    assert!(
        (sum - area).abs() <= 1e-9 * area,
        "area {sum}, the section's {area}"
    );
    assert_eq!(
        (
            mesh.report.separated_loops,
            mesh.report.self_intersecting_loops
        ),
        (0, 0),
        "valid loops are neither separated nor self-intersecting"
    );
}
