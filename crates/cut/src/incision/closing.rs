//! [`Closing`]: the last step of a closed cut, which joins the start of its own slit.

use super::columns::Column;
use super::lead::{Lead, MIN_MOTION};
use super::line::offset;
use super::map::BladeMap;
use super::segment::sagitta;
use super::{Incision, MIN_STEP, TipPoint};
use incise_mesh::geometry::{to_f32, to_f64};
use incise_mesh::{Surface, Vec3, VertexId};

/// The end of a cut at the border of its own slit, along which both walls meet.
///
/// A blade that comes around passes close by that border and hits it nowhere exactly. So the step
/// ends at its vertices, and the piece inside comes free.
#[derive(Debug)]
pub(super) struct Closing {
    /// The vertices of the border, from the surface to the level of the blade's end in the body.
    pub(super) border: Vec<VertexId>,
    /// The blade as it passes the border \[m\].
    pub(super) blade: Vec<[f32; 3]>,
}

impl Incision {
    /// Returns how a motion to a new pose closes the cut, if the blade passes the border behind its
    /// end in the body, ahead of the tip.
    ///
    /// The tip must have one part that ends in the body.
    pub(super) fn closing(
        &self,
        surface: &Surface,
        map: &BladeMap,
        leads: &[Lead],
        blade: &[[f32; 3]],
    ) -> Option<Closing> {
        let last = self.tip.len() - 1;
        let [first_is_inner, last_is_inner] = [0, last].map(|i| self.tip[i].is_inner);
        let is_one = self.tip[..last].iter().all(|point| point.is_joined);
        if !is_one || first_is_inner == last_is_inner {
            return None;
        }
        let inner = if first_is_inner { 0 } else { last };
        let border = &self.borders[usize::from(last_is_inner)];
        if !is_chain(surface, border) || border.last() != Some(&self.tip[inner].vertex) {
            return None;
        }
        let place = |v: VertexId| map.vertex(surface, v);
        let tip = self.tip.iter().map(|point| to_f32(place(point.vertex)));
        let tip: Vec<[f32; 3]> = tip.collect();
        let line = map.line(blade);
        let end = if first_is_inner { 0 } else { line.len() - 1 };
        let way = [place(self.tip[inner].vertex), line[end].1];
        let line: Vec<[f32; 3]> = line.into_iter().map(|(_, point)| to_f32(point)).collect();
        let motion = leads.iter().map(|lead| lead.distance).fold(1.0, f64::max);
        let reach = motion * self.local;
        let passing = |v: VertexId| {
            let p = place(v);
            Passing::from_offsets([&tip, &line].map(|line| offset(line, p)))
        };
        // Where the blade's end is as the blade passes the surface.
        let end = way[0].lerp(&way[1], common_part(&[passing(border[0])]));
        let off = |i: usize| (place(border[i]) - end).norm();
        let mut level = level(border.len(), reach, off)?;
        // An edge of the border to the tip is opened with it.
        if level + 2 == border.len() {
            level += 1;
        }
        let own: Vec<Passing> = border[..level].iter().map(|&v| passing(v)).collect();
        let turn = self
            .path
            .last_displacement(surface, usize::from(first_is_inner));
        let turn = turn.map_or(0.0, |way| way.angle(&own[0].way));
        let part = common_part(&own);
        let ahead: Vec3 = leads.iter().map(|lead| lead.ahead).sum();
        let ahead = ahead.try_normalize(0.0)?;
        let progress = |passing: &Passing| passing.from_tip.dot(&ahead);
        // The blade moves on an arc above its step.
        let excess = |p: &Passing| {
            let height = sagitta(p.way.norm(), turn);
            (p.distance(part) - height).max(0.0)
        };
        let squares: f64 = own.iter().map(|passing| excess(passing).powi(2)).sum();
        let is_near = squares <= own.len() as f64 * (MIN_STEP * self.local).powi(2);
        let is_noticeable = |passing: &Passing| progress(passing) >= MIN_MOTION * self.local;
        let closes = is_near
            && own.iter().any(is_noticeable)
            && own.iter().all(|passing| progress(passing) > 0.0);
        closes.then(|| Closing {
            border: border[..=level].to_vec(),
            blade: between(&self.pose, blade, part),
        })
    }
}

/// Returns the index of the border's vertex that is level with the blade's end, above 0.
///
/// It is the nearest in the first run of vertices within `reach`, given their distances \[m\].
fn level(count: usize, reach: f64, distance: impl Fn(usize) -> f64) -> Option<usize> {
    let first = (1..count).find(|&i| distance(i) <= reach)?;
    let near = (first..count).take_while(|&i| distance(i) <= reach);
    near.min_by(|&a, &b| distance(a).total_cmp(&distance(b)))
}

