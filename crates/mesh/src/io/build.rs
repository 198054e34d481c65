//! Builds welded mesh data from a reader's vertices and faces.

use crate::bucket_sort::sort_in_buckets;
use crate::geometry::{round_to_f32, to_f64, unit_normal};
use crate::ids::index_u32;
use crate::io::channels::FileChannels;
use crate::io::data::{MeshData, Warning};
use crate::io::error::{ParseError, SourceLocation};
use crate::io::polygon::triangulate;
use crate::surface::{Blend, Channel, CornerAttributes, Domain};
use std::ops::Range;

/// Marks a corner without texture coordinates or normal.
pub(super) const NONE: u32 = u32::MAX;

/// Maximum number of triangles, so that half-edge ids have 32 bits.
const MAX_TRIANGLES: usize = (u32::MAX / 3 - 1) as usize;

/// A corner of a face: indices from 0, all but the position may be [`NONE`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Corner {
    pub(super) position: u32,
    pub(super) uv: u32,
    pub(super) normal: u32,
    /// Row of the channels of corners.
    pub(super) row: u32,
}

impl Corner {
    /// Returns a corner without attributes.
    pub(super) fn position(position: u32) -> Self {
        Self {
            position,
            uv: NONE,
            normal: NONE,
            row: NONE,
        }
    }
}

/// Iterates over the triangles of a strip, all with the orientation of the first.
pub(super) fn strip_triangles(strip: &[u32]) -> impl Iterator<Item = [u32; 3]> {
    let triangles = strip.windows(3).enumerate();
    triangles.map(|(i, t)| {
        if i % 2 == 0 {
            [t[0], t[1], t[2]]
        } else {
            [t[0], t[2], t[1]]
        }
    })
}

/// Collects the elements of a file in any order; references are checked at the end.
#[derive(Debug, Default)]
pub(super) struct Builder {
    /// The point of the file that becomes the origin of the positions \[m\].
    pub(super) origin: [f64; 3],
    /// 1 if the file counts indices from 1, else 0.
    pub(super) index_base: i64,
    pub(super) warnings: Vec<Warning>,
    /// Material of the faces that follow.
    pub(super) material: u32,
    pub(super) channels: FileChannels,
    positions: Vec<[f32; 3]>,
    /// First position of each part of the file; empty for formats without parts.
    part_starts: Vec<u32>,
    uv: Vec<[f32; 2]>,
    normals: Vec<[f32; 3]>,
    corners: Vec<Corner>,
    /// The end of each face in `corners`.
    face_ends: Vec<usize>,
    /// Places of faces with references beyond the elements read before them.
    forward: Vec<(Range<usize>, SourceLocation)>,
    /// Material of each face.
    materials: Vec<u32>,
    sorted: Vec<u32>,
}

impl Builder {
    /// Creates a builder of positions relative to `origin`.
    pub(super) fn with_origin(origin: [f64; 3]) -> Self {
        Self {
            origin,
            ..Self::default()
        }
    }

    /// Begins a part of the file with positions of its own, such as a node of glTF.
    #[cfg(feature = "gltf")]
    pub(super) fn begin_part(&mut self) {
        self.part_starts.push(index_u32(self.positions.len()));
    }

    pub(super) fn position_count(&self) -> usize {
        self.positions.len()
    }

    #[cfg(feature = "gltf")]
    pub(super) fn corner_count(&self) -> usize {
        self.corners.len()
    }

    pub(super) fn uv_count(&self) -> usize {
        self.uv.len()
    }

    pub(super) fn normal_count(&self) -> usize {
        self.normals.len()
    }

    /// Parses a coordinate of a text file for [`Self::position`].
    ///
    /// It is rounded once: to 32 bits here, or after the origin was subtracted.
    pub(super) fn coordinate(&self, word: &str) -> Option<f64> {
        if self.origin == [0.0; 3] {
            word.parse::<f32>().ok().map(f64::from)
        } else {
            word.parse().ok()
        }
    }

    /// Adds a position in the file's coordinates.
    pub(super) fn position(&mut self, p: [f64; 3], at: SourceLocation) -> Result<(), ParseError> {
        let p = [0, 1, 2].map(|k| round_to_f32(p[k] - self.origin[k]));
        if !p.iter().all(|x| x.is_finite()) {
            return Err(ParseError::NotFinite { at });
        }
        self.positions.push(p);
        Ok(())
    }

    /// Sets the color of the last position.
    pub(super) fn color(&mut self, color: &[f32; 3]) {
        let channels = &mut self.channels;
        let Some(last) = self.positions.len().checked_sub(1) else {
            return;
        };
        let channel = channels.vertex_channel("color", Domain::Vertex, Blend::Linear, 3, last);
        if let Some(channel) = channel {
            channels.add_vertex_row(channel, last, color);
        }
    }

