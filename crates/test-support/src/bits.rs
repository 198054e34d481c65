//! Hashes of surfaces, which tests in several languages compare.

use incise_mesh::Surface;

/// Returns the CRC-32 (ISO 3309) of bytes that follow those of `crc`.
#[must_use]
pub fn crc32(crc: u32, bytes: impl IntoIterator<Item = u8>) -> u32 {
    let step = |crc: u32, byte| {
        (0..8).fold(crc ^ u32::from(byte), |crc, _| {
            (crc >> 1) ^ (0xedb8_8320 & (crc & 1).wrapping_neg())
        })
    };
    !bytes.into_iter().fold(!crc, step)
}

/// Returns the CRC-32 of positions and triangles of surfaces without gaps.
#[must_use]
pub fn hash<'a>(surfaces: impl IntoIterator<Item = &'a Surface>) -> u32 {
    surfaces.into_iter().fold(0, |crc, surface| {
        let positions = surface.positions().iter();
        let coordinates = positions.flat_map(|&[x, y, z, _]| [x, y, z]);
        let crc = crc32(crc, coordinates.flat_map(f32::to_le_bytes));
        let topology = surface.topology();
        let corners = topology.triangles().flat_map(|t| topology.triangle(t));
        crc32(crc, corners.flat_map(|v| v.0.to_le_bytes()))
    })
}

#[cfg(test)]
mod tests {
    use super::crc32;

    #[test]
    fn the_hash_is_crc_32() {
        assert_eq!(
            crc32(0, *b"123456789"),
            0xcbf4_3926,
            "the check value of CRC-32"
        );
        let halves = crc32(crc32(0, *b"1234"), *b"56789");
        assert_eq!(halves, 0xcbf4_3926, "hashes continue");
    }
}
