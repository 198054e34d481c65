//! Solids in 75 seeded scenes: dropped, cut, dragged, squeezed and piled up.

mod bodies;
mod scripts;

use super::{Case, Found, Outcome, Run, larger};
use incise_pbd_gpu::Material;
use incise_scene::{BodyId, Scene};
use incise_test_support::pieces::{Piece, pieces};
use scripts::{Kind, Script};

pub(super) const CASES: [Case; 1] = [Case {
    id: "solids",
    stress: "models, balls, rings and bars with an inside, 0.1 to 10 MPa: dropped, cut in flight \
             and at rest, by a knife with and without a face and by a scalpel, dragged, squeezed, \
             piled up, sliced and as plates; other frames, cells and stiffnesses",
    invariants: &[
        (
            "distance from the rest shape in zero gravity, root mean square by diagonal",
            1e-3,
        ),
        (
            "the same where it lies, beyond the strain of its own weight",
            0.03,
        ),
        (
            "volume that a piece has lost at any time, by its own",
            INVERTED,
        ),
        (
            "energy above that of the start, without work, by the energy of the fall",
            1e-3,
        ),
        ("mean mass of a node by the lightest one", 10.0),
        ("time after the last event until it is at rest [s]", 5.0),
        ("time after the last event until it sleeps [s]", 8.0),
    ],
    run: |runner| {
        let mut all = Vec::new();
        for kind in Kind::ALL {
            let seeds = 0..runner.samples.unwrap_or(SEEDS);
            all.extend(seeds.map(|seed| (kind, seed)));
        }
        if let Some(text) = &runner.matching {
            all.retain(|(kind, seed)| describe(*kind, *seed).contains(text));
        }
        runner.each(&all, |&(kind, seed)| {
            let found = Script::new(runner, kind, seed).and_then(measure);
            Run::new(describe(kind, seed), found)
        })
    },
}];

/// Number of scenes of each kind.
const SEEDS: u32 = 5;

/// A loss just below the whole volume: beyond it a piece is inverted.
const INVERTED: f64 = 1.0 - 1e-6;

/// Least rest volume of a piece whose shape is measured, by that of the largest one.
const LEAST: f64 = 1e-3;

/// Speed of a vertex at rest [m/s]: bodies are a meter across.
const REST: f64 = 0.01;

/// Simulated time after the last event, and in zero gravity \[s\].
const SECONDS: [f64; 2] = [8.5, 3.0];

/// Relaxation time in zero gravity, in which the swings of thin plates decay \[s\].
const RELAXATION: f32 = 0.3;

fn describe(kind: Kind, seed: u32) -> String {
    format!("{}, seed {seed}", kind.name())
}

fn measure(mut script: Script) -> Found<Outcome> {
    let dt = f64::from(script.scene.params.dt);
    let ids: Vec<BodyId> = script.scene.bodies().collect();
    let (start, scale) = (
        energy(&script.scene, &ids)?,
        fall_energy(&script.scene, &ids)?,
    );
    let (mut lost, mut gained, mut ratio): (f64, f64, f64) = (f64::NEG_INFINITY, 0.0, 0.0);
    let (mut moved, mut awake) = (0.0, 0.0);
    let mut time = 0.0;
    while time < script.last_event() + SECONDS[0] {
        script.drive()?;
        script.scene.step()?;
        time += dt;
        gained = larger(gained, energy(&script.scene, &ids)? - start);
        for &id in &ids {
            for piece in large(script.scene.body(id)?.surface()) {
                lost = larger(lost, 1.0 - piece.volume / piece.rest_volume);
            }
            ratio = larger(ratio, mass_ratio(&script.scene, id)?);
            if fastest(&script.scene, id)? > REST {
                moved = time - script.last_event();
            }
            if !script.scene.is_asleep(id)? {
                awake = time - script.last_event();
            }
        }
        if time > script.last_event() && awake < time - script.last_event() {
            break;
        }
    }
    let sag = script.own_weight_strain();
    let lies = deviation(&script.scene, &ids)? - sag;
    free(&mut script.scene, &ids)?;
    let frames = (SECONDS[1] / dt).ceil();
    let mut frame = 0.0;
    while frame < frames {
        script.scene.step()?;
        frame += 1.0;
    }
    let freed = deviation(&script.scene, &ids)?;
    let is_free = script.is_without_work();
    Ok(vec![
        Some(freed),
        script.lies().then_some(lies),
        Some(lost),
        is_free.then_some(gained / scale),
        Some(ratio),
        Some(moved),
        Some(awake),
    ]
    .into())
}

