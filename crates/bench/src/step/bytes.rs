//! How many bytes a frame moves if nothing stays in a cache.
//!
//! A projection reads its record, and of each of its vertices the position (16 bytes) and the
//! displacement (16), and writes the displacement (16):
//!
//! | | record | a vertex | together |
//! |---|---|---|---|
//! | stretch, device | 16 | 2 x 48 | 112 |
//! | bending, device | 24 | 4 x 48 | 216 |
//! | stretch, CPU | 12 | 2 x 48 | 108 |
//! | bending, CPU | 20 | 4 x 48 | 212 |
//!
//! Prediction reads a vertex' position and velocity and writes velocity and displacement (64 bytes);
//! integration reads position and displacement and writes position and velocity (64). A frame is
//!
//! `substeps x (128 vertices + iterations x (stretch + bending projections))`
//!
//! for materials without multipliers. Caches and workgroup memory make the true traffic less, access
//! to single vertices in sectors of 32 bytes makes it more.

/// Bytes of a projection's access to one vertex.
const VERTEX: u64 = 48;
/// Bytes of prediction and integration of one vertex.
const MOTION: u64 = 128;

/// Bytes of the constraint records.
#[derive(Debug, Clone, Copy)]
pub(super) struct Records {
    stretch: u64,
    bending: u64,
}

/// Vertex ids and rest value, in arrays of their own.
pub(super) const CPU: Records = Records {
    stretch: 12,
    bending: 20,
};

/// Vertex ids, rest value and multiplier.
#[cfg(feature = "gpu")]
pub(super) const DEVICE: Records = Records {
    stretch: 16,
    bending: 24,
};

/// What a frame works on: all bodies together.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Work {
    pub(super) vertices: u64,
    pub(super) stretch: u64,
    pub(super) bending: u64,
    pub(super) iterations: u64,
    pub(super) substeps: u64,
}

impl Work {
    /// Constraints projected in a frame.
    pub(super) fn projections(&self) -> u64 {
        self.substeps * self.iterations * (self.stretch + self.bending)
    }

    /// Bytes that a frame moves.
    pub(super) fn bytes(&self, records: Records) -> u64 {
        let stretch = self.stretch * (records.stretch + 2 * VERTEX);
        let bending = self.bending * (records.bending + 4 * VERTEX);
        self.substeps * (self.vertices * MOTION + self.iterations * (stretch + bending))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A tetrahedron: 4 vertices, 6 edges, each between two triangles.
    #[test]
    fn a_tetrahedron_counted_by_hand() {
        let work = Work {
            vertices: 4,
            stretch: 6,
            bending: 6,
            iterations: 3,
            substeps: 2,
        };
        assert_eq!(work.projections(), 72);
        // An iteration: 6 x (12 + 96) + 6 x (20 + 192) = 1920; 4 vertices: 512.
        assert_eq!(work.bytes(CPU), 2 * (512 + 3 * 1920));
    }

    #[cfg(feature = "gpu")]
    #[test]
    fn records_of_a_device_are_wider() {
        let work = Work {
            vertices: 4,
            stretch: 6,
            bending: 6,
            iterations: 1,
            substeps: 1,
        };
        // 4 x 128 + 6 x 112 + 6 x 216.
        assert_eq!(work.bytes(DEVICE), 2480);
    }
}
