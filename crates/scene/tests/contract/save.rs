//! A scene that is saved and loaded goes on with the same bits.
//!
//! `save/layout.txt` has the layout of saved states and its version. After a change of the layout,
//! raise `FORMAT_VERSION` of `incise-mesh` and write the file:
//! `INCISE_UPDATE=1 cargo test --workspace --test contract -- layout`.

mod layout;
mod scenes;

use crate::solids::cut_solid;
use incise_mesh::{ArchiveError, FORMAT_VERSION, Surface, icosphere};
use incise_pbd_gpu::{Integrator, Material, PatchParams, Solver, SolverParams, Stiffness};
use incise_scene::{LoadError, SaveError, Scene, SceneError, SceneParams};
use layout::{Lines, layout};
use proptest::prelude::*;
use scenes::{BUSY_FRAMES, SMALL_PATCHES, busy, hanging, move_blades, overlapping, small, states};
use std::path::Path;
use std::sync::LazyLock;

/// The file of [`small`].
static SMALL: LazyLock<Vec<u8>> = LazyLock::new(|| small().save().unwrap());

/// Steps a scene by a frame, and returns its bits and counters.
fn step(scene: &mut Scene, frame: u32) -> (Vec<[u32; 8]>, [u32; 4], usize) {
    move_blades(scene, frame);
    let stats = *scene.step().unwrap();
    let counts = [
        stats.cuts,
        stats.failed_cuts,
        stats.sleeping_bodies,
        stats.woken,
    ];
    (states(scene), counts, stats.contacts)
}

#[test]
fn a_loaded_scene_goes_on_with_the_same_bits() {
    let mut scene = busy([2, 3, 2], &PatchParams::default());
    let before: Vec<_> = (0..BUSY_FRAMES)
        .map(|frame| step(&mut scene, frame))
        .collect();
    let touching = before.iter().filter(|(_, _, contacts)| *contacts > 0);
    assert!(touching.count() > 20, "bodies touch");
    let bodies: Vec<_> = scene.bodies().collect();
    let pieces = |i: usize| scene.body(bodies[i]).unwrap().pieces().len();
    assert!(pieces(0) > 1 && pieces(1) > 1, "two bodies are cut");
    assert!(scene.is_asleep(bodies[2]).unwrap(), "one body sleeps");
    let blade = scene.blades().nth(1).unwrap();
    let incision = scene.incision(blade, bodies[3]).unwrap();
    assert!(incision.unwrap().is_inside(), "a blade is in a body");
    let bytes = scene.save().unwrap();
    let frames = BUSY_FRAMES..BUSY_FRAMES + 100;
    let expected: Vec<_> = frames
        .clone()
        .map(|frame| step(&mut scene, frame))
        .collect();
    let cuts: u32 = expected.iter().map(|(_, counts, _)| counts[0]).sum();
    assert!(cuts > 3, "the scene is cut after it was saved, too");
    let last = scene.save().unwrap();
    for threads in [1, 3] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        pool.build().unwrap().install(|| {
            let mut loaded = Scene::load(&bytes).unwrap();
            assert!(
                loaded.save().unwrap() == bytes,
                "a loaded scene is saved alike"
            );
            for (frame, expected) in frames.clone().zip(&expected) {
                let is_equal = step(&mut loaded, frame) == *expected;
                assert!(is_equal, "frame {frame} differs on {threads} threads");
            }
            assert!(
                loaded.save().unwrap() == last,
                "the states are equal to the bit"
            );
        });
    }
}

#[test]
fn a_file_has_all_parts_of_a_scene() {
    let mut scene = Scene::load(&SMALL).unwrap();
    let bodies: Vec<_> = scene.bodies().collect();
    assert_eq!(
        (bodies.len(), scene.blades().count(), scene.colliders.len()),
        (4, 3, 2)
    );
    let body = |i: usize| scene.body(bodies[i]).unwrap();
    assert_eq!(body(0).pieces().len(), 2);
    assert!(
        body(1).surface().channel("color").is_some(),
        "channels are saved"
    );
    assert!(!body(3).solver().pins().is_empty(), "pins are saved");
    for frame in 40..100 {
        move_blades(&mut scene, frame);
        scene.step().unwrap();
    }
    for &id in &bodies {
        let body = scene.body(id).unwrap();
        body.surface().validate().unwrap();
        body.solver().validate(body.surface()).unwrap();
    }
}

