//! [`Path`]: the path of a blade through a body, along which it may retract without a cut.

use super::line::{offset, point_at};
use super::segment::{Segment, length, sagittas};
use crate::exact::RimMove;
use incise_mesh::geometry::{to_f32, to_f64};
use incise_mesh::{Surface, Vec3, VertexId};

/// The path of a blade through a body, since it last left its path.
#[derive(Debug, Clone, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Path {
    stations: Vec<Station>,
    /// Whether it starts inside the body, with uncut material behind its first station.
    starts_inside: bool,
}

/// A line across the path: the ends of a tip, or points of a blade at the ends of the cut.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct Station {
    ends: [PathPoint; 2],
    /// Whether the blade enters the body there, so that the step before is not cut.
    is_entry: bool,
}

/// An end of a station.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
enum PathPoint {
    /// A place of the blade \[m\].
    Blade([f32; 3]),
    /// A point on each side of the slit, which are one as long as it is an end of the tip.
    Rim([RimPoint; 2]),
}

/// A pose that may be on the path, see [`Path::find`].
#[derive(Debug, Clone, Copy)]
pub(super) struct PathSearch<'a> {
    pub(super) blade: &'a [[f32; 3]],
    /// Motion of the blade from the place where it was \[m\].
    pub(super) motion: f64,
    /// Maximum distance from the path between coincident walls \[m\].
    pub(super) width: f64,
    pub(super) range: PathRange,
}

/// The part of a path that a search covers.
#[derive(Debug, Clone, Copy)]
pub(super) struct PathRange {
    /// Distance of the blade behind the end of the path before \[m\].
    pub(super) behind: f64,
    /// Whether it includes steps outside of the body, in which nothing was cut.
    pub(super) has_gaps: bool,
    /// Whether the path continues straight beyond its ends outside of the body.
    pub(super) extends: bool,
}

/// A point of a rim, between two of its vertices.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct RimPoint {
    ends: [VertexId; 2],
    /// Part of the way from the first to the second one.
    part: f32,
}

impl RimPoint {
    fn at(vertex: VertexId) -> Self {
        Self {
            ends: [vertex; 2],
            part: 0.0,
        }
    }

    fn position(&self, surface: &Surface) -> Vec3 {
        let [a, b] = self.ends.map(|v| surface.position(v));
        a + (b - a) * f64::from(self.part)
    }

    /// Keeps its place where one of its vertices moves along the rim.
    fn follow(&mut self, moved: &RimMove) {
        let Some(k) = self.ends.iter().position(|&v| v == moved.gone) else {
            return;
        };
        let end = self.ends[1 - k];
        let from_gone = if k == 0 { self.part } else { 1.0 - self.part };
        let part = if end == moved.kept {
            moved.part * (1.0 - from_gone)
        } else if end == moved.other {
            moved.part + from_gone * (1.0 - moved.part)
        } else {
            moved.part
        };
        *self = Self {
            ends: [moved.kept, moved.other],
            part,
        };
    }
}

impl PathPoint {
    /// Returns the middle between both sides, and its distance from them \[m\].
    fn middle(&self, surface: &Surface) -> (Vec3, f64) {
        match self {
            Self::Blade(place) => (to_f64(*place), 0.0),
            Self::Rim(sides) => {
                let [a, b] = sides.map(|point| point.position(surface));
                ((a + b) / 2.0, (b - a).norm() / 2.0)
            }
        }
    }

    fn sides_mut(&mut self) -> Option<&mut [RimPoint; 2]> {
        match self {
            Self::Blade(_) => None,
            Self::Rim(sides) => Some(sides),
        }
    }
}

impl Station {
    fn of_blade(pose: &[[f32; 3]], parameters: [f64; 2]) -> Self {
        Self {
            ends: parameters.map(|parameter| PathPoint::Blade(to_f32(point_at(pose, parameter)))),
            is_entry: false,
        }
    }

    fn of_tip(ends: [VertexId; 2]) -> Self {
        Self {
            ends: ends.map(|vertex| PathPoint::Rim([RimPoint::at(vertex); 2])),
            is_entry: false,
        }
    }

