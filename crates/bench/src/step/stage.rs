//! The backends of a run.

use super::bandwidth;
use super::case::{Case, Setup};
use super::cpu;
use super::device::Device;
use super::row::Row;
use super::subject::Subject;
use super::{ScheduleChoice, StepArguments};
use crate::backend::BackendChoice;
use std::io::{self, Write};

/// The backends that every model runs on.
pub(super) struct Stage {
    /// What was asked for, each once.
    choices: Vec<BackendChoice>,
    /// The memory's bandwidth [B/s].
    memory: f64,
    device: Option<Device>,
    /// How many constraints a body must have for [`BackendChoice::Auto`] to take the device.
    device_from: Option<usize>,
    schedules: Vec<ScheduleChoice>,
}

/// Why a run cannot begin.
#[derive(Debug, thiserror::Error)]
pub(super) enum StageError {
    /// There is no device, and one was asked for.
    #[error("{0}")]
    NoDevice(String),
    /// Nothing can be said.
    #[error(transparent)]
    Output(#[from] io::Error),
}

impl Stage {
    /// Opens what is asked for and says what it is.
    pub(super) fn open(
        arguments: &StepArguments,
        setup: &Setup,
        out: &mut impl Write,
    ) -> Result<Self, StageError> {
        let all = [BackendChoice::Cpu, BackendChoice::Gpu, BackendChoice::Auto];
        let by_default = [BackendChoice::Cpu, BackendChoice::Gpu];
        let asked = match arguments.backend.as_slice() {
            [] => &by_default[..],
            asked => asked,
        };
        let memory = bandwidth::of_memory();
        writeln!(out, "cpu: {:.2} GB/s of a triad", memory / 1e9)?;
        let mut stage = Self {
            choices: all.into_iter().filter(|c| asked.contains(c)).collect(),
            memory,
            device: None,
            device_from: None,
            schedules: arguments.schedule.clone(),
        };
        if asked == [BackendChoice::Cpu] {
            return Ok(stage);
        }
        match Device::open(arguments.gpu.adapter.as_deref()) {
            Ok(device) => {
                writeln!(out, "gpu: {}", device.describe())?;
                stage.device = Some(device);
            }
            Err(why) => {
                // Where nobody asked for one, or for a certain one, there need not be any.
                let is_needed = arguments.backend.contains(&BackendChoice::Gpu);
                if is_needed || arguments.gpu.adapter.is_some() {
                    return Err(StageError::NoDevice(why));
                }
                writeln!(out, "gpu: none: {why}")?;
            }
        }
        if asked.contains(&BackendChoice::Auto) {
            stage.calibrate(setup, out)?;
        }
        Ok(stage)
    }

    /// Finds out for which bodies the device is faster, and says so.
    fn calibrate(&mut self, setup: &Setup, out: &mut impl Write) -> io::Result<()> {
        let Some(device) = &mut self.device else {
            return Ok(());
        };
        match device.faster_from(&setup.params) {
            Ok(Some(count)) => {
                writeln!(out, "auto: the GPU from {count} constraints on")?;
                self.device_from = Some(count);
            }
            Ok(None) => writeln!(out, "auto: the CPU, which is faster at every size")?,
            Err(why) => writeln!(out, "auto: the CPU: {why}")?,
        }
        Ok(())
    }

    /// Measures a model on every backend.
    pub(super) fn rows(&mut self, subject: &Subject, setup: &Setup) -> Result<Vec<Row>, String> {
        let case = Case::new(subject, setup).map_err(|e| format!("{}: {e}", subject.name()))?;
        let is_large = (self.device_from).is_some_and(|count| case.constraints() >= count);
        let mut rows = Vec::new();
        for &choice in &self.choices {
            let first = rows.len();
            match (choice, &mut self.device) {
                (BackendChoice::Gpu, Some(device)) => {
                    rows.extend(device.rows(&case, &self.schedules));
                }
                (BackendChoice::Gpu, None) => {}
                (BackendChoice::Auto, Some(device)) if is_large => {
                    rows.extend(device.rows(&case, &[ScheduleChoice::Auto]));
                }
                _ => rows.push(cpu::row(&case, self.memory)),
            }
            for row in &mut rows[first..] {
                row.backend = choice.name();
            }
        }
        Ok(rows)
    }
}
