//! [`Subject`]: the meshes of stress cases over models, built in or all of a folder.

use super::scenes::place;
use crate::models::files;
use incise_mesh::{RepairParams, Surface, Vec3, read_mesh};
use incise_models::{Model, build_model};
use std::error::Error;
use std::path::Path;

/// A mesh whose largest side is 1 m, centered above the origin, with its lowest point at height 0.
#[derive(Debug)]
pub(super) struct Subject {
    /// The name of the model or of its file.
    pub(super) name: String,
    pub(super) surface: Surface,
}

impl Subject {
    fn new(name: String, mut surface: Surface) -> Option<Self> {
        surface.sort_by_position();
        let bounds = surface.bounds();
        let (low, high) = (bounds.min.map(f64::from), bounds.max.map(f64::from));
        let (low, high) = (Vec3::from(low), Vec3::from(high));
        let (side, center) = ((high - low).amax(), (low + high) / 2.0);
        let base = Vec3::new(center.x, low.y, center.z);
        place(&mut surface, |p| (p - base) / side);
        (side > 0.0).then_some(Self { name, surface })
    }
}

/// Returns the built-in models, or every mesh of a folder that can be cut, smallest first.
///
/// Of files with the same positions the first one is taken.
///
/// # Errors
/// When the folder cannot be read.
pub(super) fn load(folder: Option<&Path>) -> Result<Vec<Subject>, Box<dyn Error>> {
    let mut all: Vec<Subject> = match folder {
        None => {
            let of = |model: Model| Subject::new(model.name().to_owned(), build_model(model));
            Model::ALL.into_iter().filter_map(of).collect()
        }
        Some(folder) => files(folder)?
            .iter()
            .filter_map(|path| of_file(path))
            .collect(),
    };
    all.sort_by_key(|subject| subject.surface.topology().triangle_count());
    all.dedup_by(|next, first| next.surface.positions() == first.surface.positions());
    Ok(all)
}

/// Returns a mesh that can be cut; other files are no subjects.
fn of_file(path: &Path) -> Option<Subject> {
    let repairs = RepairParams {
        allow_boundaries: true,
        separate_sheets: true,
    };
    let (surface, _) = read_mesh(path).ok()?.repair(repairs).ok()?;
    let name = path.file_name().unwrap_or_default();
    Subject::new(name.to_string_lossy().into_owned(), surface)
}
