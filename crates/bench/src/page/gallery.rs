//! The pictures that `incise gallery` made.

use super::error::PageError;
use super::html::Html;
use serde::Deserialize;
use std::path::{Path, PathBuf};

/// What a PNG begins with.
const PNG: &[u8] = b"\x89PNG\r\n\x1a\n";

/// The gallery's index, as far as the page needs it.
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

/// Pictures with their captions.
#[derive(Debug)]
pub(super) struct Gallery {
    device: String,
    pictures: Vec<(Figure, Vec<u8>)>,
}

/// Reads a folder's index and the pictures that it names.
///
/// # Errors
/// [`PageError::Read`], [`PageError::Json`], and [`PageError::Outside`] and [`PageError::NoPng`] for an index or pictures
/// that the program did not write.
pub(super) fn read(folder: &Path) -> Result<Gallery, PageError> {
    let bytes =
        |path: PathBuf| std::fs::read(&path).map_err(|source| PageError::Read { path, source });
    let path = folder.join("index.json");
    let index = bytes(path.clone())?;
    let index: Index = serde_json::from_slice(&index).map_err(|source| PageError::Json {
        path: path.clone(),
        source,
    })?;
    let mut pictures = Vec::new();
    for figure in index.figures {
        if Path::new(&figure.file).file_name() != Some(figure.file.as_ref()) {
            let file = figure.file;
            return Err(PageError::Outside { path, file });
        }
        let file = folder.join(&figure.file);
        let picture = bytes(file.clone())?;
        if !picture.starts_with(PNG) {
            return Err(PageError::NoPng { path: file });
        }
        pictures.push((figure, picture));
    }
    Ok(Gallery {
        device: index.device,
        pictures,
    })
}

impl Gallery {
    /// All pictures, one below the other: they are wide.
    pub(super) fn show(&self, html: &mut Html) {
        html.paragraph(&format!(
            "The paper's figures, of the built-in models, by both methods. Drawn by {}.",
            self.device
        ));
        html.beside(|html| {
            for (figure, png) in &self.pictures {
                let caption = format!("{}: {}", figure.name, figure.caption);
                html.figure(&Html::png(png, &figure.name), &caption, true);
            }
        });
    }
}
