//! Workloads of the benches `cut`, `refine` and `step`: models, finer armadillos and spheres.

use crate::models::{self, Loaded};
use crate::motion;
use incise_mesh::{HalfEdge, Surface, TopologyError, cube_sphere};
use incise_models::Model;
use incise_pbd_gpu::{ConstraintError, Material, Solver};
use std::error::Error;
use std::path::Path;
use std::rc::Rc;

/// Squares along an edge of the cubes that spheres are projected from: subdivisions of Sphere768
/// up to 196,608 triangles, and one of 1.3 million.
const SPHERES: [u32; 5] = [16, 32, 64, 128, 330];
/// Radius of the spheres \[m\], that of the models.
const RADIUS: f64 = 0.5;

/// A surface, built on demand because the largest are large.
pub(crate) struct Workload {
    pub(crate) name: String,
    /// The name of the shape, for shapes in several sizes.
    pub(crate) family: Option<&'static str>,
    pub(crate) source: String,
    triangles: usize,
    kind: Kind,
}

enum Kind {
    /// A model and its number of subdivisions.
    Model(Rc<Loaded>, u32),
    /// A sphere and its squares along an edge.
    Sphere(u32),
}

impl Workload {
    /// Builds the surface.
    ///
    /// # Errors
    /// None: every workload is a surface.
    pub(crate) fn surface(&self) -> Result<Surface, TopologyError> {
        let mut surface = match &self.kind {
            Kind::Sphere(quads) => cube_sphere(*quads, RADIUS),
            Kind::Model(loaded, times) => {
                let mut surface = loaded.surface.clone();
                for _ in 0..*times {
                    surface = subdivide(&surface)?;
                }
                surface
            }
        };
        surface.sort_by_position();
        Ok(surface)
    }

    /// Builds a body of the table's material that spins and is squeezed.
    ///
    /// # Errors
    /// The error of `new_solver`.
    pub(crate) fn body(
        &self,
        new_solver: impl FnOnce(&mut Surface, &Material) -> Result<Solver, ConstraintError>,
    ) -> Result<(Surface, Solver), Box<dyn Error>> {
        let mut surface = self.surface()?;
        let mut solver = new_solver(&mut surface, &motion::material())?;
        motion::start(&mut solver, &surface)?;
        Ok((surface, solver))
    }
}

/// Returns the workloads that `only` names, or all, of at most `max_triangles`.
///
/// # Errors
/// A message for an unknown name, an unreadable file, or an empty list.
pub(crate) fn workloads(
    folder: Option<&Path>,
    only: &[String],
    max_triangles: usize,
) -> Result<Vec<Workload>, Box<dyn Error>> {
    let mut all = Vec::new();
    for loaded in models::load(folder, &[])? {
        let is_refined = loaded.model == Model::Armadillo;
        let loaded = Rc::new(loaded);
        let name = loaded.model.name();
        let mut triangles = loaded.surface.topology().triangle_count();
        for times in 0.. {
            if triangles > max_triangles || times > 0 && !is_refined {
                break;
            }
            all.push(Workload {
                name: match times {
                    0 => name.to_owned(),
                    _ => format!("{name}{triangles}"),
                },
                family: is_refined.then_some(name),
                source: loaded.source.clone(),
                triangles,
                kind: Kind::Model(Rc::clone(&loaded), times),
            });
            triangles = triangles.saturating_mul(4);
        }
    }
    all.extend(SPHERES.into_iter().map(|quads| {
        let triangles = 12 * quads as usize * quads as usize;
        Workload {
            name: format!("Sphere{triangles}"),
            family: Some("Sphere"),
            source: models::BUILT_IN.to_owned(),
            triangles,
            kind: Kind::Sphere(quads),
        }
    }));
    let is = |workload: &Workload, name: &String| workload.name.eq_ignore_ascii_case(name.trim());
    if let Some(name) = (only.iter()).find(|name| !all.iter().any(|w| is(w, name))) {
        let names: Vec<&str> = all.iter().map(|w| w.name.as_str()).collect();
        let names = names.join(", ");
        return Err(format!("'{name}' is none of {names}, or above --max-triangles").into());
    }
    all.retain(|w| {
        w.triangles <= max_triangles && (only.is_empty() || only.iter().any(|name| is(w, name)))
    });
    if all.is_empty() {
        return Err("no model is that small: raise --max-triangles".into());
    }
    let models = all.iter().filter(|w| matches!(w.kind, Kind::Model(..)));
    models::warn_built_in(folder, models.map(|w| (w.name.as_str(), w.source.as_str())));
    Ok(all)
}

/// Splits every triangle into four at the midpoints of its edges.
fn subdivide(surface: &Surface) -> Result<Surface, TopologyError> {
    let topology = surface.topology();
    let mut positions: Vec<[f32; 3]> = (surface.positions().iter())
        .map(|p| [p[0], p[1], p[2]])
        .collect();
    let mut middles = vec![u32::MAX; 3 * topology.triangle_slots()];
    let mut triangles = Vec::with_capacity(4 * topology.triangle_count());
    for t in topology.triangles() {
        let middle = t.half_edges().map(|h: HalfEdge| {
            let twin = topology.twin(h);
            if !twin.is_null() && middles[twin.index()] != u32::MAX {
                return middles[twin.index()];
            }
            let [a, b] = [topology.origin(h), topology.target(h)].map(|v| positions[v.index()]);
            let v = u32::try_from(positions.len()).unwrap_or(u32::MAX);
            positions.push([0, 1, 2].map(|k| f32::midpoint(a[k], b[k])));
            middles[h.index()] = v;
            v
        });
        let corner = topology.triangle(t).map(|v| v.0);
        triangles.extend([0, 1, 2].map(|k| [corner[k], middle[k], middle[(k + 2) % 3]]));
        triangles.push(middle);
    }
    Surface::from_triangles(&positions, &triangles)
}

#[cfg(test)]
mod tests {
    use super::*;
    use incise_models::build_model;

    #[test]
    fn workloads_are_found_by_name_and_size() {
        let names = |only: &[&str], most| -> Vec<String> {
            let only: Vec<String> = only.iter().map(|&s| s.to_owned()).collect();
            let all = workloads(None, &only, most).unwrap();
            all.into_iter().map(|w| w.name).collect()
        };
        assert_eq!(
            names(&["sphere3072", "SPHERE20"], 5000),
            ["Sphere20", "Sphere3072"]
        );
        let armadillos = ["Armadillo", "Armadillo120000"];
        assert_eq!(names(&armadillos, 1_400_000), armadillos);
        assert!(workloads(None, &["cow".to_owned()], 5000).is_err());
        assert!(workloads(None, &[], 10).is_err(), "nothing is left");
        let sphere = workloads(None, &["Sphere3072".to_owned()], 5000).unwrap();
        let (surface, _) = sphere[0].body(Solver::new).unwrap();
        assert_eq!(surface.topology().triangle_count(), 3072);
    }

    #[test]
    fn subdivision_keeps_the_volume() {
        let coarse = build_model(Model::Sphere80);
        let fine = subdivide(&coarse).unwrap();
        assert_eq!(fine.topology().triangle_count(), 320);
        assert!(fine.topology().is_closed(), "halves of edges meet");
        let volume = |s: &Surface| s.piece_volumes()[0];
        assert!((volume(&fine) / volume(&coarse) - 1.0).abs() < 1e-6);
    }
}
