//! Scenes: parameters, colliders, blades, frames and undo.

use crate::exports::parameters::number;
use crate::handles::{insert, remove, with};
use crate::memory::{count, fixed, input, output, output_bytes, output_text, put, text};
use crate::params::{Collider, SceneParams};
use crate::simulation::{Scene, SceneObject};
use crate::status::{Error, Status, call};
use incise::cut;
use incise::params::Report;
use incise::scene;
use std::ffi::c_char;
use std::mem::MaybeUninit;

/// Counters and times of a frame.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct FrameStats {
    /// Number of blades that moved.
    pub sweeps: u32,
    /// Number of sweeps that met no body.
    pub missed_sweeps: u32,
    /// Number of cuts.
    pub cuts: u32,
    /// Number of refused cuts, see `incise_scene_failed_cuts`.
    pub failed_cuts: u32,
    /// Number of contacts.
    pub contacts: u32,
    /// Number of sleeping bodies.
    pub sleeping_bodies: u32,
    /// Time of finding and making cuts in seconds.
    pub cut_seconds: f64,
    /// Time of finding contacts in seconds.
    pub contact_seconds: f64,
    /// Time of the solver in seconds.
    pub solver_seconds: f64,
}

/// Where a blade is after its last step in a body.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum IncisionState {
    /// Outside of the body, and it has cut nothing since it was inside.
    Outside = 0,
    /// At the tip of its cut in the body, or behind it on the way in, which begins outside.
    Inside = 1,
    /// Ahead of the tip, because the last step was refused. It is tried again from the same tip.
    Blocked = 2,
    /// Outside, and its cut is complete.
    Finished = 3,
    /// Outside, and the tip of its cut is in the body.
    Abandoned = 4,
}

impl From<cut::IncisionState> for IncisionState {
    fn from(state: cut::IncisionState) -> Self {
        match state {
            cut::IncisionState::Outside => Self::Outside,
            cut::IncisionState::Inside => Self::Inside,
            cut::IncisionState::Blocked => Self::Blocked,
            cut::IncisionState::Finished => Self::Finished,
            cut::IncisionState::Abandoned => Self::Abandoned,
        }
    }
}

/// The incision of a blade in a body.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Incision {
    /// Where the blade is after its last step.
    pub state: IncisionState,
    /// Number of refused steps since the last one that cut.
    pub refused_steps: u32,
}

/// Writes the default parameters of scenes.
#[unsafe(no_mangle)]
pub extern "C" fn incise_scene_params_init(out: Option<&mut MaybeUninit<SceneParams>>) -> Status {
    call(|| {
        put(
            out,
            SceneParams::from(&scene::SceneParams::default()),
            "out",
        )
    })
}

/// Makes an empty scene. `params` may be NULL for the defaults. Free it with `incise_scene_free`.
#[unsafe(no_mangle)]
pub extern "C" fn incise_scene_new(
    params: Option<&SceneParams>,
    out: Option<&mut MaybeUninit<*mut Scene>>,
) -> Status {
    call(|| {
        let defaults = SceneParams::from(&scene::SceneParams::default());
        let Some(out) = out else {
            return Err(Error::null("out"));
        };
        out.write(insert(SceneObject::new(params.unwrap_or(&defaults))?));
        Ok(())
    })
}

/// Frees a scene with its bodies; NULL is allowed.
#[unsafe(no_mangle)]
pub extern "C" fn incise_scene_free(scene: *mut Scene) -> Status {
    call(|| remove::<SceneObject>(scene))
}

/// Saves a scene: bodies, blades, colliders and parameters, without the undoable cuts.
///
/// `length` gets the number of bytes. With a `capacity` of 0 nothing is copied.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn incise_scene_save(
    scene: *mut Scene,
    out: *mut u8,
    capacity: usize,
    length: Option<&mut MaybeUninit<usize>>,
) -> Status {
    call(|| {
        with(scene, |scene: &mut SceneObject| {
            let bytes = scene.scene.save()?;
            // SAFETY: the caller's contract, see the README.
            unsafe { output_bytes(&bytes, out, capacity, length) }
        })
    })
}

