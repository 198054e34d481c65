//! Undisturbed bodies: no mesh, material or time step may add energy.
//!
//! Every mesh is at rest, spins, hangs from its highest vertex and falls onto the ground, with
//! materials, sizes and sequences of frames in rotation.

use super::primitives::{bipyramid, prism, torus, tube};
use super::runner::Runner;
use super::{Case, Found, Outcome, Run, larger};
use incise_cut::{CutParams, Cutter, Sweep};
use incise_mesh::geometry::to_f32;
use incise_mesh::{Surface, Vec3, VertexId, icosphere};
use incise_models::scenes::{FRAME, cuboid, sprung};
use incise_models::{Model, build_model, place, pose};
use incise_pbd_gpu::{Collider, Density, InteriorSprings, Material, Stiffness, Volume};
use incise_scene::{BodyId, Scene, SceneParams};
use incise_test_support::random::Random;

pub(super) const CASES: [Case; 3] = [
    Case {
        id: "still",
        stress: "40 meshes at rest, spinning, hanging and dropped, with 8 materials, 5 sizes, \
             even, alternating and random frames and a hitch",
        invariants: &[
            ("speed at rest in the last quarter [sizes/s]", 1e-3),
            (
                "gained energy, relative to the kinetic or to a fall by the size",
                0.01,
            ),
        ],
        run: |runner| runs(runner, runner.samples.unwrap_or(24)),
    },
    Case {
        id: "primitive",
        stress: "cylinders, a rod, a ball, with every preset of surfaces, at rest, dropped, cut \
                 and dropped",
        invariants: PRIMITIVE,
        run: |runner| primitives(runner, false),
    },
    Case {
        id: "primitive solids",
        stress: "the same with every preset of solids",
        invariants: PRIMITIVE,
        run: |runner| primitives(runner, true),
    },
];

const PRIMITIVE: &[(&str, f64)] = &[
    ("rise above the start [sizes]", 1e-3),
    ("speed after 12 s, or when they fall asleep [sizes/s]", 1e-3),
    ("time until they sleep [s]", 10.0),
];

const GRAVITY: f32 = 9.81;

/// Treatment of a body.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Treatment {
    Rest,
    Spin,
    Hang,
    Drop,
}

/// Sequence of the lengths of frames.
#[derive(Debug, Clone, Copy)]
enum Frames {
    Even,
    Alternating,
    Random,
    /// One frame of a quarter of a second.
    Hitch,
}

impl Frames {
    /// Returns the length of a frame \[s\].
    #[expect(clippy::cast_possible_truncation, reason = "a number of storage")]
    fn length(self, frame: u32, random: &mut Random) -> f32 {
        match self {
            Self::Alternating if frame % 2 == 1 => FRAME / 2.0,
            Self::Random => random.between(1.0 / 240.0, 1.0 / 30.0) as f32,
            Self::Hitch if frame == 20 => 0.25,
            _ => FRAME,
        }
    }
}

