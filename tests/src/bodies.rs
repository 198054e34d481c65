//! Random closed bodies.

use incise_mesh::geometry::{Vec3, to_f32, to_f64};
use incise_mesh::{Blend, Channel, Domain, Surface, cube_sphere, icosphere, torus};
use incise_models::{Model, build_model};
use incise_test_support::random::Random;
use proptest::prelude::*;
use std::sync::OnceLock;

/// Shape of a body of size about 1.
#[derive(Debug, Clone, Copy)]
pub enum Shape {
    /// 20 x 4^n triangles.
    Icosphere(u32),
    /// 12 n^2 triangles, valence 3 at eight vertices.
    CubeSphere(u32),
    /// 2 m n triangles and one handle.
    Torus(u32, u32),
    /// One of the built-in models.
    Model(Model),
}

/// Deformation of a body.
#[derive(Debug, Clone, Copy)]
pub enum Deformation {
    /// None: many vertices, edges and triangles are exactly coplanar.
    None,
    /// Stretched along the axes, then bent by contractive waves, which cause no self-intersection.
    Waves {
        /// Factors along the axes.
        stretch: [f64; 3],
        /// Phases of the waves.
        phase: [f64; 3],
    },
    /// Vertices moved at random by at most this fraction of their shortest edge.
    Noise(f64),
    /// Vertices moved at random by at most this \[m\], which causes self-intersections.
    SelfIntersecting(f64),
}

/// Description of a closed body, from which a failing one can be rebuilt.
#[derive(Debug, Clone, Copy)]
pub struct Body {
    /// The undeformed shape.
    pub shape: Shape,
    /// The deformation.
    pub deformation: Deformation,
    /// Rounds coordinates to multiples of 2^-n, so that planes through vertices are exact and
    /// vertices may coincide.
    pub lattice: Option<u32>,
    /// Seed of the noise, of the order of vertices and triangles, and of first corners.
    pub seed: u64,
}

/// Permutes items at random.
fn shuffle<T>(random: &mut Random, items: &mut [T]) {
    for i in (1..items.len()).rev() {
        items.swap(i, random.below(i + 1));
    }
}

impl Shape {
    fn build(self) -> Surface {
        static MODELS: [OnceLock<Surface>; 7] = [const { OnceLock::new() }; 7];
        match self {
            Self::Icosphere(n) => icosphere(n, 0.5),
            Self::CubeSphere(n) => cube_sphere(n, 0.5),
            Self::Torus(m, n) => torus(0.4, 0.15, m, n),
            Self::Model(model) => MODELS[model as usize]
                .get_or_init(|| build_model(model))
                .clone(),
        }
    }
}

impl Body {
    /// The body as a surface at rest. Attributes and channels are made up, so that their way
    /// through a cut is tested too.
    #[must_use]
    pub fn build(&self) -> Surface {
        let base = self.shape.build();
        let topology = base.topology();
        let mut random = Random::new(self.seed);
        let mut points: Vec<Vec3> = (base.rest_positions().iter().map(|&p| to_f64(p))).collect();
        match self.deformation {
            Deformation::None => {}
            Deformation::Waves { stretch, phase } => {
                for p in &mut points {
                    *p = p.component_mul(&Vec3::from(stretch));
                    // Lipschitz constant below 0.12 x 5 = 0.6.
                    let wave = |k: usize| 0.12 * (5.0 * p[(k + 1) % 3] + phase[k]).sin();
                    *p += Vec3::new(wave(0), wave(1), wave(2));
                }
            }
            Deformation::Noise(part) => {
                let reach: Vec<f64> = (topology.vertices())
                    .map(|v| {
                        let edges = topology.outgoing_fan(v).map(|h| topology.target(h));
                        let lengths = edges.map(|w| (points[w.index()] - points[v.index()]).norm());
                        part * lengths.fold(f64::INFINITY, f64::min)
                    })
                    .collect();
                for (p, reach) in points.iter_mut().zip(reach) {
                    *p += random_vector(&mut random) * reach;
                }
            }
            Deformation::SelfIntersecting(reach) => {
                for p in &mut points {
                    *p += random_vector(&mut random) * reach;
                }
            }
        }
        if let Some(bits) = self.lattice {
            let cells = f64::from(1 << bits);
            for p in &mut points {
                *p = p.map(|x| (x * cells).round() / cells);
            }
        }
        let mut order: Vec<usize> = (0..points.len()).collect();
        let mut faces: Vec<[u32; 3]> = (topology.triangles())
            .map(|t| topology.triangle(t).map(|v| v.0))
            .collect();
        if self.seed != 0 {
            shuffle(&mut random, &mut order);
            shuffle(&mut random, &mut faces);
            for face in &mut faces {
                face.rotate_left(usize::from(random.bits().is_multiple_of(2)));
            }
        }
        let mut number = vec![0; points.len()];
        for (new, &old) in (0..).zip(&order) {
            number[old] = new;
        }
        let positions: Vec<[f32; 3]> = order.iter().map(|&old| to_f32(points[old])).collect();
        let faces: Vec<[u32; 3]> = (faces.iter())
            .map(|face| face.map(|v| number[v as usize]))
            .collect();
        let mut surface =
            Surface::from_triangles(&positions, &faces).expect("its shape is a manifold");
        let uvs = surface.topology().corners().iter().map(|v| {
            let [x, y, z] = positions[v.index()];
            [x + 0.5 * z, y]
        });
        let uvs = uvs.collect();
        surface.set_corner_uvs(uvs).expect("one value a corner");
        set_channels(&mut surface, &positions);
        surface
    }

