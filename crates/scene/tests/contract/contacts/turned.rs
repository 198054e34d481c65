//! Scenes on a plane behave as the same scenes turned, with gravity and plane.

use super::*;

/// A turn about the z axis and about the x axis.
#[derive(Debug, Clone, Copy)]
pub(super) struct Turn {
    sin: f32,
    cos: f32,
}

impl Turn {
    pub(super) fn new(degrees: f32) -> Self {
        let (sin, cos) = degrees.to_radians().sin_cos();
        Self { sin, cos }
    }

    pub(super) fn of(self, [x, y, z]: [f32; 3]) -> [f32; 3] {
        let Self { sin, cos } = self;
        let [x, y] = [cos * x + sin * y, cos * y - sin * x];
        [x, cos * y + sin * z, cos * z - sin * y]
    }

    /// Returns a vector before the turn.
    pub(super) fn back(self, [x, y, z]: [f32; 3]) -> [f32; 3] {
        let Self { sin, cos } = self;
        let [y, z] = [cos * y - sin * z, cos * z + sin * y];
        [cos * x - sin * y, cos * y + sin * x, z]
    }

    /// Returns the ground at height 0.
    pub(super) fn ground(self) -> Collider {
        Collider::Plane {
            point: [0.0; 3],
            normal: self.of([0.0, 1.0, 0.0]),
        }
    }
}

/// Drops a block of 0.5 m by 5 cm onto a plane; returns its vertices before the turn.
fn dropped(turn: Turn, material: &Material, frames: u16) -> Vec<[f32; 3]> {
    let mut scene = Scene::new(params(turn.of([0.0, -9.81, 0.0])));
    scene.colliders.push(turn.ground());
    let mut block = merged(&[moved(&cube(4), [0.0, 0.3, 0.0], [0.25; 3])]);
    for i in 0..block.positions().len() {
        let [x, y, z] = turn.of(block.rest_positions()[i]);
        block.rest_positions_mut()[i] = [x, y, z];
        block.positions_mut()[i][..3].copy_from_slice(&[x, y, z]);
    }
    let id = scene.add_body(block, material).unwrap();
    for _ in 0..frames {
        scene.step().unwrap();
    }
    let positions = scene.body(id).unwrap().surface().positions().iter();
    positions.map(|p| turn.back([p[0], p[1], p[2]])).collect()
}

/// Largest difference of a coordinate after `frames` of 12 substeps.
///
/// A substep rounds a displacement, and so a velocity, by a unit in the last place of a meter.
/// These errors add up like a random walk, to `n^1.5` units of positions after `n` substeps.
fn rounding(frames: u16) -> f32 {
    f32::from(12 * frames).powf(1.5) * f32::EPSILON
}

#[test]
fn a_block_falls_and_lands_alike_on_every_plane() {
    let materials = [
        sprung(),
        Material {
            volume: Some(Volume::default()),
            friction: 0.0,
            ..with_springs()
        },
        Material::shell(),
    ];
    for material in &materials {
        // It touches the plane in frame 6.
        for frames in [1, 12] {
            let level = dropped(Turn::new(0.0), material, frames);
            for degrees in [20.0, 90.0, 180.0, 200.0] {
                let turned = dropped(Turn::new(degrees), material, frames);
                let pairs = level.iter().flatten().zip(turned.iter().flatten());
                let off = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
                assert!(
                    off < rounding(frames),
                    "{off} m after {frames} frames, {degrees} degrees, {material:?}"
                );
            }
        }
    }
}

/// Heights of the vertices of a block at rest do not depend on the slope under gravity along the
/// normal, and none is below the plane beyond rounding.
#[test]
fn a_block_rests_alike_on_every_plane() {
    let sorted = |turn: Turn| {
        let positions = dropped(turn, &sprung(), 180);
        let mut heights: Vec<f32> = positions.iter().map(|p| p[1]).collect();
        heights.sort_by(f32::total_cmp);
        heights
    };
    let level = sorted(Turn::new(0.0));
    for degrees in [20.0, 90.0, 200.0] {
        let turned = sorted(Turn::new(degrees));
        // Of positions within 1 m, which `back` rounds again.
        assert!(turned[0] > -4.0 * f32::EPSILON, "{} m deep", -turned[0]);
        let pairs = level.iter().zip(&turned);
        let off = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        assert!(off < 1e-5, "{off} m, {degrees} degrees");
    }
}
