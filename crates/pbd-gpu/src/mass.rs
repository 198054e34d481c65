//! Distributes the mass of a body over its vertices by rest area.

use crate::error::ConstraintError;
use crate::material::{Density, Material};
use incise_mesh::{HalfEdge, Surface, VertexId};

/// Minimum share of a vertex relative to the mean, so that degenerate triangles have some mass.
const MIN_SHARE: f64 = 1e-4;

/// Converts areas to shares that sum to 1, none below [`MIN_SHARE`] of the mean.
pub(crate) fn shares_of(areas: &mut [f64]) {
    let mean = areas.iter().sum::<f64>() / areas.len() as f64;
    let min = if mean > 0.0 { mean * MIN_SHARE } else { 1.0 };
    for area in &mut *areas {
        *area = area.max(min);
    }
    let sum: f64 = areas.iter().sum();
    for area in areas {
        *area /= sum;
    }
}

/// Returns a third of a triangle's rest area \[m^2\].
#[inline]
pub(crate) fn third_of_area(surface: &Surface, corners: [VertexId; 3]) -> f64 {
    let [a, b, c] = corners.map(|v| surface.rest_position(v));
    (b - a).cross(&(c - a)).norm() / 6.0
}

/// Returns a third of the rest area of one fan of triangles at `v` \[m^2\].
pub(crate) fn lumped_area(surface: &Surface, v: VertexId) -> f64 {
    let topology = surface.topology();
    let third = |h: HalfEdge| third_of_area(surface, topology.triangle(h.triangle()));
    let first = topology.outgoing(v);
    let (mut sum, mut at) = (0.0, first);
    while !at.is_null() {
        sum += third(at);
        at = topology.twin(at.prev());
        if at == first {
            return sum;
        }
    }
    // At a boundary the rest of the fan lies on the other side of the first half-edge.
    at = first;
    while !at.is_null() {
        let twin = topology.twin(at);
        if twin.is_null() {
            break;
        }
        at = twin.next();
        sum += third(at);
    }
    sum
}

/// Returns the mass \[kg\] of a vertex of a solid by its share of the area, given mass per area
/// [kg/m^2].
#[expect(clippy::cast_possible_truncation, reason = "rounded to storage")]
pub(crate) fn share_by_area(surface: &Surface, v: VertexId, density: f64) -> f32 {
    (density * lumped_area(surface, v)) as f32
}

/// Returns the rest volume [m^3].
fn rest_volume(surface: &Surface) -> f64 {
    let topology = surface.topology();
    let Some(first) = topology.vertices().next() else {
        return 0.0;
    };
    let apex = surface.rest_position(first);
    topology
        .triangles()
        .map(|t| {
            let [a, b, c] = topology
                .triangle(t)
                .map(|v| surface.rest_position(v) - apex);
            a.dot(&b.cross(&c)) / 6.0
        })
        .sum()
}

/// Returns the mass of every vertex \[kg\], 0 for unused slots, shape [vertex slots].
#[expect(
    clippy::cast_possible_truncation,
    reason = "a computed mass is rounded once to storage"
)]
pub(crate) fn masses(surface: &Surface, material: &Material) -> Result<Vec<f32>, ConstraintError> {
    let areas = surface.lumped_rest_areas();
    let total_area: f64 = areas.iter().sum();
    let used: Vec<VertexId> = surface.topology().vertices().collect();
    let mut mass = vec![0.0; areas.len()];
    if used.is_empty() {
        return Ok(mass);
    }
    if total_area <= 0.0 {
        return Err(ConstraintError::NoArea);
    }
    let total = match material.density {
        Density::Area(density) => f64::from(density) * total_area,
        Density::Volume(density) => {
            let volume = rest_volume(surface);
            if volume <= 0.0 {
                return Err(ConstraintError::NoVolume { volume });
            }
            f64::from(density) * volume
        }
    };
    let mut shares: Vec<f64> = used.iter().map(|v| areas[v.index()]).collect();
    shares_of(&mut shares);
    for (v, share) in used.iter().zip(shares) {
        mass[v.index()] = (total * share) as f32;
    }
    Ok(mass)
}
