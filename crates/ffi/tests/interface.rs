//! The exported functions called from Rust, and rules of the crate that no compiler checks.

use incise_c::exports::{bodies, cut, cut_result, mesh, parameters, scene};
use incise_c::{Status, incise_live_handles};
use std::ffi::{CStr, CString};
use std::mem::MaybeUninit;
use std::path::Path;
use std::ptr::{null, null_mut};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Held by tests that make objects, since one of them counts all that are alive.
static OBJECTS: Mutex<()> = Mutex::new(());

fn objects() -> MutexGuard<'static, ()> {
    OBJECTS.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Calls a function that writes a value, and returns the value.
fn get<T>(call: impl FnOnce(Option<&mut MaybeUninit<T>>) -> Status) -> Result<T, Status> {
    let mut value = MaybeUninit::uninit();
    match call(Some(&mut value)) {
        // SAFETY: a function that succeeds has written its result.
        Status::Ok => Ok(unsafe { value.assume_init() }),
        status => Err(status),
    }
}

#[test]
fn a_cut_has_pieces_whose_volumes_sum_to_that_of_the_body() {
    let _alone = objects();
    let name = c"Sphere768".as_ptr();
    // SAFETY: the pointers are those of live values, or NULL where that is allowed.
    unsafe {
        let body = get(|out| mesh::incise_mesh_model(name, out)).expect("a model");
        let normal = [0.0, 1.0, 0.3];
        let normal = normal.as_ptr();
        let result = get(|out| cut::incise_mesh_cut_plane(body, normal, 0.1, None, out));
        let result = result.expect("a cut");
        let report = get(|out| cut_result::incise_cut_result_report(result, out)).expect("live");
        assert_eq!((report.pieces, report.steps), (2, 1));
        let volume = |of| {
            get(|out| mesh::incise_mesh_measure(of, out))
                .expect("live")
                .volume
        };
        let mut sum = 0.0;
        for i in 0..report.pieces {
            let piece = get(|out| cut_result::incise_cut_result_piece(result, i, out));
            let piece = piece.expect("a piece");
            sum += volume(piece);
            assert_eq!(mesh::incise_mesh_free(piece), Status::Ok);
        }
        let error = (sum - volume(body)).abs();
        assert!(error <= report.moved_volume + 1e-7, "{error}");
        let mut faces = vec![0; 3 * report.faces as usize];
        let whole = get(|out| cut_result::incise_cut_result_mesh(result, out)).expect("live");
        let copy = |capacity, out| mesh::incise_mesh_faces(whole, out, capacity);
        assert_eq!(
            copy(faces.len() - 1, faces.as_mut_ptr()),
            Status::BufferTooSmall
        );
        assert_eq!(copy(faces.len(), null_mut()), Status::NullPointer);
        assert_eq!(copy(faces.len(), faces.as_mut_ptr()), Status::Ok);
        assert!(faces.iter().all(|&v| v < report.vertices));
        assert_eq!(mesh::incise_mesh_free(whole), Status::Ok);
        assert_eq!(cut_result::incise_cut_result_free(result), Status::Ok);
        assert_eq!(
            cut_result::incise_cut_result_free(result),
            Status::InvalidHandle
        );
        let none = get(|out| mesh::incise_mesh_model(null(), out));
        assert_eq!(none.err(), Some(Status::NullPointer));
        assert_eq!(mesh::incise_mesh_free(body), Status::Ok);
    }
    assert_eq!(incise_live_handles(), 0, "all were freed");
}

