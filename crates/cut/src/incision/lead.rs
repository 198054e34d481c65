//! How far the blade is ahead of each vertex of the tip.

use super::columns::point_at;
use super::map::BladeMap;
use super::{Incision, MIN_STEP, TipPoint};
use incise_mesh::{Surface, Vec3};

/// Motion below which a vertex of the tip keeps its place [local edge lengths].
///
/// The default of [`crate::CutParams::snap`]: walls get no edges that are shorter than those of
/// the rim.
pub(super) const MIN_MOTION: f64 = 0.1;

/// Cosine of the largest angle between a motion that cuts and the way ahead from the tip.
///
/// At 120 degrees a new wall is at least 60 degrees off the walls behind the tip.
const MIN_COSINE: f64 = -0.5;

/// The motion of the blade away from a vertex of the tip.
#[derive(Debug, Clone, Copy)]
pub(super) struct Lead {
    /// Its next place \[m\].
    pub(super) target: Vec3,
    /// Distance, and the part of it ahead and across the blade [local edge lengths].
    distance: f64,
    progress: f64,
    /// Whether the blade is behind the vertex.
    is_behind: bool,
    /// The unit vector ahead; zero at the tip of a sheet.
    pub(super) ahead: Vec3,
}

/// Returns whether the blade is far enough from a vertex of the tip for a step.
pub(super) fn has_moved(leads: &[Lead]) -> bool {
    leads.iter().any(|lead| lead.distance >= MIN_STEP)
}

/// Returns whether the blade is ahead of the tip, on the mean and somewhere by a noticeable
/// distance.
pub(super) fn is_ahead(leads: &[Lead]) -> bool {
    let sum: f64 = leads.iter().map(|lead| lead.progress).sum();
    sum > 0.0 && leads.iter().any(|lead| lead.progress >= MIN_MOTION)
}

/// Returns which vertices of the tip keep their places.
///
/// Those that the blade has not moved away from. Those that it is behind of as well, unless it has
/// turned back as a whole. None if the blade `leaves` the body.
pub(super) fn standing(leads: &[Lead], leaves: bool) -> Vec<bool> {
    let goes_on = |lead: &Lead| lead.distance >= MIN_STEP && !lead.is_behind;
    let has_turned = !leads.iter().any(goes_on);
    let stands =
        |lead: &Lead| !leaves && (lead.distance < MIN_MOTION || (lead.is_behind && !has_turned));
    leads.iter().map(stands).collect()
}

impl Incision {
    /// Returns the motion from each vertex of the tip to a new pose.
    pub(super) fn leads(&self, surface: &Surface, map: &BladeMap, blade: &[[f32; 3]]) -> Vec<Lead> {
        let lead = |i: usize| {
            let point = &self.tip[i];
            let to = map.at(point.parameter, point_at(blade, point.parameter));
            let motion = to - map.vertex(surface, point.vertex);
            let ahead = ahead(surface, map, &self.tip, i);
            let progress = ahead.map_or(motion.norm(), |ahead| motion.dot(&ahead));
            Lead {
                target: to,
                distance: motion.norm() / self.local,
                progress: progress / self.local,
                is_behind: progress < MIN_COSINE * motion.norm(),
                ahead: ahead.unwrap_or_default(),
            }
        };
        (0..self.tip.len()).map(lead).collect()
    }
}

/// Returns the unit vector from a vertex of the tip into the body, away from both walls.
///
/// None at the tip of a sheet.
fn ahead(surface: &Surface, map: &BladeMap, tip: &[TipPoint], i: usize) -> Option<Vec3> {
    let topology = surface.topology();
    let mut back = Vec3::zeros();
    let pairs = [i.checked_sub(1), Some(i)].into_iter().flatten();
    for i in pairs.filter(|&i| tip[i].is_joined && i + 1 < tip.len()) {
        let [from, to] = [i, i + 1].map(|i| tip[i].vertex);
        let half_edge = topology.find_half_edge(from, to)?;
        let [p, q] = [from, to].map(|v| map.vertex(surface, v));
        let along = (q - p).try_normalize(0.0)?;
        for h in [half_edge, topology.twin(half_edge)] {
            let third = map.vertex(surface, topology.origin(h.prev())) - p;
            let across = third - along * along.dot(&third);
            back += across.try_normalize(0.0).unwrap_or_default();
        }
    }
    (-back).try_normalize(0.0)
}
