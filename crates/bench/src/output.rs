//! Files that results are kept in. They are opened before anything is measured: a run of hours must not end with a path
//! that nothing can be written to.

use std::fs::{self, OpenOptions};
use std::io;
use std::path::{Path, PathBuf};

/// Why results cannot be kept.
#[derive(Debug, thiserror::Error)]
pub(crate) enum OutputError {
    /// A file cannot be made or opened.
    #[error("{}: cannot be written: {fault}; nothing was measured, name a file that can be", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// What the system says.
        fault: io::Error,
    },
    /// A folder cannot be made.
    #[error("{}: no folder, and none can be made: {fault}; nothing was measured, name another", path.display())]
    Folder {
        /// The folder.
        path: PathBuf,
        /// What the system says.
        fault: io::Error,
    },
    /// Results cannot be written to a file that was open before.
    #[error("{}: not written: {fault}; what was measured is printed, free its place before the next run", path.display())]
    Lost {
        /// The file.
        path: PathBuf,
        /// What the system says.
        fault: io::Error,
    },
}

/// A file that can be written to. One that had to be made and was never written goes again.
#[derive(Debug)]
pub(crate) struct OutputFile {
    path: PathBuf,
    is_new: bool,
}

impl OutputFile {
    /// Makes the file, and its folder, if they are not there; what is in it stays until something is written.
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
        opened.map_err(|fault| OutputError::File {
            path: path.to_owned(),
            fault,
        })?;
        Ok(Self {
            path: path.to_owned(),
            is_new,
        })
    }

    /// Writes all of the file, in the place of what was there.
    ///
    /// # Errors
    /// [`OutputError::Lost`].
    pub(crate) fn write(&mut self, content: impl AsRef<[u8]>) -> Result<(), OutputError> {
        fs::write(&self.path, content).map_err(|fault| self.lost(fault))?;
        self.is_new = false;
        Ok(())
    }

    /// That something could not be written.
    pub(crate) fn lost(&self, fault: io::Error) -> OutputError {
        OutputError::Lost {
            path: self.path.clone(),
            fault,
        }
    }
}

impl Drop for OutputFile {
    fn drop(&mut self) {
        if self.is_new {
            // An empty file that cannot be removed harms nobody.
            let _ = fs::remove_file(&self.path);
        }
    }
}

/// Makes a folder, and those that it is in, if it is not there.
///
/// # Errors
/// [`OutputError::Folder`].
pub(crate) fn folder(path: &Path) -> Result<(), OutputError> {
    fs::create_dir_all(path).map_err(|fault| OutputError::Folder {
        path: path.to_owned(),
        fault,
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

    #[test]
    fn what_cannot_be_written_any_more_is_told() {
        let place = tempfile::tempdir().unwrap();
        let path = place.path().join("folder/rows.json");
        let mut file = OutputFile::open(&path).unwrap();
        fs::remove_dir_all(path.parent().unwrap()).unwrap();
        let lost = file.write("[]").unwrap_err();
        assert!(matches!(lost, OutputError::Lost { .. }), "{lost}");
    }
}