    /// Whether its triangles are small against it, so that cutting whole triangles moves little
    /// volume.
    #[must_use]
    pub fn is_fine(&self) -> bool {
        match self.shape {
            Shape::Icosphere(n) => n >= 3,
            Shape::CubeSphere(n) => n >= 8,
            Shape::Torus(m, n) => m >= 24 && n >= 12,
            Shape::Model(model) => model.triangles() >= 700,
        }
    }
}

/// Sets colors and skin weights of vertices, and second texture coordinates of corners.
///
/// All of them vary from vertex to vertex, and a fifth joint appears along x.
fn set_channels(surface: &mut Surface, positions: &[[f32; 3]]) {
    let color = |&[x, y, z]: &[f32; 3]| [x, y, z].map(|x| x.sin().abs());
    let skin = |&[x, y, z]: &[f32; 3]| {
        let weights = [1.0 + x * x, 0.5 + y * y, 0.25 + z * z, 0.125];
        let sum: f32 = weights.iter().sum();
        let fifth = if x > 0.0 { 4.0 } else { 0.0 };
        let joints = [1.0, 2.0, 3.0, fifth];
        [joints, weights.map(|w| w / sum)].concat()
    };
    let topology = surface.topology();
    let corners = topology.corners().iter().map(|v| positions[v.index()]);
    let uv = corners
        .flat_map(|[x, y, z]| [x - z, y + 0.25 * z])
        .collect();
    let colors = positions.iter().flat_map(color).collect();
    let skin = positions.iter().flat_map(skin).collect();
    for channel in [
        Channel::new("color", Domain::Vertex, Blend::Linear, 3, colors),
        Channel::new("skin", Domain::Vertex, Blend::Skin, 8, skin),
        Channel::new("uv1", Domain::Corner, Blend::Linear, 2, uv),
    ] {
        let channel = channel.expect("a width that is allowed");
        surface.set_channel(channel).expect("one row a slot");
    }
}

/// A ball in a ball in a ball, the middle one hollow; each of 20 x 4^n triangles.
///
/// # Panics
/// Never for an n that memory has room for.
#[must_use]
pub fn shells(n: u32) -> Surface {
    let (mut positions, mut faces) = (Vec::new(), Vec::new());
    for (radius, is_cavity) in [(0.5, false), (0.35, true), (0.2, false)] {
        let shell = icosphere(n, radius);
        let first = u32::try_from(positions.len()).expect("ids have 32 bits");
        positions.extend(shell.rest_positions());
        let topology = shell.topology();
        faces.extend(topology.triangles().map(|t| {
            let [a, b, c] = topology.triangle(t).map(|v| v.0 + first);
            if is_cavity { [a, c, b] } else { [a, b, c] }
        }));
    }
    Surface::from_triangles(&positions, &faces).expect("three shells")
}

fn random_vector(random: &mut Random) -> Vec3 {
    loop {
        let v = Vec3::new(random.signed(), random.signed(), random.signed());
        if v.norm_squared() <= 1.0 {
            return v;
        }
    }
}

fn small_shape() -> impl Strategy<Value = Shape> {
    prop_oneof![
        (0..=3_u32).prop_map(Shape::Icosphere),
        (1..=8_u32).prop_map(Shape::CubeSphere),
        (3..=24_u32, 3..=12_u32).prop_map(|(m, n)| Shape::Torus(m, n)),
    ]
}

fn large_shape() -> impl Strategy<Value = Shape> {
    prop_oneof![
        Just(Shape::Icosphere(4)),
        (9..=14_u32).prop_map(Shape::CubeSphere),
        (24..=48_u32, 12..=24_u32).prop_map(|(m, n)| Shape::Torus(m, n)),
        Just(Shape::Model(Model::Bunny)),
        Just(Shape::Model(Model::Octopus)),
    ]
}

fn tame() -> impl Strategy<Value = Deformation> {
    let stretch = prop::array::uniform3(0.6..1.6_f64);
    let phase = prop::array::uniform3(0.0..6.3_f64);
    prop_oneof![
        1 => Just(Deformation::None),
        2 => (stretch, phase).prop_map(|(stretch, phase)| Deformation::Waves { stretch, phase }),
        2 => (0.0..0.3_f64).prop_map(Deformation::Noise),
    ]
}

fn body(
    shape: impl Strategy<Value = Shape>,
    deformation: impl Strategy<Value = Deformation>,
) -> impl Strategy<Value = Body> {
    let lattice = prop_oneof![3 => Just(None), 1 => (4..=12_u32).prop_map(Some)];
    let seed = prop_oneof![Just(0), 1..10_000_u64];
    (shape, deformation, lattice, seed).prop_map(|(shape, deformation, lattice, seed)| Body {
        shape,
        deformation,
        lattice,
        seed,
    })
}

/// Bodies of 6 to 1,300 triangles that do not pass through themselves (but for a coarse lattice).
pub fn small_body() -> impl Strategy<Value = Body> {
    body(small_shape(), tame())
}

/// Bodies of 1,000 to 5,120 triangles that do not pass through themselves.
pub fn large_body() -> impl Strategy<Value = Body> {
    body(large_shape(), tame())
}

/// Small bodies mostly, some large.
pub fn any_body() -> impl Strategy<Value = Body> {
    prop_oneof![4 => small_body().boxed(), 1 => large_body().boxed()]
}

/// Bodies that pass through themselves everywhere.
pub fn self_intersecting_body() -> impl Strategy<Value = Body> {
    let reach = prop_oneof![0.02..0.2_f64, 0.2..1.5_f64];
    body(small_shape(), reach.prop_map(Deformation::SelfIntersecting))
}
