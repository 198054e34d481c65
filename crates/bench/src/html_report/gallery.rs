//! Figures that `incise gallery` drew.

use super::error::ReportError;
use super::html::{self, Html};
use serde::Deserialize;
use std::path::{Path, PathBuf};

/// First bytes of a PNG.
const PNG: &[u8] = b"\x89PNG\r\n\x1a\n";

/// The part of the gallery's index that the report needs.
#[derive(Debug, Deserialize)]
struct Index {
    device: String,
    figures: Vec<Figure>,
}

#[derive(Debug, Deserialize)]
struct Figure {
    name: String,
    file: String,
    caption: String,
}

/// Images with their captions.
#[derive(Debug)]
pub(super) struct Gallery {
    device: String,
    pictures: Vec<(Figure, Vec<u8>)>,
}

/// Reads a folder's index and the images that it names.
///
/// # Errors
/// [`ReportError::Read`], [`ReportError::Json`]; [`ReportError::Outside`] and
/// [`ReportError::NoPng`] for files of another program.
pub(super) fn read(folder: &Path) -> Result<Gallery, ReportError> {
    let bytes =
        |path: PathBuf| std::fs::read(&path).map_err(|source| ReportError::Read { path, source });
    let path = folder.join("index.json");
    let index = bytes(path.clone())?;
    let index: Index = serde_json::from_slice(&index).map_err(|source| ReportError::Json {
        path: path.clone(),
        source,
    })?;
    let mut pictures = Vec::new();
    for figure in index.figures {
        if Path::new(&figure.file).file_name() != Some(figure.file.as_ref()) {
            let file = figure.file;
            return Err(ReportError::Outside { path, file });
        }
        let file = folder.join(&figure.file);
        let picture = bytes(file.clone())?;
        if !picture.starts_with(PNG) {
            return Err(ReportError::NoPng { path: file });
        }
        pictures.push((figure, picture));
    }
    Ok(Gallery {
        device: index.device,
        pictures,
    })
}

impl Gallery {
    /// Appends all images.
    pub(super) fn show(&self, html: &mut Html) {
        html.paragraph(&format!(
            "The paper's figures with the built-in models and both methods, drawn by {}.",
            self.device
        ));
        html.figures(|html| {
            for (figure, png) in &self.pictures {
                let caption = format!("{}: {}", figure.name, figure.caption);
                html.figure(&html::png(png, &figure.name), &caption, true);
            }
        });
    }
}
