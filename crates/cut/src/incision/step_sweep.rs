//! [`StepSweep`]: the sweep of one step, from the tip to the blade.

use super::columns::{self, Column, Extent, Poses, spread};
use super::line::point_at;
use super::{Approach, Incision};
use crate::error::CutError;
use crate::intersection::continued_tip::{ContinuedTip, TipPart};
use crate::search::Search;
use crate::sweep::Sweep;
use incise_mesh::geometry::to_f32;
use incise_mesh::{HalfEdge, Surface, Vec3, VertexId, index_u32};

/// Displacements of the sweep's free edge out of the body, tried in order [local edge lengths].
///
/// Ahead of a blade that leaves the body, and behind one that enters it.
///
/// In the rest shape the blade's place is known up to second order in its motion.
pub(super) const REACHES: [f64; 5] = [0.0, 0.125, 0.25, 0.5, 1.0];

/// The sweep of one step, the tip that it continues, and its points' parameters on the blade.
pub(crate) struct StepSweep {
    pub(crate) sweep: Sweep,
    /// The sweep in the present shape, if it is another one and has an area.
    pub(crate) present: Option<Sweep>,
    pub(crate) tip: ContinuedTip,
    pub(crate) parameters: Vec<f64>,
    /// Whether its first and its last rib must be outside of the body.
    pub(crate) ends_outside: [bool; 2],
}

impl Incision {
    /// Returns the sweep from the tip, or from the last pose, to a new pose.
    ///
    /// None for a motion along the blade's edge.
    ///
    /// # Errors
    /// As [`Sweep::strip`].
    pub(crate) fn step_sweep(
        &mut self,
        surface: &Surface,
        approach: &Approach,
        blade: &[[f32; 3]],
        extent: Extent,
        search: &mut Search<'_>,
    ) -> Result<Option<StepSweep>, CutError> {
        let map = &approach.map;
        let columns = self.front(surface, approach, blade, extent, search);
        let points = |of: fn(&Column) -> Vec3| -> Vec<[f32; 3]> {
            columns.iter().map(|column| to_f32(of(column))).collect()
        };
        let sweep = Sweep::strip(&points(|c| c.previous), &points(|c| c.current));
        let sweep = match sweep {
            Err(CutError::BladeDegenerate) => {
                if !self.is_inside() {
                    self.move_without_cut(blade);
                }
                return Ok(None);
            }
            sweep => sweep?,
        };
        let mut tip = ContinuedTip {
            parts: parts_of(surface, &columns),
            present: Vec::new(),
        };
        let mut present = None;
        if !map.is_identity() {
            let current = columns.iter().map(|c| point_at(blade, c.parameter));
            tip.present.extend(current);
            let previous = columns.iter().map(|c| {
                let place = (!c.vertex.is_null()).then(|| surface.rest_position(c.vertex));
                to_f32(place.unwrap_or_else(|| point_at(&self.pose, c.parameter)))
            });
            let previous: Vec<[f32; 3]> = previous.collect();
            let current: Vec<[f32; 3]> = tip.present.iter().map(|&p| to_f32(p)).collect();
            present = Sweep::strip(&previous, &current).ok();
        }
        Ok(Some(StepSweep {
            sweep,
            present,
            tip,
            parameters: columns.iter().map(|c| c.parameter).collect(),
            ends_outside: if extent.is_bounded {
                ends_outside(&columns, map.corners.outer)
            } else {
                [false; 2]
            },
        }))
    }

