//! Islands: groups of touching bodies, which are stepped in lockstep.
//!
//! A body without contacts with others is an island of one. `frame.rs` groups the bodies after
//! contact detection; [`step`] steps the islands and returns the bodies to the scene.

mod friction_anchors;
mod step;

use crate::body::Body;
use crate::contacts::{BodyContact, ContactDetection};
use crate::error::SceneError;
#[cfg(feature = "serde")]
use crate::save::LoadError;
use crate::scene::Bodies;
use friction_anchors::FrictionAnchors;
use incise_mesh::{VertexId, index_u32};
use incise_pbd_gpu::Contact;
use step::BodyIsland;

/// Island number of a body that no island steps: it sleeps, or the GPU steps it.
const NONE: u32 = u32::MAX;

/// The islands of a frame, in memory reused between frames.
#[derive(Debug, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Islands {
    /// By body index: parent in the union-find forest.
    #[cfg_attr(feature = "serde", serde(skip))]
    parents: Vec<u32>,
    /// By body index: number of bodies of its tree, at the root.
    #[cfg_attr(feature = "serde", serde(skip))]
    sizes: Vec<u32>,
    /// By body index: its island, or [`NONE`].
    #[cfg_attr(feature = "serde", serde(skip))]
    island_of: Vec<u32>,
    /// By body index: island vertex of its first vertex.
    #[cfg_attr(feature = "serde", serde(skip))]
    first_vertex: Vec<u32>,
    #[cfg_attr(feature = "serde", serde(skip))]
    list: Vec<BodyIsland>,
    /// Number of islands of the frame; memory of others stays in the list.
    #[cfg_attr(feature = "serde", serde(skip))]
    count: usize,
    /// Where friction held contacts in the last frame; those of a body are added with new ones.
    held: FrictionAnchors,
    /// Scratch memory: contacts of a single body.
    #[cfg_attr(feature = "serde", serde(skip))]
    contacts: Vec<Contact>,
}

impl Islands {
    /// Returns the other bodies of a body's island and itself, if it is on the CPU and awake.
    pub(crate) fn members(&self, body: usize) -> Option<&[usize]> {
        let island = *self.island_of.get(body)? as usize;
        self.list.get(island).map(|island| &*island.members)
    }

    /// Returns whether a body is stepped together with others.
    pub(crate) fn is_shared(&self, body: usize) -> bool {
        self.members(body).is_some_and(|members| members.len() > 1)
    }

    /// Groups the awake bodies by their contacts, and passes each island its contacts.
    ///
    /// Bodies of the GPU that touch no other one stay there, but solids only without contacts.
    /// Returns the number of contacts.
    pub(crate) fn group(
        &mut self,
        bodies: &mut Bodies,
        detection: &ContactDetection,
        is_awake: impl Fn(usize) -> bool,
        is_on_gpu: impl Fn(usize) -> bool,
    ) -> Result<usize, SceneError> {
        let is_stepped = |i: usize, body: &Option<Box<Body>>| body.is_some() && is_awake(i);
        self.unite(bodies, detection, is_stepped);
        self.count = 0;
        self.island_of.clear();
        self.island_of.resize(bodies.len(), NONE);
        self.first_vertex.clear();
        self.first_vertex.resize(bodies.len(), 0);
        for (i, body) in bodies.iter().enumerate() {
            let Some(body) = body.as_ref().filter(|_| is_awake(i)) else {
                continue;
            };
            let root = self.root(index_u32(i)) as usize;
            let needs_cpu = body.solver().is_solid() && detection.contacts(i).next().is_some();
            if self.sizes[root] == 1 && is_on_gpu(i) && !needs_cpu {
                continue;
            }
            if self.island_of[root] == NONE {
                self.island_of[root] = index_u32(self.count);
                self.begin_island();
            }
            self.island_of[i] = self.island_of[root];
            let island = &mut self.list[self.island_of[i] as usize];
            island.members.push(i);
            self.first_vertex[i] = island.vertices;
            island.vertices += index_u32(body.surface().positions().len());
        }
        self.assign_contacts(bodies, detection, is_stepped)
    }

    /// Builds the union-find forest of the bodies.
    fn unite(
        &mut self,
        bodies: &Bodies,
        detection: &ContactDetection,
        is_stepped: impl Fn(usize, &Option<Box<Body>>) -> bool,
    ) {
        self.parents.clear();
        self.parents.extend(0..index_u32(bodies.len()));
        self.sizes.clear();
        self.sizes.resize(bodies.len(), 1);
        for (i, _) in bodies.iter().enumerate().filter(|(i, b)| is_stepped(*i, b)) {
            let mut last = index_u32(i);
            for contact in detection.contacts(i).filter(|c| c.other as usize != i) {
                if std::mem::replace(&mut last, contact.other) == contact.other {
                    continue;
                }
                let (a, b) = (self.root(index_u32(i)), self.root(contact.other));
                if a != b {
                    self.parents[a.max(b) as usize] = a.min(b);
                    self.sizes[a.min(b) as usize] += self.sizes[a.max(b) as usize];
                }
            }
        }
    }

