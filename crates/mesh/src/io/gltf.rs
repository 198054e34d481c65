//! Reader of glTF 2.0, text and binary: the triangles of a scene with node transforms applied.
//!
//! Positions, normals, texture coordinates, colors, skin weights and custom attributes of triangle
//! lists, strips and fans are read. Points and lines are skipped. Skins and morph targets are not
//! applied.

mod accessor;
mod buffer;
mod channels;
mod document;

use crate::geometry::{Vec3, to_f32};
use crate::io::build::{Builder, Corner, NONE, strip_triangles};
use crate::io::data::{MeshData, Warning};
use crate::io::error::{ParseError, SourceLocation};
use crate::io::material_number;
use crate::io::origin::read_near_origin;
use accessor::Accessors;
use channels::read_channels;
use document::{Document, Node, Primitive};
use nalgebra::{Matrix3, Matrix4, Quaternion};
use std::path::Path;

/// Extensions that change the meaning of the file's numbers.
const COMPRESSED: [&str; 2] = ["KHR_draco_mesh_compression", "EXT_meshopt_compression"];

/// Number of positions or corners that a file may unfold to, plus this many for every byte.
///
/// Nodes and primitives may share data, so a small file could otherwise request any amount of
/// memory.
const FREE_CORNERS: usize = 1 << 20;
const CORNERS_A_BYTE: usize = 16;

/// Modes of primitives with triangles.
const TRIANGLES: u32 = 4;
const TRIANGLE_STRIP: u32 = 5;
const TRIANGLE_FAN: u32 = 6;

/// Reads a glTF file, `.gltf` or `.glb` by its first bytes.
///
/// Files that it refers to must be in or below `folder`; without a folder the file must contain
/// everything. At most the buffer's length is read from such a file.
///
/// # Errors
/// [`ParseError`] with the primitive, accessor, buffer or node.
pub fn read_gltf(bytes: &[u8], folder: Option<&Path>) -> Result<MeshData, ParseError> {
    let (json, binary) = buffer::split(bytes)?;
    let document: Document = serde_json::from_slice(json)?;
    if document
        .extensions_required
        .iter()
        .any(|e| COMPRESSED.contains(&e.as_str()))
    {
        return Err(ParseError::Unsupported {
            what: "compressed glTF",
        });
    }
    let buffers = buffer::load(&document, binary, folder)?;
    let accessors = Accessors {
        document: &document,
        buffers: &buffers,
    };
    let size = bytes.len() + buffers.iter().map(|b| b.len()).sum::<usize>();
    let most = size
        .saturating_mul(CORNERS_A_BYTE)
        .saturating_add(FREE_CORNERS);
    let meshes = placed_meshes(&document)?;
    read_near_origin(|builder| read_meshes(&meshes, &accessors, most, builder))
}

/// Reads placed meshes with at most `most` positions and corners.
fn read_meshes(
    meshes: &[(usize, Matrix4<f64>)],
    accessors: &Accessors<'_>,
    most: usize,
    builder: &mut Builder,
) -> Result<(), ParseError> {
    let mut skipped = 0;
    for &(mesh, transform) in meshes {
        let primitives = &accessors
            .document
            .meshes
            .get(mesh)
            .ok_or(ParseError::Syntax {
                at: SourceLocation::Primitive(mesh, 0),
                expected: "a mesh with this number",
            })?
            .primitives;
        builder.begin_part();
        let mirrored = transform.fixed_view::<3, 3>(0, 0).determinant() < 0.0;
        // Primitives of a mesh often share their vertices and differ in material only.
        let mut last: Option<(&Primitive, Vertices)> = None;
        for (i, primitive) in primitives.iter().enumerate() {
            let at = SourceLocation::Primitive(mesh, i);
            if !(TRIANGLES..=TRIANGLE_FAN).contains(&primitive.mode()) {
                skipped += 1;
                continue;
            }
            let shared = last.filter(|(last, _)| last.attributes == primitive.attributes);
            let vertices = match shared {
                Some((_, vertices)) => Some(vertices),
                None => Vertices::read(primitive, &transform, accessors, at, most, builder)?,
            };
            let Some(vertices) = vertices else {
                skipped += 1;
                continue;
            };
            last = Some((primitive, vertices));
            add_triangles(primitive, &vertices, mirrored, accessors, at, builder)?;
            if builder.position_count().max(builder.corner_count()) > most {
                return Err(ParseError::TooLarge);
            }
        }
    }
    if skipped > 0 {
        builder.warnings.push(Warning::Skipped { count: skipped });
    }
    Ok(())
}

