//! [`MeshArrays`]: the arrays of a Python mesh, and their conversion to and from the library's
//! surfaces and mesh data.

use crate::arrays::{Numbers, floats, wrong_shape};
use crate::error::{OrRaise, refused};
use incise::mesh::{
    Blend, Channel, Domain, MeshData, ReadError, Surface, TopologyError, TriangleId, Warning,
};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// A mesh at rest, as plain arrays.
#[derive(Debug, Default)]
pub(crate) struct MeshArrays {
    /// Shape \[n\] \[m\].
    pub(crate) positions: Vec<[f32; 3]>,
    /// Shape \[m\].
    pub(crate) triangles: Vec<[u32; 3]>,
    /// Per corner: empty, or of shape \[3m\].
    pub(crate) uv: Vec<[f32; 2]>,
    /// Per corner: empty, or of shape \[3m\].
    pub(crate) normals: Vec<[f32; 3]>,
    pub(crate) channels: Vec<Channel>,
    /// Shape \[m\].
    pub(crate) materials: Vec<u32>,
    /// Origin of the positions in the coordinates of their file \[m\].
    pub(crate) origin: [f64; 3],
    /// Warnings of the reader and of repairs.
    pub(crate) warnings: Vec<String>,
}

impl MeshArrays {
    /// Copies a surface without free slots.
    pub(crate) fn from_surface(surface: &Surface) -> Self {
        let topology = surface.topology();
        let corners = |t| topology.triangle(t).map(|v| v.0);
        let positions = surface.positions().iter();
        Self {
            positions: positions.map(|&[x, y, z, _]| [x, y, z]).collect(),
            triangles: topology.triangles().map(corners).collect(),
            uv: surface.corner_uvs().to_vec(),
            normals: surface.corner_normals().to_vec(),
            channels: surface.channels().to_vec(),
            materials: topology.triangles().map(|t| surface.material(t)).collect(),
            origin: surface.origin(),
            warnings: Vec::new(),
        }
    }

    /// Takes the content of a file.
    pub(crate) fn from_data(data: MeshData) -> Self {
        let mut materials = data.materials;
        materials.resize(data.triangles.len(), 0);
        Self {
            positions: data.positions,
            triangles: data.triangles,
            uv: data.corners.uv,
            normals: data.corners.normal,
            channels: data.channels,
            materials,
            origin: data.origin,
            warnings: data.warnings.iter().map(Warning::to_string).collect(),
        }
    }

    /// Adds warnings about repairs.
    pub(crate) fn with_warnings(mut self, warnings: &[Warning]) -> Self {
        self.warnings
            .extend(warnings.iter().map(Warning::to_string));
        self
    }

    /// Builds the surface, with the same ids of vertices and triangles.
    ///
    /// # Errors
    /// [`TopologyError`] if the triangles do not form an oriented manifold.
    pub(crate) fn surface(&self) -> Result<Surface, TopologyError> {
        let mut surface = Surface::from_triangles(&self.positions, &self.triangles)?;
        surface.set_origin(self.origin);
        let lengths = "the constructor has checked the lengths";
        (surface.set_corner_uvs(self.uv.clone())).expect(lengths);
        (surface.set_corner_normals(self.normals.clone())).expect(lengths);
        for channel in &self.channels {
            surface.set_channel(channel.clone()).expect(lengths);
        }
        for (t, &material) in self.materials.iter().enumerate() {
            if material != 0 {
                surface.set_material(TriangleId::from_index(t), material);
            }
        }
        Ok(surface)
    }

    /// Returns the mesh as the content of a file, with equal positions welded.
    ///
    /// Attributes of vertices become those of corners if welding merges any vertices.
    pub(crate) fn data(&self) -> PyResult<MeshData> {
        let data = MeshData::from_triangles(&self.positions, &self.triangles);
        let mut data = data.map_err(|source| {
            let path = "mesh".into();
            ReadError::Parse { path, source }
        });
        if let Ok(data) = &mut data {
            data.corners.uv.clone_from(&self.uv);
            data.corners.normal.clone_from(&self.normals);
            data.materials.clone_from(&self.materials);
            data.origin = self.origin;
            let is_same = data.positions.len() == self.positions.len();
            for channel in &self.channels {
                let is_vertex = channel.domain() == Domain::Vertex;
                data.channels.push(if is_vertex && !is_same {
                    self.per_corner(channel)
                } else {
                    channel.clone()
                });
            }
        }
        data.or_raise()
    }

    /// Returns a channel of vertices as one of corners.
    fn per_corner(&self, channel: &Channel) -> Channel {
        let corners = self.triangles.iter().flatten();
        let rows = corners.flat_map(|&v| channel.row(v as usize));
        let (name, blend, width) = (channel.name(), channel.blend(), channel.width());
        Channel::new(name, Domain::Corner, blend, width, rows.copied().collect())
            .expect("the width is that of a channel")
    }

    /// Reads texture coordinates of shape (n, 2) or (m, 3, 2).
    pub(crate) fn read_uv(&mut self, value: &Bound<'_, PyAny>) -> PyResult<()> {
        let Numbers { shape, values } = floats(value, "uv")?;
        let rows = values.as_chunks::<2>().0;
        let (n, m) = (self.positions.len(), self.triangles.len());
        self.uv = match *shape.as_slice() {
            [rows_given, 2] if rows_given == n => {
                let corners = self.triangles.iter().flatten();
                corners.map(|&v| rows[v as usize]).collect()
            }
            [triangles, 3, 2] if triangles == m => rows.to_vec(),
            _ => {
                let expected = format!("({n}, 2), one row per vertex, or ({m}, 3, 2)");
                return Err(wrong_shape("uv", &shape, &expected));
            }
        };
        Ok(())
    }

    /// Reads shading normals of shape (m, 3, 3).
    pub(crate) fn read_normals(&mut self, value: &Bound<'_, PyAny>) -> PyResult<()> {
        let Numbers { shape, values } = floats(value, "normals")?;
        let m = self.triangles.len();
        if shape != [m, 3, 3] {
            return Err(wrong_shape("normals", &shape, &format!("({m}, 3, 3)")));
        }
        self.normals = values.as_chunks::<3>().0.to_vec();
        Ok(())
    }

    /// Reads attributes of shape (n,), (n, k) or (m, 3, k).
    pub(crate) fn read_attributes(&mut self, attributes: &Bound<'_, PyDict>) -> PyResult<()> {
        let (n, m) = (self.positions.len(), self.triangles.len());
        for (name, value) in attributes {
            let name: String = name.extract().map_err(|_| {
                refused("attributes has a key that is no text; pass a dict from names to arrays")
            })?;
            let label = format!("attributes['{name}']");
            let Numbers { shape, values } = floats(&value, &label)?;
            let (domain, width) = match *shape.as_slice() {
                [rows] if rows == n => (Domain::Vertex, 1),
                [rows, width] if rows == n => (Domain::Vertex, width),
                [triangles, 3, width] if triangles == m => (Domain::Corner, width),
                _ => {
                    let expected = format!("({n},) or ({n}, k) for vertices, or ({m}, 3, k)");
                    return Err(wrong_shape(&label, &shape, &expected));
                }
            };
            // The readers' name of joints and weights.
            let blend = if name == "skin" {
                Blend::Skin
            } else {
                Blend::Linear
            };
            let channel = Channel::new(name, domain, blend, width, values).map_err(refused)?;
            self.channels.push(channel);
        }
        Ok(())
    }
}
