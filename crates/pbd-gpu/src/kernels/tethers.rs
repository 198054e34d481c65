//! Tethers pull back what is too far from where it is held.

use super::block::difference;
use super::displacements::Displacements;
use crate::tethers::Tether;

/// Moves every vertex that is farther from its anchor than its tether is long straight back to that distance. Anchors do
/// not move and no two tethers share a vertex.
#[inline(always)]
pub(crate) fn tethers(x: &[[f32; 4]], d: &mut impl Displacements, tethers: &[Tether]) {
    for tether in tethers {
        let (v, anchor) = (tether.vertex.index(), tether.anchor.index());
        let (xv, mut dv) = (x[v], d.get(v));
        let [x, y, z, _] = difference(xv, dv, x[anchor], d.get(anchor));
        let length = (x * x + y * y + z * z).sqrt();
        // Whoever holds a vertex by its mass means it.
        if length > tether.length && xv[3] > 0.0 {
            let back = (length - tether.length) / length;
            dv[0] += x * back;
            dv[1] += y * back;
            dv[2] += z * back;
            d.set(v, dv);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use incise_mesh::VertexId;

    #[test]
    fn what_is_too_far_comes_straight_back_and_the_rest_stays() {
        let x = [
            [1.0, 0.0, 0.0, 0.0],
            [1.0, 3.0, 0.0, 1.0],
            [1.0, 0.0, 1.5, 1.0],
            [9.0, 0.0, 0.0, 0.0],
        ];
        let mut d = [
            [0.0; 4],
            [0.0, 0.0, 4.0, 0.0],
            [0.0, 0.25, 0.0, 0.0],
            [0.0; 4],
        ];
        let all = [1, 2, 3].map(|v| Tether {
            vertex: VertexId(v),
            anchor: VertexId(0),
            length: 2.5,
        });
        tethers(&x, &mut d, &all);
        // It was 5 m away, three parts along y and four along z.
        assert_eq!(d[1], [0.0, -1.5, 2.0, 0.0]);
        assert_eq!(d[2], [0.0, 0.25, 0.0, 0.0], "it is within reach");
        assert_eq!(d[0], [0.0; 4], "anchors do not move");
        assert_eq!(d[3], [0.0; 4], "it is held by its mass");
    }

    #[test]
    fn a_tether_of_no_length_holds_its_vertex_where_the_anchor_is() {
        let x = [[1.0, 0.0, 0.0, 0.0], [1.0, 0.0, 0.0, 1.0]];
        let mut d = [[0.0; 4], [0.0, -0.5, 0.0, 0.0]];
        let tether = Tether {
            vertex: VertexId(1),
            anchor: VertexId(0),
            length: 0.0,
        };
        tethers(&x, &mut d, &[tether]);
        assert_eq!(d[1], [0.0; 4]);
        tethers(&x, &mut d, &[tether]);
        assert_eq!(d[1], [0.0; 4], "there is no direction to pull in");
    }
}
