//! The pieces of a body as files.

use crate::failure::Failure;
use crate::json::lossy;
use incise_mesh::{Surface, write_obj};
use serde::Serialize;
use std::ffi::OsStr;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// A piece as it was written.
#[derive(Serialize)]
pub(crate) struct Piece {
    #[serde(serialize_with = "lossy")]
    file: PathBuf,
    vertices: usize,
    triangles: usize,
    area: f64,
    /// Negative when the piece is a cavity.
    volume: f64,
    /// Whether it bounds a hole inside another piece: its normals point inward.
    cavity: bool,
}

/// What was done to the output folder.
pub(crate) struct Written {
    pub(crate) pieces: Vec<Piece>,
    /// Pieces of an earlier run that are there no more.
    pub(crate) removed: Vec<PathBuf>,
}

/// Writes every piece, after looking whether all of them can be: a refusal leaves nothing behind. Then
/// removes pieces of an earlier run that had more of them: else the folder would hold parts of two bodies.
pub(crate) fn write(surface: &Surface, input: &Path, folder: &Path) -> Result<Written, Failure> {
    let parts: Vec<(u32, Surface)> = surface.extract_pieces().collect();
    let file = |i: usize| folder.join(format!("piece_{i:03}.obj"));
    let check = || {
        let left_over = left_over(folder, parts.len()).into_iter();
        let mut targets = (0..parts.len()).map(file).chain(left_over);
        targets.try_for_each(|path| check_target(&path, input))
    };
    check()?;
    std::fs::create_dir_all(folder).map_err(|source| Failure::Folder {
        path: folder.to_owned(),
        source,
    })?;
    // A path like `new/..` leads nowhere until `new` is there.
    check()?;
    let volumes = surface.piece_volumes();
    let mut pieces = Vec::with_capacity(parts.len());
    for (i, (piece, part)) in parts.iter().enumerate() {
        write_obj(&file(i), part)?;
        let volume = volumes[*piece as usize];
        pieces.push(Piece {
            file: file(i),
            vertices: part.topology().vertex_count(),
            triangles: part.topology().triangle_count(),
            area: part.area(),
            volume,
            cavity: volume < 0.0,
        });
    }
    let removed = left_over(folder, parts.len());
    for path in &removed {
        std::fs::remove_file(path).map_err(|source| Failure::Remove {
            path: path.clone(),
            source,
        })?;
    }
    Ok(Written { pieces, removed })
}

/// Files of the folder that have a piece's name with a number from `count` on.
fn left_over(folder: &Path, count: usize) -> Vec<PathBuf> {
    // A folder that is not there yet has none.
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let of_piece = entries.filter(|entry| {
        let name = entry.file_name();
        let is_file = entry.file_type().is_ok_and(|kind| kind.is_file());
        is_file && piece_number(&name).is_some_and(|number| number >= count)
    });
    let mut paths: Vec<PathBuf> = of_piece.map(|entry| entry.path()).collect();
    paths.sort();
    paths
}

/// The number in a name that this program gives to a piece.
fn piece_number(name: &OsStr) -> Option<usize> {
    let name = name.to_str()?;
    let digits = name.strip_prefix("piece_")?.strip_suffix(".obj")?;
    let number: usize = digits.parse().ok()?;
    // Nothing else that reads as a number, such as +12 or 0012.
    (digits == format!("{number:03}")).then_some(number)
}

/// Refuses a folder and the input, whatever way leads there.
pub(crate) fn check_target(path: &Path, input: &Path) -> Result<(), Failure> {
    let path = path.to_owned();
    // What is not there yet, or cannot be looked at, is left to the writer.
    let Ok(target) = path.canonicalize() else {
        return Ok(());
    };
    if target.is_dir() {
        return Err(Failure::TargetIsFolder { path });
    }
    if input.canonicalize().is_ok_and(|input| input == target) {
        return Err(Failure::TargetIsInput { path });
    }
    Ok(())
}

/// A line a piece, and what became of those of an earlier run.
pub(crate) fn print(pieces: &[Piece], removed: &[PathBuf], out: &mut impl Write) -> io::Result<()> {
    for piece in pieces {
        writeln!(
            out,
            "  {}: {} vertices, {} triangles, area {:.6e}, volume {:.6e}{}",
            piece.file.display(),
            piece.vertices,
            piece.triangles,
            piece.area,
            piece.volume,
            if piece.cavity { ", a cavity" } else { "" }
        )?;
    }
    for path in removed {
        writeln!(out, "  {}: of an earlier run, removed", path.display())?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_names_of_pieces_have_a_number() {
        let number = |name: &str| piece_number(OsStr::new(name));
        for (name, expected) in [
            ("piece_000.obj", 0),
            ("piece_012.obj", 12),
            ("piece_1234.obj", 1234),
        ] {
            assert_eq!(number(name), Some(expected), "{name}");
        }
        for name in [
            "piece_0012.obj",
            "piece_12.obj",
            "piece_+12.obj",
            "piece_.obj",
            "piece_012.ply",
            "my_piece_012.obj",
            "piece_012.obj.7.part",
        ] {
            assert_eq!(number(name), None, "{name}");
        }
    }
}
