//! Writes the pieces of bodies: one file each in a folder, or one file of glTF for all.

use crate::failure::Failure;
use crate::format::Format;
use crate::input::boundary_edges;
use crate::json::lossy;
use crate::numbers::counted;
use clap::builder::{PathBufValueParser, TypedValueParser};
use incise_mesh::{Surface, Warning, write_glb};
use serde::Serialize;
use std::ffi::OsStr;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// Returns the parser of a command's output, a file or folder; it refuses `-`.
pub fn output_path() -> impl TypedValueParser<Value = PathBuf> {
    PathBufValueParser::new().try_map(|path| {
        if path == Path::new("-") {
            Err("writing to standard output is not supported; name a file or folder")
        } else {
            Ok(path)
        }
    })
}

/// A written piece.
#[derive(Serialize)]
pub(crate) struct Piece {
    #[serde(serialize_with = "lossy")]
    file: PathBuf,
    vertices: usize,
    triangles: usize,
    area: f64,
    /// Negative for a cavity, 0 for a sheet.
    volume: f64,
    /// Whether the piece is the wall of a cavity: its normals point inward.
    cavity: bool,
    /// Edges with one triangle: more than 0 for a sheet.
    boundary_edges: usize,
    /// Vertices less edges plus triangles: 2 for a ball, 1 for a sheet, 0 for a ring.
    euler_characteristic: i64,
}

/// Location and format of the pieces that a command writes.
#[derive(clap::Args)]
pub(crate) struct OutputOptions {
    /// The folder for the pieces, or a file NAME.glb for all of them.
    #[arg(short, long, value_name = "DIR|FILE.glb", value_parser = output_path())]
    output: PathBuf,
    /// Format of the pieces in a folder.
    #[arg(long, value_enum, default_value_t = Format::Obj)]
    format: Format,
}

impl OutputOptions {
    /// Returns the folder or file.
    pub(crate) fn path(&self) -> &Path {
        &self.output
    }

    /// Writes every piece of bodies, given with their inputs; see [`write`].
    pub(crate) fn write(&self, bodies: &[(&Surface, &Path)]) -> Result<Written, Failure> {
        write(bodies, &self.output, self.format)
    }
}

/// Changes to the output folder.
#[derive(Default)]
pub(crate) struct Written {
    /// The pieces, each with the index of its body.
    pub(crate) pieces: Vec<(usize, Piece)>,
    /// Removed pieces of an earlier run.
    pub(crate) removed: Vec<PathBuf>,
    /// Attributes that the format cannot hold.
    pub(crate) warnings: Vec<Warning>,
}

/// Writes every piece of bodies, given with their inputs, and removes surplus pieces of an earlier
/// run.
///
/// All targets are checked first, so that a refusal leaves the folder as it was. Surplus files are
/// removed so that the folder never holds pieces of two runs in one format. An output that ends in
/// `.glb` and is no folder is a file for all pieces.
pub(crate) fn write(
    bodies: &[(&Surface, &Path)],
    output: &Path,
    format: Format,
) -> Result<Written, Failure> {
    let pieces_of = |(body, &(surface, _)): (usize, &(&Surface, &Path))| {
        let volumes = surface.piece_volumes();
        let parts = surface.extract_pieces();
        let parts = parts.map(move |(piece, part)| (body, volumes[piece as usize], part));
        parts.collect::<Vec<_>>()
    };
    let parts: Vec<(usize, f64, Surface)> = bodies.iter().enumerate().flat_map(pieces_of).collect();
    let is_one_file = matches!(Format::of_file(output), Ok(Format::Glb)) && !output.is_dir();
    if is_one_file {
        return write_one_file(&parts, bodies, output);
    }
    let folder = output;
    let file = |i: usize| folder.join(format!("piece_{i:03}.{}", format.extension()));
    let check = || {
        let left_over = left_over(folder, parts.len(), format).into_iter();
        let mut targets = (0..parts.len()).map(file).chain(left_over);
        let inputs = || bodies.iter().map(|&(_, input)| input);
        targets.try_for_each(|path| inputs().try_for_each(|input| check_target(&path, input)))
    };
    check()?;
    std::fs::create_dir_all(folder).map_err(|source| Failure::Folder {
        path: folder.to_owned(),
        source,
    })?;
    // A path like `new/..` does not resolve before `new` exists.
    check()?;
    let mut pieces = Vec::with_capacity(parts.len());
    let mut warnings = Vec::new();
    for (i, (body, volume, part)) in parts.iter().enumerate() {
        for warning in format.write(&file(i), part)? {
            if !warnings.contains(&warning) {
                warnings.push(warning);
            }
        }
        pieces.push((*body, Piece::of(file(i), part, *volume)));
    }
    let removed = left_over(folder, parts.len(), format);
    for path in &removed {
        std::fs::remove_file(path).map_err(|source| Failure::Remove {
            path: path.clone(),
            source,
        })?;
    }
    Ok(Written {
        pieces,
        removed,
        warnings,
    })
}

