//! Input meshes: a file, or a built-in model by its name.

use crate::failure::Failure;
use incise_mesh::geometry::to_file;
use incise_mesh::{
    Aabb, Defect, MeshData, NotCuttable, ParseError, ReadError, RepairParams, Surface, TriangleId,
    Warning, read_mesh,
};
use incise_models::{Model, build_model};
use incise_refine::{HoleParams, fill_holes};
use std::fmt;
use std::path::{Path, PathBuf};

/// Options of reading meshes.
#[derive(Debug, Clone, Copy, clap::Args)]
pub struct InputOptions {
    /// Refuse meshes with edges of more than two triangles instead of separating the sheets and
    /// bodies that meet there.
    #[arg(long)]
    no_repair: bool,
}

impl InputOptions {
    /// Creates options that make all repairs, or none.
    pub(crate) fn new(repair: bool) -> Self {
        Self { no_repair: !repair }
    }

    /// Returns whether meshes are repaired.
    pub(crate) fn repair(self) -> bool {
        !self.no_repair
    }

    /// Returns the repairs to make.
    pub(crate) fn repairs(self, allow_boundaries: bool) -> RepairParams {
        RepairParams {
            allow_boundaries,
            separate_sheets: !self.no_repair,
        }
    }

    /// Reads a mesh that can be cut, with the warnings of its repair.
    ///
    /// The exact method cuts open meshes, too, the paper's closed ones only.
    pub(crate) fn read_for_cut(
        self,
        input: &Path,
        is_exact: bool,
    ) -> Result<(Surface, Vec<Warning>), Failure> {
        match is_exact {
            true => self.read_open(input),
            false => self.read_closed(input),
        }
    }

    /// Reads a closed mesh, with the warnings of its repair.
    fn read_closed(self, input: &Path) -> Result<(Surface, Vec<Warning>), Failure> {
        match model_of(input) {
            Some(model) => Ok((build_model(model), Vec::new())),
            None => {
                let data = read_data(input)?;
                let surface = data.clone().repair(self.repairs(false));
                surface.map_err(|source| self.refuse(input, source, &data))
            }
        }
    }

    /// Reads a mesh that may have holes, with the warnings of its repair.
    pub(crate) fn read_open(self, input: &Path) -> Result<(Surface, Vec<Warning>), Failure> {
        match model_of(input) {
            Some(model) => Ok((build_model(model), Vec::new())),
            None => {
                let surface = read_data(input)?.repair(self.repairs(true));
                surface.map_err(|source| Failure::NotCuttable {
                    path: input.to_owned(),
                    source,
                    advice: OpenMeshAdvice::None,
                })
            }
        }
    }

    /// Returns the error for a mesh that cannot be cut, with advice for an open mesh.
    pub(crate) fn refuse(self, input: &Path, source: NotCuttable, data: &MeshData) -> Failure {
        let is_open = |defect: &Defect| matches!(defect, Defect::OpenEdge { gap: None, .. });
        let advice = if source.defects.iter().all(is_open) {
            self.advice_for_open(data.clone())
        } else {
            OpenMeshAdvice::None
        };
        Failure::NotCuttable {
            path: input.to_owned(),
            source,
            advice,
        }
    }

    /// Fills all holes and returns the advice that the result gives.
    fn advice_for_open(self, data: MeshData) -> OpenMeshAdvice {
        let Ok((mut surface, _)) = data.repair(self.repairs(true)) else {
            return OpenMeshAdvice::None;
        };
        let Ok(filled) = fill_holes(&mut surface, &HoleParams::default()) else {
            return OpenMeshAdvice::None;
        };
        let is_simple = filled.holes.iter().all(|hole| !hole.self_intersecting);
        if !is_simple || !surface.topology().is_closed() {
            return OpenMeshAdvice::None;
        }
        let is_cuttable =
            |surface| to_data(surface).is_ok_and(|data| data.repair(self.repairs(false)).is_ok());
        match components_without_volume(&surface) {
            0 if is_cuttable(&surface) => OpenMeshAdvice::Fill,
            0 => OpenMeshAdvice::None,
            count if count == surface.piece_count() => OpenMeshAdvice::Thicken,
            count => OpenMeshAdvice::ThickenSome { count },
        }
    }
}

/// Returns the number of edges of a surface that have one triangle.
pub(crate) fn boundary_edges(surface: &Surface) -> usize {
    let topology = surface.topology();
    let half_edges = topology.triangles().flat_map(TriangleId::half_edges);
    half_edges.filter(|&h| topology.twin(h).is_null()).count()
}

