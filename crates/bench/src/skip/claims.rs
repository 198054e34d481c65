//! Claims about scenes and solvers.

use super::{Claim, Effort, Frame};
use crate::motion::{self, Body, DT};
use incise_cut::Sweep;
use incise_models::{Model, build_model};
use incise_pbd_gpu::{Collider, InteriorSprings, Material, Solver, SolverParams, Volume};
use incise_scene::{BackendChoice, BackendRequest, ContactParams, Scene, SceneParams, SleepParams};
use std::error::Error;

/// Bodies of the crowd.
const CROWD: u32 = 1000;

/// Residual of bodies at rest, above rounding and below visible motion \[m\].
const RESIDUAL: f32 = 1e-5;

/// Two positions of a blade far from the body.
const FAR: [[[f32; 3]; 2]; 2] = [
    [[9.0, 0.0, -1.0], [9.0, 0.0, 1.0]],
    [[10.0, 0.0, -1.0], [10.0, 0.0, 1.0]],
];

/// The paper's parameters without gravity.
const PARAMS: SolverParams = SolverParams {
    gravity: [0.0; 3],
    ..SolverParams::paper()
};

/// A blade far from all bodies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum FarBlade {
    AtRest,
    Moving,
}

/// A weightless scene of one body without checkpoints.
#[derive(Debug, Clone, Copy)]
struct Setup {
    material: Material,
    /// With parameters of sleep, the body is put to sleep.
    params: SceneParams,
    /// Whether the body spins and is squeezed.
    is_moving: bool,
    /// Whether the scene has a distant collider.
    has_collider: bool,
    /// Whether the body is cut in two first.
    is_cut: bool,
    blade: Option<FarBlade>,
}

impl Setup {
    /// Returns a body at rest without any feature.
    fn at_rest() -> Self {
        Self {
            material: Material::default(),
            params: scene_params(PARAMS),
            is_moving: false,
            has_collider: false,
            is_cut: false,
            blade: None,
        }
    }

    /// Returns a body of the table and its motion.
    fn moving() -> Self {
        Self {
            material: motion::material(),
            is_moving: true,
            ..Self::at_rest()
        }
    }

    /// Returns the same with contacts.
    fn touching(mut self, self_collision: bool) -> Self {
        self.params.contacts = Some(ContactParams {
            self_collision,
            ..ContactParams::default()
        });
        self
    }

    /// Returns the same with interior springs.
    fn with_springs(mut self, density: f32) -> Self {
        self.material.interior_springs = Some(InteriorSprings {
            density,
            ..InteriorSprings::default()
        });
        self
    }

    /// Returns the frame of the scene; on a GPU it ends when the GPU is done.
    fn frame(self, model: Model, on: &BackendRequest) -> Result<Frame, Box<dyn Error>> {
        let mut scene = Scene::with_backend(self.params, on)?;
        let body = scene.add_body(build_model(model), &self.material)?;
        if self.has_collider {
            scene.colliders.push(Collider::Sphere {
                center: [1e3; 3],
                radius: 1.0,
            });
        }
        if self.is_cut {
            let bounds = scene.body(body)?.surface().bounds();
            let sweep = Sweep::from_plane([0.1, 1.0, 0.2], bounds.center().y, &bounds)?;
            let [before, after] = sweep.ends();
            let blade = scene.add_blade(before);
            scene.move_blade(blade, after)?;
            if scene.cut()?.cuts != 1 {
                return Err(format!("the blade missed {}", model.name()).into());
            }
            scene.teleport_blade(blade, before.map(|p| p.map(|c| c + 1e4)))?;
        }
        if self.is_moving {
            let (solver, surface) = scene.edit(body)?.solver_mut();
            motion::start(solver, surface)?;
        }
        if self.params.sleep.is_some() {
            put_to_sleep(&mut scene, 1)?;
        }
        Ok(scene_frame(scene, self.blade))
    }
}

