//! [`BodyRows`]: the contacts of one body, in rows of vertices that threads fill independently.

use super::edges::MovingEdge;
use super::persistent::PersistentContact;
use incise_mesh::VertexId;
use incise_pbd_gpu::Contact;

/// Number of vertex slots of a row.
pub(super) const ROW: usize = 512;

/// A contact of a vertex of one body with a triangle of the same or another one, or with a plane.
#[derive(Debug, Clone, Copy)]
pub(crate) struct BodyContact {
    /// Index of the triangle's body.
    pub(crate) other: u32,
    /// The vertices of its first feature are those of the searched body.
    pub(crate) contact: Contact,
}

/// The contacts of one row, in memory reused between frames.
#[derive(Debug, Clone, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Row {
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(super) contacts: Vec<BodyContact>,
    pub(super) persistent: Vec<PersistentContact>,
    /// Scratch memory: the current vertex and its neighbors, excluded from self-collision.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(super) one_ring: Vec<VertexId>,
    /// Scratch memory: the bodies that the current vertex may touch.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(super) near: Vec<u32>,
    /// Sharp edges near other pieces, until they are tested.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(super) edges: Vec<MovingEdge>,
}

/// The contacts of the vertices of one body, in memory reused between frames.
#[derive(Debug, Clone, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct BodyRows {
    pub(super) rows: Vec<Row>,
    /// Contacts of its edges with later ones.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(super) edge_contacts: Vec<BodyContact>,
    /// The persistent contacts of the previous frame, ascending by vertex.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(super) previous: Vec<PersistentContact>,
    /// By vertex slot: first index into `previous`, or `u32::MAX`.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(super) previous_of_vertex: Vec<u32>,
}

impl BodyRows {
    /// Returns the contacts in the order of vertices, then those of edges.
    pub(super) fn contacts(&self) -> impl Iterator<Item = &BodyContact> {
        let of_vertices = self.rows.iter().flat_map(|row| &row.contacts);
        of_vertices.chain(&self.edge_contacts)
    }

    /// Returns the same contacts for changes.
    pub(super) fn contacts_mut(&mut self) -> impl Iterator<Item = &mut BodyContact> {
        let of_vertices = self.rows.iter_mut().flat_map(|row| &mut row.contacts);
        of_vertices.chain(&mut self.edge_contacts)
    }

    /// Removes all contacts; those of the last search become the previous ones.
    pub(super) fn begin_frame(&mut self, vertex_slots: usize) {
        self.previous.clear();
        for row in &mut self.rows {
            self.previous.append(&mut row.persistent);
            row.contacts.clear();
        }
        self.edge_contacts.clear();
        self.previous_of_vertex.clear();
        self.previous_of_vertex.resize(vertex_slots, u32::MAX);
        for (i, contact) in (0..).zip(&self.previous) {
            if let Some(first) = self.previous_of_vertex.get_mut(contact.vertex.index()) {
                *first = i.min(*first);
            }
        }
    }

    /// Sets the number of vertex slots that are searched.
    pub(super) fn resize(&mut self, vertex_slots: usize) {
        (self.rows).resize_with(vertex_slots.div_ceil(ROW), Row::default);
    }
}