/// A point that the blade passes on its way from the tip.
#[derive(Debug, Clone, Copy)]
struct Passing {
    /// The vector to it from the tip \[m\].
    from_tip: Vec3,
    /// The motion of the blade beside it \[m\].
    way: Vec3,
}

impl Passing {
    /// Makes the passing of a point, given the vectors from it to the tip and to the blade.
    fn from_offsets([to_tip, to_blade]: [Vec3; 2]) -> Self {
        Self {
            from_tip: -to_tip,
            way: to_blade - to_tip,
        }
    }

    /// Returns the distance of the blade after a part of its motion \[m\].
    fn distance(&self, part: f64) -> f64 {
        (self.way * part - self.from_tip).norm()
    }
}

/// Returns the part of the motion after which the blade is nearest to some points, by the sum of
/// squares.
///
/// Points beside a place about which the blade turns hardly count.
fn common_part(passings: &[Passing]) -> f64 {
    let ways: f64 = passings.iter().map(|p| p.way.norm_squared()).sum();
    let progress: f64 = passings.iter().map(|p| p.way.dot(&p.from_tip)).sum();
    let part = progress / ways;
    if part.is_nan() {
        0.0
    } else {
        part.clamp(0.0, 1.0)
    }
}

impl Closing {
    /// Returns the ends of the border along the blade.
    pub(super) fn ends(&self, tip: &[TipPoint]) -> [VertexId; 2] {
        let [outer, inner] = [0, self.border.len() - 1].map(|i| self.border[i]);
        if tip[0].is_inner {
            [inner, outer]
        } else {
            [outer, inner]
        }
    }

    /// Returns the columns from the tip to the border, with parameters of the tip.
    ///
    /// Vertices of both are level with each other by their parts of the way along them.
    pub(super) fn columns(&self, surface: &Surface, tip: &[TipPoint]) -> Vec<Column> {
        let is_reversed = tip[0].is_inner;
        let mut tip: Vec<TipPoint> = tip.to_vec();
        if is_reversed {
            tip.reverse();
        }
        let vertices: Vec<VertexId> = tip.iter().map(|point| point.vertex).collect();
        let [own, border] = [&vertices, &self.border].map(|line| parts(surface, line));
        let mut columns = Vec::new();
        let (mut i, mut j) = (0, 0);
        loop {
            let part = border[j].max(own[i]);
            let parameter = match tip.get(i + 1) {
                Some(next) => {
                    let within = (part - own[i]) / (own[i + 1] - own[i]);
                    tip[i].parameter + (next.parameter - tip[i].parameter) * within
                }
                None => tip[i].parameter,
            };
            let ends = [vertices[i], self.border[j]];
            columns.push(Column::closing(surface, parameter, ends));
            match [own.get(i + 1), border.get(j + 1)] {
                [None, None] => break,
                [Some(_), None] => i += 1,
                [None, Some(_)] => j += 1,
                [Some(a), Some(b)] => {
                    i += usize::from(a <= b);
                    j += usize::from(b <= a);
                }
            }
        }
        if is_reversed {
            columns.reverse();
        }
        if let Some(last) = columns.last_mut() {
            last.is_joined = false;
        }
        columns
    }
}

/// Returns whether edges of the surface join some vertices, at least two.
fn is_chain(surface: &Surface, vertices: &[VertexId]) -> bool {
    let topology = surface.topology();
    let is_known =
        |v: &VertexId| v.index() < topology.vertex_slots() && !topology.outgoing(*v).is_null();
    vertices.len() > 1
        && vertices.iter().all(is_known)
        && (vertices.windows(2)).all(|pair| topology.find_half_edge(pair[0], pair[1]).is_some())
}

/// Returns the part of the way along a line of vertices at which each is, 0 to 1.
fn parts(surface: &Surface, line: &[VertexId]) -> Vec<f64> {
    let mut sum = 0.0;
    let mut parts = vec![0.0];
    for pair in line.windows(2) {
        let [a, b] = [pair[0], pair[1]].map(|v| surface.position(v));
        sum += (b - a).norm();
        parts.push(sum);
    }
    parts.iter_mut().for_each(|part| *part /= sum);
    parts
}

/// Returns the pose between two at a part of the motion \[m\].
fn between(from: &[[f32; 3]], to: &[[f32; 3]], part: f64) -> Vec<[f32; 3]> {
    let points = from.iter().zip(to);
    points
        .map(|(&p, &q)| to_f32(to_f64(p) + (to_f64(q) - to_f64(p)) * part))
        .collect()
}
