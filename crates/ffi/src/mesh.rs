//! [`MeshObject`]: a surface behind a handle, and its conversion from and to flat arrays.

use crate::handles::Object;
use crate::memory::check_finite;
use crate::status::{Error, Status};
use incise::mesh::{
    MeshData, RepairParams, Surface, Warning, read_mesh, write_glb, write_obj, write_ply, write_stl,
};
use incise_models::{Model, build_model};
use std::fmt::Write;
use std::path::Path;

/// The repairs of meshes that are read and repaired: those of the program `incise`.
pub(crate) const REPAIRS: RepairParams = RepairParams {
    allow_boundaries: true,
    separate_sheets: true,
};

/// A triangle surface: a body or a sheet.
#[derive(Debug)]
pub struct Mesh {
    _opaque: [u8; 0],
}

/// A surface without free slots, and the warnings of its repair.
#[derive(Debug)]
pub(crate) struct MeshObject {
    pub(crate) surface: Surface,
    pub(crate) warnings: String,
}

impl Object for MeshObject {
    type Handle = Mesh;
    const NAME: &'static str = "mesh";
}

/// Flat arrays of a mesh: positions, triangles and texture coordinates.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Arrays<'a> {
    pub(crate) vertices: &'a [[f32; 3]],
    pub(crate) faces: &'a [[u32; 3]],
    /// None, one per vertex, or one per corner.
    pub(crate) uv: &'a [[f32; 2]],
}

impl Arrays<'_> {
    /// Returns the texture coordinates of corners, or none.
    fn corner_uvs(&self) -> Result<Vec<[f32; 2]>, Error> {
        let (vertices, corners) = (self.vertices.len(), 3 * self.faces.len());
        check_finite(self.uv.as_flattened(), "uv")?;
        match self.uv.len() {
            0 => Ok(Vec::new()),
            n if n == vertices => Ok((self.faces.as_flattened().iter())
                .map(|&v| self.uv[v as usize])
                .collect()),
            n if n == corners => Ok(self.uv.to_vec()),
            n => Err(Error::argument(format_args!(
                "uv has {n} rows; pass none, {vertices} (one per vertex) or {corners} (one per \
                 corner)"
            ))),
        }
    }

    fn check(&self) -> Result<(), Error> {
        check_finite(self.vertices.as_flattened(), "vertices")?;
        let is_outside = |v: &u32| *v as usize >= self.vertices.len();
        match self.faces.as_flattened().iter().position(is_outside) {
            Some(i) => Err(Error::new(
                Status::OutOfRange,
                format_args!(
                    "faces[{i}] is {}, and there are {} vertices",
                    self.faces.as_flattened()[i],
                    self.vertices.len()
                ),
            )),
            None => Ok(()),
        }
    }

    /// Returns the surface with the indices of the arrays.
    pub(crate) fn surface(&self) -> Result<Surface, Error> {
        self.check()?;
        let mut surface = Surface::from_triangles(self.vertices, self.faces)?;
        let uvs = self.corner_uvs()?;
        surface.set_corner_uvs(uvs).map_err(Error::argument)?;
        Ok(surface)
    }

    /// Returns the arrays as the data of a file, with equal positions welded.
    pub(crate) fn data(&self) -> Result<MeshData, Error> {
        self.check()?;
        let mut data = MeshData::from_triangles(self.vertices, self.faces)?;
        data.corners.uv = self.corner_uvs()?;
        Ok(data)
    }
}

impl MeshObject {
    /// Stores a surface without free slots.
    pub(crate) fn new(surface: Surface) -> Self {
        Self {
            surface,
            warnings: String::new(),
        }
    }

    /// Repairs mesh data to a surface that can be cut.
    pub(crate) fn repair(data: MeshData) -> Result<Self, Error> {
        let (surface, warnings) = data.repair(REPAIRS)?;
        Ok(Self {
            surface,
            warnings: lines(&warnings),
        })
    }

    /// Reads and repairs a file.
    pub(crate) fn read(path: &str) -> Result<Self, Error> {
        Self::repair(read_mesh(Path::new(path))?)
    }

    /// Builds one of the models of `incise-models`.
    pub(crate) fn model(name: &str) -> Result<Self, Error> {
        let is_named = |model: &Model| name.eq_ignore_ascii_case(model.name());
        match Model::ALL.into_iter().find(is_named) {
            Some(model) => Ok(Self::new(build_model(model))),
            None => Err(Error::argument(format_args!(
                "no model is named {name}; there are {}",
                Model::ALL.map(Model::name).join(", ")
            ))),
        }
    }

    /// Writes a file in the format of its extension. Returns the warnings.
    pub(crate) fn write(&self, path: &str) -> Result<String, Error> {
        let file = Path::new(path);
        let extension = file.extension().unwrap_or_default().to_ascii_lowercase();
        let surface = &self.surface;
        let warnings = match extension.to_str() {
            Some("obj") => write_obj(file, surface)?,
            Some("ply") => write_ply(file, surface)?,
            Some("stl") => write_stl(file, surface)?,
            Some("glb") => write_glb(file, &[("mesh", surface)])?,
            _ => {
                let text = format_args!("{path}: name a file that ends in obj, ply, stl or glb");
                return Err(Error::new(Status::File, text));
            }
        };
        Ok(lines(&warnings))
    }

    /// Returns the positions of all vertices.
    pub(crate) fn vertices(&self) -> Vec<[f32; 3]> {
        let position = |&[x, y, z, _]: &[f32; 4]| [x, y, z];
        self.surface.positions().iter().map(position).collect()
    }
}

/// Returns the vertices of all triangles of a surface, in slot order.
pub(crate) fn faces(surface: &Surface) -> Vec<[u32; 3]> {
    let topology = surface.topology();
    let corners = |t| topology.triangle(t).map(|v| v.0);
    topology.triangles().map(corners).collect()
}

/// Returns warnings as lines of text.
pub(crate) fn lines(warnings: &[Warning]) -> String {
    let mut text = String::new();
    for warning in warnings {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{warning}");
    }
    text
}
