//! Output files, opened before a run of hours so that a bad path is reported at once.

use std::fs::{self, OpenOptions};
use std::io;
use std::path::{Path, PathBuf};

/// An error of writing results.
#[derive(Debug, thiserror::Error)]
pub(crate) enum OutputError {
    /// A file cannot be created or opened.
    #[error("{}: cannot be written: {source}; nothing was measured", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// The system's error.
        source: io::Error,
    },
    /// A folder cannot be created.
    #[error("{}: cannot be created: {source}; nothing was measured", path.display())]
    Folder {
        /// The folder.
        path: PathBuf,
        /// The system's error.
        source: io::Error,
    },
    /// An open file cannot be written.
    #[error("{}: not written: {source}; the results are printed only", path.display())]
    Lost {
        /// The file.
        path: PathBuf,
        /// The system's error.
        source: io::Error,
    },
}

/// A writable file. A new file that is never written is removed again.
#[derive(Debug)]
pub(crate) struct OutputFile {
    path: PathBuf,
    is_new: bool,
}

impl OutputFile {
    /// Creates the file and its folder if they are absent; old content stays until a write.
    ///
    /// # Errors
    /// [`OutputError::Folder`], [`OutputError::File`].
    pub(crate) fn open(path: &Path) -> Result<Self, OutputError> {
        if let Some(parent) = path.parent() {
            folder(parent)?;
        }
        let is_new = !path.exists();
        let opened = OpenOptions::new()
            .write(true)
            .create(true)
            .truncate(false)
            .open(path);
        opened.map_err(|source| OutputError::File {
            path: path.to_owned(),
            source,
        })?;
        Ok(Self {
            path: path.to_owned(),
            is_new,
        })
    }

    /// Replaces the content.
    ///
    /// # Errors
    /// [`OutputError::Lost`].
    pub(crate) fn write(&mut self, content: impl AsRef<[u8]>) -> Result<(), OutputError> {
        fs::write(&self.path, content).map_err(|source| self.lost(source))?;
        self.is_new = false;
        Ok(())
    }

    /// Returns the error of a failed write.
    pub(crate) fn lost(&self, source: io::Error) -> OutputError {
        OutputError::Lost {
            path: self.path.clone(),
            source,
        }
    }
}

impl Drop for OutputFile {
    fn drop(&mut self) {
        if self.is_new {
            // An empty file that cannot be removed does no harm.
            let _ = fs::remove_file(&self.path);
        }
    }
}

/// Creates a folder and its parents if they are absent.
///
/// # Errors
/// [`OutputError::Folder`].
pub(crate) fn folder(path: &Path) -> Result<(), OutputError> {
    fs::create_dir_all(path).map_err(|source| OutputError::Folder {
        path: path.to_owned(),
        source,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_made_with_its_folder_and_kept_only_if_it_is_written() {
        let place = tempfile::tempdir().unwrap();
        let path = place.path().join("a/b/rows.json");
        let file = OutputFile::open(&path).unwrap();
        assert!(path.exists(), "it can be written to");
        drop(file);
        assert!(!path.exists(), "nothing was written");
        let mut file = OutputFile::open(&path).unwrap();
        file.write("[1]").unwrap();
        file.write("[]").unwrap();
        drop(file);
        assert_eq!(fs::read_to_string(&path).unwrap(), "[]");
        drop(OutputFile::open(&path).unwrap());
        let kept = fs::read_to_string(&path).unwrap();
        assert_eq!(kept, "[]", "what was there before stays");
    }

    #[test]
    fn a_path_that_cannot_be_written_is_named_before_anything_is_measured() {
        let place = tempfile::tempdir().unwrap();
        let is_folder = OutputFile::open(place.path()).unwrap_err();
        assert!(
            matches!(&is_folder, OutputError::File { path, .. } if path == place.path()),
            "{is_folder}"
        );
        let file = place.path().join("file");
        fs::write(&file, "").unwrap();
        let below = OutputFile::open(&file.join("rows.json")).unwrap_err();
        assert!(
            matches!(&below, OutputError::Folder { path, .. } if *path == file),
            "{below}"
        );
        assert!(
            below.to_string().contains("nothing was measured"),
            "{below}"
        );
    }
}
