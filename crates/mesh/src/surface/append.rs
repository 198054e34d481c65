//! Joins surfaces into one.

use super::channels::{Channel, ChannelError};
use super::{Domain, Surface};
use crate::geometry::{Vec3, to_f32, to_f64, unit_normal};
use crate::ids::{HalfEdge, TriangleId, VertexId};

impl Surface {
    /// Adds the vertices and triangles of another surface. Its pieces get the next free numbers.
    ///
    /// The other surface stays in place in its file: its positions are rounded once if its
    /// [`Self::origin`] differs. Attributes that one surface lacks are neutral there: white, the
    /// joint 0 with the weight 1, the normals of triangles, or else zeros. Returns the new id, or
    /// null, of every vertex slot of `other`.
    ///
    /// # Errors
    /// [`ChannelError::Mismatch`] if the surfaces have different channels of one name; nothing has
    /// changed then.
    ///
    /// ```
    /// let mut surface = incise_mesh::icosphere(2, 0.5);
    /// let vertices = surface.append(&incise_mesh::cube_sphere(4, 0.2))?;
    /// assert_eq!(surface.piece_count(), 2);
    /// assert_eq!(vertices[0].index(), 162);
    /// # Ok::<(), incise_mesh::ChannelError>(())
    /// ```
    pub fn append(&mut self, other: &Self) -> Result<Vec<VertexId>, ChannelError> {
        self.check_channels(other)?;
        let (first_piece, slots) = (self.piece_bound(), other.topology.vertex_slots());
        let by = Vec3::from(other.origin) - Vec3::from(self.origin);
        let moved = |p: [f32; 3]| {
            if other.origin == self.origin {
                p
            } else {
                to_f32(to_f64(p) + by)
            }
        };
        let (positions, rest) = (other.positions.iter(), other.rest.iter());
        let positions: Vec<([f32; 4], [f32; 3])> = (positions.zip(rest))
            .map(|(&[x, y, z, w], &rest)| {
                let [x, y, z] = moved([x, y, z]);
                ([x, y, z, w], moved(rest))
            })
            .collect();
        let mut vertices = vec![VertexId::NULL; slots];
        for v in other.topology.vertices() {
            let (position, rest) = positions[v.index()];
            vertices[v.index()] = self.add_vertex(position, rest);
        }
        let mut triangles = Vec::with_capacity(other.topology.triangle_count());
        for t in other.topology.triangles() {
            let corners = other.topology.triangle(t).map(|v| vertices[v.index()]);
            let new = self
                .add_triangle(corners, first_piece + other.piece(t))
                .expect("the corners of a triangle are distinct vertices");
            self.set_material(new, other.material(t));
            triangles.push((t, new));
        }
        let half_edges = triangles.iter().flat_map(|(_, new)| new.half_edges());
        let half_edges: Vec<HalfEdge> = half_edges.collect();
        self.stitch(&half_edges)
            .expect("a part of an oriented manifold is one");
        self.fit_attributes(other);
        for (old, new) in triangles {
            self.copy_corners(new, other, old);
        }
        for channel in &mut self.channels {
            let neutral = channel.neutral_row();
            let neutral = &neutral[..channel.width()];
            let from = other.channel(channel.name());
            if channel.domain() == Domain::Vertex {
                let vertices = vertices.iter().enumerate().filter(|(_, v)| !v.is_null());
                vertices.for_each(|(old, new)| {
                    let row = from.map_or(neutral, |from| from.row(old));
                    channel.set_row(new.index(), row);
                });
            } else if from.is_none() {
                let corners = half_edges.iter();
                corners.for_each(|h| channel.set_row(h.index(), neutral));
            }
        }
        Ok(vertices)
    }

    /// Checks that channels of one name are alike.
    ///
    /// # Errors
    /// [`ChannelError::Mismatch`].
    fn check_channels(&self, other: &Self) -> Result<(), ChannelError> {
        let differs = |from: &&Channel| {
            let own = self.channel(from.name());
            own.is_some_and(|own| !own.is_like(from))
        };
        if let Some(channel) = other.channels.iter().find(differs) {
            return Err(ChannelError::Mismatch {
                name: channel.name().into(),
            });
        }
        Ok(())
    }

