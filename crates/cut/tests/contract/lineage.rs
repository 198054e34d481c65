//! The vertices of a cut surface lie between their parents, through any number of cuts.

use incise_cut::{CutParams, Cutter, Sweep};
use incise_mesh::geometry::to_f64;
use incise_mesh::{Lineage, Vec3, icosphere};

#[test]
fn positions_follow_from_the_weights_of_the_parents() {
    let mut surface = icosphere(3, 0.5);
    let points = surface.positions().iter();
    let mut points: Vec<Vec3> = points.map(|&[x, y, z, _]| to_f64([x, y, z])).collect();
    let mut lineage = Lineage::new(&surface);
    let mut cutter = Cutter::new(&surface);
    // Without snapping no old vertex moves.
    let params = CutParams {
        snap: 0.0,
        remesh: 0.0,
        ..CutParams::default()
    };
    for normal in [[0.1, 1.0, 0.2], [1.0, 0.3, 0.1], [-0.3, 0.2, 1.0]] {
        let plane = Sweep::from_plane(normal, 0.05, &surface.bounds()).unwrap();
        let outcome = cutter.cut(&mut surface, &plane, &params).unwrap();
        lineage.follow(&outcome.delta);
    }
    assert_eq!(lineage.input_count() as usize, points.len());
    for (parents, weights) in lineage.parents().iter().zip(lineage.weights()) {
        let sum: f64 = weights.iter().sum();
        assert!((sum - 1.0).abs() < 1e-6, "weights sum to {sum}");
        let terms = parents.iter().zip(weights);
        let point: Vec3 = terms.map(|(&p, &w)| points[p as usize] * w).sum();
        points.push(point);
    }
    assert!(points.len() > 1000, "{} ids", points.len());
    let mut ids = Vec::new();
    for v in surface.topology().vertices() {
        let id = lineage.id(v) as usize;
        let error = (points[id] - surface.position(v)).norm();
        assert!(error < 1e-4, "{v}, id {id}, is {error} m off");
        ids.push(id);
    }
    ids.sort_unstable();
    assert!(
        ids.windows(2).all(|pair| pair[0] < pair[1]),
        "ids are unique"
    );
}
