//! Claims about scenes and solvers.

use super::{Claim, DT, Effort, Frame};
use crate::motion;
use incise_cut::Sweep;
use incise_mesh::Surface;
use incise_models::{Model, build_model};
use incise_pbd_gpu::{
    Collider, InteriorSprings, Material, Scheme, Solver, SolverParams, Stiffness, Volume,
};
use incise_scene::{
    BackendChoice, BackendRequest, BodyId, ContactParams, Scene, SceneParams, SleepParams,
};
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

/// A weightless scene of one body without checkpoints.
#[derive(Debug, Clone, Copy)]
struct Setup {
    material: Material,
    solver: SolverParams,
    /// Whether the body spins and is squeezed.
    is_moving: bool,
    /// The parameters of sleep, for a body that is put to sleep.
    sleep: Option<SleepParams>,
    contacts: Option<ContactParams>,
    /// Whether the scene has a distant collider.
    has_collider: bool,
    /// Whether the body is cut in two first.
    is_cut: bool,
    /// Whether a distant blade moves; none without a blade.
    far_blade: Option<bool>,
}

impl Setup {
    /// Returns a body at rest without any feature.
    fn at_rest() -> Self {
        Self {
            material: Material::default(),
            solver: PARAMS,
            is_moving: false,
            sleep: None,
            contacts: None,
            has_collider: false,
            is_cut: false,
            far_blade: None,
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

    fn scene(self, model: Model, on: &BackendRequest) -> Result<(Scene, BodyId), Box<dyn Error>> {
        let mut scene = Scene::with_backend(scene_params(self.solver, self.sleep), on)?;
        scene.params.contacts = self.contacts;
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
        if self.sleep.is_some() {
            put_to_sleep(&mut scene, 1)?;
        }
        Ok((scene, body))
    }

    /// Returns the frame of the scene; on a GPU it ends when the GPU is done.
    fn frame(self, model: Model, on: &BackendRequest) -> Result<Frame, Box<dyn Error>> {
        let (mut scene, _) = self.scene(model, on)?;
        let blade = self.far_blade.map(|moves| (scene.add_blade(FAR[0]), moves));
        let mut frames = 0_usize;
        Ok(Box::new(move || {
            frames += 1;
            if let Some((blade, true)) = blade {
                scene.move_blade(blade, FAR[frames % 2])?;
            }
            scene.step()?;
            Ok(scene.wait_for_gpu()?)
        }))
    }
}

/// Returns the parameters of a weightless scene without checkpoints.
fn scene_params(solver: SolverParams, sleep: Option<SleepParams>) -> SceneParams {
    SceneParams {
        dt: DT,
        solver: SolverParams {
            gravity: [0.0; 3],
            ..solver
        },
        checkpoint: 0,
        sleep,
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

/// A claim about two scenes: feature, text, bound, scene with the feature and without.
type OfScenes = (&'static str, &'static str, f64, [Setup; 2]);

/// Returns the claim that sleep costs nothing.
fn sleep() -> OfScenes {
    let awake = Setup {
        solver: SolverParams::default(),
        ..Setup::at_rest()
    };
    let asleep = Setup {
        sleep: Some(SleepParams::default()),
        ..awake
    };
    let text = "time of a frame, relative to the same body awake";
    ("sleep", text, 0.01, [asleep, awake])
}

/// Returns the claim about volume on a GPU.
fn volume() -> OfScenes {
    let without = Setup {
        solver: SolverParams::default(),
        ..Setup::at_rest()
    };
    let mut with = without;
    with.material.volume = Some(Volume::default());
    let text = "time of a frame with volume, relative to none";
    ("volume", text, 2.0, [with, without])
}

/// Returns the claims about scenes of every model.
fn of_scenes() -> [OfScenes; 8] {
    let (rest, none) = (Setup::at_rest(), Setup::moving());
    let springs = |density| {
        let mut with = none;
        with.material.interior_springs = Some(InteriorSprings {
            density,
            ..InteriorSprings::default()
        });
        [with, none]
    };
    let touching = |self_collision, of: Setup| {
        let contacts = Some(ContactParams {
            self_collision,
            ..ContactParams::default()
        });
        [Setup { contacts, ..of }, of]
    };
    let cut = Setup {
        is_cut: true,
        ..none
    };
    let far = Setup {
        has_collider: true,
        ..none
    };
    let blade = |moves| {
        let far_blade = Some(moves);
        [Setup { far_blade, ..rest }, rest]
    };
    let mut early = rest;
    early.solver.residual = Some(RESIDUAL);
    [
        (
            "absent",
            "time of a frame with interior springs of density 0, relative to none",
            1.02,
            springs(0.0),
        ),
        (
            "absent",
            "time of a frame of one piece with contacts and a far collider, relative to none",
            1.05,
            [touching(false, far)[0], none],
        ),
        (
            "interior-springs",
            "time of a frame with an interior spring per vertex, relative to none",
            1.5,
            springs(InteriorSprings::default().density),
        ),
        (
            "contacts",
            "time of a frame with the contacts of two halves, relative to none",
            2.0,
            touching(false, cut),
        ),
        (
            "contacts",
            "the same with self-collision",
            4.0,
            touching(true, cut),
        ),
        (
            "blade-at-rest",
            "time of a frame, relative to one without the resting blade",
            1.02,
            blade(false),
        ),
        (
            "far-blade",
            "time of a frame, relative to one without the far blade",
            1.02,
            blade(true),
        ),
        (
            "early-out",
            "time of a frame at rest with a residual of 1e-5 m, relative to none",
            0.5,
            [early, rest],
        ),
    ]
}

/// Returns all claims on a backend; on a GPU those about sleep and volume.
pub(super) fn claims(effort: Effort, on: &BackendRequest) -> Vec<Claim> {
    let of = |(feature, text, bound, [with, without]): OfScenes, model| {
        let on = on.clone();
        Claim::new(feature, text, model, bound, move || {
            Ok([with.frame(model, &on)?, without.frame(model, &on)?])
        })
    };
    if on.choice == BackendChoice::Gpu {
        let mut claims = vec![of(sleep(), Model::Bunny)];
        claims.extend(effort.models.iter().map(|&model| of(volume(), model)));
        return claims;
    }
    let mut claims: Vec<Claim> = (effort.sleepers.iter())
        .map(|&model| of(sleep(), model))
        .collect();
    claims.extend([false, true].map(crowd));
    for &model in effort.models {
        claims.extend(of_solvers(model));
        claims.extend(of_scenes().map(|claim| of(claim, model)));
    }
    claims
}

fn crowd(with_blade: bool) -> Claim {
    let on = match with_blade {
        true => "a blade moves beside them",
        false => "no blade",
    };
    Claim {
        feature: "sleep",
        text: "time of a frame of 1,000 sleeping bodies [us]",
        on: on.to_owned(),
        bound: 50.0,
        is_time: true,
        frames: Box::new(move || {
            let sleep = Some(SleepParams::default());
            let mut scene = Scene::new(scene_params(SolverParams::default(), sleep));
            for _ in 0..CROWD {
                scene.add_body(build_model(Model::Sphere20), &Material::default())?;
            }
            put_to_sleep(&mut scene, CROWD)?;
            let blade = with_blade.then(|| scene.add_blade(FAR[0]));
            let mut frames = 0_usize;
            let frame = move || {
                frames += 1;
                if let Some(blade) = blade {
                    scene.move_blade(blade, FAR[frames % 2])?;
                }
                Ok(scene.step().map(|_| ())?)
            };
            Ok([Box::new(frame) as Frame, Box::new(|| Ok(()))])
        }),
    }
}

/// Returns the claims about solvers of a model.
fn of_solvers(model: Model) -> [Claim; 4] {
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
        Ok([scene, solver_frame((surface, solver), PARAMS)])
    };
    let scheme_choice = move || {
        let frame = |scheme| -> Result<Frame, Box<dyn Error>> {
            let params = SolverParams { scheme, ..PARAMS };
            Ok(solver_frame(body(model, &soft())?, params))
        };
        Ok([frame(Scheme::Auto)?, frame(Scheme::Sweeps)?])
    };
    let turned_off = move || {
        let (surface, mut solver) = body(model, &with_volume)?;
        solver.set_volume(&surface, None)?;
        let both = [(surface, solver), body(model, &motion::material())?];
        Ok(both.map(|body| solver_frame(body, PARAMS)))
    };
    let turned_on = move || {
        let both = [
            body(model, &with_volume)?,
            body(model, &motion::material())?,
        ];
        Ok(both.map(|body| solver_frame(body, PARAMS)))
    };
    let text = [
        "time of a scene's frame, relative to the solver alone",
        "time of a frame of a soft body that may take the global step, relative to sweeps",
        "time of a frame after volume was turned off, relative to never any",
        "time of a frame with volume, relative to none",
    ];
    [
        Claim::new("absent", text[0], model, 1.02, overhead),
        Claim::new("absent", text[1], model, 1.02, scheme_choice),
        Claim::new("absent", text[2], model, 1.02, turned_off),
        Claim::new("volume", text[3], model, 2.0, turned_on),
    ]
}

/// Returns the frame of a solver.
fn solver_frame((mut surface, mut solver): (Surface, Solver), params: SolverParams) -> Frame {
    Box::new(move || Ok(solver.step(&mut surface, DT, &params).map(|_| ())?))
}

/// Returns the material of a body that is too soft for the global step.
fn soft() -> Material {
    Material {
        stretch: Stiffness::Compliance(1.0),
        bending: Some(Stiffness::Compliance(100.0)),
        ..motion::material()
    }
}

/// Returns a body with the motion of the table.
fn body(model: Model, material: &Material) -> Result<(Surface, Solver), Box<dyn Error>> {
    let mut surface = build_model(model);
    let mut solver = Solver::new(&mut surface, material)?;
    motion::start(&mut solver, &surface)?;
    Ok((surface, solver))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scenes_have_the_measured_features_only() {
        let [absent, whole, springs, halves, own, ..] = of_scenes().map(|claim| claim.3);
        let stats = |of: Setup| {
            let request = BackendRequest::default();
            let (mut scene, body) = of.scene(Model::Sphere80, &request).unwrap();
            let stats = *scene.step().unwrap();
            let solver = scene.body(body).unwrap().solver();
            let projections = solver.stats().interior_spring_projections;
            (projections, stats.contact_searches, stats.contacts)
        };
        assert_eq!(stats(absent[0]), (0, 0, 0));
        assert_eq!(stats(whole[0]), (0, 0, 0));
        assert!(stats(springs[0]).0 > 0);
        for [with, without] in [halves, own] {
            let (_, searches, contacts) = stats(with);
            assert!(searches == 1 && contacts > 0);
            assert_eq!(stats(without), (0, 0, 0));
        }
    }
}
