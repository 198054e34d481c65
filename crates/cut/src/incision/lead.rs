//! How far the blade is ahead of each vertex of the tip.

use super::columns::is_at_boundary;
use super::line::{level_with, point_at};
use super::map::BladeMap;
use super::piercings::Piercing;
use super::{Incision, MIN_STEP, TipPoint};
use incise_mesh::{Surface, Vec3, VertexId};

/// Motion below which a vertex of the tip keeps its place [local edge lengths].
///
/// The default of [`crate::CutParams::snap`]: walls get no edges that are shorter than those of
/// the rim.
pub(super) const MIN_MOTION: f64 = 0.1;

/// Minimum distance of the next places of neighbors along a tip [their distance].
const MIN_SPACING: f64 = 0.1;

/// Cosine of the largest angle between a motion that cuts and the way ahead from the tip.
///
/// At 120 degrees a new wall is at least 60 degrees off the walls behind the tip.
const MIN_COSINE: f64 = -0.5;

/// The motion of the blade away from a vertex of the tip.
#[derive(Debug, Clone, Copy)]
pub(super) struct Lead {
    /// The vertex's place, and its next one \[m\].
    place: Vec3,
    pub(super) target: Vec3,
    /// Distance, and the part of it ahead [local edge lengths]; 0 beyond an end of the blade.
    pub(super) distance: f64,
    progress: f64,
    /// Whether the blade is behind the vertex, and the vertex beyond an end of the blade.
    is_behind: bool,
    is_beyond: bool,
    /// The unit vector ahead.
    pub(super) ahead: Vec3,
}

/// Returns whether the blade is far enough from a vertex of the tip for a step.
pub(super) fn has_moved(leads: &[Lead]) -> bool {
    leads.iter().any(|lead| lead.distance >= MIN_STEP)
}

/// Returns whether the blade is at a vertex of the tip.
pub(super) fn is_at_tip(leads: &[Lead]) -> bool {
    leads
        .iter()
        .any(|lead| !lead.is_beyond && lead.distance < MIN_STEP)
}

/// Returns whether a blade outside of the body has left it across the tip.
///
/// It has not if it is behind the tip, or if most of the tip is beyond an end of the blade, which
/// was pulled out along its edge.
pub(super) fn has_cut_through(leads: &[Lead]) -> bool {
    let beyond = leads.iter().filter(|lead| lead.is_beyond).count();
    let is_across = |lead: &Lead| !lead.is_behind && lead.distance >= MIN_MOTION;
    2 * beyond < leads.len() && leads.iter().any(is_across)
}

/// Returns whether the blade is ahead of the tip, on the mean and somewhere by a noticeable
/// distance.
pub(super) fn is_ahead(leads: &[Lead]) -> bool {
    let sum: f64 = leads.iter().map(|lead| lead.progress).sum();
    sum > 0.0 && leads.iter().any(|lead| lead.progress >= MIN_MOTION)
}

/// Returns which vertices of the tip keep their places.
///
/// A vertex does if it is beyond an end of the blade, if the blade is near, or if the blade is
/// behind it. Two exceptions move vertices: a blade that is behind the whole tip moves it, and one
/// that `leaves` the body moves all vertices between its ends.
pub(super) fn standing(leads: &[Lead], leaves: bool) -> Vec<bool> {
    let goes_on = |lead: &Lead| lead.distance >= MIN_STEP && !lead.is_behind;
    let has_turned = !leads.iter().any(goes_on);
    let stays = |lead: &Lead| lead.distance < MIN_MOTION || (lead.is_behind && !has_turned);
    let stands = |lead: &Lead| lead.is_beyond || (!leaves && stays(lead));
    leads.iter().map(stands).collect()
}

/// Releases single standing vertices and moves them ahead by [`MIN_MOTION`].
///
/// Returns the displacement of each vertex from the blade \[m\]; `local` is the edge length \[m\].
/// Walls stay joined at a vertex that stands. Alone between two that move, it would turn the tip
/// back. Beside an end in the body that moves, the edge between both could not be opened.
pub(super) fn release_isolated(
    leads: &[Lead],
    tip: &[TipPoint],
    stands: &mut [bool],
    local: f64,
) -> Vec<Vec3> {
    let mut offsets = vec![Vec3::zeros(); tip.len()];
    let is_joined = |i: usize| tip[i].is_joined && i + 1 < tip.len();
    let beside = |i: usize| {
        let before = i.checked_sub(1).filter(|&before| is_joined(before));
        [before, Some(i + 1).filter(|_| is_joined(i))]
    };
    let is_inner_end = |i: usize| tip[i].is_inner && beside(i).contains(&None);
    let mut is_done = false;
    while !is_done {
        is_done = true;
        for i in 0..tip.len() {
            let moving = beside(i).map(|other| other.filter(|&other| !stands[other]));
            let is_held = moving.contains(&None) && !moving.into_iter().flatten().any(is_inner_end);
            if stands[i] && !is_held {
                stands[i] = false;
                offsets[i] =
                    leads[i].place + leads[i].ahead * (MIN_MOTION * local) - leads[i].target;
                is_done = false;
            }
        }
    }
    offsets
}