    /// Adds arrays of neutral values for the attributes that only the other surface has.
    fn fit_attributes(&mut self, other: &Self) {
        for from in &other.channels {
            if self.channel(from.name()).is_none() {
                let mut channel = from.with_values(Vec::new());
                channel.fit_neutral(self.slots(from.domain()));
                self.channels.push(channel);
            }
        }
        let corners = self.slots(Domain::Corner);
        if !other.corners.uv.is_empty() {
            self.corners.uv.resize(corners, [0.0; 2]);
        }
        if !other.corners.normal.is_empty() && self.corners.normal.is_empty() {
            self.corners.normal = vec![[0.0; 3]; corners];
            for t in 0..self.topology.triangle_slots() {
                let t = TriangleId::from_index(t);
                if self.topology.is_triangle(t) {
                    self.set_flat_normals(t);
                }
            }
        }
    }

    /// Sets the normals of a triangle's corners to that of the triangle, if the surface has any.
    fn set_flat_normals(&mut self, t: TriangleId) {
        let normal = unit_normal(self.triangle_positions(t));
        for h in t.half_edges() {
            if let Some(own) = self.corners.normal.get_mut(h.index()) {
                *own = normal;
            }
        }
    }

    /// Copies the attributes of the corners of a triangle of another surface.
    fn copy_corners(&mut self, to: TriangleId, other: &Self, from: TriangleId) {
        if other.corners.normal.is_empty() {
            self.set_flat_normals(to);
        }
        let corners = to.half_edges().into_iter().zip(from.half_edges());
        for (to, from) in corners.map(|(a, b): (HalfEdge, HalfEdge)| (a.index(), b.index())) {
            if let Some(&uv) = other.corners.uv.get(from) {
                self.corners.uv[to] = uv;
            }
            if let Some(&normal) = other.corners.normal.get(from) {
                self.corners.normal[to] = normal;
            }
            for (channel, source) in self.like_channels(other) {
                if source.domain() == Domain::Corner {
                    channel.set_row(to, source.row(from));
                }
            }
        }
    }

