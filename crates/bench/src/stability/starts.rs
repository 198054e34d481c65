//! Bodies that start crushed, inside out or folded.

use super::audit::{Rule, angle, energy_over, keeping};
use super::case::{Case, Worst, told};
use super::failure::Failure;
use super::scenes::{FRAME, GROUND, WEIGHTLESS, ball, elastic_shell, pose};
use super::stage::Stage;
use crate::directions::Directions;
use incise_mesh::{Surface, Vec3, VertexId};
use incise_pbd_gpu::{Material, Stiffness};
use std::f64::consts::PI;

pub(super) const CASES: [Case; 4] = [
    Case {
        id: "T5",
        torture: "elastic ball in a point, on a line, on a plane, at random in its box, inside out",
        law: "energy of what there was",
        bound: 1.01,
        run: energy_of_crushed,
    },
    Case {
        id: "T5",
        torture: "ball that does not stretch, on a plane, at random in its box, inside out",
        law: "mean strain after 10 s",
        bound: 0.05,
        run: strain_of_crushed,
    },
    Case {
        id: "T6",
        torture: "ball with one vertex pushed through the other side",
        law: "mean strain after 10 s",
        bound: 0.05,
        run: flipped,
    },
    Case {
        id: "T6",
        torture: "hinge of 0, 90, 179.9, -179.9 degrees, folded by 180 degrees +-1e-7",
        law: "angle off rest after 2 s [rad]",
        bound: 0.02,
        run: folded,
    },
];

/// The middle of the ball.
const CENTER: Vec3 = Vec3::new(0.0, 0.6, 0.0);
/// All ways of crushing.
const WAYS: [&str; 5] = ["point", "line", "plane", "random", "inside out"];

/// The ball, crushed.
fn crushed(way: &str, subdivisions: u32) -> Surface {
    let mut surface = ball(subdivisions, CENTER.y);
    let mut directions = Directions(5);
    let mut randoms = Vec::new();
    randoms.resize_with(surface.positions.len(), || {
        Vec3::from_fn(|_, _| directions.next()) * 0.5
    });
    let mut next = randoms.into_iter();
    let to = |p: Vec3, random: Vec3| match way {
        "point" => CENTER,
        "line" => Vec3::new(p.x, CENTER.y, 0.0),
        "plane" => Vec3::new(p.x, CENTER.y, p.z),
        "random" => CENTER + random,
        _ => CENTER * 2.0 - p,
    };
    for i in 0..surface.positions.len() {
        let p = surface.position(VertexId::from_index(i));
        let random = next.next().unwrap_or_default();
        let [x, y, z] = incise_mesh::geometry::round(to(p, random));
        surface.positions[i] = [x, y, z, surface.positions[i][3]];
    }
    surface
}

fn energy_of_crushed(stage: &mut Stage) -> Result<Worst, Failure> {
    let mut worst = Worst::default();
    let frames = stage.pick(60, 600);
    for way in WAYS {
        for stretch in [1e-3, 1e-5, 1e-7] {
            let material = elastic_shell(stretch, 1e3 * stretch);
            let mut mover = stage.enter(crushed(way, 2), &material)?;
            let found = energy_over(&mut mover, FRAME, &GROUND, frames, Rule::above(0.0));
            worst.judge(found, || format!("{way}, {stretch:e} m/N"));
        }
    }
    Ok(worst)
}

fn strain_of_crushed(stage: &mut Stage) -> Result<Worst, Failure> {
    let mut worst = Worst::default();
    let subdivisions = stage.pick(1, 2);
    // Out of a point and a line no force points, and out of a plane none but that of bending.
    for way in &WAYS[2..] {
        for bending in [None, Some(0.2), Some(1.0)] {
            if *way == "plane" && bending.is_none() {
                continue;
            }
            let material = Material {
                bending: bending.map(Stiffness::Pbd),
                ..Material::default()
            };
            let mut mover = stage.enter(crushed(way, subdivisions), &material)?;
            let found = mover.advance(FRAME, &GROUND, 600);
            let found = found.map(|()| mover.strain());
            worst.judge(found, || {
                format!(
                    "{way}, {}",
                    bending.map_or("no bending".to_owned(), |k| format!("bending {k}"))
                )
            });
        }
    }
    Ok(worst)
}

fn flipped(stage: &mut Stage) -> Result<Worst, Failure> {
    let mut worst = Worst::default();
    for vertex in (0..42).step_by(stage.pick(21, 3)) {
        let mut surface = ball(1, CENTER.y);
        let through = CENTER * 2.0 - surface.position(VertexId(vertex));
        let old = surface.position(VertexId(vertex));
        pose(&mut surface, |p| if p == old { through } else { p });
        for material in [Material::default(), elastic_shell(1e-6, 1e-3)] {
            let mut mover = stage.enter(surface.clone(), &material)?;
            let found = match material.stretch {
                // Nobody knows the energy of constraints without compliance.
                Stiffness::Pbd(_) => (mover.advance(FRAME, &GROUND, 600)).map(|()| 0.0.into()),
                Stiffness::Compliance(_) => {
                    keeping(&mut mover, FRAME, &GROUND, 600, Rule::above(0.0))
                }
            };
            let found = found.map(|found| found.by(mover.strain()));
            worst.judge(found, || {
                format!("vertex {vertex}, {}", told(material.stretch))
            });
        }
    }
    Ok(worst)
}

/// Two triangles with that angle at their edge at rest \[rad\].
fn hinge(rest: f64) -> Result<Surface, Failure> {
    let (sin, cos) = rest.sin_cos();
    let points = [[0.0; 3], [1.0, 0.0, 0.0], [0.5, 0.9, 0.0]];
    let [x, y, z] = incise_mesh::geometry::round(wing(sin, cos));
    let points = [points[0], points[1], points[2], [x, y, z]];
    Ok(Surface::from_triangles(&points, &[[0, 1, 2], [1, 0, 3]])?)
}

/// Where the second wing's tip is.
fn wing(sin: f64, cos: f64) -> Vec3 {
    Vec3::new(0.5, -0.9 * cos, -0.9 * sin)
}

fn folded(stage: &mut Stage) -> Result<Worst, Failure> {
    let mut worst = Worst::default();
    let rests = [0.0, 90.0, 179.9, -179.9_f64].map(f64::to_radians);
    let starts = [0.0, 0.5, PI - 1e-7, PI + 1e-7, PI, -0.5];
    for rest in rests {
        for start in starts {
            for stiffness in [Stiffness::Pbd(1.0), Stiffness::Compliance(0.0)] {
                let material = Material {
                    bending: Some(stiffness),
                    ..Material::default()
                };
                let mut surface = hinge(rest)?;
                let [x, y, z] = incise_mesh::geometry::round(wing(start.sin(), start.cos()));
                surface.positions[3] = [x, y, z, surface.positions[3][3]];
                let mut mover = stage.enter(surface, &material)?;
                let vertices = [0, 1, 2, 3].map(VertexId);
                // The angle of the rest shape as constraints measure it.
                let wanted = angle(&hinge(rest)?, vertices);
                let found = mover.advance(FRAME, &WEIGHTLESS, 120).map(|()| {
                    let off = angle(&mover.surface, vertices) - wanted;
                    (off - (off / (2.0 * PI)).round() * 2.0 * PI).abs()
                });
                worst.judge(found, || {
                    format!("rest {rest:.3}, from {start:.3} rad, {}", told(stiffness))
                });
            }
        }
    }
    Ok(worst)
}
