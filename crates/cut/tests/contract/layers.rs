//! Thin layers: snapping moves a thousandth of the smaller part at most.

use crate::common::{check, lattice_box, params};
use incise_cut::{CutParams, Cutter, Sweep};
use incise_mesh::{Surface, Vec3};
use std::f64::consts::PI;

/// Cuts a copy along a plane and returns the volumes of the pieces, ascending.
fn volumes(whole: &Surface, normal: [f64; 3], d: f64, params: &CutParams) -> Vec<f64> {
    let mut surface = whole.clone();
    let sweep = Sweep::from_plane(normal, d, &whole.bounds()).unwrap();
    let outcome = Cutter::new(&surface).cut(&mut surface, &sweep, params);
    assert!(!outcome.unwrap().is_miss(), "the plane cuts");
    check(&surface);
    let mut volumes = surface.piece_volumes();
    volumes.sort_unstable_by(f64::total_cmp);
    volumes
}

/// Checks the volumes against those without snapping, which are exact up to rounding.
///
/// Each part changes by at most `share` of its own volume, the largest by that of all others.
fn check_layer(whole: &Surface, normal: [f64; 3], d: f64, share: f64) -> Vec<f64> {
    let exact = volumes(whole, normal, d, &params(0.0));
    for snap in [0.1, 0.3] {
        let snapped = volumes(whole, normal, d, &params(snap));
        assert_eq!(snapped.len(), exact.len(), "number of pieces");
        let largest = exact.len() - 1;
        for (i, (a, b)) in snapped.iter().zip(&exact).enumerate() {
            let bound = if i < largest {
                exact[i]
            } else {
                exact[..largest].iter().sum()
            };
            let part = (a - b).abs() / bound;
            assert!(part < share, "{normal:?} {d}: {part} of {bound}");
        }
    }
    exact
}

/// A plate of 100 x 100 x 10 mm; a layer of 0.1 mm lost a third of its volume.
#[test]
fn a_thin_layer_of_a_plate_keeps_its_volume() {
    for counts in [[1, 1, 1], [10, 10, 1], [23, 17, 5]] {
        let plate = lattice_box(counts, |p| {
            [p[0] * 100.0 - 50.0, p[1] * 100.0 - 50.0, p[2] * 10.0 - 5.0]
        });
        assert!((plate.volume() - 1e5).abs() < 0.1);
        for layer in [0.01, 0.03, 0.1, 0.3, 1.0] {
            for normal in [[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]] {
                let exact = check_layer(&plate, normal, 5.0 - layer, 1e-3);
                let expected = 1e4 * layer;
                // Positions are rounded to 2.4e-7 of 5 mm.
                let rounding = 1e4 * 5e-7 * 5.0;
                assert!(
                    (exact[0] - expected).abs() < rounding,
                    "{} {expected}",
                    exact[0]
                );
            }
            // A wedge, thinner to one side.
            let slope = 0.9 * layer / 50.0;
            check_layer(&plate, [slope, 0.3 * slope, 1.0], 5.0 - layer, 1e-3);
        }
    }
}

/// The layer that a plane takes off a bent plate is thinner toward its rim.
#[test]
fn a_thin_layer_of_a_bent_plate_keeps_its_volume() {
    for counts in [[8, 8, 1], [32, 16, 2]] {
        let plate = lattice_box(counts, |[x, y, z]| {
            let (sin, cos) = (0.5 * (x - 0.5)).sin_cos();
            [
                (200.0 + 10.0 * z) * sin,
                100.0 * y,
                (200.0 + 10.0 * z) * cos - 200.0,
            ]
        });
        for layer in [0.01, 0.1, 0.5, 1.0, 2.0] {
            check_layer(&plate, [0.0, 0.0, 1.0], 10.0 - layer, 1e-3);
            check_layer(&plate, [0.01, 0.02, 1.0], 11.0 - layer, 1e-3);
        }
        // From below, two layers beside the ends.
        for height in [-6.0, -5.5, -5.0] {
            check_layer(&plate, [0.0, 0.0, 1.0], height, 1e-3);
        }
    }
}

/// A part of 40 mm beside a layer says nothing about the thickness of the layer.
#[test]
fn a_post_on_a_layer_does_not_thicken_it() {
    let post = |[x, y, z]: [f64; 3]| {
        let is_post = z > 0.5 && (0.0..=0.21).contains(&x) && (0.0..=0.21).contains(&y);
        let height = if is_post { 40.0 } else { 10.0 * z };
        [100.0 * x, 100.0 * y, height]
    };
    let plate = lattice_box([10, 10, 1], post);
    // The share of the post in the section is sampled, to 10 % of the volume.
    for layer in [0.03, 0.1, 0.3] {
        check_layer(&plate, [0.0, 0.0, 1.0], 10.0 - layer, 1.1e-3);
    }
}

/// A sphere cut in two is snapped as much as its rim asks for.
#[test]
fn an_ordinary_cut_snaps_all_short_edges() {
    let ball = incise_mesh::icosphere(4, 0.5);
    for d in [0.01, 0.113, 0.27] {
        let mut surface = ball.clone();
        let sweep = Sweep::from_plane([0.1, 0.3, 1.0], d, &ball.bounds()).unwrap();
        let outcome = Cutter::new(&surface).cut(&mut surface, &sweep, &params(0.1));
        let report = outcome.unwrap().report;
        assert_eq!(report.short_rim_edges, 0);
        assert!(report.snapped_vertices > 0 && report.merged_points > 0);
        let h: f64 = 0.5 - d / Vec3::new(0.1, 0.3, 1.0).norm();
        let exact = PI * h * h * (1.5 - h) / 3.0;
        let smaller = surface.piece_volumes().into_iter().fold(1.0, f64::min);
        assert!((smaller / exact - 1.0).abs() < 1e-2, "{smaller} {exact}");
    }
}