    /// Returns the points of the next sweep.
    ///
    /// For a blade outside of the body, the front is displaced until it is outside as well, or not
    /// at all if it never is.
    fn front(
        &self,
        surface: &Surface,
        approach: &Approach,
        blade: &[[f32; 3]],
        extent: Extent,
        search: &mut Search<'_>,
    ) -> Vec<Column> {
        let closing = approach.closing.as_ref();
        let reaches = if approach.leaves {
            &REACHES[..]
        } else {
            &REACHES[..1]
        };
        if !self.is_inside() && !approach.map.is_identity() {
            return self.entry_columns(surface, approach, blade, extent, search);
        }
        let mut first = Vec::new();
        for reach in reaches {
            let offsets: Vec<Vec3> = (approach.offsets.iter().zip(&approach.ahead))
                .map(|(offset, ahead)| offset + ahead * (reach * self.local))
                .collect();
            let poses = Poses {
                map: &approach.map,
                tip: &approach.tip,
                stands: &approach.stands,
                offsets: &offsets,
                last: &self.pose,
                new: closing.map_or(blade, |closing| &closing.blade),
            };
            let mut columns = self.columns(surface, &poses, extent, closing);
            if !self.is_inside() || closing.is_some() {
                return columns;
            }
            let near = search.along(surface, &line(&columns));
            spread(&mut columns, surface, &near, &poses, &self.bends(poses.new));
            if !approach.leaves {
                return columns;
            }
            let near = search.along(surface, &line(&columns));
            if !columns::is_inside(&columns, surface, &near) {
                return columns;
            }
            if first.is_empty() {
                first = columns;
            }
        }
        first
    }
}

/// Returns the front of some columns.
fn line(columns: &[Column]) -> Vec<Vec3> {
    columns.iter().map(|column| column.current).collect()
}

/// Returns whether the first and the last of some columns are beside the tip, or for a blade
/// without a tip its outer corners.
fn ends_outside(columns: &[Column], outer: [Option<f64>; 2]) -> [bool; 2] {
    let has_tip = columns.iter().any(Column::is_tip);
    let is_outside = |column: Option<&Column>, corner: Option<f64>| {
        column.is_some_and(|c| !c.is_tip() && (has_tip || corner == Some(c.parameter)))
    };
    let ends = [columns.first(), columns.last()];
    [0, 1].map(|k| is_outside(ends[k], outer[k]))
}

/// Returns the parts of the tip at some columns.
fn parts_of(surface: &Surface, columns: &[Column]) -> Vec<TipPart> {
    let mut parts: Vec<TipPart> = Vec::new();
    let mut is_joined = false;
    for (corner, column) in (0..).zip(columns) {
        let Column { vertex, begins, .. } = *column;
        let last = parts.last_mut().filter(|_| is_joined);
        // No part ends at a column where another one begins, unless it is joined to it.
        if !last.is_some_and(|part| extend(part, surface, corner, vertex))
            && !vertex.is_null()
            && begins == vertex
        {
            parts.push(TipPart::of(corner, vertex));
        }
        if begins != vertex {
            parts.push(TipPart::of(corner, begins));
        }
        is_joined = column.is_joined;
    }
    let count = index_u32(columns.len());
    let closing = (count..2 * count).zip(columns).rev();
    let mut closing = closing.filter(|(_, column)| !column.closes.is_null());
    let Some((corner, column)) = closing.next() else {
        return parts;
    };
    let mut border = TipPart::of(corner, column.closes);
    for (corner, column) in closing {
        extend(&mut border, surface, corner, column.closes);
    }
    let Some(tip) = parts.pop() else {
        return vec![border];
    };
    // Where the blade begins in the body, both meet at the first column there.
    if columns[0].closes.is_null() {
        joined(surface, tip, border)
    } else {
        joined(surface, border, tip)
    }
}

/// Appends a vertex to a part of the tip, unless it is the last one. Returns whether it is there.
fn extend(part: &mut TipPart, surface: &Surface, corner: u32, vertex: VertexId) -> bool {
    if vertex == part.last() {
        return true;
    }
    let half_edge = surface.topology().find_half_edge(part.last(), vertex);
    if let Some(half_edge) = half_edge {
        part.push(half_edge, corner, vertex);
    }
    half_edge.is_some()
}

/// Joins the tip and the border of its slit, which may share a vertex in the body, at the end of
/// the first one, and have an edge between them at the surface, at its beginning.
fn joined(surface: &Surface, mut first: TipPart, mut last: TipPart) -> Vec<TipPart> {
    let edge = surface
        .topology()
        .find_half_edge(last.last(), first.vertices[0]);
    if first.last() == last.vertices[0] {
        first.append(HalfEdge::NULL, &last);
        first.half_edges.extend(edge);
        return vec![first];
    }
    if let Some(edge) = edge {
        last.append(edge, &first);
        return vec![last];
    }
    vec![first, last]
}