/// Returns the meshes of the scene and their transforms, parents before children.
fn placed_meshes(document: &Document) -> Result<Vec<(usize, Matrix4<f64>)>, ParseError> {
    if document.nodes.is_empty() {
        return Ok((0..document.meshes.len())
            .map(|mesh| (mesh, Matrix4::identity()))
            .collect());
    }
    let roots = match document.scenes.get(document.scene.unwrap_or(0)) {
        Some(scene) => scene.nodes.clone(),
        None => roots(document),
    };
    let mut out = Vec::new();
    let mut seen = vec![false; document.nodes.len()];
    let mut stack: Vec<_> = roots
        .into_iter()
        .rev()
        .map(|node| (node, Matrix4::identity()))
        .collect();
    while let Some((i, parent)) = stack.pop() {
        let at = SourceLocation::Node(i);
        let node = document.nodes.get(i).ok_or(ParseError::Syntax {
            at,
            expected: "a node with this number",
        })?;
        if std::mem::replace(&mut seen[i], true) {
            return Err(ParseError::Syntax {
                at,
                expected: "one parent a node",
            });
        }
        let transform = parent * local_transform(node);
        if let Some(mesh) = node.mesh {
            out.push((mesh, transform));
        }
        stack.extend(node.children.iter().rev().map(|&child| (child, transform)));
    }
    Ok(out)
}

/// Returns the nodes that are no child of another.
fn roots(document: &Document) -> Vec<usize> {
    let mut is_child = vec![false; document.nodes.len()];
    for &child in document.nodes.iter().flat_map(|node| &node.children) {
        if let Some(is_child) = is_child.get_mut(child) {
            *is_child = true;
        }
    }
    (0..is_child.len()).filter(|&i| !is_child[i]).collect()
}

fn local_transform(node: &Node) -> Matrix4<f64> {
    if let Some(columns) = node.matrix {
        return Matrix4::from_column_slice(&columns);
    }
    let [x, y, z, w] = node.rotation.unwrap_or([0.0, 0.0, 0.0, 1.0]);
    let rotation = nalgebra::UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z));
    let scale = Vec3::from(node.scale.unwrap_or([1.0; 3]));
    Matrix4::new_translation(&Vec3::from(node.translation.unwrap_or_default()))
        * rotation.to_homogeneous()
        * Matrix4::new_nonuniform_scaling(&scale)
}

/// The vertices of a primitive: numbers of its first position, texture coordinates and normal.
#[derive(Clone, Copy)]
struct Vertices {
    first: usize,
    count: usize,
    uv: Option<usize>,
    normal: Option<usize>,
}