    /// Adds texture coordinates and returns their index, [`NONE`] beyond 32 bits.
    pub(super) fn uv(&mut self, uv: [f32; 2]) -> u32 {
        self.uv.push(uv);
        u32::try_from(self.uv.len() - 1).unwrap_or(NONE)
    }

    /// Adds a normal and returns its index, [`NONE`] beyond 32 bits.
    pub(super) fn normal(&mut self, normal: [f32; 3]) -> u32 {
        self.normals.push(normal);
        u32::try_from(self.normals.len() - 1).unwrap_or(NONE)
    }

    /// Adds a face of any number of corners, which may refer to later vertices.
    pub(super) fn face(
        &mut self,
        corners: &[Corner],
        at: SourceLocation,
    ) -> Result<(), ParseError> {
        if corners.len() < 3 {
            return Err(ParseError::TooFewCorners {
                at,
                corners: corners.len(),
            });
        }
        // A triangle that repeats a vertex is as harmless as one whose corners coincide.
        if corners.len() > 3 {
            self.sorted.clear();
            self.sorted.extend(corners.iter().map(|c| c.position));
            self.sorted.sort_unstable();
            if self.sorted.windows(2).any(|pair| pair[0] == pair[1]) {
                return Err(ParseError::RepeatedVertex { at });
            }
        }
        let first = self.corners.len();
        self.corners.extend_from_slice(corners);
        self.face_ends.push(self.corners.len());
        if corners.iter().any(|corner| self.invalid(corner).is_some()) {
            self.forward.push((first..self.corners.len(), at));
        }
        self.materials.push(self.material);
        Ok(())
    }

    pub(super) fn finish(mut self) -> Result<MeshData, ParseError> {
        if self.face_ends.is_empty() {
            return Err(ParseError::NoFaces);
        }
        self.check_references()?;
        let (corners, materials) = self.triangle_corners();
        if corners.len() / 3 > MAX_TRIANGLES || self.positions.len() > MAX_TRIANGLES {
            return Err(ParseError::TooLarge);
        }
        let (positions, welded) = self.weld(&corners);
        let triangles: Vec<[u32; 3]> = corners
            .as_chunks::<3>()
            .0
            .iter()
            .map(|t| t.map(|c| welded[c.position as usize]))
            .collect();
        let used = welded.iter().filter(|&&v| v != NONE).count();
        let file_triangles = if used == positions.len() {
            Vec::new()
        } else {
            let triangles = corners.as_chunks::<3>().0.iter();
            triangles.map(|t| t.map(|c| c.position)).collect()
        };
        let parts = self.parts(&corners);
        let (attributes, channels) = self.attributes(&corners, &welded);
        let file_vertices = if corners.iter().all(|&c| c == Corner::position(c.position)) {
            used
        } else {
            let corners = corners.iter().copied();
            let mut tuples = sort_in_buckets(corners, self.positions.len(), |c| c.position);
            tuples.dedup();
            tuples.len()
        };
        Ok(MeshData {
            positions,
            triangles,
            corners: attributes,
            channels,
            vertex_map: welded,
            materials,
            file_vertices,
            warnings: self.warnings,
            file_triangles,
            parts,
            origin: self.origin,
        })
    }

    /// Returns the part of the file in which each triangle is; nothing if there is only one.
    fn parts(&self, corners: &[Corner]) -> Vec<u32> {
        if self.part_starts.len() < 2 {
            return Vec::new();
        }
        let part = |position| self.part_starts.partition_point(|&start| start <= position);
        let triangles = corners.as_chunks::<3>().0.iter();
        triangles
            .map(|[a, ..]| index_u32(part(a.position)))
            .collect()
    }

    fn check_references(&self) -> Result<(), ParseError> {
        for (corners, at) in &self.forward {
            let mut invalid = self.corners[corners.clone()]
                .iter()
                .map(|c| self.invalid(c));
            if let Some((index, count)) = invalid.find_map(|invalid| invalid) {
                return Err(ParseError::IndexOutOfRange {
                    at: *at,
                    index: i64::from(index) + self.index_base,
                    count,
                });
            }
        }
        Ok(())
    }

    /// Returns the first index of a corner that is out of range so far, and the number of elements.
    fn invalid(&self, corner: &Corner) -> Option<(u32, usize)> {
        let of = |index: u32, count: usize, is_optional: bool| {
            let is_valid = (index as usize) < count || is_optional && index == NONE;
            (!is_valid).then_some((index, count))
        };
        of(corner.position, self.positions.len(), false)
            .or_else(|| of(corner.uv, self.uv.len(), true))
            .or_else(|| of(corner.normal, self.normals.len(), true))
    }