/// Materials by name: the presets' kinds, and compliances without and with a volume.
fn materials() -> [(&'static str, Material); 8] {
    let soft = sprung();
    let compliant = |stretch: f32| Material {
        stretch: Stiffness::Compliance(stretch),
        ..soft
    };
    let bare = Material {
        interior_springs: None,
        damping: 0.0,
        ..soft
    };
    [
        ("soft", soft),
        ("shell", Material::shell()),
        ("1e-5 m/N", compliant(1e-5)),
        ("cloth", Material::cloth()),
        (
            "1e-3 m/N, 1e-2 rad/(N m)",
            Material {
                stretch: Stiffness::Compliance(1e-3),
                bending: Some(Stiffness::Compliance(1e-2)),
                ..bare
            },
        ),
        (
            "1e-7 m/N, 1e-5 rad/(N m)",
            Material {
                stretch: Stiffness::Compliance(1e-7),
                bending: Some(Stiffness::Compliance(1e-5)),
                interior_springs: soft.interior_springs.map(|springs| InteriorSprings {
                    stiffness: Stiffness::Compliance(1e-6),
                    ..springs
                }),
                ..bare
            },
        ),
        (
            "1e-5 m/N alone",
            Material {
                stretch: Stiffness::Compliance(1e-5),
                bending: None,
                volume: None::<Volume>,
                ..bare
            },
        ),
        (
            "heavy",
            Material {
                density: Density::Area(100.0),
                damping: 0.0,
                ..soft
            },
        ),
    ]
}

/// Returns the part of a surface on the side of a plane to which its normal points.
fn cut_off(surface: &Surface, through: Vec3, normal: Vec3) -> Surface {
    let mut surface = surface.clone();
    let normal = normal.normalize();
    let bounds = surface.bounds();
    let sweep = Sweep::from_plane(normal.into(), normal.dot(&through), &bounds);
    let sweep = sweep.expect("a plane");
    let params = CutParams::default();
    let cut = Cutter::new(&surface).cut(&mut surface, &sweep, &params);
    let outcome = cut.expect("a closed mesh can be cut");
    assert!(!outcome.is_miss(), "the plane is within the mesh");
    let height = |piece: &Surface| {
        let vertices = piece.topology().vertices();
        let heights = vertices.map(|v| normal.dot(&piece.position(v)));
        heights.fold(f64::NEG_INFINITY, f64::max)
    };
    let pieces = surface.extract_pieces().map(|(_, piece)| piece);
    let kept = pieces.max_by(|a, b| height(a).total_cmp(&height(b)));
    kept.expect("there are pieces")
}

/// Returns all meshes with their names, centered, with a diagonal of 1 m.
fn meshes() -> Vec<(String, Surface)> {
    let mut all: Vec<(String, Surface)> = Vec::new();
    let mut add = |name: String, surface: Surface| all.push((name, surface));
    for n in [6, 12, 32, 64, 128, 256] {
        add(format!("fans of {n}"), bipyramid(n, 0.5, 0.3));
    }
    for n in [6, 12, 32, 64] {
        add(
            format!("prism of {n}, fans from centers"),
            prism([n, 1], 0.5, 1.0, true),
        );
        add(
            format!("prism of {n}, fans from corners"),
            prism([n, 1], 0.5, 1.0, false),
        );
    }
    for n in [6, 24] {
        add(format!("needle of {n}"), bipyramid(n, 0.01, 1.0));
    }
    add("rod".into(), prism([12, 10], 0.05, 1.0, true));
    add("disc".into(), prism([48, 1], 0.5, 0.01, true));
    for level in 0..3 {
        add(format!("icosphere {level}"), icosphere(level, 0.5));
    }
    add("coarse torus".into(), torus([8, 6], 0.4, 0.15));
    add("torus".into(), torus([16, 10], 0.4, 0.1));
    add("box of 12".into(), cuboid([1.0; 3], [1; 3]));
    add("box".into(), cuboid([1.0; 3], [4; 3]));
    add("plate of 12".into(), cuboid([1.0, 0.01, 1.0], [1; 3]));
    add("plate".into(), cuboid([1.0, 0.01, 1.0], [8, 1, 8]));
    add("bar".into(), cuboid([1.0, 0.125, 0.125], [16, 2, 2]));
    add("tube".into(), tube(16, [0.5, 0.4], 1.0));
    add("ring".into(), tube(48, [0.5, 0.49], 0.2));
    add("rod of 200".into(), prism([200, 1], 0.1, 2.0, false));
    add("rod of 16".into(), prism([16, 1], 0.1, 2.0, false));
    for model in [Model::Sphere80, Model::Sphere768, Model::Bunny] {
        add(model.name().into(), build_model(model));
    }
    let (ball, ring) = (icosphere(2, 0.5), torus([16, 10], 0.4, 0.1));
    let at = Vec3::new;
    let cap = cut_off(&ball, at(0.03, 0.1, 0.0), at(0.1, 1.0, 0.2));
    add("cap of a ball".into(), cap);
    let arc = cut_off(&ring, at(0.01, 0.0, 0.013), at(0.3, 1.0, 0.1));
    add("half of a torus".into(), arc);
    let slab = cut_off(&ball, at(0.0, 0.1, 0.0), at(0.01, 1.0, 0.02));
    add(
        "slab of a ball".into(),
        cut_off(&slab, at(0.0, 0.13, 0.0), at(0.03, -1.0, 0.0)),
    );
    let bunny = build_model(Model::Bunny);
    let vertices = bunny.topology().vertices();
    let positions: Vec<Vec3> = vertices.map(|v| bunny.position(v)).collect();
    let center = positions.iter().sum::<Vec3>() / positions.len() as f64;
    for (name, side) in [("upper", 1.0), ("lower", -1.0)] {
        let normal = at(0.2, 1.0, 0.1) * side;
        add(format!("{name} bunny"), cut_off(&bunny, center, normal));
    }
    all.into_iter()
        .map(|(name, surface)| (name, centered(surface)))
        .collect()
}

/// Moves a surface to the origin and to a diagonal of 1 m.
fn centered(mut surface: Surface) -> Surface {
    let vertices: Vec<VertexId> = surface.topology().vertices().collect();
    let sum: Vec3 = vertices.iter().map(|&v| surface.position(v)).sum();
    let (center, size) = (sum / vertices.len() as f64, surface.bounds().diagonal());
    place(&mut surface, |p| (p - center) / size);
    surface
}

/// A mesh and its treatment.
struct Still<'a> {
    name: String,
    surface: &'a Surface,
    material: Material,
    size: f64,
    treatment: Treatment,
    frames: Frames,
}

