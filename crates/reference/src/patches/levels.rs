//! Divides a body into patches of several sizes.

use crate::model::Model;
use nalgebra::Vector3;
use std::ops::Range;

/// Number of times that patches of a level are halved for the next one.
const HALVINGS: usize = 3;

/// Largest number of vertices of the smallest patches above single vertices.
const LEAST: usize = 8;

/// Vertices that move together, and the constraints that others share with them.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Patch {
    pub(super) vertices: Vec<usize>,
    pub(super) stretch: Vec<usize>,
    pub(super) bending: Vec<usize>,
}

/// Returns the patches of all levels of some vertices, the whole body first.
pub(super) fn levels(model: &Model, vertices: &[usize], x: &[Vector3<f64>]) -> Vec<Patch> {
    let mut order = vertices.to_vec();
    let mut parts: Vec<Range<usize>> = std::iter::once(0..order.len()).collect();
    let mut patches = Vec::new();
    while parts.iter().any(|part| part.len() > LEAST) {
        add_level(&mut patches, model, &order, &parts);
        for _ in 0..HALVINGS {
            parts = (parts.into_iter())
                .flat_map(|part| halve(&mut order, part, x))
                .collect();
        }
    }
    add_level(&mut patches, model, &order, &parts);
    let single: Vec<Range<usize>> = (0..order.len()).map(|i| i..i + 1).collect();
    add_level(&mut patches, model, &order, &single);
    patches
}

/// Halves a part of `order` across the longest side of its bounding box.
fn halve(order: &mut [usize], part: Range<usize>, x: &[Vector3<f64>]) -> [Range<usize>; 2] {
    let vertices = &mut order[part.clone()];
    let middle = vertices.len() / 2;
    if let Some(&first) = vertices.first() {
        let corners = vertices.iter().map(|&v| (x[v], x[v]));
        let (low, high) = corners.fold((x[first], x[first]), |(low, high), (a, b)| {
            (low.inf(&a), high.sup(&b))
        });
        let axis = (high - low).imax();
        vertices.select_nth_unstable_by(middle, |&a, &b| x[a][axis].total_cmp(&x[b][axis]));
    }
    let middle = part.start + middle;
    [part.start..middle, middle..part.end]
}

/// Adds the patches of a level.
fn add_level(patches: &mut Vec<Patch>, model: &Model, order: &[usize], parts: &[Range<usize>]) {
    let mut patch_of = vec![None; model.mass.len()];
    for part in parts.iter().filter(|part| !part.is_empty()) {
        let mut vertices = order[part.clone()].to_vec();
        vertices.sort_unstable();
        for &v in &vertices {
            patch_of[v] = Some(patches.len());
        }
        patches.push(Patch {
            vertices,
            ..Patch::default()
        });
    }
    let mut add = |vertices: &[usize], to: fn(&mut Patch) -> &mut Vec<usize>, i: usize| {
        let mut crossed: Vec<Option<usize>> = vertices.iter().map(|&v| patch_of[v]).collect();
        crossed.sort_unstable();
        crossed.dedup();
        if crossed.len() > 1 {
            for patch in crossed.into_iter().flatten() {
                to(&mut patches[patch]).push(i);
            }
        }
    };
    for (i, vertices) in model.stretch.vertices.iter().enumerate() {
        add(vertices, |patch| &mut patch.stretch, i);
    }
    for (i, vertices) in model.bending.vertices.iter().enumerate() {
        add(vertices, |patch| &mut patch.bending, i);
    }
}