/// A field of a saved type that is new, gone, moved or of another type changes the layout.
#[test]
fn the_layout_is_that_of_its_version() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/contract/save/layout.txt");
    let stored = std::fs::read_to_string(&path).unwrap_or_default();
    let version = format!("format version {FORMAT_VERSION}");
    let is_same_version = stored.lines().next() == Some(&version);
    let expected: Lines = stored.lines().skip(1).map(str::to_owned).collect();
    let found: Lines = sample_layouts();
    let different: Vec<_> = found.symmetric_difference(&expected).collect();
    if std::env::var_os("INCISE_UPDATE").is_some() && !is_same_version {
        let lines = found.iter().map(|line| format!("{line}\n"));
        let text = format!("{version}\n{}", lines.collect::<String>());
        std::fs::write(&path, text).unwrap();
        return;
    }
    assert!(
        is_same_version && different.is_empty(),
        "saved states have another layout than {path:?}, see `save.rs`: {different:#?}"
    );
}

/// Returns the layout of scenes that together have a value of most types.
///
/// A type without a value in any of them leaves no trace; add a scene for a new one.
fn sample_layouts() -> Lines {
    let mut lines: Lines = [hanging(second_order()), overlapping(), cut_solid()]
        .iter()
        .flat_map(layout)
        .collect();
    let mut scene = busy([1, 1, 1], &SMALL_PATCHES);
    for frame in 0..BUSY_FRAMES + 30 {
        step(&mut scene, frame);
        if frame % 10 == 0 {
            lines.extend(layout(&scene));
        }
    }
    lines
}

/// Sets length and checksum of a header to those of its content.
fn seal(bytes: &mut [u8]) {
    let length = (bytes.len() - 32) as u64;
    bytes[16..24].copy_from_slice(&length.to_le_bytes());
    let mut hasher = crc32fast::Hasher::new();
    hasher.update(&bytes[..24]);
    hasher.update(&bytes[28..]);
    let sum = hasher.finalize();
    bytes[24..28].copy_from_slice(&sum.to_le_bytes());
}

#[test]
fn headers_are_checked() {
    let bytes = Scene::default().save().unwrap();
    let with = |at: usize, byte: u8| {
        let mut bytes = bytes.clone();
        bytes[at] = byte;
        Scene::load(&bytes).err()
    };
    let error = |error: ArchiveError| Some(LoadError::Archive(error));
    assert_eq!(with(0, 0), error(ArchiveError::UnknownFormat));
    assert_eq!(Scene::load(&[]).err(), error(ArchiveError::UnknownFormat));
    let other = with(12, 99).map(|error| error.to_string());
    let (version, program) = (FORMAT_VERSION, env!("CARGO_PKG_VERSION"));
    let expected = format!(
        "the file has format version 99 and this program reads version {version}; load it with \
         incise {program}, which wrote it"
    );
    assert_eq!(other, Some(expected));
    assert_eq!(with(40, bytes[40] ^ 1), error(ArchiveError::WrongChecksum));
    let short = Scene::load(&bytes[..bytes.len() - 1]).err();
    assert!(matches!(
        short,
        Some(LoadError::Archive(ArchiveError::WrongLength { .. }))
    ));
    let surface = icosphere(1, 0.5).save().unwrap();
    let kind = Scene::load(&surface).err();
    assert!(matches!(
        kind,
        Some(LoadError::Archive(ArchiveError::WrongKind { .. }))
    ));
}

/// Loads a file and steps the scene, if it loads; returns whether it does.
fn load_and_step(bytes: &[u8], params: SceneParams) -> bool {
    let Ok(mut scene) = Scene::load(bytes) else {
        return false;
    };
    // Parameters are public fields; huge numbers of substeps would take hours.
    scene.params = params;
    for frame in 40..43 {
        move_blades(&mut scene, frame);
        // A typed error ends the scene.
        if scene.step().is_err() {
            break;
        }
    }
    true
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(512))]

    /// The checksum is right, so that the content is decoded and validated.
    #[test]
    fn damaged_files_are_errors_or_scenes(
        changes in prop::collection::vec((any::<prop::sample::Index>(), 1..=u8::MAX), 1..4),
        end in prop::option::weighted(0.1, any::<prop::sample::Index>()),
    ) {
        let mut bytes = SMALL.to_vec();
        let length = bytes.len() - 32;
        for (at, by) in changes {
            bytes[32 + at.index(length)] ^= by;
        }
        if let Some(end) = end {
            bytes.truncate(32 + end.index(length));
        }
        seal(&mut bytes);
        load_and_step(&bytes, small_params());
    }
}

