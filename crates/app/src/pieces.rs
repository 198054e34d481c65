//! The pieces of a body as files.

use crate::failure::Failure;
use crate::json::lossy;
use incise_mesh::{Surface, write_obj};
use serde::Serialize;
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

/// Writes every piece, after looking whether all of them can be: a refusal leaves nothing behind.
pub(crate) fn write(surface: &Surface, input: &Path, folder: &Path) -> Result<Vec<Piece>, Failure> {
    let parts: Vec<(u32, Surface)> = (0..surface.piece_bound())
        .map(|piece| (piece, surface.extract_piece(piece)))
        .filter(|(_, part)| part.topology().triangle_count() > 0)
        .collect();
    let file = |i: usize| folder.join(format!("piece_{i:03}.obj"));
    let check = || (0..parts.len()).try_for_each(|i| check_target(&file(i), input));
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
    Ok(pieces)
}

/// Refuses a folder and the input, whatever way leads there.
fn check_target(path: &Path, input: &Path) -> Result<(), Failure> {
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

/// A line a piece.
pub(crate) fn print(pieces: &[Piece], out: &mut impl Write) -> io::Result<()> {
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
    Ok(())
}
