//! [`Sample`]: one drop of a sweep over models, mixes of constraints, sizes and planes.

use super::super::subjects::Subject;
use crate::directions::RelativePlane;
use incise_pbd_gpu::{InteriorSprings, Material, Volume};
use incise_scene::ContactParams;

/// Largest sides of bodies \[m\].
const SIZES: [f64; 5] = [1.0, 0.01, 100.0, 0.1, 10.0];
/// Mixes of volume, interior springs and contacts.
const MIXES: u32 = 8;
/// Pairs of a mix and a size; the numbers of both are coprime.
const PAIRS: u32 = 40;
/// Planes, from which each model takes one per drop.
const PLANES: u32 = 20;
/// Seed of the planes.
const SEED: u64 = 17;

/// Which constraints a body has beside edges and hinges, and whether its pieces touch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Mix {
    pub(super) volume: bool,
    pub(super) springs: bool,
    pub(super) contacts: bool,
}

impl Mix {
    /// Returns the mix of a number below [`MIXES`]; 0 has all three.
    const fn numbered(number: u32) -> Self {
        Self {
            volume: number & 1 == 0,
            springs: number & 2 == 0,
            contacts: number & 4 == 0,
        }
    }

    pub(super) fn material(self) -> Material {
        Material {
            volume: self.volume.then(Volume::default),
            interior_springs: self.springs.then(InteriorSprings::default),
            ..Material::default()
        }
    }

    pub(super) fn contacts(self) -> Option<ContactParams> {
        self.contacts.then(ContactParams::default)
    }
}

/// One drop.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sample<'a> {
    pub(super) subject: &'a Subject,
    /// The number of the drop of this model.
    pub(super) number: u32,
    pub(super) mix: Mix,
    /// Largest side \[m\].
    pub(super) size: f64,
    pub(super) plane: RelativePlane,
    plane_number: u32,
    /// Simulated time \[s\].
    pub(super) seconds: f32,
}

impl<'a> Sample<'a> {
    /// Number of all drops of a model.
    pub(super) const ALL: u32 = PAIRS * PLANES;

    /// Returns the first `count` drops of a model, at most [`Sample::ALL`].
    ///
    /// The first 40 have every mix in every size; every plane is taken as often as the others.
    pub(super) fn first(subject: &'a Subject, count: u32, seconds: f32) -> Vec<Self> {
        let planes = RelativePlane::seeded(SEED, PLANES);
        let numbered = |k: u32| {
            let plane_number = (k % PAIRS + k / PAIRS) % PLANES;
            Self {
                subject,
                number: k,
                mix: Mix::numbered(k % MIXES),
                size: SIZES[k as usize % SIZES.len()],
                plane: planes[plane_number as usize],
                plane_number,
                seconds,
            }
        };
        (0..count.min(Self::ALL)).map(numbered).collect()
    }

    /// Describes the drop for someone who wants to repeat it.
    pub(super) fn describe(&self) -> String {
        let Self { subject, mix, .. } = self;
        let parts = [
            (mix.volume, "volume"),
            (mix.springs, "springs"),
            (mix.contacts, "contacts"),
        ];
        let parts: Vec<&str> = (parts.iter())
            .filter_map(|&(is, name)| is.then_some(name))
            .collect();
        let parts = match parts.is_empty() {
            true => "shell".to_owned(),
            false => parts.join("+"),
        };
        let size = self.size;
        format!(
            "{}, {size} m, {parts}, plane {}",
            subject.name, self.plane_number
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stability::subjects::load;
    use std::collections::HashSet;

    #[test]
    fn forty_drops_have_all_mixes_in_all_sizes_and_all_are_different() {
        let subjects = load(None).unwrap();
        let described = |count| -> Vec<String> {
            let samples = Sample::first(&subjects[0], count, 1.0);
            samples.iter().map(Sample::describe).collect()
        };
        let pairs: HashSet<String> = (described(40).iter())
            .map(|text| text.rsplit_once(", plane").unwrap().0.to_owned())
            .collect();
        assert_eq!(pairs.len(), 40);
        let all = described(u32::MAX);
        assert_eq!(all.len(), 800);
        assert_eq!(all.iter().collect::<HashSet<_>>().len(), 800);
    }
}
