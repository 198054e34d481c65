//! [`SavedSleep`]: the sleeping state of all bodies, for files.

use super::excursion::Excursion;
use super::{Conditions, Observation, Sleep, SleepParams};
use incise_mesh::{Aabb, index_u32};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// [`Sleep`], as it is saved.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct SavedSleep<'a> {
    asleep: Cow<'a, [bool]>,
    bounds: Cow<'a, [Aabb]>,
    observations: Cow<'a, [Observation]>,
    excursions: Cow<'a, [Excursion]>,
    islands: Vec<u32>,
    woken: u32,
    conditions: Option<Conditions>,
    observed_frames: u32,
}

impl Sleep {
    /// Returns the state as plain data for a file.
    pub(crate) fn to_saved(&self) -> SavedSleep<'_> {
        SavedSleep {
            asleep: (&self.asleep).into(),
            bounds: (&self.bounds).into(),
            observations: (&self.observations).into(),
            excursions: (&self.excursions).into(),
            islands: self.islands.iter().map(|&i| index_u32(i)).collect(),
            woken: self.woken,
            conditions: self.conditions,
            observed_frames: self.observed_frames,
        }
    }

    /// Returns a saved state of a number of bodies, removed ones included, if it fits.
    pub(crate) fn from_saved(saved: SavedSleep<'_>, bodies: usize) -> Option<Self> {
        let lengths = [
            saved.asleep.len(),
            saved.bounds.len(),
            saved.observations.len(),
            saved.excursions.len(),
        ];
        let last = saved.observed_frames.checked_add(SleepParams::LAG)?;
        let is_valid = lengths == [bodies; 4]
            && saved.islands.len() == bodies
            && saved.islands.iter().all(|&i| (i as usize) < bodies)
            && saved
                .observations
                .iter()
                .all(|observation| observation.frames <= last);
        let sleeping = saved.asleep.iter().filter(|&&is_asleep| is_asleep).count();
        is_valid.then(|| Self {
            sleeping_bodies: index_u32(sleeping),
            asleep: saved.asleep.into_owned(),
            bounds: saved.bounds.into_owned(),
            observations: saved.observations.into_owned(),
            excursions: saved.excursions.into_owned(),
            islands: saved.islands.iter().map(|&i| i as usize).collect(),
            woken: saved.woken,
            conditions: saved.conditions,
            observed_frames: saved.observed_frames,
        })
    }
}