/// Returns the parameters of a weightless scene without checkpoints and sleep.
fn scene_params(solver: SolverParams) -> SceneParams {
    SceneParams {
        dt: DT,
        solver: SolverParams {
            gravity: [0.0; 3],
            ..solver
        },
        checkpoint: 0,
        sleep: None,
        ..SceneParams::default()
    }
}

/// Steps until all bodies sleep.
fn put_to_sleep(scene: &mut Scene, bodies: u32) -> Result<(), Box<dyn Error>> {
    let frames = SleepParams::default().frames(scene.params.dt) + SleepParams::LAG;
    for _ in 0..=frames {
        scene.step()?;
    }
    match scene.stats().sleeping_bodies {
        asleep if asleep == bodies => Ok(()),
        asleep => Err(format!("{asleep} of {bodies} bodies at rest sleep").into()),
    }
}

/// Returns the frame of a scene with a far blade or without.
fn scene_frame(mut scene: Scene, far_blade: Option<FarBlade>) -> Frame {
    let blade = far_blade.map(|_| scene.add_blade(FAR[0]));
    let moving = blade.filter(|_| far_blade == Some(FarBlade::Moving));
    let mut frames = 0_usize;
    Box::new(move || {
        frames += 1;
        if let Some(blade) = moving {
            scene.move_blade(blade, FAR[frames % 2])?;
        }
        scene.step()?;
        Ok(scene.wait_for_gpu()?)
    })
}

/// Returns the frame of a solver.
fn solver_frame(mut body: Body, params: SolverParams) -> Frame {
    Box::new(move || {
        body.solver.step(&mut body.surface, DT, &params)?;
        Ok(())
    })
}

/// Returns a body with the motion of the table.
fn moving_body(model: Model, material: &Material) -> Result<Body, Box<dyn Error>> {
    let surface = build_model(model);
    Ok(Body::moving(surface, |surface| {
        Solver::new(surface, material)
    })?)
}

/// Returns all claims on a backend; on a GPU those about sleep and volume.
pub(super) fn claims(effort: Effort, on: &BackendRequest) -> Vec<Claim> {
    if on.choice == BackendChoice::Gpu {
        let volumes = effort.models.iter().map(|&model| volume(model, on));
        return [sleep(Model::Bunny, on)]
            .into_iter()
            .chain(volumes)
            .collect();
    }
    let sleepers = effort.sleepers.iter().map(|&model| sleep(model, on));
    let mut claims: Vec<Claim> = sleepers.collect();
    claims.extend([
        crowd("no blade", None),
        crowd("a blade moves beside them", Some(FarBlade::Moving)),
    ]);
    for &model in effort.models {
        claims.extend(of_solvers(model));
        claims.extend(of_scenes(model, on));
    }
    claims
}

/// Returns the claim that sleep costs nothing.
fn sleep(model: Model, on: &BackendRequest) -> Claim {
    let awake = Setup {
        params: scene_params(SolverParams::default()),
        ..Setup::at_rest()
    };
    let mut asleep = awake;
    asleep.params.sleep = Some(SleepParams::default());
    let text = "time of a frame, relative to the same body awake";
    Claim::new("sleep", text, model, 0.01, frames(asleep, awake, model, on))
}

/// Returns the claim that sleeping bodies cost nothing beside each other.
fn crowd(on: &'static str, blade: Option<FarBlade>) -> Claim {
    Claim {
        feature: "sleep",
        text: "time of a frame of 1,000 sleeping bodies [us]",
        on,
        bound: 50.0,
        is_time: true,
        frames: Box::new(move || {
            let mut scene = Scene::new(SceneParams {
                sleep: Some(SleepParams::default()),
                ..scene_params(SolverParams::default())
            });
            for _ in 0..CROWD {
                scene.add_body(build_model(Model::Sphere20), &Material::default())?;
            }
            put_to_sleep(&mut scene, CROWD)?;
            Ok([scene_frame(scene, blade), Box::new(|| Ok(()))])
        }),
    }
}