    /// Iterates over the channels that another surface has, too, with the other's.
    fn like_channels<'a>(
        &'a mut self,
        other: &'a Self,
    ) -> impl Iterator<Item = (&'a mut Channel, &'a Channel)> {
        let pair = |own: &'a mut Channel| {
            let from = other.channel(own.name())?;
            Some((own, from))
        };
        self.channels.iter_mut().filter_map(pair)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::Blend;
    use crate::{cube_sphere, icosphere, sheet};

    fn channel(surface: &Surface, name: &str, domain: Domain) -> Channel {
        let values = (0..surface.slots(domain)).map(|i| i as f32 + 1.0).collect();
        Channel::new(name, domain, Blend::Linear, 1, values).unwrap()
    }

    #[test]
    fn appended_pieces_are_extracted_as_they_were() {
        let mut ball = icosphere(2, 0.5);
        let unused = ball.remove_triangles(&[TriangleId(3), TriangleId(100)]);
        ball.remove_vertices(&unused);
        ball.set_channel(channel(&ball, "heat", Domain::Vertex))
            .unwrap();
        let mut block = cube_sphere(3, 0.2);
        let corners = block.slots(Domain::Corner);
        block
            .set_corner_uvs((0..corners).map(|i| [i as f32, 1.0]).collect())
            .unwrap();
        block.set_material(TriangleId(4), 7);
        block
            .set_channel(channel(&block, "heat", Domain::Vertex))
            .unwrap();
        block
            .set_channel(channel(&block, "color", Domain::Corner))
            .unwrap();
        let cloth = sheet([1.0; 2], [3; 2]);
        let mut all = Surface::default();
        all.append(&ball).unwrap();
        all.append(&block).unwrap();
        let vertices = all.append(&cloth).unwrap();
        all.validate().unwrap();
        assert_eq!(all.piece_count(), 3);
        for (piece, part) in [(0, &ball), (1, &block), (2, &cloth)] {
            let mut whole = part.clone();
            whole.compact();
            let mut found = all.extract_piece(piece);
            for t in 0..found.topology.triangle_slots() {
                found.set_piece(TriangleId::from_index(t), 0);
            }
            assert_eq!(found.positions, whole.positions);
            assert_eq!(found.rest, whole.rest);
            assert_eq!(found.material, whole.material);
            for t in whole.topology.triangles() {
                assert_eq!(found.topology.triangle(t), whole.topology.triangle(t));
                let twins = |s: &Surface| t.half_edges().map(|h| s.topology.twin(h));
                assert_eq!(twins(&found), twins(&whole));
            }
            for channel in found.channels() {
                let zeros = vec![0.0; channel.values().len()];
                let own = whole.channel(channel.name());
                assert_eq!(channel.values(), own.map_or(&*zeros, Channel::values));
            }
            let own = !part.corners.uv.is_empty();
            let uv = if own {
                whole.corners.uv
            } else {
                vec![[0.0; 2]; found.corners.uv.len()]
            };
            assert_eq!(found.corners.uv, uv);
        }
        let position = |s: &Surface, v: VertexId| s.positions[v.index()];
        for v in cloth.topology.vertices() {
            assert_eq!(position(&all, vertices[v.index()]), position(&cloth, v));
        }
    }

    #[test]
    fn attributes_that_a_part_lacks_are_neutral() {
        let mut full = icosphere(1, 0.5);
        for (name, domain, blend, width) in [
            ("color", Domain::Vertex, Blend::Linear, 4),
            ("color1", Domain::Corner, Blend::Linear, 3),
            ("skin", Domain::Vertex, Blend::Skin, 8),
            ("heat", Domain::Vertex, Blend::Linear, 1),
        ] {
            let values = vec![0.25; full.slots(domain) * width];
            let channel = Channel::new(name, domain, blend, width, values).unwrap();
            full.set_channel(channel).unwrap();
        }
        let bare = cube_sphere(2, 0.2);
        let (mut before, mut after) = (bare.clone(), full.clone());
        before.append(&full).unwrap();
        after.append(&bare).unwrap();
        for (all, piece) in [(before, 0), (after, 1)] {
            let part = all.extract_piece(piece);
            assert_eq!(
                part.topology.triangle_count(),
                bare.topology.triangle_count()
            );
            for (name, neutral) in [
                ("color", &[1.0; 4][..]),
                ("color1", &[1.0; 3]),
                ("skin", &[0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0]),
                ("heat", &[0.0]),
            ] {
                let channel = part.channel(name).unwrap();
                let mut rows = channel.values().chunks(channel.width());
                assert!(rows.all(|row| row == neutral), "{name} of piece {piece}");
            }
            for t in part.topology.triangles() {
                let [a, b, c] = part.triangle_positions(t);
                let expected = (b - a).cross(&(c - a)).normalize();
                for h in t.half_edges() {
                    let normal = to_f64(part.corners.normal[h.index()]);
                    assert!((normal - expected).norm() < 1e-6, "{normal} {expected}");
                }
            }
        }
    }

    #[test]
    fn surfaces_far_from_their_origins_stay_in_place() {
        let mut all = icosphere(1, 0.5);
        let mut other = icosphere(1, 0.5);
        other.set_origin([4096.0, 0.0, -8.0]);
        let vertices = all.append(&other).unwrap();
        for v in other.topology.vertices() {
            let by = all.position(vertices[v.index()]) - other.position(v);
            assert!((by - Vec3::new(4096.0, 0.0, -8.0)).norm() < 5e-4, "{by}");
        }
    }

    #[test]
    fn channels_of_one_name_must_be_alike() {
        let mut all = icosphere(1, 0.5);
        all.set_channel(channel(&all, "heat", Domain::Vertex))
            .unwrap();
        let mut other = icosphere(1, 0.5);
        other
            .set_channel(channel(&other, "heat", Domain::Corner))
            .unwrap();
        let before = all.clone();
        let name = "heat".into();
        assert_eq!(all.append(&other), Err(ChannelError::Mismatch { name }));
        assert_eq!(all, before);
    }
}