    /// Replaces vertices that both sides share by the two that a step has made of each.
    fn open(&mut self, copies: impl Fn(VertexId) -> Option<[VertexId; 2]>) {
        let sides = self.ends.iter_mut().filter_map(PathPoint::sides_mut);
        for sides in sides.filter(|sides| sides[0] == sides[1]) {
            if let Some(own) = copies(sides[0].ends[0]) {
                *sides = own.map(RimPoint::at);
            }
        }
    }
}

impl Path {
    pub(super) fn clear(&mut self) {
        self.stations.clear();
    }

    pub(super) fn is_empty(&self) -> bool {
        self.stations.is_empty()
    }

    /// Returns whether it ends at a tip or, without one, where it began.
    pub(super) fn ends_inside(&self) -> bool {
        let last = self.stations.last();
        last.is_some_and(|last| matches!(last.ends[0], PathPoint::Rim(_)))
    }

    /// Adds the place at which a blade enters the body, given parameters of the tip's ends.
    ///
    /// `is_inside` is whether the blade was stabbed in there.
    pub(super) fn enter(&mut self, pose: &[[f32; 3]], parameters: [f64; 2], is_inside: bool) {
        if self.is_empty() {
            self.starts_inside = is_inside;
        }
        self.stations.push(Station {
            is_entry: true,
            ..Station::of_blade(pose, parameters)
        });
    }

    /// Adds the place at which a blade has left the body.
    pub(super) fn leave(&mut self, pose: &[[f32; 3]], parameters: [f64; 2]) {
        self.stations.push(Station::of_blade(pose, parameters));
    }

    /// Adds the ends of a tip.
    pub(super) fn push(&mut self, ends: [VertexId; 2]) {
        self.stations.push(Station::of_tip(ends));
    }

    /// Replaces the ends of the last tip by the two vertices that a step has made of each.
    pub(super) fn open_tip(&mut self, copies: impl Fn(VertexId) -> Option<[VertexId; 2]>) {
        if let Some(last) = self.stations.last_mut() {
            last.open(copies);
        }
    }

    /// Replaces all ends by the two vertices that a step has made of each.
    pub(super) fn open(&mut self, copies: impl Fn(VertexId) -> Option<[VertexId; 2]>) {
        self.stations
            .iter_mut()
            .for_each(|station| station.open(&copies));
    }

    /// Keeps the ends of all tips in place where vertices of the slit's rim move along it.
    pub(super) fn follow(&mut self, moves: &[RimMove]) {
        for moved in moves {
            let ends = self
                .stations
                .iter_mut()
                .flat_map(|station| &mut station.ends);
            let points = ends.filter_map(PathPoint::sides_mut).flatten();
            points.for_each(|point| point.follow(moved));
        }
    }

    /// Returns the distance of a blade behind the end of the path \[m\], or none off the path.
    ///
    /// The blade is on the path up to a width and the distance of the walls. A motion too short for
    /// another lap excludes places where the path crosses itself. If the blade was infinitely far
    /// behind, the place nearest to the start is returned.
    pub(super) fn find(&self, surface: &Surface, search: &PathSearch<'_>) -> Option<f64> {
        let PathSearch { width, range, .. } = *search;
        let before = range.behind;
        let reach = 2.0 * (search.motion + width);
        let mut found = None;
        for segment in self.segments(surface) {
            if segment.behind > before + reach {
                break;
            }
            let is_near = before.is_infinite() || segment.behind + segment.length >= before - reach;
            let is_used = is_near && (range.has_gaps || !segment.is_gap);
            if is_used && segment.has(search.blade, [width; 2], range.extends) {
                let parts = segment.parts(search.blade);
                let part = parts.map(|part| part.clamp(0.0, 1.0)).iter().sum::<f64>() / 2.0;
                found = Some(segment.behind + segment.length * (1.0 - part));
                if before.is_finite() {
                    break;
                }
            }
        }
        found
    }