    /// Returns the corners of the faces' triangles, and the triangles' materials unless all are 0.
    fn triangle_corners(&mut self) -> (Vec<Corner>, Vec<u32>) {
        let of_faces = std::mem::take(&mut self.materials);
        let has_materials = of_faces.iter().any(|&m| m != 0);
        if self.corners.len() == 3 * self.face_ends.len() {
            let materials = if has_materials { of_faces } else { Vec::new() };
            return (std::mem::take(&mut self.corners), materials);
        }
        let mut out = Vec::with_capacity(self.corners.len());
        let mut materials = Vec::new();
        let (mut points, mut triangles) = (Vec::new(), Vec::new());
        let mut first = 0;
        for (&end, &material) in self.face_ends.iter().zip(&of_faces) {
            let face = &self.corners[first..end];
            points.clear();
            points.extend(face.iter().map(|c| self.positions[c.position as usize]));
            triangulate(&points, &mut triangles);
            out.extend(triangles.iter().flatten().map(|&i| face[i]));
            if has_materials {
                materials.resize(out.len() / 3, material);
            }
            first = end;
        }
        (out, materials)
    }

    /// Returns the distinct used positions, and the new index of every position.
    fn weld(&mut self, corners: &[Corner]) -> (Vec<[f32; 3]>, Vec<u32>) {
        let mut used = vec![false; self.positions.len()];
        for c in corners {
            used[c.position as usize] = true;
        }
        // Adding 0 turns -0 into 0.
        let key = |i: u32| self.positions[i as usize].map(|x| (x + 0.0).to_bits());
        let in_use = (0..).zip(&used).filter(|&(_, &used)| used);
        let keyed = in_use.map(|(i, _)| (key(i), i));
        let bits = usize::BITS - used.len().leading_zeros();
        let bucket = |&(key, _): &([u32; 3], u32)| position_bucket(key, bits);
        // Equal positions are neighbors, the first one of the file in front.
        let keyed = sort_in_buckets(keyed, 1 << bits, bucket);
        let unused = used.len() - keyed.len();
        let mut first_equal = vec![NONE; used.len()];
        for group in keyed.chunk_by(|a, b| a.0 == b.0) {
            for &(_, i) in group {
                first_equal[i as usize] = group[0].1;
            }
        }
        let mut positions = Vec::new();
        let mut welded = vec![NONE; used.len()];
        for i in (0..used.len()).filter(|&i| used[i]) {
            let first = first_equal[i] as usize;
            if first == i {
                welded[i] = index_u32(positions.len());
                positions.push(self.positions[i]);
            } else {
                welded[i] = welded[first];
            }
        }
        if unused > 0 {
            self.warnings
                .push(Warning::UnusedVertices { count: unused });
        }
        (positions, welded)
    }

    fn attributes(
        &mut self,
        corners: &[Corner],
        welded: &[u32],
    ) -> (CornerAttributes, Vec<Channel>) {
        let mut out = CornerAttributes::default();
        if corners.iter().any(|c| c.uv != NONE) {
            let indices = corners.iter().map(|c| c.uv);
            let uv = gather("texture coordinates", &self.uv, indices, |_| [0.0; 2]);
            out.uv = uv.0;
            self.warnings.extend(uv.1);
        }
        if corners.iter().any(|c| c.normal != NONE) {
            let flat = |corner: usize| {
                let triangle = &corners.as_chunks::<3>().0[corner / 3];
                let point = |c: &Corner| to_f64(self.positions[c.position as usize]);
                unit_normal(triangle.each_ref().map(point))
            };
            let indices = corners.iter().map(|c| c.normal);
            let normals = gather("normals", &self.normals, indices, flat);
            out.normal = normals.0;
            self.warnings.extend(normals.1);
        }
        let channels = std::mem::take(&mut self.channels);
        let channels = channels.finish(welded, corners, &mut self.warnings);
        (out, channels)
    }
}

/// Returns a number below 2^`bits` that few other positions have.
fn position_bucket(key: [u32; 3], bits: u32) -> u32 {
    let mixed = key.iter().fold(0_u64, |mixed, &word| {
        let x = (mixed ^ u64::from(word)).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        x ^ (x >> 29)
    });
    u32::try_from(mixed >> (u64::BITS - bits)).expect("there are at most 2^32 positions")
}

/// Returns a value per corner, `neutral` where one is missing or not finite, and a warning about
/// those.
fn gather<const N: usize>(
    name: &str,
    values: &[[f32; N]],
    indices: impl Iterator<Item = u32>,
    neutral: impl Fn(usize) -> [f32; N],
) -> (Vec<[f32; N]>, Option<Warning>) {
    let mut missing = 0;
    let values = indices.enumerate().map(|(corner, i)| {
        let value = values.get(i as usize).copied();
        let value = value.filter(|value| value.iter().all(|x| x.is_finite()));
        value.unwrap_or_else(|| {
            missing += 1;
            neutral(corner)
        })
    });
    (values.collect(), Warning::partial(name, missing))
}
