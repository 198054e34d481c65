//! Element ids: a `u32` newtype for each kind, printed with its letter; null is `u32::MAX`.

use bytemuck::{Pod, Zeroable};
use std::fmt;

/// Converts an index or a count to the 32 bits of stored ids.
///
/// # Panics
/// If `index` exceeds `u32::MAX`. No array of a surface or of its constraints is that long, because
/// half-edge ids have 32 bits.
#[must_use]
#[inline]
#[expect(clippy::cast_possible_truncation, reason = "checked one line above")]
pub const fn index_u32(index: usize) -> u32 {
    assert!(
        index <= u32::MAX as usize,
        "arrays have at most 2^32 elements"
    );
    index as u32
}

macro_rules! id {
    ($(#[$doc:meta])* $name:ident, $letter:literal) => {
        $(#[$doc])*
        #[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Pod, Zeroable)]
        #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
        #[repr(transparent)]
        pub struct $name(pub u32);

        impl $name {
            /// The null id.
            pub const NULL: Self = Self(u32::MAX);

            /// Returns the id of the element at `index` of its array.
            ///
            /// # Panics
            /// If `index` is not below `u32::MAX`.
            #[must_use]
            #[inline]
            pub fn from_index(index: usize) -> Self {
                u32::try_from(index)
                    .ok()
                    .filter(|&id| id != u32::MAX)
                    .map(Self)
                    .expect("arrays have fewer than 2^32 - 1 elements")
            }

            /// Returns the element's index in arrays of its kind.
            #[must_use]
            #[inline]
            pub const fn index(self) -> usize {
                self.0 as usize
            }

            /// Returns whether the id is null.
            #[must_use]
            #[inline]
            pub const fn is_null(self) -> bool {
                self.0 == u32::MAX
            }
        }

        impl Default for $name {
            /// Returns the null id.
            fn default() -> Self {
                Self::NULL
            }
        }

        impl fmt::Display for $name {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                if self.is_null() {
                    write!(f, concat!($letter, "-"))
                } else {
                    write!(f, concat!($letter, "{}"), self.0)
                }
            }
        }

        impl fmt::Debug for $name {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                fmt::Display::fmt(self, f)
            }
        }
    };
}

id!(
    /// A vertex of a surface, and the particle with the same index.
    VertexId,
    "v"
);
id!(
    /// A triangle of a surface.
    TriangleId,
    "t"
);
id!(
    /// A directed edge of a triangle, and the corner at its origin.
    ///
    /// Half-edge `3t + i` runs from corner `i` of triangle `t` to the next corner.
    HalfEdge,
    "h"
);

impl TriangleId {
    /// Returns the triangle's half-edges, in order.
    #[must_use]
    #[inline]
    pub const fn half_edges(self) -> [HalfEdge; 3] {
        [
            HalfEdge(3 * self.0),
            HalfEdge(3 * self.0 + 1),
            HalfEdge(3 * self.0 + 2),
        ]
    }
}

impl HalfEdge {
    /// Returns the triangle of the half-edge.
    #[must_use]
    #[inline]
    pub const fn triangle(self) -> TriangleId {
        TriangleId(self.0 / 3)
    }

    /// Returns the next half-edge of the triangle, counterclockwise.
    #[must_use]
    #[inline]
    pub const fn next(self) -> Self {
        // This test costs half as many instructions as one of the remainder.
        if (self.0 + 1).is_multiple_of(3) {
            Self(self.0 - 2)
        } else {
            Self(self.0 + 1)
        }
    }

    /// Returns the previous half-edge of the triangle.
    #[must_use]
    #[inline]
    pub const fn prev(self) -> Self {
        if self.0.is_multiple_of(3) {
            Self(self.0 + 2)
        } else {
            Self(self.0 - 1)
        }
    }
}

/// An undirected edge as its two vertices, the smaller first, packed in one number.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct EdgeKey(u64);

impl EdgeKey {
    /// Returns the key of the edge between `a` and `b`, in either order.
    #[must_use]
    #[inline]
    pub const fn new(a: VertexId, b: VertexId) -> Self {
        let (low, high) = if a.0 < b.0 { (a.0, b.0) } else { (b.0, a.0) };
        Self(((low as u64) << 32) | high as u64)
    }

    /// Returns the edge's vertices, the smaller first.
    #[must_use]
    #[expect(
        clippy::cast_possible_truncation,
        reason = "the two halves are 32 bits each by construction"
    )]
    #[inline]
    pub const fn vertices(self) -> [VertexId; 2] {
        [VertexId((self.0 >> 32) as u32), VertexId(self.0 as u32)]
    }
}

impl fmt::Debug for EdgeKey {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [a, b] = self.vertices();
        write!(f, "{a}-{b}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_steps_around_a_triangle_come_home() {
        for h in (0..9).map(HalfEdge) {
            assert_eq!(h.next().next().next(), h);
            assert_eq!(h.next().prev(), h);
            assert_eq!(h.next().triangle(), h.triangle());
        }
    }

    #[test]
    fn an_edge_key_is_undirected() {
        let (a, b) = (VertexId(7), VertexId(3));
        assert_eq!(EdgeKey::new(a, b), EdgeKey::new(b, a));
        assert_eq!(EdgeKey::new(a, b).vertices(), [b, a]);
    }

    #[test]
    fn ids_print_with_their_letter() {
        assert_eq!(
            format!("{} {:?} {}", VertexId(12), HalfEdge(7), TriangleId::NULL),
            "v12 h7 t-"
        );
    }
}
