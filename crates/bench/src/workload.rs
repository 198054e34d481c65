//! Workloads of the benches `cut`, `refine`, `solver` and `step`: models, finer armadillos and
//! shapes by formula.

use crate::models::{self, load_model, named};
use crate::options::ModelArguments;
use incise_mesh::{HalfEdge, Surface, TopologyError, cube_sphere, icosphere, torus};
use incise_models::Model;
use std::error::Error;
use std::path::Path;
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
    build: Box<dyn Fn() -> Result<Surface, TopologyError>>,
}

impl Workload {
    /// Builds the surface.
    ///
    /// # Errors
    /// None: every workload is a surface.
    pub(crate) fn surface(&self) -> Result<Surface, TopologyError> {
        (self.build)()
    }

    /// Returns a shape by formula.
    fn shape(name: &str, triangles: usize, build: impl Fn() -> Surface + 'static) -> Self {
        Self {
            name: name.to_owned(),
            family: None,
            source: models::BUILT_IN.to_owned(),
            triangles,
            build: Box::new(move || Ok(build())),
        }
    }

    /// Returns a sphere with a number of squares along an edge of its cube.
    fn sphere(quads: u32) -> Self {
        let triangles = 12 * quads as usize * quads as usize;
        let build = move || {
            let mut surface = cube_sphere(quads, RADIUS);
            surface.sort_by_position();
            surface
        };
        Self {
            family: Some("Sphere"),
            ..Self::shape(&format!("Sphere{triangles}"), triangles, build)
        }
    }

    /// Returns all models, and the subdivisions of `refined`, of at most `max_triangles`.
    fn models(
        folder: Option<&Path>,
        refined: Option<Model>,
        max_triangles: usize,
    ) -> Result<Vec<Self>, Box<dyn Error>> {
        let mut all = Vec::new();
        for model in Model::ALL {
            let loaded = Rc::new(load_model(folder, model)?);
            let is_refined = refined == Some(model);
            let name = model.name();
            let mut triangles = loaded.surface.topology().triangle_count();
            for times in 0.. {
                if triangles > max_triangles || times > 0 && !is_refined {
                    break;
                }
                let source = Rc::clone(&loaded);
                let build = move || {
                    let mut surface = source.surface.clone();
                    for _ in 0..times {
                        surface = subdivide(&surface)?;
                    }
                    surface.sort_by_position();
                    Ok(surface)
                };
                all.push(Self {
                    name: match times {
                        0 => name.to_owned(),
                        _ => format!("{name}{triangles}"),
                    },
                    family: is_refined.then_some(name),
                    source: loaded.source.clone(),
                    triangles,
                    build: Box::new(build),
                });
                triangles = triangles.saturating_mul(4);
            }
        }
        Ok(all)
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
    let folder = arguments.models.as_deref();
    let mut all = Workload::models(folder, Some(Model::Armadillo), max_triangles)?;
    all.extend(SPHERES.map(Workload::sphere));
    all.retain(|workload| workload.triangles <= max_triangles);
    let all = named(all, |workload| &workload.name, &arguments.only)
        .map_err(|error| format!("{error}, or above --max-triangles"))?;
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
    let mut all = Workload::models(arguments.models.as_deref(), None, usize::MAX)?;
    all.extend([
        Workload::shape("Sphere30000", 30_000, || cube_sphere(50, RADIUS)),
        Workload::shape("Torus30000", 30_000, || torus(0.35, 0.15, 150, 100)),
        Workload::shape("Icosphere1280", 1280, || icosphere(3, RADIUS)),
    ]);
    let mut only = arguments.only.clone();
    if only.is_empty() && !is_long {
        only = PROGRESSIVE.map(str::to_owned).to_vec();
    }
    Ok(named(all, |workload| &workload.name, &only)?)
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