/// Returns the claim about volume on a GPU.
fn volume(model: Model, on: &BackendRequest) -> Claim {
    let without = Setup {
        params: scene_params(SolverParams::default()),
        ..Setup::at_rest()
    };
    let mut with = without;
    with.material.volume = Some(Volume::default());
    let text = "time of a frame with volume, relative to none";
    Claim::new("volume", text, model, 2.0, frames(with, without, model, on))
}

/// Sets up the frames of two scenes.
fn frames(
    with: Setup,
    without: Setup,
    model: Model,
    on: &BackendRequest,
) -> impl FnOnce() -> Result<[Frame; 2], Box<dyn Error>> + 'static {
    let on = on.clone();
    move || Ok([with.frame(model, &on)?, without.frame(model, &on)?])
}

/// Returns the claims about scenes of a model.
fn of_scenes(model: Model, on: &BackendRequest) -> [Claim; 8] {
    let (rest, none) = (Setup::at_rest(), Setup::moving());
    let cut = Setup {
        is_cut: true,
        ..none
    };
    let far = Setup {
        has_collider: true,
        ..none
    };
    let beside = |blade| Setup {
        blade: Some(blade),
        ..rest
    };
    let mut early = rest;
    early.params.solver.residual = Some(RESIDUAL);
    let claim = |feature, text, bound, with, without| {
        Claim::new(
            feature,
            text,
            model,
            bound,
            frames(with, without, model, on),
        )
    };
    [
        claim(
            "absent",
            "time of a frame with interior springs of density 0, relative to none",
            1.02,
            none.with_springs(0.0),
            none,
        ),
        claim(
            "absent",
            "time of a frame of one piece with contacts and a far collider, relative to none",
            1.05,
            far.touching(false),
            none,
        ),
        claim(
            "interior-springs",
            "time of a frame with an interior spring per vertex, relative to none",
            1.5,
            none.with_springs(InteriorSprings::default().density),
            none,
        ),
        claim(
            "contacts",
            "time of a frame with the contacts of two halves, relative to none",
            2.0,
            cut.touching(false),
            cut,
        ),
        claim(
            "contacts",
            "the same with self-collision",
            4.0,
            cut.touching(true),
            cut,
        ),
        claim(
            "blade-at-rest",
            "time of a frame, relative to one without the resting blade",
            1.02,
            beside(FarBlade::AtRest),
            rest,
        ),
        claim(
            "far-blade",
            "time of a frame, relative to one without the far blade",
            1.02,
            beside(FarBlade::Moving),
            rest,
        ),
        claim(
            "early-out",
            "time of a frame at rest with a residual of 1e-5 m, relative to none",
            0.5,
            early,
            rest,
        ),
    ]
}

/// Returns the claims about solvers of a model.
fn of_solvers(model: Model) -> [Claim; 3] {
    let bare = Material {
        bending: None,
        ..Material::default()
    };
    let with_volume = Material {
        volume: Some(Volume::default()),
        ..motion::material()
    };
    let overhead = move || {
        let mut surface = build_model(model);
        let solver = Solver::new(&mut surface, &bare)?;
        let scene = Setup {
            material: bare,
            ..Setup::at_rest()
        };
        let scene = scene.frame(model, &BackendRequest::default())?;
        Ok([scene, solver_frame(Body { surface, solver }, PARAMS)])
    };
    let beside_none = move |is_on: bool| {
        let mut with = moving_body(model, &with_volume)?;
        if !is_on {
            with.solver.set_volume(&with.surface, None)?;
        }
        let without = moving_body(model, &motion::material())?;
        Ok([with, without].map(|body| solver_frame(body, PARAMS)))
    };
    let text = [
        "time of a scene's frame, relative to the solver alone",
        "time of a frame after volume was turned off, relative to never any",
        "time of a frame with volume, relative to none",
    ];
    [
        Claim::new("absent", text[0], model, 1.02, overhead),
        Claim::new("absent", text[1], model, 1.02, move || beside_none(false)),
        Claim::new("volume", text[2], model, 2.0, move || beside_none(true)),
    ]
}