impl Vertices {
    /// Adds the vertices of a primitive; none if it has no positions.
    fn read(
        primitive: &Primitive,
        transform: &Matrix4<f64>,
        accessors: &Accessors<'_>,
        at: SourceLocation,
        most: usize,
        builder: &mut Builder,
    ) -> Result<Option<Self>, ParseError> {
        let Some(position) = primitive.attributes.position else {
            return Ok(None);
        };
        let linear: Matrix3<f64> = transform.fixed_view::<3, 3>(0, 0).into_owned();
        let translation: Vec3 = transform.fixed_view::<3, 1>(0, 3).into_owned();
        let first = builder.position_count();
        let positions = accessors.vectors::<3>(position)?;
        let count = positions.len();
        for p in positions {
            builder.position((linear * Vec3::from(p) + translation).into(), at)?;
        }
        let first_uv = builder.uv_count();
        if let Some(uv) = primitive.attributes.texcoord {
            for [u, v] in accessors.vectors::<2>(uv)? {
                let uv = to_f32(Vec3::new(u, v, 0.0));
                builder.uv([uv[0], uv[1]]);
            }
        }
        let first_normal = builder.normal_count();
        if let Some(normal) = primitive.attributes.normal {
            let [a, b, c] = [0, 1, 2].map(|k| Vec3::from(linear.column(k)));
            let cofactors = Matrix3::from_columns(&[b.cross(&c), c.cross(&a), a.cross(&b)]);
            for n in accessors.vectors::<3>(normal)? {
                let n = Vec3::from(n);
                let is_kept = cofactors == Matrix3::identity();
                let turned = || (cofactors * n).try_normalize(0.0).unwrap_or_default();
                builder.normal(to_f32(if is_kept { n } else { turned() }));
            }
        }
        read_channels(
            primitive,
            accessors,
            first,
            count,
            most.saturating_mul(4),
            builder,
        )?;
        let complete = |first: usize, end: usize| (end - first == count).then_some(first);
        Ok(Some(Self {
            first,
            count,
            uv: complete(first_uv, builder.uv_count()),
            normal: complete(first_normal, builder.normal_count()),
        }))
    }

    /// Returns the corner of the vertex with number `i` of the primitive.
    fn corner(&self, i: u32) -> Result<Corner, ParseError> {
        let index = |first: usize| {
            let index = u32::try_from(first + i as usize);
            index.map_err(|_| ParseError::TooLarge)
        };
        let optional = |first: Option<usize>| first.map_or(Ok(NONE), index);
        Ok(Corner {
            position: index(self.first)?,
            uv: optional(self.uv)?,
            normal: optional(self.normal)?,
            row: NONE,
        })
    }
}

/// Adds the triangles of a primitive.
fn add_triangles(
    primitive: &Primitive,
    vertices: &Vertices,
    mirrored: bool,
    accessors: &Accessors<'_>,
    at: SourceLocation,
    builder: &mut Builder,
) -> Result<(), ParseError> {
    let count = vertices.count;
    let indices = match primitive.indices {
        Some(indices) => accessors.indices(indices)?,
        None => (0..u32::try_from(count).map_err(|_| ParseError::TooLarge)?).collect(),
    };
    if let Some(&index) = indices.iter().find(|&&i| i as usize >= count) {
        return Err(ParseError::IndexOutOfRange {
            at,
            index: i64::from(index),
            count,
        });
    }
    let material = primitive
        .material
        .and_then(|i| accessors.document.materials.get(i));
    builder.material = material.map_or(0, |material| material_number(material.name.as_bytes()));
    let mut add = |[a, b, c]: [u32; 3]| {
        let (b, c) = if mirrored { (c, b) } else { (b, c) };
        let [a, b, c] = [a, b, c].map(|i| vertices.corner(i));
        builder.face(&[a?, b?, c?], at)
    };
    match primitive.mode() {
        TRIANGLES => {
            let (triangles, rest) = indices.as_chunks::<3>();
            if !rest.is_empty() {
                return Err(ParseError::Syntax {
                    at,
                    expected: "three indices a triangle",
                });
            }
            triangles.iter().try_for_each(|&t| add(t))
        }
        TRIANGLE_STRIP => strip_triangles(&indices).try_for_each(add),
        _ => {
            let mut pairs = indices.get(1..).unwrap_or_default().windows(2);
            pairs.try_for_each(|pair| add([indices[0], pair[0], pair[1]]))
        }
    }
}

#[cfg(test)]
mod tests;
