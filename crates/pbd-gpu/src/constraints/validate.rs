//! Compares constraints with those of a solver built from scratch, for tests.

use crate::constraints::Constraints;
use crate::constraints::batches::{Batch, ConstraintSet, Slot};
use crate::constraints::coloring::MAX_COLORS;
use crate::constraints::interior_springs::is_inside;
use crate::constraints::rest;
use crate::constraints::volumes::VolumeSet;
use crate::error::InvalidConstraints;
use crate::patches::Patches;
use incise_mesh::{EdgeKey, Surface, Topology, VertexId};

impl Constraints {
    /// Checks every index, rest value and color against a surface.
    pub(crate) fn validate(
        &self,
        surface: &Surface,
        has_volumes: bool,
    ) -> Result<(), InvalidConstraints> {
        if let Some(interior) = &self.interior {
            self.check_surface_is_free()?;
            return interior.validate(surface);
        }
        let topology = surface.topology();
        let (mut stretch, mut bending) = (Vec::new(), Vec::new());
        for h in topology.edges() {
            let twin = topology.twin(h);
            let forward = topology.origin(h) < topology.target(h);
            let (h, twin) = if forward || twin.is_null() {
                (h, twin)
            } else {
                (twin, h)
            };
            let key = EdgeKey::new(topology.origin(h), topology.target(h));
            let [low, high] = key.vertices();
            stretch.push(([low, high], rest::length(surface, [low, high]).to_bits()));
            if !twin.is_null() {
                let opposite = [h, twin].map(|h| topology.origin(h.prev()));
                let vertices = [low, high, opposite[0], opposite[1]];
                bending.push((vertices, rest::angle(surface, vertices).to_bits()));
            }
        }
        let edges = stretch.len();
        check_set(&self.stretch, stretch)?;
        check_layers(&self.stretch, self.patches.as_ref())?;
        if let Some(set) = &self.bending {
            check_set(set, bending)?;
            check_layers(set, self.patches.as_ref())?;
        }
        if let Some(interior_springs) = &self.interior_springs {
            let rest = |&[from, to]: &[VertexId; 2]| {
                let ends = [from.min(to), from.max(to)];
                ([from, to], rest::length(surface, ends).to_bits())
            };
            let expected =
                (interior_springs.all()).flat_map(|batch| batch.vertices().iter().map(rest));
            check_set(interior_springs, expected.collect())?;
            let mut ends = interior_springs.all().flat_map(Batch::vertices);
            if let Some([a, b]) = ends.find(|&&ends| !is_inside(surface, ends)) {
                return broken(
                    "interior springs lie within a piece",
                    Some(EdgeKey::new(*a, *b)),
                );
            }
        }
        let mut expected = VolumeSet::default();
        if has_volumes {
            expected.update(surface);
        }
        let volumes = &self.volumes;
        let is_expected = volumes.pieces() == expected.pieces()
            && volumes.spokes == expected.spokes
            && volumes.rings == expected.rings;
        if !is_expected {
            return broken("one volume constraint per closed piece", None);
        }
        if let Some(patches) = &self.patches
            && let Err(rule) = patches.check(surface)
        {
            return broken(rule, None);
        }
        if self.edges.len() != edges {
            return broken("one record per edge", None);
        }
        self.check_slots(topology)
    }

    /// Checks that no constraint acts between vertices, as in a solid.
    pub(super) fn check_surface_is_free(&self) -> Result<(), InvalidConstraints> {
        let is_free = self.stretch.is_empty()
            && self.bending.is_none()
            && self.interior_springs.is_none()
            && self.volumes.pieces.is_empty();
        if is_free {
            Ok(())
        } else {
            broken("a solid has no constraints of its surface", None)
        }
    }

    fn check_slots(&self, topology: &Topology) -> Result<(), InvalidConstraints> {
        for (color, batch) in self.stretch.numbered() {
            for (index, (&[a, b], &edge)) in batch.vertices().iter().zip(batch.edges()).enumerate()
            {
                let record = self.edges.record(edge);
                let is_known = record.stretch() == Some(Slot { color, index });
                if !is_known || record.ends(topology) != Some([a, b]) {
                    let key = EdgeKey::new(a, b);
                    return broken(
                        "edge records hold the slots of stretch constraints",
                        Some(key),
                    );
                }
            }
        }
        let bending = self.bending.iter().flat_map(ConstraintSet::numbered);
        for (color, batch) in bending {
            for (index, (&[a, b, ..], &edge)) in
                batch.vertices().iter().zip(batch.edges()).enumerate()
            {
                let record = self.edges.record(edge);
                let is_known = record.bending() == Some(Slot { color, index });
                if !is_known || record.ends(topology) != Some([a, b]) {
                    let key = EdgeKey::new(a, b);
                    return broken(
                        "edge records hold the slots of bending constraints",
                        Some(key),
                    );
                }
            }
        }
        Ok(())
    }
}

pub(super) fn broken<T>(
    rule: &'static str,
    edge: Option<EdgeKey>,
) -> Result<T, InvalidConstraints> {
    Err(InvalidConstraints { rule, edge })
}

fn check_set<const N: usize>(
    set: &ConstraintSet<N>,
    mut expected: Vec<([VertexId; N], u32)>,
) -> Result<(), InvalidConstraints> {
    let mut found = Vec::new();
    for batch in set.all() {
        if batch.rest().len() != batch.len() || batch.edges().len() != batch.len() {
            return broken("one rest value and one edge per constraint", None);
        }
        let rest = batch.rest().iter().map(|r| r.to_bits());
        found.extend(batch.vertices().iter().copied().zip(rest));
    }
    found.sort_unstable();
    expected.sort_unstable();
    if found != expected {
        let differing = found.iter().zip(&expected).find(|(a, b)| a != b);
        let edge = differing.map(|((v, _), _)| EdgeKey::new(v[0], v[1]));
        return broken("constraints equal those of the surface", edge);
    }
    let mut masks: Vec<Vec<u64>> = set.color_masks().to_vec();
    masks.iter_mut().for_each(|layer| layer.fill(0));
    for (color, batch) in set.batches().iter().enumerate() {
        let (layer, bit) = (color / MAX_COLORS, 1 << (color % MAX_COLORS));
        for vertices in batch.vertices() {
            for v in vertices {
                let mask = &mut masks[layer][v.index()];
                if *mask & bit != 0 {
                    let edge = EdgeKey::new(vertices[0], vertices[1]);
                    return broken("constraints of a color share no vertex", Some(edge));
                }
                *mask |= bit;
            }
        }
    }
    if masks != set.color_masks() {
        return broken("color masks equal the colors in use", None);
    }
    Ok(())
}

/// Checks that the constraints of a layer lie within its patches.
pub(super) fn check_layers<const N: usize>(
    set: &ConstraintSet<N>,
    patches: Option<&Patches>,
) -> Result<(), InvalidConstraints> {
    for (color, batch) in set.batches().iter().enumerate().skip(MAX_COLORS) {
        let patching = patches.and_then(|patches| patches.of_layer(color / MAX_COLORS));
        for vertices in batch.vertices() {
            if patching.is_none_or(|p| p.shared(vertices).is_none()) {
                let edge = EdgeKey::new(vertices[0], vertices[1]);
                return broken("constraints of a layer lie within its patches", Some(edge));
            }
        }
    }
    Ok(())
}