fn runs(runner: &Runner, per_mesh: u32) -> Vec<Run> {
    let (meshes, materials) = (meshes(), materials());
    let mut all = Vec::new();
    for (name, surface) in &meshes {
        for i in 0..per_mesh {
            let k = all.len();
            let treatment = [
                Treatment::Rest,
                Treatment::Spin,
                Treatment::Hang,
                Treatment::Drop,
            ][i as usize % 4];
            let size = match treatment {
                Treatment::Rest | Treatment::Spin => [1.0, 0.01, 100.0, 0.1, 10.0][k % 5],
                _ => [1.0, 0.3, 10.0][k % 3],
            };
            let frames = [
                Frames::Even,
                Frames::Alternating,
                Frames::Random,
                Frames::Hitch,
            ][(k / 4 + i as usize) % 4];
            let (of, material) = materials[(k + k / 8) % 8];
            all.push(Still {
                name: format!("{name} of {size} m, {of}, {treatment:?}, {frames:?} frames"),
                surface,
                material,
                size,
                treatment,
                frames,
            });
        }
    }
    runner.each(&all, |still| {
        Run::new(still.name.clone(), still.run(runner))
    })
}

impl Still<'_> {
    fn run(&self, runner: &Runner) -> Found<Outcome> {
        let size = self.size;
        let mut surface = self.surface.clone();
        place(&mut surface, |p| p * size);
        let lowest = surface.bounds().min[1];
        let mut random = Random::new(7);
        pose(&mut surface, |p| {
            let by = Vec3::from_fn(|_, _| random.signed());
            p + by * (5e-8 * size)
        });
        let mut scene = Scene::with_backend(
            SceneParams {
                sleep: None,
                ..SceneParams::default()
            },
            &runner.backend,
        )?;
        let falls = matches!(self.treatment, Treatment::Hang | Treatment::Drop);
        scene.params.solver.gravity = [0.0, if falls { -GRAVITY } else { 0.0 }, 0.0];
        if self.treatment == Treatment::Drop {
            let [_, ground, _] = to_f32(Vec3::new(0.0, f64::from(lowest) - 0.3 * size, 0.0));
            scene.colliders.push(Collider::ground(ground));
        }
        let body = scene.add_body(surface, &self.material)?;
        self.begin(&mut scene, body)?;
        let start = Energy::of(&scene, body)?;
        let unit = match self.treatment {
            Treatment::Spin => start.kinetic,
            _ => start.weight * size,
        };
        // Large meshes move for half as long.
        let vertices = self.surface.topology().vertex_count();
        let frames = if vertices > 300 { 45 } else { 90 };
        let (mut gain, mut speed) = (0.0, 0.0);
        for frame in 0..frames {
            scene.params.dt = self.frames.length(frame, &mut random);
            scene.step()?;
            scene.read_back(body)?;
            let now = Energy::of(&scene, body)?;
            gain = larger(gain, (now.total() - start.total()) / unit);
            if frame + frames / 4 >= frames {
                speed = larger(speed, now.speed / size);
            }
        }
        let is_at_rest = self.treatment == Treatment::Rest;
        Ok(vec![is_at_rest.then_some(speed), (!is_at_rest).then_some(gain)].into())
    }

    /// Gives the body its velocities and pins.
    fn begin(&self, scene: &mut Scene, body: BodyId) -> Found<()> {
        let (solver, surface) = scene.edit(body)?.solver_mut();
        let vertices: Vec<VertexId> = surface.topology().vertices().collect();
        match self.treatment {
            Treatment::Rest | Treatment::Drop => {}
            Treatment::Spin => {
                let mass = |v: VertexId| f64::from(solver.masses()[v.index()]);
                let sum: Vec3 = vertices
                    .iter()
                    .map(|&v| surface.position(v) * mass(v))
                    .sum();
                let center = sum / solver.total_mass();
                for &v in &vertices {
                    let arm = surface.position(v) - center;
                    let velocity = Vec3::new(3.0, 4.0, 1.0).cross(&arm);
                    solver.set_velocity(v, to_f32(velocity))?;
                }
            }
            Treatment::Hang => {
                let height = |v: &VertexId| surface.position(*v).y;
                let highest = vertices
                    .iter()
                    .max_by(|a, b| height(a).total_cmp(&height(b)));
                let highest = *highest.ok_or("the mesh has vertices")?;
                solver.pin(surface, highest)?;
            }
        }
        Ok(())
    }
}