    /// Returns the displacement of an end of the tip in the last step \[m\].
    pub(super) fn last_displacement(&self, surface: &Surface, k: usize) -> Option<Vec3> {
        self.segments(surface)
            .next()
            .map(|segment| segment.displacement(k))
    }

    /// Returns whether a blade is before the start of a path in the body, by more than `width`
    /// \[m\].
    pub(super) fn is_before(&self, surface: &Surface, blade: &[[f32; 3]], width: f64) -> bool {
        self.starts_inside
            && self.segments(surface).last().is_some_and(|first| {
                (first.parts(blade).iter()).all(|part| -part * first.length > width)
            })
    }

    /// Reverses the path, which started in the body at the ends of a tip.
    pub(super) fn reverse(&mut self, start: [VertexId; 2]) {
        let was_entry = |station: &Station| station.is_entry;
        let entries: Vec<bool> = self.stations.iter().map(was_entry).collect();
        self.starts_inside = self.ends_inside();
        self.stations[0] = Station::of_tip(start);
        self.stations.reverse();
        // The step to an entry, in which nothing was cut, is now the one after it.
        for (i, station) in self.stations.iter_mut().enumerate() {
            station.is_entry = i > 0 && entries[entries.len() - i];
        }
    }

    /// Returns whether a blade is nearer to the start of the path than to its end.
    pub(super) fn is_nearer_start(&self, surface: &Surface, blade: &[[f32; 3]]) -> bool {
        let distance = |station: Option<&Station>| -> f64 {
            let ends = station.iter().flat_map(|station| &station.ends);
            ends.map(|end| offset(blade, end.middle(surface).0).norm())
                .sum()
        };
        distance(self.stations.first()) < distance(self.stations.last())
    }

    /// Returns the distance of the last line behind the tip, if all lines are on the path \[m\].
    ///
    /// None unless the last step crosses an earlier one. A line is on the path up to `width` \[m\],
    /// the distance of the walls, and the sagitta of the blade's arc.
    pub(super) fn find_recrossing(
        &self,
        surface: &Surface,
        lines: &[Vec<[f32; 3]>],
        width: f64,
    ) -> Option<f64> {
        let segments = self.segments(surface);
        let segments: Vec<Segment> = segments.take_while(|segment| !segment.is_gap).collect();
        let [last, _, before @ ..] = &segments[..] else {
            return None;
        };
        let has_crossed = |k: usize| before.iter().any(|segment| last.crosses(segment, k));
        if !(0..2).all(has_crossed) {
            return None;
        }
        let find = |line: &Vec<[f32; 3]>| {
            let is_there = |&i: &usize| {
                let heights = sagittas(&segments, i).map(|height| width + height);
                segments[i].has(line, heights, true)
            };
            (1..segments.len()).find(is_there)
        };
        let places = lines.iter().map(find).collect::<Option<Vec<usize>>>()?;
        places.last().map(|&i| segments[i].behind)
    }

    /// Iterates over the steps of the path, from its end to the start.
    fn segments<'a>(&'a self, surface: &'a Surface) -> impl Iterator<Item = Segment> + 'a {
        let slots = surface.topology().vertex_slots();
        let is_known = move |end: &PathPoint| match end {
            PathPoint::Blade(_) => true,
            PathPoint::Rim(sides) => {
                (sides.iter().flat_map(|side| side.ends)).all(|v| v.index() < slots)
            }
        };
        let middles = |station: &Station| station.ends.map(|end| end.middle(surface));
        let last = self.stations.len().saturating_sub(1);
        let mut behind = 0.0;
        let steps = self.stations.windows(2).enumerate().rev();
        steps.map_while(move |(i, pair)| {
            if !pair.iter().flat_map(|station| &station.ends).all(is_known) {
                return None;
            }
            let [from, to] = [middles(&pair[0]), middles(&pair[1])];
            let length = length(from.map(|end| end.0), to.map(|end| end.0));
            let segment = Segment {
                behind,
                length,
                from,
                to,
                enters: i == 0 && !self.starts_inside,
                leaves: i + 1 == last && !self.ends_inside(),
                is_gap: pair[1].is_entry,
            };
            behind += length;
            Some(segment)
        })
    }
}
