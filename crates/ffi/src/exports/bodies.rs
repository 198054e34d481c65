//! Bodies of scenes: adding, counts, copies, pins and rays.

use crate::handles::with;
use crate::memory::{check_finite, count, fixed, output, put};
use crate::mesh::{Mesh, MeshObject, faces};
use crate::params::Material;
use crate::simulation::{Scene, SceneObject};
use crate::status::{Error, Status, call};
use incise::mesh::{Surface, TriangleId, Vec3};
use incise::scene::{Body, SceneError};
use std::mem::MaybeUninit;

/// Counts of a body.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct BodyCounts {
    /// Number of vertices: rows of 3 floats of `incise_body_positions`. Cuts leave some unused.
    pub vertices: u32,
    /// Number of triangles: rows of 3 indices of `incise_body_faces`.
    pub faces: u32,
    /// Rows of 2 floats of `incise_body_uv`: three per triangle, or 0.
    pub uv: u32,
    /// Number of pieces.
    pub pieces: u32,
    /// 1 if the body sleeps.
    pub asleep: u32,
    /// Changes when a cut or an undo changes the triangles, and only then.
    pub version: u64,
}

/// The first hit of a ray.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct RayHit {
    /// 1 if the ray hits the body; the other fields are 0 otherwise.
    pub hit: u32,
    /// The corner of the hit triangle that is nearest to the point.
    pub vertex: u32,
    /// Distance in lengths of the ray's direction.
    pub distance: f64,
}

/// Writes a material, one of the constants `INCISE_MATERIAL_`.
#[unsafe(no_mangle)]
pub extern "C" fn incise_material_init(
    preset: u32,
    out: Option<&mut MaybeUninit<Material>>,
) -> Status {
    call(|| put(out, Material::preset(preset)?, "out"))
}

/// Adds a copy of a mesh as a body at rest. A `material` of NULL is a soft body, or cloth for a
/// mesh with a boundary. `out` gets the index of the body; indices are not reused.
///
/// All coordinates of a scene are relative to the origin of its first mesh, see
/// `incise_mesh_measure`; others are moved to it.
#[unsafe(no_mangle)]
pub extern "C" fn incise_scene_add_body(
    scene: *mut Scene,
    mesh: *mut Mesh,
    material: Option<&Material>,
    out: Option<&mut MaybeUninit<u32>>,
) -> Status {
    call(|| {
        let material = material.map(Material::check).transpose()?;
        let out = out.ok_or_else(|| Error::null("out"))?;
        let surface = with(mesh, |mesh: &mut MeshObject| Ok(mesh.surface.clone()))?;
        let material = material.unwrap_or_else(|| incise::pbd::Material::for_surface(&surface));
        with(scene, |scene: &mut SceneObject| {
            out.write(scene.add_body(surface, &material)?);
            Ok(())
        })
    })
}

/// Changes the material of a body from the next frame on.
///
/// Refused for another density or other cells, and where bending comes or goes: these are made
/// with the body.
#[unsafe(no_mangle)]
pub extern "C" fn incise_body_set_material(
    scene: *mut Scene,
    body: u32,
    material: Option<&Material>,
) -> Status {
    call(|| {
        let material = material.ok_or_else(|| Error::null("material"))?.check()?;
        with(scene, |scene: &mut SceneObject| {
            let id = scene.body_id(body)?;
            let (solver, surface) = scene.scene.edit(id)?.solver_mut();
            solver
                .set_material(surface, &material)
                .map_err(SceneError::from)?;
            Ok(())
        })
    })
}

/// Removes a body.
#[unsafe(no_mangle)]
pub extern "C" fn incise_scene_remove_body(scene: *mut Scene, body: u32) -> Status {
    call(|| with(scene, |scene: &mut SceneObject| scene.remove_body(body)))
}

