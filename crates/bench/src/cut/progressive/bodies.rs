//! Bodies of the progressive bench: models, spheres and tori.

use crate::models;
use incise_mesh::{Surface, cube_sphere, icosphere, torus};
use incise_models::Model;
use std::error::Error;
use std::path::Path;

/// Bodies of the default run, of 30,000 triangles each.
const TIMED: [&str; 3] = ["Armadillo", "Sphere30000", "Torus30000"];

/// A body by its name.
pub(super) struct NewBody {
    pub(super) name: String,
    pub(super) source: String,
    pub(super) surface: Surface,
}

/// The name of a shape and its formula.
type Shape = (&'static str, fn() -> Surface);

/// Shapes by formula, beside the seven models.
const SHAPES: [Shape; 3] = [
    ("Sphere30000", || cube_sphere(50, 0.5)),
    ("Torus30000", || torus(0.35, 0.15, 150, 100)),
    ("Icosphere1280", || icosphere(3, 0.5)),
];

/// Returns the bodies that `only` names: by default those of 30,000 triangles, in a long run all.
///
/// # Errors
/// A message for an unknown name or an unreadable file.
pub(super) fn load(
    folder: Option<&Path>,
    only: &[String],
    is_long: bool,
) -> Result<Vec<NewBody>, Box<dyn Error>> {
    let names = || {
        let models = Model::ALL.iter().map(|model| model.name());
        models.chain(SHAPES.iter().map(|shape| shape.0))
    };
    let is = |name: &str, other: &str| name.eq_ignore_ascii_case(other.trim());
    if let Some(unknown) = only.iter().find(|&o| !names().any(|name| is(name, o))) {
        let names: Vec<&str> = names().collect();
        return Err(format!("'{unknown}' is none of {}", names.join(", ")).into());
    }
    let is_wanted = |name: &str| match only {
        [] => is_long || TIMED.contains(&name),
        only => only.iter().any(|o| is(name, o)),
    };
    let wanted: Vec<String> = (Model::ALL.iter().map(|model| model.name()))
        .filter(|name| is_wanted(name))
        .map(str::to_owned)
        .collect();
    let mut bodies = Vec::new();
    if !wanted.is_empty() {
        bodies.extend(
            models::load(folder, &wanted)?
                .into_iter()
                .map(|loaded| NewBody {
                    name: loaded.model.name().to_owned(),
                    source: loaded.source,
                    surface: loaded.surface,
                }),
        );
    }
    let used = bodies.iter().map(|b| (b.name.as_str(), b.source.as_str()));
    models::warn_built_in(folder, used);
    let shapes = SHAPES.iter().filter(|shape| is_wanted(shape.0));
    bodies.extend(shapes.map(|(name, build)| NewBody {
        name: (*name).to_owned(),
        source: models::BUILT_IN.to_owned(),
        surface: build(),
    }));
    Ok(bodies)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn timed_bodies_have_30_000_triangles_and_long_runs_have_ten() {
        let timed = load(None, &[], false).unwrap();
        assert_eq!(timed.len(), 3);
        for body in &timed {
            let count = body.surface.topology().triangle_count();
            assert_eq!(count, 30_000, "{}", body.name);
        }
        assert_eq!(load(None, &[], true).unwrap().len(), 10);
        let named = load(None, &["sphere20".to_owned()], false).unwrap();
        assert_eq!(named[0].surface.topology().triangle_count(), 20);
        assert!(load(None, &["cow".to_owned()], false).is_err());
    }
}
