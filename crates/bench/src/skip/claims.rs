//! Claims about scenes and solvers on the CPU.

use super::{Claim, DT, Effort, Frame};
use crate::motion;
use incise_cut::Sweep;
use incise_mesh::Surface;
use incise_models::{Model, build_model};
use incise_pbd_gpu::{
    Collider, InteriorSprings, Material, Scheme, Solver, SolverParams, Stiffness, Volume,
};
use incise_scene::{BodyId, ContactParams, Scene, SceneParams, SleepParams};
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

/// Returns the parameters of a weightless scene without checkpoints.
pub(super) fn scene_params(solver: SolverParams, sleep: Option<SleepParams>) -> SceneParams {
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

/// Returns a scene of one body at rest.
fn at_rest(
    model: Model,
    material: &Material,
    solver: SolverParams,
    sleep: Option<SleepParams>,
) -> Result<Scene, Box<dyn Error>> {
    let mut scene = Scene::new(scene_params(solver, sleep));
    scene.add_body(build_model(model), material)?;
    Ok(scene)
}

/// Steps until all bodies sleep.
pub(super) fn put_to_sleep(scene: &mut Scene, bodies: u32) -> Result<(), Box<dyn Error>> {
    let frames = SleepParams::default().frames(scene.params.dt) + SleepParams::LAG;
    for _ in 0..=frames {
        scene.step()?;
    }
    match scene.stats().sleeping_bodies {
        asleep if asleep == bodies => Ok(()),
        asleep => Err(format!("{asleep} of {bodies} bodies at rest sleep").into()),
    }
}

/// Returns the frame of a scene.
fn frame(mut scene: Scene) -> Frame {
    Box::new(move || Ok(scene.step().map(|_| ())?))
}

/// Returns the frame of a solver.
fn solver_frame((mut surface, mut solver): (Surface, Solver)) -> Frame {
    Box::new(move || Ok(solver.step(&mut surface, DT, &PARAMS).map(|_| ())?))
}

/// Returns all claims on the CPU.
pub(super) fn on_cpu(effort: Effort) -> Vec<Claim> {
    let mut claims: Vec<Claim> = effort.sleepers.iter().map(|&model| asleep(model)).collect();
    claims.extend([false, true].map(crowd));
    for &model in effort.models {
        claims.extend([
            scene_overhead(model),
            scheme_choice(model),
            volume_turned_off(model),
            volume_turned_on(model),
        ]);
        claims.extend(
            beyond_the_paper().map(|(feature, text, bound, [with, without])| {
                Claim::new(feature, text, model, bound, move || {
                    let scenes = [with.scene(model)?, without.scene(model)?];
                    Ok(scenes.map(|(scene, _)| frame(scene)))
                })
            }),
        );
        claims.extend([blade(model, false), blade(model, true), early_out(model)]);
    }
    claims
}

fn asleep(model: Model) -> Claim {
    Claim::new(
        "sleep",
        "time of a frame, relative to the same body awake",
        model,
        0.01,
        move || {
            let (material, params) = (Material::default(), SolverParams::default());
            let mut asleep = at_rest(model, &material, params, Some(SleepParams::default()))?;
            put_to_sleep(&mut asleep, 1)?;
            Ok([
                frame(asleep),
                frame(at_rest(model, &material, params, None)?),
            ])
        },
    )
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
            let material = Material::default();
            let sleep = Some(SleepParams::default());
            let mut scene = Scene::new(scene_params(SolverParams::default(), sleep));
            for _ in 0..CROWD {
                scene.add_body(build_model(Model::Sphere20), &material)?;
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

fn scene_overhead(model: Model) -> Claim {
    Claim::new(
        "absent",
        "time of a scene's frame, relative to the solver alone",
        model,
        1.02,
        move || {
            let material = Material {
                bending: None,
                ..Material::default()
            };
            let scene = at_rest(model, &material, PARAMS, None)?;
            let mut surface = build_model(model);
            let solver = Solver::new(&mut surface, &material)?;
            Ok([frame(scene), solver_frame((surface, solver))])
        },
    )
}

fn scheme_choice(model: Model) -> Claim {
    Claim::new(
        "absent",
        "time of a frame of a soft body that may take the global step, relative to sweeps",
        model,
        1.02,
        move || {
            let frame = |scheme| -> Result<Frame, Box<dyn Error>> {
                let (mut surface, mut solver) = soft_body(model)?;
                let params = SolverParams { scheme, ..PARAMS };
                Ok(Box::new(move || {
                    Ok(solver.step(&mut surface, DT, &params).map(|_| ())?)
                }))
            };
            Ok([frame(Scheme::Auto)?, frame(Scheme::Sweeps)?])
        },
    )
}

/// Returns a body that is too soft for the global step.
fn soft_body(model: Model) -> Result<(Surface, Solver), Box<dyn Error>> {
    let mut surface = build_model(model);
    let material = Material {
        stretch: Stiffness::Compliance(1.0),
        bending: Some(Stiffness::Compliance(100.0)),
        ..motion::material()
    };
    let mut solver = Solver::new(&mut surface, &material)?;
    motion::start(&mut solver, &surface)?;
    Ok((surface, solver))
}

/// Returns a body of the table, with volume or without.
fn body(model: Model, volume: Option<Volume>) -> Result<(Surface, Solver), Box<dyn Error>> {
    let mut surface = build_model(model);
    let material = Material {
        volume,
        ..motion::material()
    };
    let mut solver = Solver::new(&mut surface, &material)?;
    motion::start(&mut solver, &surface)?;
    Ok((surface, solver))
}

fn volume_turned_off(model: Model) -> Claim {
    Claim::new(
        "absent",
        "time of a frame after volume was turned off, relative to never any",
        model,
        1.02,
        move || {
            let (surface, mut solver) = body(model, Some(Volume::default()))?;
            solver.set_volume(&surface, None)?;
            Ok([(surface, solver), body(model, None)?].map(solver_frame))
        },
    )
}

fn volume_turned_on(model: Model) -> Claim {
    Claim::new(
        "volume",
        "time of a frame with volume, relative to none",
        model,
        2.0,
        move || {
            let bodies = [body(model, Some(Volume::default()))?, body(model, None)?];
            Ok(bodies.map(solver_frame))
        },
    )
}

fn blade(model: Model, moves: bool) -> Claim {
    let (feature, text) = match moves {
        true => (
            "far-blade",
            "time of a frame, relative to one without the far blade",
        ),
        false => (
            "blade-at-rest",
            "time of a frame, relative to one without the resting blade",
        ),
    };
    Claim::new(feature, text, model, 1.02, move || {
        let mut with = at_rest(model, &Material::default(), PARAMS, None)?;
        let without = at_rest(model, &Material::default(), PARAMS, None)?;
        let blade = with.add_blade(FAR[0]);
        let mut frames = 0_usize;
        let first = move || {
            frames += 1;
            if moves {
                with.move_blade(blade, FAR[frames % 2])?;
            }
            Ok(with.step().map(|_| ())?)
        };
        Ok([Box::new(first) as Frame, frame(without)])
    })
}

fn early_out(model: Model) -> Claim {
    Claim::new(
        "early-out",
        "time of a frame at rest with a residual of 1e-5 m, relative to none",
        model,
        0.5,
        move || {
            let scene = |residual| -> Result<Frame, Box<dyn Error>> {
                let params = SolverParams { residual, ..PARAMS };
                Ok(frame(at_rest(model, &Material::default(), params, None)?))
            };
            Ok([scene(Some(RESIDUAL))?, scene(None)?])
        },
    )
}

/// Features of a scene that the paper lacks.
#[derive(Debug, Clone, Copy, Default)]
struct Features {
    interior_springs: Option<InteriorSprings>,
    contacts: Option<ContactParams>,
    /// Whether the scene has a distant collider.
    collider: bool,
    /// Whether the body is cut in two first.
    cut: bool,
}

impl Features {
    /// Returns a scene with a body of the table and its motion.
    fn scene(self, model: Model) -> Result<(Scene, BodyId), Box<dyn Error>> {
        let mut scene = Scene::new(SceneParams {
            contacts: self.contacts,
            ..scene_params(PARAMS, None)
        });
        let material = Material {
            interior_springs: self.interior_springs,
            ..motion::material()
        };
        let body = scene.add_body(build_model(model), &material)?;
        if self.collider {
            scene.colliders.push(Collider::Sphere {
                center: [1e3; 3],
                radius: 1.0,
            });
        }
        if self.cut {
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
        let (solver, surface) = scene.edit(body)?.solver_mut();
        motion::start(solver, surface)?;
        Ok((scene, body))
    }
}

/// A claim about features that the paper lacks: feature, text, bound, scene with and without.
type Beyond = (&'static str, &'static str, f64, [Features; 2]);

fn beyond_the_paper() -> [Beyond; 5] {
    let none = Features::default();
    let cut = Features { cut: true, ..none };
    let springs = |density| {
        let params = InteriorSprings::default();
        let interior_springs = Some(InteriorSprings { density, ..params });
        Features {
            interior_springs,
            ..none
        }
    };
    let touching = |self_collision, of: Features| {
        let params = ContactParams::default();
        let contacts = Some(ContactParams {
            self_collision,
            ..params
        });
        Features { contacts, ..of }
    };
    let far = Features {
        collider: true,
        ..none
    };
    [
        (
            "absent",
            "time of a frame with interior springs of density 0, relative to none",
            1.02,
            [springs(0.0), none],
        ),
        (
            "absent",
            "time of a frame of one piece with contacts and a far collider, relative to none",
            1.05,
            [touching(false, far), none],
        ),
        (
            "interior-springs",
            "time of a frame with an interior spring per vertex, relative to none",
            1.5,
            [springs(InteriorSprings::default().density), none],
        ),
        (
            "contacts",
            "time of a frame with the contacts of two halves, relative to none",
            2.0,
            [touching(false, cut), cut],
        ),
        (
            "contacts",
            "the same with self-collision",
            4.0,
            [touching(true, cut), cut],
        ),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn soft_bodies_have_no_memory_of_the_global_step() {
        let [auto, sweeps] = [Scheme::Auto, Scheme::Sweeps].map(|scheme| {
            let (mut surface, mut solver) = soft_body(Model::Bunny).unwrap();
            let params = SolverParams { scheme, ..PARAMS };
            solver.step(&mut surface, DT, &params).unwrap();
            assert_eq!(solver.stats().global_iterations, 0);
            solver.capacity()
        });
        assert_eq!(auto, sweeps);
    }

    #[test]
    fn scenes_have_the_measured_features_only() {
        let [absent, whole, springs, halves, own] = beyond_the_paper().map(|claim| claim.3);
        let stats = |of: Features| {
            let (mut scene, body) = of.scene(Model::Sphere80).unwrap();
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