/// Counts vertices, triangles and pieces of a body.
#[unsafe(no_mangle)]
pub extern "C" fn incise_body_count(
    scene: *mut Scene,
    body: u32,
    out: Option<&mut MaybeUninit<BodyCounts>>,
) -> Status {
    call(|| {
        with(scene, |scene: &mut SceneObject| {
            let id = scene.body_id(body)?;
            let asleep = scene.scene.is_asleep(id)?;
            let surface = scene.body(body)?.surface();
            let topology = surface.topology();
            let has_uv = !surface.corner_uvs().is_empty();
            let counts = BodyCounts {
                vertices: count(topology.vertex_slots()),
                faces: count(topology.triangle_count()),
                uv: if has_uv {
                    count(3 * topology.triangle_count())
                } else {
                    0
                },
                pieces: count(surface.piece_count()),
                asleep: u32::from(asleep),
                version: surface.fingerprint(),
            };
            put(out, counts, "out")
        })
    })
}

/// Copies the positions of all vertices (meters): 3 floats each. `capacity` counts floats.
///
/// A vertex keeps its index as long as it exists. No triangle refers to an unused one.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn incise_body_positions(
    scene: *mut Scene,
    body: u32,
    out: *mut f32,
    capacity: usize,
) -> Status {
    copy(scene, body, |body| {
        let position = |&[x, y, z, _]: &[f32; 4]| [x, y, z];
        let positions: Vec<[f32; 3]> = body.surface().positions().iter().map(position).collect();
        // SAFETY: the caller's contract, see the README.
        unsafe { output(positions.as_flattened(), out, capacity, "out") }
    })
}

/// Copies all triangles: 3 vertex indices each. `capacity` counts indices.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn incise_body_faces(
    scene: *mut Scene,
    body: u32,
    out: *mut u32,
    capacity: usize,
) -> Status {
    copy(scene, body, |body| {
        // SAFETY: the caller's contract, see the README.
        unsafe { output(faces(body.surface()).as_flattened(), out, capacity, "out") }
    })
}

/// Copies the texture coordinates of all corners of `incise_body_faces`: 2 floats each.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn incise_body_uv(
    scene: *mut Scene,
    body: u32,
    out: *mut f32,
    capacity: usize,
) -> Status {
    copy(scene, body, |body| {
        let surface = body.surface();
        let corners = surface.topology().triangles().flat_map(|t| t.half_edges());
        let uvs = corners.filter_map(|h| surface.corner_uvs().get(h.index()).copied());
        // SAFETY: the caller's contract, see the README.
        unsafe { output(uvs.collect::<Vec<_>>().as_flattened(), out, capacity, "out") }
    })
}

/// Copies the piece number of each triangle of `incise_body_faces`. Numbers need not be
/// consecutive.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn incise_body_face_pieces(
    scene: *mut Scene,
    body: u32,
    out: *mut u32,
    capacity: usize,
) -> Status {
    // SAFETY: the caller's contract, see the README.
    unsafe { copy_of_faces(scene, body, Surface::piece, out, capacity) }
}

/// Copies the material number of each triangle of `incise_body_faces`: `cap_material` of the
/// parameters for caps, else 0 or that of the file.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn incise_body_face_materials(
    scene: *mut Scene,
    body: u32,
    out: *mut u32,
    capacity: usize,
) -> Status {
    // SAFETY: the caller's contract, see the README.
    unsafe { copy_of_faces(scene, body, Surface::material, out, capacity) }
}

/// Copies a body with its present shape to a new mesh without unused vertices.
#[unsafe(no_mangle)]
pub extern "C" fn incise_body_mesh(
    scene: *mut Scene,
    body: u32,
    out: Option<&mut MaybeUninit<*mut Mesh>>,
) -> Status {
    copy(scene, body, |body| {
        crate::exports::mesh::put_new(out, || {
            let mut surface = body.surface().clone();
            surface.compact();
            Ok(MeshObject::new(surface))
        })
    })
}

