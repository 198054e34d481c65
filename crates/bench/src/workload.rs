//! Workloads of the benches `cut`, `refine`, `solver` and `step`: models, finer armadillos and
//! shapes by formula.

use crate::models::{self, Loaded};
use crate::motion;
use crate::options::ModelArguments;
use incise_mesh::{HalfEdge, Surface, TopologyError, cube_sphere, icosphere, torus};
use incise_models::Model;
use incise_pbd_gpu::{ConstraintError, Material, Solver};
use std::error::Error;
use std::rc::Rc;

/// Squares along an edge of the cubes that spheres are projected from: subdivisions of Sphere768
/// up to 196,608 triangles, and one of 1.3 million.
const SPHERES: [u32; 5] = [16, 32, 64, 128, 330];
/// Radius of the spheres \[m\], that of the models.
const RADIUS: f64 = 0.5;
/// Bodies of progressive cuts by default, of 30,000 triangles each.
const PROGRESSIVE: [&str; 3] = ["Armadillo", "Sphere30000", "Torus30000"];

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
    /// A shape in the order of its formula.
    Shape(fn() -> Surface),
}

impl Workload {
    /// Builds the surface.
    ///
    /// # Errors
    /// None: every workload is a surface.
    pub(crate) fn surface(&self) -> Result<Surface, TopologyError> {
        let mut surface = match &self.kind {
            Kind::Shape(build) => return Ok(build()),
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

    /// Returns the subdivisions of a model up to a number of triangles; without `is_refined` the
    /// model alone.
    fn of_model(loaded: Loaded, is_refined: bool, max_triangles: usize) -> Vec<Self> {
        let name = loaded.model.name();
        let count = loaded.surface.topology().triangle_count();
        let loaded = Rc::new(loaded);
        let sizes = (0..).map(|times| (times, count.saturating_mul(4_usize.saturating_pow(times))));
        let sizes = sizes.take_while(|&(times, triangles)| {
            triangles <= max_triangles && (times == 0 || is_refined)
        });
        let workload = |(times, triangles)| Self {
            name: match times {
                0 => name.to_owned(),
                _ => format!("{name}{triangles}"),
            },
            family: is_refined.then_some(name),
            source: loaded.source.clone(),
            triangles,
            kind: Kind::Model(Rc::clone(&loaded), times),
        };
        sizes.map(workload).collect()
    }

    fn by_formula(
        name: String,
        family: Option<&'static str>,
        triangles: usize,
        kind: Kind,
    ) -> Self {
        Self {
            name,
            family,
            source: models::BUILT_IN.to_owned(),
            triangles,
            kind,
        }
    }
}

/// Returns the named workloads, or all, of at most `max_triangles`.
///
/// # Errors
/// A message for an unknown name, an unreadable file, or an empty list.
pub(crate) fn workloads(
    arguments: &ModelArguments,
    max_triangles: usize,
) -> Result<Vec<Workload>, Box<dyn Error>> {
    let mut all = Vec::new();
    for model in Model::ALL {
        let loaded = models::load_model(arguments.models.as_deref(), model)?;
        let is_refined = model == Model::Armadillo;
        all.extend(Workload::of_model(loaded, is_refined, max_triangles));
    }
    all.extend(SPHERES.into_iter().map(|quads| {
        let triangles = 12 * quads as usize * quads as usize;
        let name = format!("Sphere{triangles}");
        Workload::by_formula(name, Some("Sphere"), triangles, Kind::Sphere(quads))
    }));
    all.retain(|workload| workload.triangles <= max_triangles);
    let named = models::named(all, |workload| workload.name.clone(), &arguments.only);
    let all = named.map_err(|error| format!("{error}, or above --max-triangles"))?;
    match all.is_empty() {
        true => Err("no model is that small: raise --max-triangles".into()),
        false => Ok(all),
    }
}

/// Returns the named bodies of progressive cuts: by default those of 30,000 triangles, in a long
/// run all.
///
/// # Errors
/// A message for an unknown name or an unreadable file.
pub(crate) fn progressive_workloads(
    arguments: &ModelArguments,
    is_long: bool,
) -> Result<Vec<Workload>, Box<dyn Error>> {
    let mut all = Vec::new();
    for model in Model::ALL {
        let loaded = models::load_model(arguments.models.as_deref(), model)?;
        all.extend(Workload::of_model(loaded, false, usize::MAX));
    }
    type Shape = (&'static str, usize, fn() -> Surface);
    let shapes: [Shape; 3] = [
        ("Sphere30000", 30_000, || cube_sphere(50, RADIUS)),
        ("Torus30000", 30_000, || torus(0.35, 0.15, 150, 100)),
        ("Icosphere1280", 1280, || icosphere(3, RADIUS)),
    ];
    all.extend(shapes.map(|(name, triangles, build)| {
        Workload::by_formula(name.to_owned(), None, triangles, Kind::Shape(build))
    }));
    let mut only = arguments.only.clone();
    if only.is_empty() && !is_long {
        only = PROGRESSIVE.map(str::to_owned).to_vec();
    }
    Ok(models::named(all, |workload| workload.name.clone(), &only)?)
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
    fn subdivision_keeps_the_volume() {
        let coarse = build_model(Model::Sphere80);
        let fine = subdivide(&coarse).unwrap();
        assert_eq!(fine.topology().triangle_count(), 320);
        assert!(fine.topology().is_closed(), "halves of edges meet");
        let volume = |s: &Surface| s.piece_volumes()[0];
        assert!((volume(&fine) / volume(&coarse) - 1.0).abs() < 1e-6);
    }
}
