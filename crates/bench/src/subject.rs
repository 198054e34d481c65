//! What is cut: the seven models, finer and finer armadillos and spheres.

use crate::models::{self, Loaded};
use crate::subdivide::subdivide;
use incise_mesh::{Model, Surface, cube_sphere};
use std::error::Error;
use std::path::Path;
use std::rc::Rc;

/// Squares along an edge of the cubes that spheres are blown up from: subdivisions of Sphere768 up to
/// 196,608 triangles, and one of 1.3 million.
const SPHERES: [u32; 5] = [16, 32, 64, 128, 330];
/// Radius of the spheres \[m\], that of the models.
const RADIUS: f64 = 0.5;

/// A surface to cut. Made when it is its turn: the largest are large.
pub(crate) struct Subject {
    pub(crate) name: String,
    /// Of one shape at several sizes, which the growth of times is told by.
    pub(crate) family: Option<&'static str>,
    pub(crate) source: String,
    triangles: usize,
    kind: Kind,
}

enum Kind {
    /// A model, subdivided so often.
    Model(Rc<Loaded>, u32),
    /// A sphere of so many squares along an edge.
    Sphere(u32),
}

impl Subject {
    pub(crate) fn surface(&self) -> Result<Surface, Box<dyn Error>> {
        match &self.kind {
            Kind::Sphere(quads) => Ok(cube_sphere(*quads, RADIUS)),
            Kind::Model(loaded, times) => {
                let mut surface = loaded.surface.clone();
                for _ in 0..*times {
                    surface = subdivide(&surface)?;
                }
                Ok(surface)
            }
        }
    }
}

/// The subjects that `only` names (all when empty) with at most so many triangles.
pub(crate) fn list(
    folder: Option<&Path>,
    only: &[String],
    max_triangles: usize,
) -> Result<Vec<Subject>, Box<dyn Error>> {
    let mut subjects = Vec::new();
    for loaded in models::load(folder, &[])? {
        let grows = loaded.model == Model::Armadillo;
        let loaded = Rc::new(loaded);
        let mut triangles = loaded.surface.topology().triangle_count();
        for times in 0.. {
            if triangles > max_triangles || times > 0 && !grows {
                break;
            }
            let name = loaded.model.name();
            subjects.push(Subject {
                name: match times {
                    0 => name.to_owned(),
                    _ => format!("{name}{triangles}"),
                },
                family: grows.then_some(name),
                source: loaded.source.clone(),
                triangles,
                kind: Kind::Model(Rc::clone(&loaded), times),
            });
            let Some(finer) = triangles.checked_mul(4) else {
                break;
            };
            triangles = finer;
        }
    }
    subjects.extend(SPHERES.into_iter().map(|quads| {
        let triangles = 12 * quads as usize * quads as usize;
        Subject {
            name: format!("Sphere{triangles}"),
            family: Some("Sphere"),
            source: models::BUILT_IN.to_owned(),
            triangles,
            kind: Kind::Sphere(quads),
        }
    }));
    let is = |subject: &Subject, name: &String| subject.name.eq_ignore_ascii_case(name.trim());
    if let Some(name) = only
        .iter()
        .find(|name| !subjects.iter().any(|s| is(s, name)))
    {
        let names: Vec<&str> = subjects.iter().map(|s| s.name.as_str()).collect();
        return Err(format!("'{name}' is none of {}", names.join(", ")).into());
    }
    subjects.retain(|s| {
        s.triangles <= max_triangles && (only.is_empty() || only.iter().any(|name| is(s, name)))
    });
    if subjects.is_empty() {
        return Err("no model is that small: raise --max-triangles".into());
    }
    let models = subjects
        .iter()
        .filter(|s| matches!(s.kind, Kind::Model(..)));
    models::tell_built_in(folder, models.map(|s| (s.name.as_str(), s.source.as_str())));
    Ok(subjects)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn models_armadillos_and_spheres_are_found_by_name_and_size() {
        let names = |only: &[&str], most| -> Vec<String> {
            let only: Vec<String> = only.iter().map(|&s| s.to_owned()).collect();
            let subjects = list(None, &only, most).unwrap();
            subjects.into_iter().map(|s| s.name).collect()
        };
        assert_eq!(
            names(&["sphere3072", "SPHERE20"], 5000),
            ["Sphere20", "Sphere3072"]
        );
        let armadillos = ["Armadillo", "Armadillo120000", "Armadillo480000"];
        assert_eq!(names(&armadillos, 1_400_000), armadillos);
        assert!(list(None, &["cow".to_owned()], 5000).is_err());
        assert!(list(None, &[], 10).is_err(), "nothing is left");
        let sphere = list(None, &["Sphere3072".to_owned()], 5000).unwrap();
        let surface = sphere[0].surface().unwrap();
        assert_eq!(surface.topology().triangle_count(), 3072);
    }
}