/// Energies of a body \[J\].
struct Energy {
    kinetic: f64,
    potential: f64,
    /// Force of gravity, or of the earth's without any \[N\].
    weight: f64,
    /// Largest speed of a vertex [m/s].
    speed: f64,
}

impl Energy {
    fn of(scene: &Scene, body: BodyId) -> Found<Self> {
        let body = scene.body(body)?;
        let (solver, surface) = (body.solver(), body.surface());
        let gravity = f64::from(-scene.params.solver.gravity[1]);
        let mut potential = 0.0;
        let mut speed = 0.0;
        for v in surface.topology().vertices() {
            let mass = f64::from(solver.masses()[v.index()]);
            let fallen = surface.rest_position(v).y - surface.position(v).y;
            potential -= mass * gravity * fallen;
            let [x, y, z] = solver.velocity(v).map(f64::from);
            speed = larger(speed, Vec3::new(x, y, z).norm());
        }
        Ok(Self {
            kinetic: solver.kinetic_energy(),
            potential,
            weight: solver.total_mass() * f64::from(GRAVITY),
            speed,
        })
    }

    fn total(&self) -> f64 {
        self.kinetic + self.potential
    }
}

/// Runs cylinders and rods until they sleep, at most for 12 s.
fn primitives(runner: &Runner, are_solid: bool) -> Vec<Run> {
    let ways = ["rest", "drop", "cut"];
    let meshes = [
        (
            "cylinder, fans from centers",
            prism([32, 1], 0.5, 1.0, true),
            &ways[..],
        ),
        (
            "cylinder, fans from corners",
            prism([32, 1], 0.5, 1.0, false),
            &ways[..],
        ),
        ("rod of 48", prism([48, 1], 0.1, 2.0, false), &ways[..]),
        // The halves of a ball topple, which lifts their rims.
        ("ball", icosphere(3, 0.5), &ways[..2]),
    ];
    let mut all = Vec::new();
    for (name, surface, ways) in &meshes {
        let is_solid =
            |preset: &str| Material::preset(preset).is_some_and(|own| own.solid.is_some());
        for preset in Material::PRESETS
            .into_iter()
            .filter(|preset| is_solid(preset) == are_solid)
        {
            for &way in *ways {
                all.push((format!("{name}, {preset}, {way}"), surface, preset, way));
            }
        }
    }
    runner.each(&all, |(name, surface, preset, way)| {
        Run::new(name.clone(), primitive(runner, surface, preset, way))
    })
}

/// Returns the largest rise of a vertex and the time until all sleep.
fn primitive(runner: &Runner, surface: &Surface, preset: &str, way: &str) -> Found<Outcome> {
    let material = Material::preset(preset).ok_or("a preset")?;
    let mut scene = Scene::with_backend(SceneParams::default(), &runner.backend)?;
    let bounds = surface.bounds();
    if way == "rest" {
        scene.params.solver.gravity = [0.0; 3];
    } else {
        scene.colliders.push(Collider::ground(bounds.min[1] - 0.1));
    }
    let body = scene.add_body(surface.clone(), &material)?;
    if way == "cut" {
        let sweep = Sweep::from_plane([1.0, 0.2, 0.3], 0.01, &bounds)?;
        let params = CutParams::default();
        let cut = |cutter: &mut Cutter, surface: &mut Surface| cutter.cut(surface, &sweep, &params);
        let outcome = scene.cut_with(body, &sweep, cut)??;
        assert!(!outcome.is_miss(), "the plane is within the mesh");
    }
    let highest = |scene: &Scene| -> Found<f64> {
        let surface = scene.body(body)?.surface();
        Ok(f64::from(surface.bounds().max[1]))
    };
    let (start, mut rise, mut frames) = (f64::from(bounds.max[1]), 0.0, 0);
    while !scene.is_asleep(body)? && frames < 720 {
        scene.step()?;
        scene.read_back(body)?;
        rise = larger(rise, highest(&scene)? - start);
        frames += 1;
    }
    let time = f64::from(frames) * f64::from(FRAME);
    let speed = Energy::of(&scene, body)?.speed;
    Ok([rise / bounds.diagonal(), speed / bounds.diagonal(), time].into())
}