#[test]
fn parameters_are_set_and_read_by_name() {
    let _alone = objects();
    // SAFETY: the pointers are those of live values, or NULL where that is allowed.
    unsafe {
        let scene = get(|out| scene::incise_scene_new(None, out)).expect("a scene");
        let number =
            |name: &CStr| get(|out| parameters::incise_scene_get_number(scene, name.as_ptr(), out));
        let set = |name: &CStr, value: &CStr| {
            parameters::incise_scene_set(scene, name.as_ptr(), value.as_ptr())
        };
        let set_number =
            |name: &CStr, value| parameters::incise_scene_set_number(scene, name.as_ptr(), value);
        assert_eq!(number(c"solver.substep"), Ok(0.001_388_888_9));
        assert_eq!(set_number(c"substep", 0.002), Status::Ok);
        assert_eq!(set(c"solver.residual", c"1e-6"), Status::Ok);
        assert_eq!(set(c"gravity", c"0,-1,0"), Status::Ok);
        assert_eq!(set(c"integrator", c"bdf2"), Status::Ok);
        assert_eq!(set_number(c"contacts.enabled", 1.0), Status::Ok);
        for (name, value) in [
            (c"substep", c"0"),
            (c"integrator", c"fast"),
            (c"substeps", c"1"),
        ] {
            assert_eq!(set(name, value), Status::InvalidArgument, "{name:?}");
        }
        // The struct does not have the residual, which stays.
        let params = get(|out| scene::incise_scene_params_init(out)).expect("defaults");
        assert_eq!(
            scene::incise_scene_set_params(scene, Some(&params)),
            Status::Ok
        );
        assert_eq!(number(c"substep"), Ok(0.001_388_888_9));
        assert_eq!(number(c"contacts.enabled"), Ok(0.0));
        assert_eq!(number(c"solver.residual"), Ok(1e-6));
        assert_eq!(number(c"integrator").err(), Some(Status::InvalidArgument));
        let text = |name: &CStr| {
            let (mut text, mut length) = ([0; 64], MaybeUninit::uninit());
            let out = text.as_mut_ptr();
            let status = parameters::incise_scene_get(
                scene,
                name.as_ptr(),
                out,
                text.len(),
                Some(&mut length),
            );
            assert_eq!(status, Status::Ok);
            CStr::from_ptr(text.as_ptr())
                .to_str()
                .expect("UTF-8")
                .to_owned()
        };
        // A value of several parts is a text that is accepted again.
        let level = || text(c"cut.refine.level");
        let named = level();
        assert_eq!(set(c"cut.refine.level", c"0.7"), Status::Ok);
        let number = CString::new(level()).expect("no NUL");
        assert_eq!(set(c"cut.refine.level", c"original"), Status::Ok);
        assert_eq!(level(), named);
        assert_eq!(set(c"cut.refine.level", &number), Status::Ok);
        assert_eq!(level().as_bytes(), number.as_bytes());
        let statistic =
            |name: &CStr| get(|out| scene::incise_scene_statistic(scene, name.as_ptr(), out));
        assert_eq!(scene::incise_scene_step(scene, None), Status::Ok);
        assert_eq!(statistic(c"cuts"), Ok(0.0));
        assert_eq!(statistic(c"fell_back"), Ok(0.0));
        assert!(statistic(c"seconds.total").is_ok_and(|seconds| seconds > 0.0));
        assert_eq!(statistic(c"cats").err(), Some(Status::InvalidArgument));
        assert_eq!(text(c"integrator"), "bdf2");
        assert_eq!(text(c"cut.caps"), "bodies");
        let ball = get(|out| mesh::incise_mesh_model(c"Sphere80".as_ptr(), out)).expect("a model");
        let body =
            get(|out| bodies::incise_scene_add_body(scene, ball, None, out)).expect("a body");
        let friction = c"friction".as_ptr();
        let set = |value| parameters::incise_body_set_number(scene, body, friction, value);
        assert_eq!(set(0.25), Status::Ok);
        assert_eq!(set(-1.0), Status::Simulation);
        let read = get(|out| parameters::incise_body_get_number(scene, body, friction, out));
        assert_eq!(read, Ok(0.25));
        let pressure = c"volume.pressure".as_ptr();
        let set = parameters::incise_body_set(scene, body, pressure, c"1.5".as_ptr());
        assert_eq!(set, Status::Ok);
        assert_eq!(mesh::incise_mesh_free(ball), Status::Ok);
        assert_eq!(scene::incise_scene_free(scene), Status::Ok);
    }
}

/// Returns the source files of the crate with their paths from `src`.
fn sources() -> Vec<(String, String)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut folders = vec![root.clone()];
    let mut files = Vec::new();
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).expect("a folder of the crate") {
            let path = entry.expect("readable").path();
            if path.is_dir() {
                folders.push(path);
                continue;
            }
            let text = std::fs::read_to_string(&path).expect("UTF-8");
            let name = path
                .strip_prefix(&root)
                .expect("below the root")
                .to_string_lossy();
            files.push((name.replace('\\', "/"), text));
        }
    }
    files
}

#[test]
fn pointers_are_dereferenced_in_one_module_and_arrive_in_another() {
    for (name, text) in sources() {
        let is_exempt = name == "memory.rs" || name.starts_with("exports/");
        for line in text
            .lines()
            .filter(|line| !line.trim_start().starts_with("//"))
        {
            let other = line.replace("#[unsafe(no_mangle)]", "");
            assert!(is_exempt || !other.contains("unsafe"), "{name}: {line}");
            let is_dereference = ["from_raw_parts", "CStr::from_ptr", "copy_nonoverlapping"]
                .iter()
                .any(|function| other.contains(function));
            assert!(name == "memory.rs" || !is_dereference, "{name}: {line}");
        }
    }
}

#[test]
fn the_header_declares_every_exported_function() {
    let header = include_str!("../include/incise.h");
    let mut count = 0;
    for (name, text) in sources() {
        for part in text.split("extern \"C\" fn ").skip(1) {
            let function = part.split('(').next().unwrap_or_default();
            let is_declared = header.contains(&format!("{function}("));
            assert!(
                is_declared,
                "{function} of {name}: make the header again, see the README"
            );
            count += 1;
        }
    }
    assert!(count > 50, "{count} functions");
}