/// Writes all pieces as the nodes of one file; each has its body, volume and surface.
fn write_one_file(
    parts: &[(usize, f64, Surface)],
    bodies: &[(&Surface, &Path)],
    file: &Path,
) -> Result<Written, Failure> {
    let mut inputs = bodies.iter().map(|&(_, input)| input);
    inputs.try_for_each(|input| check_target(file, input))?;
    let names: Vec<String> = (0..parts.len()).map(|i| format!("piece_{i:03}")).collect();
    let surfaces = names.iter().zip(parts);
    let surfaces: Vec<_> = surfaces
        .map(|(name, part)| (name.as_str(), &part.2))
        .collect();
    let warnings = write_glb(file, &surfaces)?;
    let piece = |part: &(usize, f64, Surface)| {
        let (body, volume, surface) = part;
        (*body, Piece::of(file.to_owned(), surface, *volume))
    };
    Ok(Written {
        pieces: parts.iter().map(piece).collect(),
        removed: Vec::new(),
        warnings,
    })
}

impl Piece {
    /// Describes a piece of a body that was written to `file`.
    fn of(file: PathBuf, part: &Surface, volume: f64) -> Self {
        let boundary_edges = boundary_edges(part);
        let volume = if boundary_edges == 0 { volume } else { 0.0 };
        Self {
            file,
            vertices: part.topology().vertex_count(),
            triangles: part.topology().triangle_count(),
            area: part.area(),
            volume,
            cavity: volume < 0.0,
            boundary_edges,
            euler_characteristic: euler_characteristic(part, boundary_edges),
        }
    }
}

/// Returns vertices less edges plus triangles of a surface with this number of boundary edges.
///
/// Other edges have two triangles, so there are three sides a triangle for two edges.
fn euler_characteristic(surface: &Surface, boundary_edges: usize) -> i64 {
    let topology = surface.topology();
    let count = |n: usize| i64::try_from(n).unwrap_or(i64::MAX);
    count(topology.vertex_count()) - count((topology.triangle_count() + boundary_edges) / 2)
}

/// Returns the piece files of a format in the folder, with numbers from `count` on.
fn left_over(folder: &Path, count: usize, format: Format) -> Vec<PathBuf> {
    // A folder that does not exist yet has none.
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let of_piece = entries.filter(|entry| {
        let name = entry.file_name();
        let is_file = entry.file_type().is_ok_and(|kind| kind.is_file());
        is_file && piece_number(&name, format).is_some_and(|number| number >= count)
    });
    let mut paths: Vec<PathBuf> = of_piece.map(|entry| entry.path()).collect();
    paths.sort();
    paths
}

/// Returns the number of a piece from the name of its file.
fn piece_number(name: &OsStr, format: Format) -> Option<usize> {
    let stem = name.to_str()?.strip_suffix(format.extension())?;
    let digits = stem.strip_suffix('.')?.strip_prefix("piece_")?;
    let number: usize = digits.parse().ok()?;
    // Other spellings of a number, such as +12 or 0012, are not ours.
    (digits == format!("{number:03}")).then_some(number)
}

/// Refuses a folder, and the input under any of its paths.
pub(crate) fn check_target(path: &Path, input: &Path) -> Result<(), Failure> {
    let path = path.to_owned();
    // The writer reports a path that cannot be resolved.
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

/// Prints a line per piece and per removed file.
pub(crate) fn print<'a>(
    pieces: impl IntoIterator<Item = &'a Piece>,
    removed: &[PathBuf],
    out: &mut impl Write,
) -> io::Result<()> {
    for piece in pieces {
        writeln!(
            out,
            "  {}: {}, {}, area {:.6e}, {}, Euler characteristic {}{}",
            piece.file.display(),
            counted(piece.vertices, "vertex"),
            counted(piece.triangles, "triangle"),
            piece.area,
            match piece.boundary_edges {
                0 => format!("volume {:.6e}", piece.volume),
                edges => counted(edges, "boundary edge"),
            },
            piece.euler_characteristic,
            if piece.cavity { ", cavity" } else { "" }
        )?;
    }
    for path in removed {
        writeln!(out, "  {}: removed, of an earlier run", path.display())?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn piece_numbers_have_one_spelling() {
        let number = |name: &str| piece_number(OsStr::new(name), Format::Obj);
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
            "piece_012obj",
            "my_piece_012.obj",
            "piece_012.obj.7.part",
        ] {
            assert_eq!(number(name), None, "{name}");
        }
    }
}