/// Returns the volume of a surface without its pieces with a boundary.
pub(crate) fn closed_volume(surface: &Surface) -> f64 {
    let volumes = surface.piece_volumes().into_iter();
    let closed = volumes.zip(surface.open_pieces()).filter(|(_, open)| !open);
    closed.map(|(volume, _)| volume).sum()
}

/// Reads the data of a mesh, with its defects.
pub(crate) fn read_unrepaired(input: &Path) -> Result<MeshData, Failure> {
    let Some(model) = model_of(input) else {
        return read_data(input);
    };
    let data = to_data(&build_model(model));
    Ok(data.map_err(|source| ReadError::Parse {
        path: input.to_owned(),
        source,
    })?)
}

/// Volume of a closed component, relative to its area to the 3/2, below which it is a flat sheet of
/// two sides. A cube has 0.07.
pub(crate) const FLAT_VOLUME: f64 = 1e-6;

/// A way to make an open mesh cuttable.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum OpenMeshAdvice {
    /// Fill the holes with `incise fill`.
    Fill,
    /// Give every component thickness: filled, none encloses a volume.
    Thicken,
    /// Give these components thickness before `incise fill`.
    ThickenSome {
        /// Number of components that enclose no volume when filled.
        count: usize,
    },
    /// No advice.
    None,
}

impl fmt::Display for OpenMeshAdvice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Fill => write!(f, " with `incise fill`"),
            Self::Thicken => write!(
                f,
                "; an open sheet without volume has no inside, also with its holes closed: give \
                 it thickness (Solidify in Blender)"
            ),
            Self::ThickenSome { count } => write!(
                f,
                " with `incise fill`, after removing the open sheets without volume or giving \
                 them thickness (Solidify in Blender): {count}"
            ),
            Self::None => Ok(()),
        }
    }
}

/// Returns the number of closed components that enclose no volume, up to rounding.
pub(crate) fn components_without_volume(surface: &Surface) -> usize {
    let is_flat = |part: &Surface| {
        part.topology().is_closed() && part.volume().abs() <= FLAT_VOLUME * part.area().powf(1.5)
    };
    let parts = surface.extract_pieces();
    parts.filter(|(_, part)| is_flat(part)).count()
}

/// Returns the bounding box of a surface in the coordinates of its file.
pub(crate) fn file_bounds(surface: &Surface) -> Aabb {
    in_file(surface.origin(), &surface.bounds())
}

/// Returns a box relative to an origin in the coordinates of the file.
pub(crate) fn in_file(origin: [f64; 3], bounds: &Aabb) -> Aabb {
    Aabb {
        min: to_file(origin, bounds.min),
        max: to_file(origin, bounds.max),
    }
}

/// Returns the positions and triangles of a surface as the data of a mesh file.
fn to_data(surface: &Surface) -> Result<MeshData, ParseError> {
    let position = |&[x, y, z, _]: &[f32; 4]| [x, y, z];
    let positions: Vec<[f32; 3]> = surface.positions().iter().map(position).collect();
    let topology = surface.topology();
    let corners = |t| topology.triangle(t).map(|v| v.0);
    let triangles: Vec<[u32; 3]> = topology.triangles().map(corners).collect();
    MeshData::from_triangles(&positions, &triangles)
}

/// Returns the path of a mesh that a file in `folder` names; the name of a model stays.
pub(crate) fn resolve(folder: &Path, name: &Path) -> PathBuf {
    let path = folder.join(name);
    if named_model(name).is_some() && !path.exists() {
        return name.to_owned();
    }
    path
}

/// Reads a file. The error of a name that is no file says which model may be meant.
fn read_data(input: &Path) -> Result<MeshData, Failure> {
    let path = || input.to_owned();
    if input.is_dir() {
        return Err(Failure::InputIsFolder { path: path() });
    }
    if !input.exists() {
        let stem = input.with_extension("");
        if let Some(model) = named_model(&stem) {
            return Err(Failure::NoFileButModel {
                path: path(),
                model: model.name(),
            });
        }
        if input.extension().is_none() {
            return Err(Failure::NoInput { path: path() });
        }
    }
    Ok(read_mesh(input)?)
}

/// Returns the model of this name. A file of the same name comes first.
fn model_of(input: &Path) -> Option<Model> {
    named_model(input).filter(|_| !input.exists())
}

/// Returns the model of this name, in any case.
fn named_model(input: &Path) -> Option<Model> {
    let is_named = |model: &Model| {
        let name = input.to_str();
        name.is_some_and(|name| name.eq_ignore_ascii_case(model.name()))
    };
    Model::ALL.into_iter().find(is_named)
}