    /// Returns the first body of a tree, halving paths on the way.
    fn root(&mut self, mut i: u32) -> u32 {
        while self.parents[i as usize] != i {
            let next = self.parents[self.parents[i as usize] as usize];
            self.parents[i as usize] = next;
            i = next;
        }
        i
    }

    fn begin_island(&mut self) {
        if self.list.len() == self.count {
            self.list.push(BodyIsland::default());
        }
        let island = &mut self.list[self.count];
        island.members.clear();
        island.contacts.clear();
        island.vertices = 0;
        island.done = None;
        self.count += 1;
    }

    /// Passes contacts to the solvers of single bodies and to the islands of others.
    fn assign_contacts(
        &mut self,
        bodies: &mut Bodies,
        detection: &ContactDetection,
        is_stepped: impl Fn(usize, &Option<Box<Body>>) -> bool,
    ) -> Result<usize, SceneError> {
        for (i, body) in bodies.iter().enumerate() {
            if let Some(body) = body.as_ref().filter(|_| is_stepped(i, body)) {
                let contacts = body.solver().contacts();
                self.held.add(contacts, |v| [index_u32(i), v.0]);
            }
        }
        self.held.sort();
        let mut count = 0;
        for i in 0..bodies.len() {
            if !is_stepped(i, &bodies[i]) {
                continue;
            }
            self.contacts.clear();
            let held = |found: &BodyContact| {
                let both = [i, found.other as usize].map(|i| (i, version(bodies, i)));
                let held = self.held.find(&found.contact, both);
                Contact {
                    held,
                    ..found.contact
                }
            };
            if self.is_shared(i) {
                let island = &mut self.list[self.island_of[i] as usize];
                let first = &self.first_vertex;
                let before = island.contacts.len();
                island.contacts.extend(detection.contacts(i).map(|found| {
                    let offsets = [first[i], first[found.other as usize]];
                    shifted(&held(found), offsets)
                }));
                count += island.contacts.len() - before;
            } else {
                self.contacts.extend(detection.contacts(i).map(held));
                count += self.contacts.len();
            }
            if let Some(body) = &mut bodies[i] {
                body.parts().1.set_contacts(&self.contacts)?;
            }
        }
        for island in self.list[..self.count].iter_mut() {
            if island.members.len() > 1 {
                let vertices = island.vertices as usize;
                island.solver.set_contacts(&island.contacts, vertices)?;
            }
        }
        Ok(count)
    }

    /// Keeps where friction held the contacts of shared islands; solvers keep those of a body.
    fn store_friction_anchors(&mut self, bodies: &Bodies) {
        let versions = (0..bodies.len()).map(|i| version(bodies, i));
        self.held.begin(versions);
        let first = &self.first_vertex;
        for island in &self.list[..self.count] {
            let members = &island.members;
            if members.len() > 1 {
                self.held.add(island.solver.contacts(), |v| {
                    let end = members.partition_point(|&i| first[i] <= v.0);
                    let body = members[end - 1];
                    [index_u32(body), v.0 - first[body]]
                });
            }
        }
    }

    /// Forgets the contacts of a body that is edited or moved.
    pub(crate) fn forget(&mut self, body: usize) {
        self.held.forget(body);
    }

    /// Checks a state that was read with serde.
    ///
    /// # Errors
    /// [`LoadError::Array`].
    #[cfg(feature = "serde")]
    pub(crate) fn validate(&self) -> Result<(), LoadError> {
        let array = "held contacts";
        let is_valid = self.held.are_finite();
        is_valid.then_some(()).ok_or(LoadError::Array { array })
    }
}

/// Returns the version of a body's topology, none without the body.
fn version(bodies: &Bodies, body: usize) -> Option<u64> {
    Some(bodies.get(body)?.as_ref()?.topology_version())
}

/// Returns a contact in island vertices, from those of a body and those of the other one.
fn shifted(contact: &Contact, [of_first, of_others]: [u32; 2]) -> Contact {
    let mut out = *contact;
    let first = contact.first_vertex_count();
    for (i, v) in out.vertices.iter_mut().enumerate() {
        if *v != VertexId::NULL {
            v.0 += if i < first { of_first } else { of_others };
        }
    }
    out
}
