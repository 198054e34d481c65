//! Sections to cover, and what every cover fulfills.

use incise_refine::{Cover, CoverParams, CoverScratch, CoverSize, RefineError, Section, cover};
use robust::{Coord, orient2d};

/// Points and loops of a section.
#[derive(Debug, Clone, Default)]
pub(crate) struct Shape {
    pub(crate) points: Vec<[f64; 2]>,
    pub(crate) loops: Vec<Vec<u32>>,
}

impl Shape {
    pub(crate) fn add(&mut self, points: impl IntoIterator<Item = [f64; 2]>) {
        let first = index(self.points.len());
        self.points.extend(points);
        self.loops.push((first..index(self.points.len())).collect());
    }

    pub(crate) fn section(&self, crease: bool) -> Section<'_> {
        Section {
            points: &self.points,
            loops: &self.loops,
            crease,
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

pub(crate) fn index(i: usize) -> u32 {
    u32::try_from(i).expect("small")
}

pub(crate) fn cross(o: [f64; 2], a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - o[0]) * (b[1] - o[1]) - (a[1] - o[1]) * (b[0] - o[0])
}

/// Positive where a triangle turns left. The sign is exact.
fn turn(p: [[f64; 2]; 3]) -> f64 {
    let [a, b, c] = p.map(|[x, y]| Coord { x, y });
    orient2d(a, b, c)
}

pub(crate) fn polygon_area(p: &[[f64; 2]]) -> f64 {
    (1..p.len() - 1)
        .map(|i| cross(p[0], p[i], p[i + 1]) / 2.0)
        .sum()
}

pub(crate) fn corners(shape: &Shape, cover: &Cover, t: [u32; 3]) -> [[f64; 2]; 3] {
    t.map(|v| {
        let v = v as usize;
        let n = shape.points.len();
        if v < n {
            shape.points[v]
        } else {
            cover.inner[v - n].at
        }
    })
}

pub(crate) fn run(shape: &Shape, length: Option<f64>, crease: bool) -> Result<Cover, RefineError> {
    run_joined(shape, length, crease, |_, _| false)
}

pub(crate) fn run_joined(
    shape: &Shape,
    length: Option<f64>,
    crease: bool,
    joined: impl Fn(u32, u32) -> bool,
) -> Result<Cover, RefineError> {
    let params = CoverParams {
        size: length.map_or(CoverSize::Any, CoverSize::Uniform),
        ..CoverParams::default()
    };
    cover(
        &shape.section(crease),
        &params,
        joined,
        &mut CoverScratch::default(),
    )
}

/// The contract for any section.
pub(crate) fn check_any(shape: &Shape, cover: &Cover) {
    let tolerance = 1e-12 * shape.extent();
    if let Err(fault) = cover.validate(&shape.section(false), tolerance) {
        panic!("{fault}: {shape:?}");
    }
    let signed: f64 = cover
        .triangles
        .iter()
        .map(|&t| polygon_area(&corners(shape, cover, t)))
        .sum();
    let size = shape.extent().powi(2) * shape.points.len() as f64;
    assert!(
        (signed - shape.area()).abs() <= 1e-12 * size,
        "signed area {signed}, the loops' {}",
        shape.area()
    );
}

/// The contract for disjoint loops that wind as they should.
pub(crate) fn check_clean(shape: &Shape, cover: &Cover, crease: bool) {
    check_any(shape, cover);
    let area = shape.area();
    let mut sum = 0.0;
    for &t in &cover.triangles {
        let p = corners(shape, cover, t);
        let part = polygon_area(&p);
        // A corner a rounding off the line between its neighbors has an area that differences round away.
        assert!(turn(p) > 0.0, "triangle {t:?} has area {part}");
        sum += part;
        if crease {
            let (low, high) = (p.iter().any(|p| p[1] < 0.0), p.iter().any(|p| p[1] > 0.0));
            assert!(
                !(low && high),
                "triangle {t:?} lies on both sides of the crease: {p:?}"
            );
        }
    }
    assert!(
        (sum - area).abs() <= 1e-9 * area,
        "area {sum}, the section's {area}"
    );
    assert_eq!(
        (cover.report.apart, cover.report.discs),
        (0, 0),
        "nothing is apart"
    );
}
