//! Target edge lengths that outlast cuts: a channel of the surface.
//!
//! Without it, targets would follow the fragments of earlier cuts and shrink with every cut. The
//! first incision adds the channel; other bodies have none. Before a cut splits triangles, their
//! corners store the mean length of the edges around them at rest. Vertices of the cut interpolate
//! it, as all attributes.

use incise_mesh::{Blend, Channel, ChannelError, Domain, Edit, Surface};
use incise_mesh::{TriangleId, Vec3, VertexId};

/// Name of the channel, with two values per vertex: the target length at rest \[m\], 0 if no cut
/// has come near, and a value above 0 if a cut has made the vertex.
pub(crate) const CHANNEL: &str = "cut_sizing";

/// The shape of a surface in which its rest positions are.
///
/// Steps of an incision in a deformed body exchange both shapes for a while.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum RestShape {
    /// In the rest positions.
    Rest,
    /// In the positions.
    Present,
}

impl RestShape {
    /// Returns the position of a vertex at rest \[m\].
    pub(crate) fn position(self, surface: &Surface, v: VertexId) -> Vec3 {
        match self {
            Self::Rest => surface.rest_position(v),
            Self::Present => surface.position(v),
        }
    }

    /// Returns the bits of a vertex' position at rest, by which coincident vertices are found.
    pub(crate) fn bits(self, surface: &Surface, v: VertexId) -> [u32; 3] {
        let place = match self {
            Self::Rest => surface.rest_positions()[v.index()],
            Self::Present => {
                let [x, y, z, _] = surface.positions()[v.index()];
                [x, y, z]
            }
        };
        // Zeros of both signs are one place.
        place.map(|x| (x + 0.0).to_bits())
    }
}

/// Returns the local edge length around a cut through `triangles` \[m\].
///
/// It is the mean target of their corners, stretched as the triangles are. Without stored targets
/// it is the mean of their edges.
pub(crate) fn local_length(
    surface: &Surface,
    shape: RestShape,
    triangles: impl Iterator<Item = TriangleId> + Clone,
) -> f64 {
    let present = surface.mean_edge_length_of(triangles.clone());
    let Some(channel) = surface.channel(CHANNEL) else {
        return present;
    };
    let (mut sum, mut count) = (0.0, 0.0);
    let mut edges = 0.0;
    for t in triangles {
        let corners = surface.topology().triangle(t);
        for (k, &v) in corners.iter().enumerate() {
            let next = corners[(k + 1) % 3];
            let [p, q] = [v, next].map(|v| shape.position(surface, v));
            edges += (q - p).norm();
            sum += row_target(channel, v).unwrap_or_else(|| mean_around(surface, shape, v));
            count += 1.0;
        }
    }
    if count == 0.0 || edges == 0.0 {
        return present;
    }
    let stretch = match shape {
        RestShape::Rest => present * count / edges,
        RestShape::Present => 1.0,
    };
    sum / count * stretch
}

/// Returns the target length in the row of a vertex \[m\]; none without any.
fn row_target(channel: &Channel, v: VertexId) -> Option<f64> {
    match channel.row(v.index()) {
        &[target, _] if target > 0.0 => Some(f64::from(target)),
        _ => None,
    }
}

/// Returns the mean length of the edges that leave a vertex at rest \[m\].
fn mean_around(surface: &Surface, shape: RestShape, v: VertexId) -> f64 {
    let topology = surface.topology();
    let center = shape.position(surface, v);
    let (mut sum, mut count) = (0.0, 0.0);
    for h in topology.outgoing_fan(v) {
        sum += (shape.position(surface, topology.target(h)) - center).norm();
        count += 1.0;
    }
    if count > 0.0 { sum / count } else { 0.0 }
}

/// Stores the targets of the corners of triangles before a cut splits these.
pub(crate) fn prepare(
    edit: &mut Edit<'_>,
    shape: RestShape,
    triangles: impl Iterator<Item = TriangleId>,
) {
    if edit.surface().channel(CHANNEL).is_none() {
        let channel = channel();
        edit.add_channel(&channel.expect("two values are a valid row"));
    }
    for t in triangles {
        for v in edit.surface().topology().triangle(t) {
            let surface = edit.surface();
            let channel = surface.channel(CHANNEL);
            if channel.is_some_and(|channel| channel.row(v.index()).first() == Some(&0.0)) {
                #[expect(clippy::cast_possible_truncation, reason = "storage precision")]
                let target = mean_around(surface, shape, v) as f32;
                edit.set_vertex_row(v, CHANNEL, &[target]);
            }
        }
    }
}

fn channel() -> Result<Channel, ChannelError> {
    Channel::new(CHANNEL, Domain::Vertex, Blend::Linear, 2, Vec::new())
}

/// Marks vertices as made by a cut, if targets are stored.
pub(crate) fn mark(edit: &mut Edit<'_>, vertices: impl Iterator<Item = VertexId>) {
    for v in vertices {
        let surface = edit.surface();
        let row = surface
            .channel(CHANNEL)
            .map(|channel| channel.row(v.index()));
        if let Some(&[target, _]) = row {
            edit.set_vertex_row(v, CHANNEL, &[target, 1.0]);
        }
    }
}

/// Returns whether a vertex was made by a cut since targets are stored.
pub(crate) fn is_made(surface: &Surface, v: VertexId) -> bool {
    let channel = surface.channel(CHANNEL);
    channel.is_some_and(|channel| matches!(channel.row(v.index()), &[_, made] if made > 0.0))
}

/// Returns the target length stored at a vertex \[m\]; none without any.
pub(crate) fn stored(surface: &Surface, v: VertexId) -> Option<f64> {
    row_target(surface.channel(CHANNEL)?, v)
}
