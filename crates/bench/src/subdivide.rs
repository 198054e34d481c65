//! Finer surfaces of the same shape.

use incise_mesh::{HalfEdge, Surface, TopologyError};

/// Every triangle in four: edges are halved where they are.
pub(crate) fn subdivide(surface: &Surface) -> Result<Surface, TopologyError> {
    let topology = surface.topology();
    let mut positions: Vec<[f32; 3]> = surface
        .positions
        .iter()
        .map(|p| [p[0], p[1], p[2]])
        .collect();
    let mut middles = vec![u32::MAX; 3 * topology.triangle_slots()];
    let mut triangles = Vec::with_capacity(4 * topology.triangle_count());
    for t in topology.triangles() {
        let middle = t.half_edges().map(|h: HalfEdge| {
            let twin = topology.twin(h);
            if !twin.is_null() && middles[twin.index()] != u32::MAX {
                return middles[twin.index()];
            }
            let [a, b] = [topology.origin(h), topology.target(h)].map(|v| positions[v.index()]);
            let v = u32::try_from(positions.len()).unwrap_or(u32::MAX);
            positions.push([0, 1, 2].map(|k| (a[k] + b[k]) / 2.0));
            middles[h.index()] = v;
            v
        });
        let corner = topology.triangle(t).map(|v| v.0);
        for k in 0..3 {
            triangles.push([corner[k], middle[k], middle[(k + 2) % 3]]);
        }
        triangles.push(middle);
    }
    Surface::from_triangles(&positions, &triangles)
}

#[cfg(test)]
mod tests {
    use super::*;
    use incise_mesh::{Model, build_model};

    #[test]
    fn four_times_as_many_triangles_hold_the_same_volume() {
        let coarse = build_model(Model::Sphere80);
        let fine = subdivide(&coarse).unwrap();
        assert_eq!(fine.topology().triangle_count(), 320);
        assert!(fine.topology().is_closed(), "halves of edges meet");
        let volume = |s: &Surface| s.piece_volumes()[0];
        assert!((volume(&fine) / volume(&coarse) - 1.0).abs() < 1e-6);
    }
}
