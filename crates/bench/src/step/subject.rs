//! What is measured: the seven models, and finer and finer spheres.

use crate::models::{self, Loaded};
use crate::motion;
use incise_mesh::{Model, Surface, cube_sphere};
#[cfg(feature = "gpu")]
use incise_pbd_gpu::PatchParams;
use incise_pbd_gpu::{ConstraintError, Material, Solver};
use std::error::Error;
use std::path::Path;

/// Squares along an edge of the cubes that spheres are blown up from: subdivisions of Sphere768,
/// and one of a million triangles.
const SPHERES: [u32; 5] = [16, 32, 64, 128, 289];
/// Radius of the spheres \[m\], that of the models.
const RADIUS: f64 = 0.5;

/// A surface to measure.
pub(super) enum Subject {
    Model(Box<Loaded>),
    /// A sphere of so many squares along an edge. Made when it is its turn: the largest are large.
    Sphere(u32),
}

impl Subject {
    pub(super) fn name(&self) -> String {
        match self {
            Self::Model(loaded) => loaded.model.name().to_owned(),
            Self::Sphere(quads) => sphere_name(*quads),
        }
    }

    pub(super) fn source(&self) -> &str {
        match self {
            Self::Model(loaded) => &loaded.source,
            Self::Sphere(_) => "built-in",
        }
    }

    pub(super) fn triangles(&self) -> usize {
        match self {
            Self::Model(loaded) => loaded.surface.topology().triangle_count(),
            Self::Sphere(quads) => sphere_triangles(*quads),
        }
    }

    /// The body as the table has it: its material, spinning and squeezed.
    pub(super) fn body(&self) -> Result<(Surface, Solver), ConstraintError> {
        self.made_by(Solver::new)
    }

    /// The same divided into patches.
    #[cfg(feature = "gpu")]
    pub(super) fn patched(&self) -> Result<(Surface, Solver), ConstraintError> {
        self.made_by(|surface, material| {
            Solver::with_patches(surface, material, &PatchParams::default())
        })
    }

    fn made_by(
        &self,
        make: impl FnOnce(&mut Surface, &Material) -> Result<Solver, ConstraintError>,
    ) -> Result<(Surface, Solver), ConstraintError> {
        let mut surface = match self {
            Self::Model(loaded) => loaded.surface.clone(),
            Self::Sphere(quads) => cube_sphere(*quads, RADIUS),
        };
        let mut solver = make(&mut surface, &motion::material())?;
        motion::start(&mut solver, &surface)?;
        Ok((surface, solver))
    }
}

fn sphere_triangles(quads: u32) -> usize {
    12 * quads as usize * quads as usize
}

fn sphere_name(quads: u32) -> String {
    format!("Sphere{}", sphere_triangles(quads))
}

/// The models and spheres that `only` names (all when empty) with at most so many triangles.
pub(super) fn list(
    folder: Option<&Path>,
    only: &[String],
    max_triangles: usize,
) -> Result<Vec<Subject>, Box<dyn Error>> {
    let is_sphere =
        |name: &String, quads: u32| sphere_name(quads).eq_ignore_ascii_case(name.trim());
    let (spheres, models): (Vec<String>, Vec<String>) = (only.iter().cloned())
        .partition(|name| SPHERES.iter().any(|&quads| is_sphere(name, quads)));
    if let Some(name) = models.iter().find(|name| models::named(name).is_none()) {
        let all = Model::ALL.map(|m| m.name().to_owned());
        let all: Vec<String> = all.into_iter().chain(SPHERES.map(sphere_name)).collect();
        return Err(format!("'{name}' is none of {}", all.join(", ")).into());
    }
    let mut subjects = Vec::new();
    if only.is_empty() || !models.is_empty() {
        let loaded = models::load(folder, &models)?;
        subjects.extend(loaded.into_iter().map(|l| Subject::Model(Box::new(l))));
    }
    let wanted =
        |quads: &u32| only.is_empty() || spheres.iter().any(|name| is_sphere(name, *quads));
    subjects.extend(SPHERES.into_iter().filter(wanted).map(Subject::Sphere));
    subjects.retain(|subject| subject.triangles() <= max_triangles);
    if subjects.is_empty() {
        return Err("no model is that small: raise --max-triangles".into());
    }
    let models = subjects.iter().filter_map(|subject| match subject {
        Subject::Model(loaded) => Some((loaded.model.name(), loaded.source.as_str())),
        Subject::Sphere(_) => None,
    });
    models::tell_built_in(folder, models);
    Ok(subjects)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(only: &[&str], max_triangles: usize) -> Vec<String> {
        let only: Vec<String> = only.iter().map(|&s| s.to_owned()).collect();
        let subjects = list(None, &only, max_triangles).unwrap();
        subjects.iter().map(Subject::name).collect()
    }

    #[test]
    fn models_and_spheres_are_found_by_name_and_size() {
        assert_eq!(
            names(&["sphere3072", "SPHERE20"], usize::MAX),
            ["Sphere20", "Sphere3072"]
        );
        assert_eq!(names(&["Sphere1002252"], usize::MAX), ["Sphere1002252"]);
        assert_eq!(names(&["Sphere20", "Sphere80"], 20), ["Sphere20"]);
        assert!(list(None, &["Sphere3073".to_owned()], 10).is_err());
        assert!(
            list(None, &["Sphere20".to_owned()], 10).is_err(),
            "nothing is left"
        );
    }

    #[test]
    fn a_sphere_has_the_triangles_of_its_name() {
        let subject = Subject::Sphere(SPHERES[0]);
        let (surface, _) = subject.body().unwrap();
        assert_eq!(surface.topology().triangle_count(), 3072);
        assert_eq!(subject.triangles(), 3072);
    }
}
