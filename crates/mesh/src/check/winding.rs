//! Orientation of triangles: consistent within components, and outward.

use super::Defect;
use super::links::{Links, origin};
use super::repair::Repaired;
use super::tally::Tally;
use crate::geometry::{Aabb, area_vector, to_f64};
use crate::ids::TriangleId;
use crate::io::{MeshData, Warning};
use crate::measure::cone_volume;
use crate::partition::Partition;

/// Volume of a closed component, relative to area times diagonal, below which it encloses nothing.
///
/// Rounding in 64 bits leaves about 1e-15 for a flat one; the thinnest sheet in 32 bits has 1e-8.
const FLAT: f64 = 1e-12;

impl Repaired {
    /// Orients each component like most of its triangles.
    pub(super) fn orient(&mut self, links: &Links) {
        let twin = links.twins();
        let (mut reoriented, mut one_sided) = (Tally::default(), Tally::default());
        let mut seen = vec![false; self.triangles.len()];
        for seed in 0..self.triangles.len() {
            if seen[seed] {
                continue;
            }
            seen[seed] = true;
            let mut component = vec![TriangleId::from_index(seed)];
            let mut conflict = None;
            let mut at = 0;
            while let Some(&t) = component.get(at) {
                at += 1;
                for h in t.half_edges() {
                    let other = twin[h.index()];
                    if other.is_null() {
                        continue;
                    }
                    let same_way = origin(&self.triangles, h) == origin(&self.triangles, other);
                    let wanted = self.flipped[t.index()] != same_way;
                    let neighbor = other.triangle();
                    if std::mem::replace(&mut seen[neighbor.index()], true) {
                        if self.flipped[neighbor.index()] != wanted {
                            conflict = Some(neighbor);
                        }
                    } else {
                        self.flipped[neighbor.index()] = wanted;
                        component.push(neighbor);
                    }
                }
            }
            let flips = component.iter().filter(|t| self.flipped[t.index()]).count();
            let majority = 2 * flips > component.len();
            for t in &component {
                self.flipped[t.index()] ^= majority;
            }
            one_sided.note(
                conflict.is_some(),
                conflict.map_or(0, |t| self.sources[t.index()]),
            );
        }
        for (i, t) in self.triangles.iter_mut().enumerate() {
            if reoriented.note(self.flipped[i], self.sources[i]) {
                t.swap(1, 2);
            }
        }
        if let Some((triangle, count)) = one_sided.found() {
            self.defects.push(Defect::NonOrientable { triangle, count });
        } else if let Some((triangle, count)) = reoriented.found() {
            self.warnings.push(Warning::Reoriented { triangle, count });
        }
    }

    /// Finds closed components without volume, and returns the volume of all closed ones \[m^3\].
    ///
    /// If `remove_flat` is set, components without volume beside others are removed.
    pub(super) fn check_volumes(
        &mut self,
        data: &MeshData,
        is_open: bool,
        remove_flat: bool,
    ) -> f64 {
        #[derive(Clone, Copy, Default)]
        struct Component {
            volume: f64,
            area: f64,
            bounds: Aabb,
            is_open: bool,
        }
        let mut parts = Partition::new(self.vertices.len());
        for &[a, b, c] in &self.triangles {
            parts.join(a, b);
            parts.join(a, c);
        }
        let position = |v: u32| data.positions[self.vertices[v as usize] as usize];
        let mut components = vec![Component::default(); self.vertices.len()];
        for t in &self.triangles {
            let root = parts.find(t[0]);
            let component = &mut components[root as usize];
            let corners = t.map(|v| to_f64(position(v)));
            component.volume += cone_volume(corners, to_f64(position(root)));
            component.area += area_vector(corners).norm() / 2.0;
            t.iter().for_each(|&v| component.bounds.grow(position(v)));
        }
        let links = is_open.then(|| Links::new(&self.triangles));
        for edge in links.iter().flat_map(Links::edges) {
            if let [(key, _)] = *edge {
                components[parts.find(key.vertices()[0].0) as usize].is_open = true;
            }
        }
        let is_flat =
            |c: &Component| !c.is_open && c.volume.abs() <= FLAT * c.area * c.bounds.diagonal();
        let mut flat = Tally::default();
        let mut is_reported = vec![false; components.len()];
        let mut is_kept = Vec::with_capacity(self.triangles.len());
        for (t, &source) in self.triangles.iter().zip(&self.sources) {
            let root = parts.find(t[0]) as usize;
            is_kept.push(!is_flat(&components[root]));
            if !std::mem::replace(&mut is_reported[root], true) {
                flat.note(is_flat(&components[root]), source);
            }
        }
        if let Some((triangle, count)) = flat.found() {
            if remove_flat && is_kept.contains(&true) {
                self.retain_triangles(&is_kept);
                self.twins.clear();
                self.warnings
                    .push(Warning::FlatComponentsRemoved { triangle, count });
            } else {
                self.defects.push(Defect::ZeroVolume { triangle, count });
            }
        }
        let closed = components.iter().filter(|c| !c.is_open);
        closed.map(|c| c.volume).sum()
    }

    /// Flips all triangles.
    pub(super) fn invert(&mut self) {
        self.twins.clear();
        for (t, flipped) in self.triangles.iter_mut().zip(&mut self.flipped) {
            t.swap(1, 2);
            *flipped = !*flipped;
        }
        self.warnings.push(Warning::Inverted);
    }
}
