//! [`SavedContacts`]: the contacts that persist to the next frame, and blade faces, for files.

use super::ContactDetection;
use super::blade_face::{BladeFace, Pose};
use super::body_rows::BodyRows;
use super::edge_pairs::EdgePair;
use super::overlaps::Overlaps;
use super::persistent::PersistentContact;
use incise_mesh::{HalfEdge, TriangleId, Vec3, VertexId};
use incise_pbd_gpu::ContactKind;
use serde::{Deserialize, Serialize};

/// The persistent contacts of a scene, as they are saved.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct SavedContacts {
    /// By body index, in order of vertices.
    vertices: Vec<Vec<SavedContact>>,
    edges: Vec<SavedEdgePair>,
    overlaps: Overlaps,
}

/// See [`PersistentContact`].
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
struct SavedContact {
    vertex: VertexId,
    other: u32,
    triangle: TriangleId,
    corners: [VertexId; 3],
    kind: ContactKind,
    is_behind: bool,
    weights: [f64; 3],
    offset: [f64; 3],
}

/// See [`EdgePair`].
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
struct SavedEdgePair {
    key: [(u32, HalfEdge); 2],
    ends: [[VertexId; 2]; 2],
    normal: [f64; 3],
}

impl ContactDetection {
    /// Returns the contacts of the last search as plain data for a file.
    pub(crate) fn to_saved(&self) -> SavedContacts {
        let of_body = |rows: &BodyRows| rows.persistent().map(SavedContact::new).collect();
        SavedContacts {
            vertices: self.rows.iter().map(of_body).collect(),
            edges: self.edges.found().iter().map(SavedEdgePair::new).collect(),
            overlaps: self.overlaps.clone(),
        }
    }

    /// Returns saved contacts of a number of bodies, if they fit.
    ///
    /// The search ignores a contact with a triangle that does not exist.
    pub(crate) fn from_saved(saved: SavedContacts, bodies: usize) -> Option<Self> {
        let is_finite = |pair: &SavedEdgePair| pair.normal.iter().all(|c| c.is_finite());
        if saved.vertices.len() > bodies
            || !saved.edges.iter().all(is_finite)
            || !saved.overlaps.is_valid()
        {
            return None;
        }
        let mut detection = Self::default();
        let of_body = |contacts: Vec<SavedContact>| {
            BodyRows::with_persistent(contacts.into_iter().map(SavedContact::into_contact))
        };
        detection
            .rows
            .extend(saved.vertices.into_iter().map(of_body));
        let pairs = saved.edges.into_iter().map(SavedEdgePair::into_pair);
        detection.edges.set_found(pairs.collect());
        detection.overlaps = saved.overlaps;
        Some(detection)
    }
}

impl SavedContact {
    fn new(contact: &PersistentContact) -> Self {
        Self {
            vertex: contact.vertex,
            other: contact.other,
            triangle: contact.triangle,
            corners: contact.corners,
            kind: contact.kind,
            is_behind: contact.is_behind,
            weights: contact.weights,
            offset: contact.offset.into(),
        }
    }

    fn into_contact(self) -> PersistentContact {
        PersistentContact {
            vertex: self.vertex,
            other: self.other,
            triangle: self.triangle,
            corners: self.corners,
            kind: self.kind,
            is_behind: self.is_behind,
            weights: self.weights,
            offset: Vec3::from(self.offset),
        }
    }
}

impl SavedEdgePair {
    fn new(pair: &EdgePair) -> Self {
        Self {
            key: pair.key,
            ends: pair.ends,
            normal: pair.normal.into(),
        }
    }

    fn into_pair(self) -> EdgePair {
        EdgePair {
            key: self.key,
            ends: self.ends,
            normal: Vec3::from(self.normal),
        }
    }
}

/// A [`BladeFace`] of the last frame, as it is saved: previous and current pose.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
pub(crate) struct SavedFace([SavedPose; 2]);

/// Origin, both sides \[m\] and unit normal.
type SavedPose = [[f64; 3]; 4];

impl BladeFace {
    /// Returns the face as plain data for a file.
    pub(crate) fn to_saved(self) -> SavedFace {
        let saved = |pose: Pose| {
            let [a, b] = pose.sides;
            [pose.origin, a, b, pose.normal].map(<[f64; 3]>::from)
        };
        SavedFace([self.previous, self.current].map(saved))
    }

    /// Returns a saved face.
    pub(crate) fn from_saved(SavedFace(saved): SavedFace) -> Self {
        let [previous, current] = saved.map(|pose| {
            let [origin, a, b, normal] = pose.map(Vec3::from);
            Pose {
                origin,
                sides: [a, b],
                normal,
            }
        });
        Self { previous, current }
    }
}
