//! Origins for meshes that lie far from the coordinates' origin.
//!
//! Coordinates are stored in 32 bits. Far from the origin little of that remains for the shape, so
//! such files are read a second time, relative to a nearby point.

use crate::geometry::Aabb;
use crate::io::build::Builder;
use crate::io::data::{MeshData, Warning};
use crate::io::error::ParseError;
#[cfg(doc)]
use crate::surface::Surface;

/// Distance from the origin, in diagonals, beyond which coordinates get another origin.
const FAR: f64 = 100.0;

/// Reads a file with `read`, relative to a nearby origin if it is far from its own.
///
/// The first pass rounds numbers to 32 bits at once. Only files far from the origin have a second.
pub(super) fn read_near_origin(
    read: impl Fn(&mut Builder) -> Result<(), ParseError>,
) -> Result<MeshData, ParseError> {
    let mut builder = Builder::default();
    read(&mut builder)?;
    let data = builder.finish()?;
    let origin = nearby_origin(&Aabb::around(data.positions.iter().copied()));
    if origin == [0.0; 3] {
        return Ok(data);
    }
    let mut builder = Builder::with_origin(origin);
    read(&mut builder)?;
    let mut data = builder.finish()?;
    data.warnings.push(Warning::OriginMoved { origin });
    Ok(data)
}

/// Returns an origin for positions in `bounds`: a near point if they are far away, else zero.
///
/// Far is a distance of more than 100 diagonals. Positions of 64 bits keep their digits if it is
/// subtracted before they are rounded to 32 bits, see [`Surface::set_origin`]. It lies on a grid of
/// the box's size, so that round coordinates stay round. That of an empty box is zero.
#[must_use]
pub fn nearby_origin(bounds: &Aabb) -> [f64; 3] {
    if bounds.min[0] > bounds.max[0] {
        return [0.0; 3];
    }
    let center = bounds.center();
    // Vertices closer than the spacing of 32-bit numbers may have become one.
    let spacing = center.amax() * f64::from(f32::EPSILON);
    let size = bounds.diagonal().max(spacing);
    if center.amax() <= FAR * size {
        return [0.0; 3];
    }
    let cell = next_power_of_two(size);
    // Adding 0 turns -0 into 0.
    [center.x, center.y, center.z].map(|x| (x / cell).round() * cell + 0.0)
}

/// Returns the smallest power of two that is at least a positive normal number.
fn next_power_of_two(x: f64) -> f64 {
    const EXPONENT: u64 = 0x7ff << 52;
    let power = f64::from_bits(x.to_bits() & EXPONENT);
    if power < x { 2.0 * power } else { power }
}

#[cfg(test)]
mod tests;
