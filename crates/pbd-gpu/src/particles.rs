//! Particles of a body: masses, velocities and pins. Positions are those of the surface.

use incise_mesh::VertexId;

/// The masses, velocities and pins of a body. Particle i is vertex i.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Particles {
    /// Mass \[kg\], 0 for unused slots, shape [vertex slots].
    pub(crate) mass: Vec<f32>,
    /// Velocity [m/s], last component 0, shape [vertex slots].
    pub(crate) velocities: Vec<[f32; 4]>,
    /// Internal displacement of the last substep, by constraints without contacts, colliders and
    /// attachments \[m\], last component 0, shape [vertex slots].
    pub(crate) corrections: Vec<[f32; 4]>,
    /// Pinned vertices, ascending.
    pub(crate) pins: Vec<Pin>,
    /// Whether a pin got another target since the last frame.
    pub(crate) has_moving_pins: bool,
}

/// A vertex that moves to a prescribed position.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Pin {
    /// The vertex.
    pub vertex: VertexId,
    /// Its position at the end of the frame \[m\].
    pub target: [f32; 3],
}

impl Particles {
    /// Creates particles at rest without pins.
    pub(crate) fn new(mass: Vec<f32>) -> Self {
        Self {
            velocities: vec![[0.0; 4]; mass.len()],
            corrections: vec![[0.0; 4]; mass.len()],
            mass,
            pins: Vec::new(),
            has_moving_pins: false,
        }
    }

    /// Returns the number of vertex slots.
    pub(crate) fn len(&self) -> usize {
        self.mass.len()
    }

    /// Returns true if a triangle uses the vertex.
    pub(crate) fn is_used(&self, v: VertexId) -> bool {
        self.mass.get(v.index()).is_some_and(|&m| m > 0.0)
    }

    /// Returns the index of a vertex's pin, or the index to insert it at.
    pub(crate) fn find_pin(&self, v: VertexId) -> Result<usize, usize> {
        self.pins.binary_search_by_key(&v, |pin| pin.vertex)
    }

    /// Returns the inverse mass that constraints see: 0 if the vertex is pinned or unused.
    pub(crate) fn inverse_mass(&self, v: VertexId) -> f32 {
        match self.find_pin(v) {
            Ok(_) => 0.0,
            Err(_) => inverse(self.mass[v.index()]),
        }
    }

    /// Adds unused slots, or removes the last ones.
    pub(crate) fn resize(&mut self, slots: usize) {
        self.mass.resize(slots, 0.0);
        self.velocities.resize(slots, [0.0; 4]);
        self.corrections.resize(slots, [0.0; 4]);
    }

    /// Allocates room for more vertices.
    pub(crate) fn reserve(&mut self, vertices: usize) {
        self.mass.reserve(vertices);
        self.velocities.reserve(vertices);
        self.corrections.reserve(vertices);
    }

    /// Returns the allocated size in elements.
    pub(crate) fn capacity(&self) -> usize {
        self.mass.capacity()
            + self.velocities.capacity()
            + self.corrections.capacity()
            + self.pins.capacity()
    }
}

/// Returns the inverse of a mass, or 0 for mass 0.
pub(crate) fn inverse(mass: f32) -> f32 {
    if mass > 0.0 { 1.0 / mass } else { 0.0 }
}
