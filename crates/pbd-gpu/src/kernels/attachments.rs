//! Long range attachments: pulls back vertices that are too far from their anchor.

use super::block::difference;
use super::particle_state::ParticleStates;
use crate::constraints::attachments::LongRangeAttachment;
use std::cell::Cell;

/// Rate at which excess distance from before the substep is corrected [1/s].
///
/// Velocities follow from displacements, so a correction in one substep would be an impulse. The
/// edges correct most of the distance; this rate only keeps them from increasing it again.
pub(crate) const RETURN: f32 = 0.05;

/// Projects vertices whose distance from their anchor exceeds the attachment's length.
///
/// `corrections`, the internal displacements, exclude the pulls, which act on one side only;
/// empty without a lift. Vertices move straight toward the anchor, to that length. If the
/// distance exceeded the length at the start of a substep of `h` \[s\], it is instead limited to
/// that distance, reduced at rate [`RETURN`]. Anchors do not move, and no two attachments share a
/// vertex.
#[inline(always)]
pub(crate) fn attachments(
    particles: ParticleStates<'_>,
    corrections: &[Cell<[f32; 4]>],
    attachments: &[LongRangeAttachment],
    h: f32,
) {
    let kept = 1.0 - RETURN * h;
    for attachment in attachments {
        let (v, anchor) = (attachment.vertex.index(), attachment.anchor.index());
        let (from, to) = (particles.get(v), particles.get(anchor));
        let offset = difference(from, to);
        let length = norm(offset);
        // Vertices with zero inverse mass do not move.
        if length > attachment.length && from.x[3] > 0.0 {
            let before = kept * norm(difference(from.at_start(), to.at_start()));
            let reach = if before > attachment.length {
                before
            } else {
                attachment.length
            };
            let back = (length - reach) / length;
            if back > 0.0 {
                let pull = offset.map(|c| c * back);
                particles.add_d(v, pull);
                if let Some(correction) = corrections.get(v) {
                    let u = correction.get();
                    correction.set([u[0] - pull[0], u[1] - pull[1], u[2] - pull[2], 0.0]);
                }
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
    use crate::kernels::particle_state::on_arrays;
    use incise_mesh::VertexId;

    #[test]
    fn vertices_beyond_the_length_move_straight_back() {
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
        let all = [1, 2, 3].map(|v| LongRangeAttachment {
            vertex: VertexId(v),
            anchor: VertexId(0),
            length: 2.5,
        });
        on_arrays(&x, &mut d, |p| attachments(p, &[], &all, 0.01));
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
        let attachment = LongRangeAttachment {
            vertex: VertexId(1),
            anchor: VertexId(0),
            length: 0.0,
        };
        on_arrays(&x, &mut d, |p| attachments(p, &[], &[attachment], 0.01));
        assert_eq!(d[1], [0.0; 4]);
        on_arrays(&x, &mut d, |p| attachments(p, &[], &[attachment], 0.01));
        assert_eq!(d[1], [0.0; 4], "there is no direction to pull in");
    }

    #[test]
    fn what_was_too_far_before_comes_back_slowly() {
        let x = [[0.0; 4], [4.0, 0.0, 0.0, 1.0]];
        let attachment = LongRangeAttachment {
            vertex: VertexId(1),
            anchor: VertexId(0),
            length: 1.0,
        };
        let h = 1.0 / 64.0;
        let mut d = [[0.0; 4], [3.0, 0.0, 0.0, 0.0]];
        on_arrays(&x, &mut d, |p| attachments(p, &[], &[attachment], h));
        let reach = 4.0 * (1.0 - RETURN * h);
        assert_eq!(
            d[1][0],
            reach - 4.0,
            "new excess is removed at once, old excess slowly"
        );
        let nearer = [[0.0; 4], [-1.0, 0.0, 0.0, 0.0]];
        let mut d = nearer;
        on_arrays(&x, &mut d, |p| attachments(p, &[], &[attachment], h));
        assert_eq!(d, nearer, "it is approaching already");
    }
}
