//! The exported functions called from Rust, and rules of the crate that no compiler checks.

use incise_c::exports::{cut, cut_result, mesh};
use incise_c::{Status, incise_live_handles};
use std::mem::MaybeUninit;
use std::path::Path;
use std::ptr::{null, null_mut};

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
