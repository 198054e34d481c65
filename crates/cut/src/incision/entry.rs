//! Entries of a blade into a deformed body.
//!
//! As all steps in a deformed body, an entry is cut in the rest shape, where the body overlaps
//! itself nowhere. The blade is known there where it pierces the surface. Before the step it was
//! outside, up to second order in its motion.

use super::Incision;
use super::approach::Approach;
use super::columns::{Column, Extent, MAX_WIDENING, Poses, WIDENING};
use super::piercings::{Piercing, is_pierced};
use super::step_sweep::REACHES;
use crate::search::Search;
use incise_mesh::geometry::area_vector;
use incise_mesh::{Surface, Vec3};

/// Points beside the body at which the line of a blade bends in the rest shape.
#[derive(Debug, Clone, Default)]
pub(super) struct EntryCorners {
    /// Their parameters, ascending.
    pub(super) parameters: Vec<f64>,
    /// The first and the last one, if the blade begins and ends outside of the body.
    pub(super) outer: [Option<f64>; 2],
    /// The mean unit vector out of the body where the blade pierces the surface, at rest.
    outward: Vec3,
}

impl EntryCorners {
    /// Returns the corners beside the ends of a blade's parts in the body, outside of it.
    ///
    /// `bends` are those of the blade, `speeds` lengths at rest per parameter at the ends \[m\],
    /// `local` is the length of edges \[m\].
    pub(super) fn beside(
        surface: &Surface,
        ends: &[Piercing],
        bends: &[f64],
        speeds: &[f64],
        local: f64,
    ) -> Self {
        let end = bends.last().copied().unwrap_or_default();
        let corner = |i: usize| {
            let own = ends[i].parameter;
            let others = ends.iter().map(|end| end.parameter);
            let points = others.chain(bends.iter().copied());
            let next = if ends[i].enters {
                points.filter(|&point| point < own).fold(0.0, f64::max)
            } else {
                points.filter(|&point| point > own).fold(end, f64::min)
            };
            let part = (WIDENING * local / (speeds[i] * (next - own).abs())).min(MAX_WIDENING);
            own + (next - own) * part
        };
        let parameters: Vec<f64> = (0..ends.len()).map(corner).collect();
        let last = ends.len().saturating_sub(1);
        let outer = [(0, true), (last, false)].map(|(i, enters)| {
            let own = ends.get(i).filter(|end| end.enters == enters);
            own.map(|_| parameters[i])
        });
        let normals = ends.iter().map(|end| {
            let corners = surface.topology().triangle(end.triangle);
            let normal = area_vector(corners.map(|v| surface.rest_position(v)));
            normal.try_normalize(0.0).unwrap_or_default()
        });
        let outward = normals.sum::<Vec3>().try_normalize(0.0).unwrap_or_default();
        Self {
            parameters,
            outer,
            outward,
        }
    }
}

impl Incision {
    /// Returns the columns of a step into a deformed body.
    ///
    /// The previous edge is displaced out of the body and back, until it pierces the surface
    /// nowhere, or not at all if it always does.
    pub(super) fn entry_columns(
        &self,
        surface: &Surface,
        approach: &Approach,
        blade: &[[f32; 3]],
        extent: Extent,
        search: &mut Search<'_>,
    ) -> Vec<Column> {
        let poses = Poses {
            map: &approach.map,
            tip: &[],
            stands: &[],
            offsets: &[],
            last: &self.pose,
            new: blade,
        };
        let columns = self.columns(surface, &poses, extent, None);
        let motion: Vec3 = columns.iter().map(|c| c.current - c.previous).sum();
        let motion = motion.try_normalize(0.0).unwrap_or_default();
        let back = approach.map.corners.outward - motion;
        let back = back.try_normalize(0.0).unwrap_or_default();
        let displaced = REACHES.into_iter().map(|reach| {
            let mut columns = columns.clone();
            for column in &mut columns {
                column.previous += back * (reach * self.local);
            }
            columns
        });
        let free = displaced.into_iter().find(|columns| {
            let points: Vec<Vec3> = columns.iter().map(|column| column.previous).collect();
            let near = search.along(surface, &points);
            !is_pierced(&points, surface, &near)
        });
        free.unwrap_or(columns)
    }
}
