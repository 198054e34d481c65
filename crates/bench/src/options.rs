//! Options that several benches share.

use crate::motion;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::{Args, ValueEnum};
use incise_cut::{CutOutcome, CutParams, Cutter, Sweep};
use incise_mesh::Surface;
use incise_paper::PaperParams;
use incise_pbd_gpu::{Material, Solid};
use incise_refine::{RefineParams, RefinementLevel};
use incise_scene::{BackendChoice, BackendRequest};
use serde::{Serialize, Serializer};
use std::error::Error;
use std::path::PathBuf;

/// Output of rows and progress.
#[derive(Args, Clone, Debug, Default)]
pub(crate) struct OutputArguments {
    /// Append the rows to a file, a JSON object per line, as they arrive.
    #[arg(long, value_name = "FILE")]
    pub(crate) json: Option<PathBuf>,
    /// Print nothing but warnings and errors: neither rows nor progress.
    #[arg(short, long)]
    pub(crate) quiet: bool,
}

/// Choice of models.
#[derive(Args, Clone, Debug, Default)]
pub(crate) struct ModelArguments {
    /// Folder of models (bunny*.obj, armadillo*.ply, ...) that replace the built-in ones.
    #[arg(long, value_name = "DIR")]
    pub(crate) models: Option<PathBuf>,
    /// Models to run, separated by commas: those of the table; for cut, refine, step and solver
    /// also finer armadillos such as Armadillo120000 and spheres such as Sphere3072.
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    pub(crate) only: Vec<String>,
}

/// Returns the backend of a name.
fn backend(name: String) -> BackendChoice {
    match name.as_str() {
        "gpu" => BackendChoice::Gpu,
        "auto" => BackendChoice::Auto,
        _ => BackendChoice::Cpu,
    }
}

/// Backends that everything runs on.
#[derive(Args, Clone, Debug, Default)]
pub(crate) struct BackendArguments {
    /// Backends of the solver, separated by commas; everything runs on each: cpu, gpu, which may be
    /// a software adapter, or auto, a hardware GPU for bodies that are faster on it. The default is
    /// cpu; for step a GPU too, if there is one.
    #[arg(
        long,
        value_name = "NAMES",
        value_delimiter = ',',
        value_parser = PossibleValuesParser::new(["cpu", "gpu", "auto"]).map(backend)
    )]
    backend: Vec<BackendChoice>,
    /// Part of the name of the GPU.
    #[arg(long, value_name = "NAME")]
    pub(crate) adapter: Option<String>,
}

impl BackendArguments {
    /// Returns the backends in the given order, each once; empty if none is named.
    pub(crate) fn named(&self) -> Vec<BackendChoice> {
        let mut each = Vec::new();
        for &backend in &self.backend {
            if !each.contains(&backend) {
                each.push(backend);
            }
        }
        each
    }

    /// Returns the request of a scene's backend, which may be a software adapter.
    pub(crate) fn request(&self, choice: BackendChoice) -> BackendRequest {
        BackendRequest {
            choice,
            adapter: self.adapter.clone(),
            allow_software: true,
            min_gpu_constraints: None,
        }
    }

    /// Returns the CPU, the GPU or both in the given order; the CPU if none is named.
    ///
    /// # Errors
    /// A message for [`BackendChoice::Auto`].
    pub(crate) fn devices(&self) -> Result<Vec<BackendChoice>, &'static str> {
        let named = self.named();
        if named.contains(&BackendChoice::Auto) {
            return Err("this bench compares backends: name cpu or gpu instead of auto");
        }
        Ok(match named.is_empty() {
            true => vec![BackendChoice::Cpu],
            false => named,
        })
    }
}

/// Length of a measurement.
#[derive(Args, Clone, Debug, Default)]
pub(crate) struct LengthArguments {
    /// Simulated seconds per run of the table, by default 15; seconds per measurement of step, by
    /// default 1, and of solver, by default 3.
    #[arg(long, value_name = "S", conflicts_with = "frames", value_parser = positive)]
    pub(crate) seconds: Option<f64>,
    /// Frames instead of seconds.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) frames: Option<u32>,
}

/// Parses a positive number or a fraction.
pub(crate) fn positive(text: &str) -> Result<f64, String> {
    let number = |s: &str| s.trim().parse::<f64>().ok();
    let value = match text.split_once('/') {
        Some((above, below)) => number(above).zip(number(below)).map(|(a, b)| a / b),
        None => number(text),
    };
    value
        .filter(|v| v.is_finite() && *v > 0.0)
        .ok_or_else(|| format!("'{text}' is not a positive number or fraction"))
}

/// Material of the bodies.
#[derive(Args, Clone, Copy, Debug, Default, Serialize)]
pub(crate) struct MaterialArguments {
    /// Bodies are soft solids with at most this many cells along the longest side, instead of
    /// surfaces of the table's material.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=64))]
    cells_across: Option<u32>,
}

impl MaterialArguments {
    /// Returns the material.
    pub(crate) fn material(self) -> Material {
        let Some(cells_across) = self.cells_across else {
            return motion::material();
        };
        let soft = Material::soft_body();
        let solid = soft.solid.unwrap_or_default();
        Material {
            solid: Some(Solid {
                cells_across,
                ..solid
            }),
            ..soft
        }
    }

    /// Returns whether bodies are solids.
    pub(crate) fn is_solid(self) -> bool {
        self.cells_across.is_some()
    }
}

/// A cut method.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Method {
    /// Splits hit triangles, keeps the volume, closes any cross-section.
    Exact,
    /// The paper's method: deletes hit triangles and rebuilds the rim.
    Paper,
}

/// The cut method and the refinement of its caps.
#[derive(Args, Debug, Clone, Copy, Serialize)]
pub(crate) struct MethodArguments {
    /// Cut method.
    #[arg(long, value_enum, default_value_t = Method::Exact)]
    pub(crate) method: Method,
    /// Refinement level of the caps: one of the five names, or z.
    #[arg(long, default_value = "1")]
    #[serde(serialize_with = "z")]
    pub(crate) level: RefinementLevel,
    /// Growth of the caps' edge length per meter of distance from the boundary.
    #[arg(long, default_value_t = RefineParams::default().grading)]
    pub(crate) grading: f64,
}

impl MethodArguments {
    /// Returns the parameters of a cut by the exact method.
    pub(crate) fn exact(&self) -> CutParams {
        CutParams {
            refine: RefineParams {
                level: self.level,
                grading: self.grading,
                ..RefineParams::default()
            },
            ..CutParams::default()
        }
    }

    /// Cuts a surface, or one of its pieces.
    ///
    /// # Errors
    /// The reason why the method refused the cut.
    pub(crate) fn cut(
        &self,
        cutter: &mut Cutter,
        surface: &mut Surface,
        sweep: &Sweep,
        only_piece: Option<u32>,
    ) -> Result<CutOutcome, Box<dyn Error>> {
        match self.method {
            Method::Exact => {
                let params = CutParams {
                    only_piece,
                    ..self.exact()
                };
                Ok(cutter.cut(surface, sweep, &params)?)
            }
            Method::Paper => {
                let params = PaperParams {
                    level: self.level,
                    only_piece,
                    ..PaperParams::default()
                };
                Ok(incise_paper::cut(cutter, surface, sweep, &params)?.cut)
            }
        }
    }
}

/// Serializes a refinement level as its number.
fn z<S: Serializer>(level: &RefinementLevel, to: S) -> Result<S::Ok, S::Error> {
    to.serialize_f64(level.z())
}