/// Makes a scene of the bytes of `incise_scene_save`, on the CPU. It goes on with the same bits.
///
/// Bodies and blades keep their indices. The undo limit is that of `incise_scene_params_init`. Free
/// it with `incise_scene_free`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn incise_scene_load(
    bytes: *const u8,
    length: usize,
    out: Option<&mut MaybeUninit<*mut Scene>>,
) -> Status {
    call(|| {
        // SAFETY: the caller's contract, see the README.
        let bytes = unsafe { input(bytes, length, "bytes")? };
        let out = out.ok_or_else(|| Error::null("out"))?;
        out.write(insert(SceneObject::load(bytes)?));
        Ok(())
    })
}

/// Sets the parameters from the next frame on; one out of range is an error, and nothing changes.
#[unsafe(no_mangle)]
pub extern "C" fn incise_scene_set_params(
    scene: *mut Scene,
    params: Option<&SceneParams>,
) -> Status {
    call(|| {
        let params = params.ok_or_else(|| Error::null("params"))?;
        with(scene, |scene: &mut SceneObject| scene.set_params(params))
    })
}

/// Replaces all colliders. Those of a list of the same length move to their new places in the next
/// frame. One that is no solid shape is an error, and nothing changes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn incise_scene_set_colliders(
    scene: *mut Scene,
    colliders: *const Collider,
    collider_count: usize,
) -> Status {
    call(|| {
        // SAFETY: the caller's contract, see the README.
        let colliders = unsafe { input(colliders, collider_count, "colliders")? };
        let checked = |(number, collider): (usize, &Collider)| collider.check(number);
        let colliders = colliders.iter().enumerate().map(checked);
        let colliders = colliders.collect::<Result<Vec<_>, Error>>()?;
        with(scene, |scene: &mut SceneObject| {
            scene.scene.colliders = colliders;
            Ok(())
        })
    })
}

/// Writes the point to which all coordinates of a scene are relative: 3 numbers (meters).
///
/// It is the origin of the bodies, see `incise_mesh_measure`, and zero without bodies.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn incise_scene_origin(scene: *mut Scene, out: *mut f64) -> Status {
    call(|| {
        with(scene, |scene: &mut SceneObject| {
            // SAFETY: the caller's contract, see the README.
            unsafe { output(&scene.scene.origin(), out, 3, "out") }
        })
    })
}

/// Adds a blade with its edge from start to end: 6 floats (meters). `out` gets its index.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn incise_scene_add_blade(
    scene: *mut Scene,
    edge: *const f32,
    out: Option<&mut MaybeUninit<u32>>,
) -> Status {
    call(|| {
        // SAFETY: the caller's contract, see the README.
        let edge = unsafe { fixed(edge, "edge")? };
        let out = out.ok_or_else(|| Error::null("out"))?;
        with(scene, |scene: &mut SceneObject| {
            out.write(scene.add_blade(edge)?);
            Ok(())
        })
    })
}

/// Moves the edge of a blade; the next frame cuts along its sweep.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn incise_scene_move_blade(
    scene: *mut Scene,
    blade: u32,
    edge: *const f32,
) -> Status {
    call(|| {
        // SAFETY: the caller's contract, see the README.
        let edge = unsafe { fixed(edge, "edge")? };
        with(scene, |scene: &mut SceneObject| {
            scene.move_blade(blade, edge, true)
        })
    })
}

/// Moves the edge of a blade without cutting, and ends its incisions.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn incise_scene_teleport_blade(
    scene: *mut Scene,
    blade: u32,
    edge: *const f32,
) -> Status {
    call(|| {
        // SAFETY: the caller's contract, see the README.
        let edge = unsafe { fixed(edge, "edge")? };
        with(scene, |scene: &mut SceneObject| {
            scene.move_blade(blade, edge, false)
        })
    })
}