impl Incision {
    /// Returns the motion from each vertex of the tip to its point of a new pose.
    ///
    /// A motion of the blade along its edge moves nothing but a corner of the tip, at which the
    /// blade ends in the body.
    ///
    /// The first result is the tip with the parameters of these points.
    pub(super) fn leads(
        &self,
        surface: &Surface,
        map: &BladeMap,
        blade: &[[f32; 3]],
        piercings: &[Piercing],
    ) -> (Vec<TipPoint>, Vec<Lead>) {
        let (tip, beyond) = self.slid(surface, map, blade, piercings);
        let lead = |i: usize| {
            let point = &tip[i];
            let target = map.at(point.parameter, point_at(blade, point.parameter));
            let place = map.vertex(surface, point.vertex);
            let motion = target - place;
            let ahead = ahead(surface, map, &tip, i);
            let progress = ahead.map_or(motion.norm(), |ahead| motion.dot(&ahead));
            let scale = if beyond[i] { 0.0 } else { 1.0 / self.local };
            Lead {
                place,
                target,
                distance: scale * motion.norm(),
                progress: scale * progress,
                is_behind: progress < MIN_COSINE * motion.norm(),
                is_beyond: beyond[i],
                ahead: ahead.unwrap_or_default(),
            }
        };
        let leads = (0..tip.len()).map(lead).collect();
        (tip, leads)
    }

    /// Returns the tip with parameters that the blade's motion along its edge does not change, and
    /// which of its vertices are beyond an end of the blade.
    ///
    /// A vertex takes the point of the blade that is level with it along the blade's chord. A
    /// corner of the tip, at an end of the blade in the body, keeps that of the end. The tip of a
    /// sheet takes that of the nearest point at which the blade pierces the sheet.
    fn slid(
        &self,
        surface: &Surface,
        map: &BladeMap,
        blade: &[[f32; 3]],
        piercings: &[Piercing],
    ) -> (Vec<TipPoint>, Vec<bool>) {
        let line = map.line(blade);
        let last = line[line.len() - 1].0;
        let chord = line[line.len() - 1].1 - line[0].1;
        let mut tip = self.tip.clone();
        let mut beyond = vec![false; tip.len()];
        let count = tip.len();
        for (i, point) in tip.iter_mut().enumerate() {
            let place = map.vertex(surface, point.vertex);
            let is_in_sheet = is_at_boundary(surface, point.vertex);
            if is_in_sheet && !piercings.is_empty() {
                let kept = map.at(point.parameter, point_at(blade, point.parameter));
                let distance = |p: &&Piercing| (map.piercing(p) - place).norm();
                let nearest = piercings.iter();
                let nearest = nearest.min_by(|a, b| distance(a).total_cmp(&distance(b)));
                let has_slid =
                    |p: &&Piercing| (map.piercing(p) - kept).norm() > MIN_MOTION * self.local;
                if let Some(nearest) = nearest.filter(has_slid) {
                    point.parameter = nearest.parameter;
                }
                continue;
            }
            let (parameter, excess) = level_with(&line, place, point.parameter);
            beyond[i] = excess > MIN_MOTION * self.local;
            let is_corner = point.is_inner && (i == 0 || i + 1 == count);
            if !is_corner && !is_in_sheet {
                point.parameter = parameter;
            }
        }
        // Vertices that stand need no room on the blade.
        let least = |i: usize| match i.checked_sub(1).map(|before| tip[before]) {
            Some(before) if !before.meets_next && !beyond[i - 1] && !beyond[i] => {
                let ends = [before, tip[i]].map(|p| map.vertex(surface, p.vertex));
                MIN_SPACING * (ends[1] - ends[0]).norm() * last / chord.norm()
            }
            _ => 0.0,
        };
        let least: Vec<f64> = (0..count).map(least).collect();
        separate(&mut tip, &least, last);
        (tip, beyond)
    }
}

/// Separates the parameters of vertices of a tip, given the least difference of each from the one
/// before.
///
/// Where a tip runs across the blade, its vertices are level with one point.
fn separate(tip: &mut [TipPoint], least: &[f64], last: f64) {
    for i in 1..tip.len() {
        let before = tip[i - 1].parameter + least[i];
        tip[i].parameter = if tip[i - 1].meets_next {
            tip[i - 1].parameter
        } else {
            tip[i].parameter.max(before)
        };
    }
    let mut end = last;
    for i in (0..tip.len()).rev() {
        tip[i].parameter = tip[i].parameter.min(end);
        end = tip[i].parameter - least[i];
    }
}

/// Returns the unit vector from a vertex of the tip into the body, away from both walls.
///
/// None without walls.
fn ahead(surface: &Surface, map: &BladeMap, tip: &[TipPoint], i: usize) -> Option<Vec3> {
    let topology = surface.topology();
    let own = tip[i].vertex;
    if is_at_boundary(surface, own) {
        return ahead_in_sheet(surface, map, own);
    }
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

/// Returns the unit vector from a vertex on the boundary of a sheet into the sheet.
fn ahead_in_sheet(surface: &Surface, map: &BladeMap, vertex: VertexId) -> Option<Vec3> {
    let topology = surface.topology();
    let beside = topology.outgoing_fan(vertex).flat_map(|h| {
        let before = h.prev();
        let sides = [(h, topology.target(h)), (before, topology.origin(before))];
        sides.map(|(side, end)| topology.twin(side).is_null().then_some(end))
    });
    let place = map.vertex(surface, vertex);
    let to_end = |end| (map.vertex(surface, end) - place).try_normalize(0.0);
    let back: Vec3 = beside.flatten().filter_map(to_end).sum();
    (-back).try_normalize(0.0)
}
