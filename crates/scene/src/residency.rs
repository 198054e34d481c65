//! [`Residency`]: where the newest state of a body is, and how that changes.
//!
//! `gpu_bodies/resident.rs` applies an event to each body; `Scene::residency` returns the state.
//!
//! | state | `Added` | `ReadBack` | `Edited` | `Uploaded` | `Stepped` |
//! |---|---|---|---|---|---|
//! | `CpuOnly` | `InSync` | `CpuOnly` | `CpuOnly` | `CpuOnly` | `CpuOnly` |
//! | `InSync` | `InSync` | `InSync` | `CpuAhead` | `InSync` | `GpuAhead` |
//! | `GpuAhead` | `InSync` | `InSync` | `CpuAhead` | `InSync` | `GpuAhead` |
//! | `CpuAhead` | `InSync` | `CpuAhead` | `CpuAhead` | `InSync` | `GpuAhead` |
//!
//! A body that is removed from the GPU is `CpuOnly` again.
//!
//! Callers read a body back before they edit it, and upload it before they step it. So the
//! transitions that would lose a state, `Edited` and `Uploaded` from `GpuAhead` and `Stepped` from
//! `CpuAhead`, do not occur.

/// Location of the newest state of a body.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Residency {
    /// Only in CPU memory: the CPU steps the body.
    CpuOnly,
    /// In CPU and GPU memory alike.
    InSync,
    /// In GPU memory: the CPU copy is out of date.
    GpuAhead,
    /// In CPU memory: an edit or a cut is not uploaded yet.
    CpuAhead,
}

impl Residency {
    /// Returns whether the CPU copy is up to date.
    #[must_use]
    pub const fn is_cpu_current(self) -> bool {
        !matches!(self, Self::GpuAhead)
    }
}

/// An event that changes the residency of a body.
#[cfg(feature = "gpu")]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Event {
    /// The body was added to the GPU.
    Added,
    /// The GPU state was copied to the CPU if it was newer.
    ReadBack,
    /// The CPU copy was edited or cut.
    Edited,
    /// The CPU copy was uploaded if it was newer.
    Uploaded,
    /// The GPU stepped the body.
    Stepped,
}

#[cfg(feature = "gpu")]
impl Residency {
    /// Returns the state after an event, by the table of this module.
    pub(crate) const fn after(self, event: Event) -> Self {
        match (self, event) {
            (_, Event::Added) => Self::InSync,
            (Self::CpuOnly, _) => Self::CpuOnly,
            (Self::CpuAhead, Event::ReadBack) | (_, Event::Edited) => Self::CpuAhead,
            (_, Event::ReadBack | Event::Uploaded) => Self::InSync,
            (_, Event::Stepped) => Self::GpuAhead,
        }
    }
}

#[cfg(all(test, feature = "gpu"))]
mod tests {
    use super::{Event, Residency};

    /// A body with numbered states in both memories.
    #[derive(Debug, Clone, Copy)]
    struct Model {
        residency: Residency,
        cpu: u32,
        gpu: Option<u32>,
    }

    impl Model {
        /// Applies an event as `resident.rs` does, with the readback or upload that precedes it.
        fn apply(&mut self, event: Event) {
            match event {
                Event::Edited if self.gpu.is_some() => self.apply(Event::ReadBack),
                Event::Stepped if self.gpu.is_some() => self.apply(Event::Uploaded),
                // The next frame uploads edits only.
                Event::Uploaded if self.residency == Residency::GpuAhead => return,
                _ => {}
            }
            let newest = self.newest();
            match event {
                Event::Added => {
                    if self.gpu.is_some() {
                        return;
                    }
                    self.gpu = Some(self.cpu);
                }
                Event::ReadBack => self.cpu = newest,
                Event::Edited => self.cpu = newest + 1,
                Event::Uploaded => self.gpu = self.gpu.map(|_| newest),
                Event::Stepped => match &mut self.gpu {
                    Some(gpu) => *gpu = newest + 1,
                    None => self.cpu += 1,
                },
            }
            self.residency = self.residency.after(event);
            assert!(self.newest() >= newest, "{event:?} lost a state");
        }

        fn newest(&self) -> u32 {
            self.gpu.map_or(self.cpu, |gpu| gpu.max(self.cpu))
        }

        fn expected(&self) -> Residency {
            match self.gpu {
                None => Residency::CpuOnly,
                Some(gpu) if gpu > self.cpu => Residency::GpuAhead,
                Some(gpu) if gpu < self.cpu => Residency::CpuAhead,
                Some(_) => Residency::InSync,
            }
        }
    }

    #[test]
    fn every_sequence_of_six_events_tracks_the_newest_state() {
        let events = [
            Event::Added,
            Event::ReadBack,
            Event::Edited,
            Event::Uploaded,
            Event::Stepped,
        ];
        for number in 0..5_usize.pow(6) {
            let mut model = Model {
                residency: Residency::CpuOnly,
                cpu: 0,
                gpu: None,
            };
            for place in 0..6 {
                let event = events[number / 5_usize.pow(place) % 5];
                model.apply(event);
                assert_eq!(model.residency, model.expected(), "{event:?} of {number}");
            }
        }
    }
}
