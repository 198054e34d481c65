//! Tethers pull back what is too far from where it is held.

use super::block::difference;
use super::displacements::Displacements;
use crate::tethers::Tether;

/// How fast what is too far at the beginning of a substep comes back, in parts of its distance [1/s]. A body that was soft, or
/// whose pins leapt, is far out of reach: taken back at once that would be a blow, since velocities follow from displacements. Edges bring it back; this
/// is no more than what keeps edges from drawing a vertex out of reach again in every substep.
pub(crate) const RETURN: f32 = 0.05;

/// Moves every vertex that is farther from its anchor than its tether is long straight back: to that distance, or to the one
/// that it has at the beginning of a substep of `h` \[s\], less [`RETURN`]'s part. Anchors do not move and no two tethers share
/// a vertex.
#[inline(always)]
pub(crate) fn tethers(x: &[[f32; 4]], d: &mut impl Displacements, tethers: &[Tether], h: f32) {
    let kept = 1.0 - RETURN * h;
    for tether in tethers {
        let (v, anchor) = (tether.vertex.index(), tether.anchor.index());
        let (xv, xa, mut dv) = (x[v], x[anchor], d.get(v));
        let way = difference(xv, dv, xa, d.get(anchor));
        let length = norm(way);
        // Whoever holds a vertex by its mass means it.
        if length > tether.length && xv[3] > 0.0 {
            let before = kept * norm(difference(xv, [0.0; 4], xa, [0.0; 4]));
            let reach = if before > tether.length {
                before
            } else {
                tether.length
            };
            let back = (length - reach) / length;
            if back > 0.0 {
                for (c, way) in dv.iter_mut().zip(way) {
                    *c += way * back;
                }
                d.set(v, dv);
            }
        }
    }
}

#[inline(always)]
fn norm([x, y, z, _]: [f32; 4]) -> f32 {
    (x * x + y * y + z * z).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use incise_mesh::VertexId;

    #[test]
    fn what_is_too_far_comes_straight_back_and_the_rest_stays() {
        let x = [
            [1.0, 0.0, 0.0, 0.0],
            [1.0, 1.5, 0.0, 1.0],
            [1.0, 0.0, 1.5, 1.0],
            [9.0, 0.0, 0.0, 0.0],
        ];
        let mut d = [
            [0.0; 4],
            [0.0, 1.5, 4.0, 0.0],
            [0.0, 0.25, 0.0, 0.0],
            [0.0; 4],
        ];
        let all = [1, 2, 3].map(|v| Tether {
            vertex: VertexId(v),
            anchor: VertexId(0),
            length: 2.5,
        });
        tethers(&x, &mut d, &all, 0.01);
        // It was 5 m away, three parts along y and four along z.
        assert_eq!(d[1], [0.0, 0.0, 2.0, 0.0]);
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
        tethers(&x, &mut d, &[tether], 0.01);
        assert_eq!(d[1], [0.0; 4]);
        tethers(&x, &mut d, &[tether], 0.01);
        assert_eq!(d[1], [0.0; 4], "there is no direction to pull in");
    }

    #[test]
    fn what_was_too_far_before_comes_back_slowly() {
        let x = [[0.0; 4], [4.0, 0.0, 0.0, 1.0]];
        let tether = Tether {
            vertex: VertexId(1),
            anchor: VertexId(0),
            length: 1.0,
        };
        let h = 1.0 / 64.0;
        let mut d = [[0.0; 4], [3.0, 0.0, 0.0, 0.0]];
        tethers(&x, &mut d, &[tether], h);
        let reach = 4.0 * (1.0 - RETURN * h);
        assert_eq!(d[1][0], reach - 4.0, "all of what came, a part of what was");
        let nearer = [[0.0; 4], [-1.0, 0.0, 0.0, 0.0]];
        let mut d = nearer;
        tethers(&x, &mut d, &[tether], h);
        assert_eq!(d, nearer, "it is coming back already");
    }
}
