//! Reads scene files: syntax, paths, and errors with lines.

use super::{SceneFile, Source};
use crate::failure::Failure;
use crate::input::resolve;
use incise_params::{Field, ParamError, Params};
use incise_pbd_gpu::Material;
use incise_scene::SceneParams;
use std::path::{Path, PathBuf};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// A reason why a file is not a scene.
#[derive(Debug, thiserror::Error)]
pub(crate) enum SceneFileError {
    /// The file cannot be read, or is not text.
    #[error("the scene cannot be read: {0}")]
    Read(std::io::Error),
    /// The file is not TOML, or has an unknown key or a wrong value.
    #[error("line {line}: {message}")]
    Syntax {
        /// The line.
        line: usize,
        /// The message of the parser.
        message: String,
    },
    /// The scene has no body.
    #[error("the scene has no body; add [[bodies]] with the key mesh")]
    NoBody,
    /// A body's material is neither defined nor a preset.
    #[error(
        "line {line}: there is no material {name}; define [materials.{name}], or use one of {}",
        Material::PRESETS.join(", ")
    )]
    UnknownMaterial {
        /// The line.
        line: usize,
        /// The name.
        name: String,
    },
    /// A parameter has another type, is out of range or unknown.
    #[error("line {line}: {source}")]
    Parameter {
        /// The line of the parameter.
        line: usize,
        /// The reason.
        source: ParamError,
    },
    /// A collider has no shape.
    #[error(
        "line {line}: the collider has a number that is not finite, a size that is not positive, \
         or a zero direction"
    )]
    Collider {
        /// The line of the collider.
        line: usize,
    },
    /// A blade has no motion, or two.
    #[error(
        "line {line}: a blade needs either `poses`, each with its `at`, or `path`, a file, with \
         the `at` of its first pose"
    )]
    BladeMotion {
        /// The line of the blade.
        line: usize,
    },
    /// A blade has fewer than two poses.
    #[error("line {line}: the blade has fewer than 2 poses, which is no motion")]
    FewPoses {
        /// The line of the blade.
        line: usize,
    },
    /// A pose is not later than the one before.
    #[error(
        "line {line}: the pose at {at} s is not a frame of {dt} s later than the one before; write \
         poses in the order of their times"
    )]
    PoseOrder {
        /// The line of the pose.
        line: usize,
        /// Its time [s].
        at: f64,
        /// The time step [s].
        dt: f64,
    },
    /// A cut or pose is before the start or after the end.
    #[error(
        "line {line}: the time {at} s is not within the simulation of {seconds} s; change `at`, \
         or increase `seconds`"
    )]
    TimeOutside {
        /// The line of the cut or pose.
        line: usize,
        /// Its time [s].
        at: f64,
        /// The simulated time [s].
        seconds: f64,
    },
}

impl SceneFile {
    /// Reads a scene. Its paths are relative to its folder.
    pub(in crate::simulate) fn read(path: &Path) -> Result<Self, Failure> {
        let failed = |source| Failure::SceneFile {
            path: path.to_owned(),
            source,
        };
        let text = std::fs::read_to_string(path);
        let text = text.map_err(|error| failed(SceneFileError::Read(error)))?;
        let mut file: Self = toml::from_str(&text).map_err(|error| {
            let begin = error.span().map_or(0, |span| span.start);
            failed(SceneFileError::Syntax {
                line: line_of(&text, begin),
                message: error.message().to_owned(),
            })
        })?;
        if file.bodies.is_empty() {
            return Err(failed(SceneFileError::NoBody));
        }
        let folder = path.parent().unwrap_or(Path::new(""));
        for body in &mut file.bodies {
            body.mesh = resolve(folder, &body.mesh);
        }
        let blades = file.blades.iter_mut().map(Spanned::get_mut);
        let paths = blades.filter_map(|blade| blade.path.as_mut());
        for path in paths.chain(file.output.paths_mut()) {
            *path = folder.join(&path);
        }
        file.source = Some(Source {
            path: path.to_owned(),
            text,
        });
        Ok(file)
    }

    /// Returns the line of a value, from 1; none in a scene made of options.
    pub(in crate::simulate) fn line<T>(&self, value: &Spanned<T>) -> Option<usize> {
        let source = self.source.as_ref()?;
        Some(line_of(&source.text, value.span().start))
    }

    /// Returns the failure of a parameter of the scene.
    pub(in crate::simulate) fn refuse_parameter(&self, source: ParamError) -> Failure {
        if self.source.is_none() {
            return Failure::Parameter(source);
        }
        let line = self.line_of_key("", SceneParams::FIELDS, &source.name());
        let line = line.unwrap_or_default();
        self.refuse(SceneFileError::Parameter { line, source })
    }

    /// Returns the line of the key behind `prefix` that names a parameter, or contains it.
    pub(in crate::simulate) fn line_of_key(
        &self,
        prefix: &str,
        fields: &'static [Field],
        name: &str,
    ) -> Option<usize> {
        let text = &self.source.as_ref()?.text;
        let table = DeTable::parse(text).ok()?;
        let mut keys = Vec::new();
        append_keys(&mut keys, "", table.get_ref());
        let full = |name: &str| incise_params::resolve(fields, name).ok();
        let line_of_name = |name: &str| {
            let mut below = keys.iter().filter_map(|(key, start)| {
                let key = key.strip_prefix(prefix)?;
                Some((key, *start))
            });
            let exact = below.clone().find(|&(key, _)| key == name);
            let is_meant = |key: &str| full(key).is_some_and(|key| key == name);
            let (_, start) = exact.or_else(|| below.find(|&(key, _)| is_meant(key)))?;
            Some(line_of(text, start))
        };
        // The key of a number, or of the struct or alternative around it.
        let ends = name.match_indices('.').map(|(dot, _)| dot);
        let ends = ends.chain([name.len()]).collect::<Vec<_>>();
        ends.into_iter()
            .rev()
            .find_map(|end| line_of_name(&name[..end]))
    }

    /// Returns the path of the file; empty for a scene made of options.
    pub(in crate::simulate) fn path(&self) -> PathBuf {
        let path = self.source.as_ref().map(|source| source.path.clone());
        path.unwrap_or_default()
    }

    /// Returns the failure of this file.
    pub(in crate::simulate) fn refuse(&self, source: SceneFileError) -> Failure {
        let path = self.path();
        Failure::SceneFile { path, source }
    }
}

/// Appends all dotted keys of a table and their first bytes.
fn append_keys(keys: &mut Vec<(String, usize)>, prefix: &str, table: &DeTable<'_>) {
    for (key, value) in table {
        let name = match prefix {
            "" => key.get_ref().to_string(),
            prefix => format!("{prefix}.{}", key.get_ref()),
        };
        keys.push((name.clone(), key.span().start));
        if let DeValue::Table(inner) = value.get_ref() {
            append_keys(keys, &name, inner);
        }
    }
}

/// Returns the line of a byte, from 1.
fn line_of(text: &str, at: usize) -> usize {
    let before = text.as_bytes().iter().take(at);
    1 + before.filter(|&&byte| byte == b'\n').count()
}