/// Returns the parameters of [`small`].
fn small_params() -> SceneParams {
    Scene::load(&SMALL).unwrap().params
}

#[test]
fn one_changed_byte_anywhere_is_an_error_or_a_scene() {
    let params = small_params();
    let mut loaded = 0;
    let changes = [0x01, 0x80, 0xff].into_iter().cycle();
    for (at, by) in (32..SMALL.len()).step_by(331).zip(changes) {
        let mut bytes = SMALL.to_vec();
        bytes[at] ^= by;
        seal(&mut bytes);
        loaded += u32::from(load_and_step(&bytes, params));
    }
    assert!(loaded > 0, "changed coordinates are valid");
}

/// Histories of second order are validated, too.
#[test]
fn one_changed_byte_of_a_solver_is_an_error_or_a_solver() {
    let params = second_order();
    let (mut surface, mut solver) = swinging(1);
    for frame in 0..4 {
        if frame == 3 {
            let last = surface.topology().vertices().last().unwrap();
            solver.pin(&mut surface, last).unwrap();
        }
        solver.step(&mut surface, 1.0 / 60.0, &params).unwrap();
    }
    let bytes = solver.save(&surface).unwrap();
    let mut loaded = 0;
    let changes = [0x01, 0x80, 0xff].into_iter().cycle();
    for (at, by) in (32..bytes.len()).step_by(7).zip(changes) {
        let mut bytes = bytes.clone();
        bytes[at] ^= by;
        seal(&mut bytes);
        if let Ok((mut surface, mut solver)) = Solver::load(&bytes) {
            loaded += 1;
            // A typed error is allowed.
            let _ = solver.step(&mut surface, 1.0 / 60.0, &params);
        }
    }
    assert!(loaded > 0, "changed coordinates are valid");
}

#[test]
fn a_surface_is_saved_with_all_arrays() {
    let mut scene = small();
    let cut = scene.bodies().nth(1).unwrap();
    let surface = scene.body(cut).unwrap().surface();
    let loaded = Surface::load(&surface.save().unwrap()).unwrap();
    assert_eq!(&loaded, surface);
    assert_eq!(loaded.fingerprint(), surface.fingerprint());
    // A surface that is not finite is refused before it is written.
    let (_, surface) = scene.edit(cut).unwrap().solver_mut();
    let vertex = surface.topology().vertices().next().unwrap();
    surface.positions_mut()[vertex.index()][0] = f32::NAN;
    assert!(matches!(surface.save(), Err(ArchiveError::Surface(_))));
    let error = SceneError::PositionNotFinite { body: cut, vertex };
    assert_eq!(scene.save(), Err(SaveError::Scene(error)));
}

/// Returns a ball with an energy, which swings on a pin, and its solver.
fn swinging(level: u32) -> (Surface, Solver) {
    let mut surface = icosphere(level, 0.5);
    let material = Material {
        stretch: Stiffness::Compliance(1e-4),
        bending: Some(Stiffness::Compliance(1e-2)),
        ..Material::default()
    };
    let mut solver = Solver::new(&mut surface, &material).unwrap();
    let top = surface.topology().vertices().next().unwrap();
    solver.pin(&mut surface, top).unwrap();
    (surface, solver)
}

/// A solver is saved in every frame, also after an edit of pins, and steps on beside its copy.
#[test]
fn second_order_solvers_go_on_with_the_same_bits() {
    let params = second_order().with_substeps(1.0 / 60.0, 2);
    let (mut surface, mut solver) = swinging(3);
    for frame in 0..60 {
        if frame == 5 {
            let last = surface.topology().vertices().last().unwrap();
            solver.pin(&mut surface, last).unwrap();
        }
        let bytes = solver.save(&surface).unwrap();
        let (mut other_surface, mut other) = Solver::load(&bytes).unwrap();
        assert!(
            other.save(&other_surface).unwrap() == bytes,
            "saved alike in frame {frame}"
        );
        solver.step(&mut surface, 1.0 / 60.0, &params).unwrap();
        other.step(&mut other_surface, 1.0 / 60.0, &params).unwrap();
        assert_eq!(
            surface.positions(),
            other_surface.positions(),
            "frame {frame}"
        );
        assert_eq!(solver.velocities(), other.velocities(), "frame {frame}");
    }
}

/// Returns parameters of second order.
fn second_order() -> SolverParams {
    SolverParams {
        integrator: Integrator::Bdf2,
        ..SolverParams::default()
    }
}
