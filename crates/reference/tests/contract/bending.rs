//! Bending of a clamped strip in the reference against beam theory, for every diagonal pattern.

use crate::common::{G, gravity, run};
use incise_reference::{Constraints, Model, State};
use nalgebra::Vector3;

/// Diagonals of the rectangles of a strip.
#[derive(Debug, Clone, Copy)]
enum Diagonals {
    Rising,
    Falling,
    Alternating,
}

impl Diagonals {
    fn rises(self, rectangle: usize) -> bool {
        match self {
            Self::Rising => true,
            Self::Falling => false,
            Self::Alternating => rectangle.is_multiple_of(2),
        }
    }
}

/// How far the free end of a strip of 1 m by 0.5 m and 1 N/m comes down \[m\], by its flexural
/// rigidity [N m^2].
///
/// A rectangle has one hinge across and one along its diagonal, of which each takes half of the
/// turn: rigidity is their distance by twice their compliance. So the first hinge stands for the
/// strip from a quarter of a rectangle before it on, and it is there that the strip is clamped.
fn tip(rectangles: usize, diagonals: Diagonals, rigidity: f64) -> f64 {
    let wide = 1.0 / (rectangles as f64 - 0.75);
    let x: Vec<Vector3<f64>> = (0..=rectangles)
        .flat_map(|i| [0.0, 0.5].map(|z| Vector3::new((i as f64 - 0.75) * wide, 0.0, z)))
        .collect();
    let (mut edges, mut hinges) = (Vec::new(), Vec::new());
    // The corner of a rectangle that is in one triangle with an edge across.
    let left = |i: usize| 2 * i - if diagonals.rises(i - 1) { 2 } else { 1 };
    let right = |i: usize| 2 * i + if diagonals.rises(i) { 3 } else { 2 };
    for i in 0..=rectangles {
        let [a, b] = [2 * i, 2 * i + 1];
        edges.push([a, b]);
        if i == rectangles {
            break;
        }
        let [c, d] = [a + 2, b + 2];
        edges.extend([[a, c], [b, d]]);
        let diagonal = if diagonals.rises(i) { [a, d] } else { [b, c] };
        edges.push(diagonal);
        if i > 0 {
            hinges.push([a, b, left(i), right(i)]);
            let others = if diagonals.rises(i) { [b, c] } else { [d, a] };
            hinges.push([diagonal[0], diagonal[1], others[0], others[1]]);
        }
    }
    let mass = (0..x.len()).map(|v| match v / 2 {
        0 | 1 => 0.0,
        column if column == rectangles => wide / G / 4.0,
        _ => wide / G / 2.0,
    });
    let model = Model {
        mass: mass.collect(),
        stretch: Constraints {
            rest: edges
                .iter()
                .map(|&[a, b]: &[usize; 2]| (x[b] - x[a]).norm())
                .collect(),
            vertices: edges,
            compliance: 0.0,
        },
        bending: Constraints {
            rest: vec![0.0; hinges.len()],
            vertices: hinges,
            compliance: wide / (2.0 * rigidity),
        },
        gravity: gravity(),
        damping: 1.0,
        ..Model::default()
    };
    let mut state = State::at(x);
    run(&model, &mut state, 1.0, 12);
    let fastest = state.v.iter().map(|v| v.norm()).fold(0.0, f64::max);
    assert!(fastest < 1e-5, "it still moves at {fastest} m/s");
    let [a, b] = [2 * rectangles, 2 * rectangles + 1].map(|v| state.x[v].y);
    -f64::midpoint(a, b)
}

/// The same of a beam that bends and does not stretch: `rigidity theta'' = -(1 - s) cos theta`,
/// theta its slope downward, clamped at s = 0 and free at s = 1. Found by shooting with steps of
/// the fourth order.
fn heavy_elastica(rigidity: f64) -> f64 {
    let rate = |s: f64, [theta, turn, _]: [f64; 3]| {
        [turn, -(1.0 - s) * theta.cos() / rigidity, theta.sin()]
    };
    let shoot = |turn: f64| {
        let steps = 1000_u16;
        let h = 1.0 / f64::from(steps);
        let mut at = [0.0, turn, 0.0];
        for i in 0..steps {
            let s = h * f64::from(i);
            let off = |k: [f64; 3], by: f64| std::array::from_fn(|j| at[j] + by * k[j]);
            let k1 = rate(s, at);
            let k2 = rate(s + h / 2.0, off(k1, h / 2.0));
            let k3 = rate(s + h / 2.0, off(k2, h / 2.0));
            let k4 = rate(s + h, off(k3, h));
            at = std::array::from_fn(|j| at[j] + h / 6.0 * (k1[j] + 2.0 * (k2[j] + k3[j]) + k4[j]));
        }
        at
    };
    let (mut low, mut high) = (0.0, 1.0 / rigidity);
    for _ in 0..100 {
        let middle = f64::midpoint(low, high);
        if shoot(middle)[1] > 0.0 {
            high = middle;
        } else {
            low = middle;
        }
    }
    shoot(low)[2]
}

const ALL: [Diagonals; 3] = [
    Diagonals::Rising,
    Diagonals::Falling,
    Diagonals::Alternating,
];

#[test]
fn a_stiff_strip_sags_as_a_beam() {
    let rigidity = 20.0;
    let expected = 1.0 / (8.0 * rigidity);
    assert!(
        (heavy_elastica(rigidity) / expected - 1.0).abs() < 1e-3,
        "the elastica is a beam"
    );
    for diagonals in ALL {
        let found = tip(32, diagonals, rigidity);
        assert!(
            (found / expected - 1.0).abs() < 0.02,
            "{diagonals:?}: {found} m, not {expected} m"
        );
    }
}

#[test]
fn a_limp_strip_hangs_as_the_elastica() {
    for rigidity in [0.3, 0.05] {
        let expected = heavy_elastica(rigidity);
        for diagonals in ALL {
            let found = tip(32, diagonals, rigidity);
            assert!(
                (found / expected - 1.0).abs() < 0.02,
                "{diagonals:?}: {found} m, not {expected} m"
            );
        }
    }
}

#[test]
fn a_finer_strip_is_nearer_to_the_elastica() {
    let expected = heavy_elastica(0.3);
    let off = [8, 16, 32].map(|n| (tip(n, Diagonals::Alternating, 0.3) / expected - 1.0).abs());
    assert!(off[1] < off[0] / 2.0 && off[2] < off[1] / 2.0, "{off:?}");
}