/// Writes the incision of a blade in a body: whether the blade is inside, and refused steps.
///
/// A blade that has cut nothing, or whose incisions have ended, is outside.
#[unsafe(no_mangle)]
pub extern "C" fn incise_scene_incision(
    scene: *mut Scene,
    blade: u32,
    body: u32,
    out: Option<&mut MaybeUninit<Incision>>,
) -> Status {
    call(|| {
        with(scene, |scene: &mut SceneObject| {
            let incision = scene.incision(blade, body)?;
            let state = incision.map(cut::Incision::state).unwrap_or_default();
            let values = Incision {
                state: state.into(),
                refused_steps: incision.map_or(0, cut::Incision::refused_steps),
            };
            put(out, values, "out")
        })
    })
}

/// Gives a blade a face that bodies collide with: the vector from its edge to its back, 3 floats
/// (meters). NULL removes the face.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn incise_scene_set_blade_face(
    scene: *mut Scene,
    blade: u32,
    face: *const f32,
) -> Status {
    call(|| {
        let face = match face.is_null() {
            true => None,
            // SAFETY: the caller's contract, see the README.
            false => Some(unsafe { fixed(face, "face")? }),
        };
        with(scene, |scene: &mut SceneObject| {
            scene.set_blade_face(blade, face)
        })
    })
}

/// Steps by one frame: cuts along the sweeps of blades, then moves the bodies.
///
/// A refused cut is no error, see `incise_scene_failed_cuts`. `out` may be NULL.
#[unsafe(no_mangle)]
pub extern "C" fn incise_scene_step(
    scene: *mut Scene,
    out: Option<&mut MaybeUninit<FrameStats>>,
) -> Status {
    call(|| {
        with(scene, |scene: &mut SceneObject| {
            scene.step()?;
            let stats = scene.scene.stats();
            let stats = FrameStats {
                sweeps: stats.sweeps,
                missed_sweeps: stats.missed_sweeps,
                cuts: stats.cuts,
                failed_cuts: stats.failed_cuts,
                contacts: count(stats.contacts),
                sleeping_bodies: stats.sleeping_bodies,
                cut_seconds: stats.cutting().as_secs_f64(),
                contact_seconds: stats.contact_detection.as_secs_f64(),
                solver_seconds: stats.solver.as_secs_f64(),
            };
            match out {
                Some(_) => put(out, stats, "out"),
                None => Ok(()),
            }
        })
    })
}

/// Writes a counter or a time of the last frame by name, such as `"bvh_refits"` or
/// `"seconds.solver"`; 1 or 0 for true and false. `docs/parameters.md` lists them.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn incise_scene_statistic(
    scene: *mut Scene,
    name: *const c_char,
    out: Option<&mut MaybeUninit<f64>>,
) -> Status {
    call(|| {
        // SAFETY: the caller's contract, see the README.
        let name = unsafe { text(name, "name")? };
        with(scene, |scene: &mut SceneObject| {
            put(out, number(name, &scene.scene.stats().get(name)?)?, "out")
        })
    })
}

/// Copies a line for each cut that was refused in the last frame; see `incise_mesh_warnings` for
/// the arguments.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn incise_scene_failed_cuts(
    scene: *mut Scene,
    out: *mut c_char,
    capacity: usize,
    length: Option<&mut MaybeUninit<usize>>,
) -> Status {
    call(|| {
        with(scene, |scene: &mut SceneObject| {
            // SAFETY: the caller's contract, see the README.
            unsafe { output_text(&scene.failed_cuts(), out, capacity, length) }
        })
    })
}

/// Undoes the last cut of a body, and ends the incisions in it.
///
/// A blade that was inside the body cuts on from its next motion. One frame of a blade in motion is
/// one cut.
#[unsafe(no_mangle)]
pub extern "C" fn incise_scene_undo(scene: *mut Scene, body: u32) -> Status {
    call(|| with(scene, |scene: &mut SceneObject| scene.undo(body)))
}

/// Counts the cuts of a body that can be undone.
#[unsafe(no_mangle)]
pub extern "C" fn incise_scene_undo_count(
    scene: *mut Scene,
    body: u32,
    out: Option<&mut MaybeUninit<u32>>,
) -> Status {
    call(|| {
        with(scene, |scene: &mut SceneObject| {
            put(out, scene.undo_count(body)?, "out")
        })
    })
}
