//! The bodies of the scenes, at random.

use super::super::Found;
use super::super::runner::Runner;
use super::scripts::Kind;
use crate::bodies::{Body, Deformation, Shape};
use incise_mesh::{Surface, Vec3, cuboid, icosphere, torus};
use incise_models::scenes::unit_size;
use incise_test_support::random::Random;
use incise_test_support::surfaces::at_rest;
use nalgebra::Rotation3;

/// Most triangles of a model that is taken.
const MOST_TRIANGLES: usize = 10_000;

/// Returns the bodies of a scene with the places of their lowest points \[m\].
pub(super) fn bodies(
    runner: &Runner,
    kind: Kind,
    random: &mut Random,
) -> Found<Vec<(Surface, Vec3)>> {
    let height = |random: &mut Random| Vec3::new(0.0, random.between(0.1, 0.5), 0.0);
    Ok(match kind {
        Kind::Slices => vec![(
            cuboid([0.5, 0.4, 0.4], [10, 8, 8]),
            Vec3::new(0.0, 1e-3, 0.0),
        )],
        Kind::Plates => (0..3)
            .map(|i| {
                let thickness = random.between(0.05, 0.15);
                let plate = cuboid([0.5, thickness / 2.0, 0.5], [10, 2, 10]);
                (
                    turned(plate, random, [0.0, 1.0, 0.0]),
                    Vec3::new(0.0, 0.05 + 0.3 * f64::from(i), 0.0),
                )
            })
            .collect(),
        Kind::Pile => {
            let mut pile = Vec::new();
            for i in 0..4 {
                let at = Vec3::new(
                    0.2 * random.signed(),
                    0.1 + 1.1 * f64::from(i),
                    0.2 * random.signed(),
                );
                pile.push((any_body(runner, random)?, at));
            }
            pile
        }
        Kind::PinnedScalpel | Kind::HangingScalpel => {
            vec![(any_body(runner, random)?, Vec3::zeros())]
        }
        _ => {
            let body = any_body(runner, random)?;
            vec![(body, height(random))]
        }
    })
}

/// Returns a random body of about a meter, turned at random.
fn any_body(runner: &Runner, random: &mut Random) -> Found<Surface> {
    let models: Vec<&Surface> = runner
        .closed_subjects(MOST_TRIANGLES)
        .map(|subject| &subject.surface)
        .collect();
    let surface = match random.below(models.len() + 4) {
        0 => icosphere(3, 0.5),
        1 => torus(0.35, 0.15, 32, 16),
        2 => cuboid([0.5, 0.1, 0.15], [20, 4, 6]),
        3 => wavy(random),
        i => models[i - 4].clone(),
    };
    let surface = unit_size(surface).ok_or("a body without an extent")?;
    Ok(turned(surface, random, [1.0; 3]))
}

/// Returns a ball that is bent by waves.
fn wavy(random: &mut Random) -> Surface {
    let body = Body {
        shape: Shape::Icosphere(4),
        deformation: Deformation::Waves {
            stretch: [1.0; 3],
            phase: [(); 3].map(|()| 3.0 * random.signed()),
        },
        lattice: None,
        seed: 0,
    };
    body.build()
}

/// Turns a body by a random vector, times factors by axis.
fn turned(surface: Surface, random: &mut Random, factors: [f64; 3]) -> Surface {
    let turn = Vec3::from_fn(|k, _| 3.0 * factors[k] * random.signed());
    let turn = Rotation3::new(turn);
    at_rest(surface, |p| turn * p)
}