/// Pins a vertex of a body where it is.
#[unsafe(no_mangle)]
pub extern "C" fn incise_body_pin(scene: *mut Scene, body: u32, vertex: u32) -> Status {
    call(|| {
        with(scene, |scene: &mut SceneObject| {
            let (id, vertex) = (scene.body_id(body)?, scene.vertex(body, vertex)?);
            let (solver, surface) = scene.scene.edit(id)?.solver_mut();
            solver.pin(surface, vertex).map_err(range_error)
        })
    })
}

/// Releases a pinned vertex.
#[unsafe(no_mangle)]
pub extern "C" fn incise_body_unpin(scene: *mut Scene, body: u32, vertex: u32) -> Status {
    call(|| {
        with(scene, |scene: &mut SceneObject| {
            let (id, vertex) = (scene.body_id(body)?, scene.vertex(body, vertex)?);
            let (solver, surface) = scene.scene.edit(id)?.solver_mut();
            solver.unpin(surface, vertex).map_err(range_error)
        })
    })
}

/// Sets where a pinned vertex is at the end of the next frame: 3 floats (meters).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn incise_body_move_pin(
    scene: *mut Scene,
    body: u32,
    vertex: u32,
    position: *const f32,
) -> Status {
    call(|| {
        // SAFETY: the caller's contract, see the README.
        let position: [f32; 3] = unsafe { fixed(position, "position")? };
        check_finite(&position, "position")?;
        with(scene, |scene: &mut SceneObject| {
            let (id, vertex) = (scene.body_id(body)?, scene.vertex(body, vertex)?);
            Ok(scene.scene.set_pin_target(id, vertex, position)?)
        })
    })
}

/// Casts a ray at a body in its present shape. `origin` and `direction` have 3 numbers each
/// (meters).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn incise_body_cast_ray(
    scene: *mut Scene,
    body: u32,
    origin: *const f64,
    direction: *const f64,
    out: Option<&mut MaybeUninit<RayHit>>,
) -> Status {
    call(|| {
        // SAFETY: the caller's contract, see the README.
        let (origin, direction) = unsafe {
            (
                fixed::<f64, 3>(origin, "origin")?,
                fixed::<f64, 3>(direction, "direction")?,
            )
        };
        with(scene, |scene: &mut SceneObject| {
            let id = scene.body_id(body)?;
            let hit = (scene.scene).cast_ray(id, Vec3::from(origin), Vec3::from(direction))?;
            let topology = scene.body(body)?.surface().topology();
            let hit = hit.map(|hit| RayHit {
                hit: 1,
                vertex: topology.triangle(hit.triangle)[hit.nearest_corner()].0,
                distance: hit.distance,
            });
            let none = RayHit {
                hit: 0,
                vertex: 0,
                distance: 0.0,
            };
            put(out, hit.unwrap_or(none), "out")
        })
    })
}

fn copy(scene: *mut Scene, body: u32, copy: impl FnOnce(&Body) -> Result<(), Error>) -> Status {
    call(|| {
        with(scene, |scene: &mut SceneObject| {
            let body = scene.body(body)?;
            copy(body)
        })
    })
}

/// Copies a value of each triangle of `incise_body_faces`.
///
/// # Safety
/// As [`output`].
unsafe fn copy_of_faces(
    scene: *mut Scene,
    body: u32,
    value: impl Fn(&Surface, TriangleId) -> u32,
    out: *mut u32,
    capacity: usize,
) -> Status {
    copy(scene, body, |body| {
        let surface = body.surface();
        let triangles = surface.topology().triangles();
        let values: Vec<u32> = triangles.map(|t| value(surface, t)).collect();
        // SAFETY: the caller's contract.
        unsafe { output(&values, out, capacity, "out") }
    })
}

/// Returns the error of an edit of pins.
fn range_error(error: impl std::fmt::Display) -> Error {
    Error::new(Status::OutOfRange, error)
}