/// Removes gravity, colliders, pins and contacts, so that only the shapes are left.
fn free(scene: &mut Scene, ids: &[BodyId]) -> Found<()> {
    scene.params.solver.gravity = [0.0; 3];
    scene.params.contacts = None;
    scene.params.sleep = None;
    scene.colliders.clear();
    for &id in ids {
        let (solver, surface) = scene.edit(id)?.solver_mut();
        for pin in solver.pins().to_vec() {
            solver.unpin(surface, pin.vertex)?;
        }
        let mut material: Material = *solver.material();
        if let Some(solid) = &mut material.solid {
            solid.relaxation_time = RELAXATION;
        }
        solver.set_material(surface, &material)?;
    }
    Ok(())
}

/// Returns the pieces whose shape is measured.
fn large(surface: &incise_mesh::Surface) -> impl Iterator<Item = Piece> {
    let pieces = pieces(surface);
    let largest = pieces.iter().map(|piece| piece.rest_volume);
    let least = LEAST * largest.fold(0.0, f64::max);
    pieces
        .into_iter()
        .filter(move |piece| piece.rest_volume > least)
}

/// Returns the largest distance of a piece from its rest shape, by its diagonal.
fn deviation(scene: &Scene, ids: &[BodyId]) -> Found<f64> {
    let mut worst = 0.0;
    for &id in ids {
        let of_pieces = large(scene.body(id)?.surface()).map(|piece| piece.deviation);
        worst = of_pieces.fold(worst, larger);
    }
    Ok(worst)
}

/// Returns potential, kinetic and elastic energy \[J\].
fn energy(scene: &Scene, ids: &[BodyId]) -> Found<f64> {
    let [x, y, z] = scene.params.solver.gravity.map(f64::from);
    let mut sum = 0.0;
    for &id in ids {
        let solver = scene.body(id)?.solver();
        let potential = |p: &[f32; 4]| {
            let [px, py, pz, w] = p.map(f64::from);
            if w > 0.0 {
                -(x * px + y * py + z * pz) / w
            } else {
                0.0
            }
        };
        sum += solver.nodes().iter().map(potential).sum::<f64>();
        sum += solver.kinetic_energy() + solver.elastic_energy();
    }
    Ok(sum)
}

/// Returns the energy of a fall of all bodies by a meter \[J\].
fn fall_energy(scene: &Scene, ids: &[BodyId]) -> Found<f64> {
    let mut mass = 0.0;
    for &id in ids {
        mass += scene.body(id)?.solver().total_mass();
    }
    Ok(9.81 * mass)
}

/// Returns the mean mass of a node of a body by the lightest one.
fn mass_ratio(scene: &Scene, id: BodyId) -> Found<f64> {
    let nodes = scene.body(id)?.solver().nodes();
    let masses = || {
        nodes
            .iter()
            .filter(|x| x[3] > 0.0)
            .map(|x| 1.0 / f64::from(x[3]))
    };
    let mean = masses().sum::<f64>() / masses().count() as f64;
    Ok(mean / masses().fold(f64::INFINITY, f64::min))
}

/// Returns the speed of the fastest vertex [m/s].
fn fastest(scene: &Scene, id: BodyId) -> Found<f64> {
    let velocities = scene.body(id)?.solver().velocities().iter();
    let squares = velocities.map(|v| v.iter().map(|&c| f64::from(c) * f64::from(c)).sum::<f64>());
    Ok(squares.fold(0.0, larger).sqrt())
}
