//! What can be asked of a body and set in it: velocities, pins, sums.

use crate::error::ConstraintError;
use crate::plan::Pin;
use crate::solver::{Solver, inverse};
use incise_mesh::{Surface, Vec3, VertexId};

impl Solver {
    /// How fast `v` is [m/s].
    ///
    /// # Panics
    /// When the vertex slot does not exist.
    #[must_use]
    pub fn velocity(&self, v: VertexId) -> [f32; 3] {
        let [x, y, z, _] = self.velocities[v.index()];
        [x, y, z]
    }

    /// All velocities [m/s], last entry 0, shape [vertex slots].
    #[must_use]
    pub fn velocities(&self) -> &[[f32; 4]] {
        &self.velocities
    }

    /// The mass of every vertex \[kg\], shape [vertex slots]. Pinned vertices keep theirs.
    #[must_use]
    pub fn masses(&self) -> &[f32] {
        &self.mass
    }

    /// Sets how fast `v` is [m/s].
    ///
    /// # Errors
    /// [`ConstraintError`] when the vertex is unknown or the velocity is not finite.
    pub fn set_velocity(&mut self, v: VertexId, to: [f32; 3]) -> Result<(), ConstraintError> {
        self.check_vertex(v)?;
        check_value(v, to)?;
        self.velocities[v.index()] = [to[0], to[1], to[2], 0.0];
        self.changes.velocity(v);
        Ok(())
    }

    /// Sets the mass of `v` \[kg\], which else follows from the material and the area at rest: a load, say. An
    /// edit at `v` shares out what is there, loads included.
    ///
    /// # Errors
    /// [`ConstraintError`] when the vertex is unknown or the mass is not a number above 0 with an inverse.
    pub fn set_mass(
        &mut self,
        surface: &mut Surface,
        v: VertexId,
        mass: f32,
    ) -> Result<(), ConstraintError> {
        self.check_vertex(v)?;
        let inverse_mass = inverse(mass);
        if !(mass.is_finite() && inverse_mass > 0.0 && inverse_mass.is_finite()) {
            return Err(ConstraintError::BadMass {
                vertex: v,
                value: mass,
            });
        }
        self.mass[v.index()] = mass;
        if self.pin_of(v).is_err() {
            surface.positions[v.index()][3] = inverse_mass;
        }
        self.changes.mass(v);
        Ok(())
    }

    /// Holds `v` where it is: its inverse mass becomes 0. Pinning a pinned vertex moves its target here.
    ///
    /// # Errors
    /// [`ConstraintError::UnknownVertex`].
    pub fn pin(&mut self, surface: &mut Surface, v: VertexId) -> Result<(), ConstraintError> {
        self.check_vertex(v)?;
        let position = &mut surface.positions[v.index()];
        position[3] = 0.0;
        let target = [position[0], position[1], position[2]];
        self.velocities[v.index()] = [0.0; 4];
        self.changes.mass(v);
        self.changes.velocity(v);
        self.changes.pins();
        match self.pins.binary_search_by_key(&v, |pin| pin.vertex) {
            Ok(i) => self.pins[i].target = target,
            Err(i) => {
                self.pins.insert(i, Pin { vertex: v, target });
                self.tethers.invalidate();
            }
        }
        Ok(())
    }

    /// Lets `v` go, with the velocity that its target gave it.
    ///
    /// # Errors
    /// [`ConstraintError::NotPinned`].
    pub fn unpin(&mut self, surface: &mut Surface, v: VertexId) -> Result<(), ConstraintError> {
        let i = self.pin_of(v)?;
        self.pins.remove(i);
        self.tethers.invalidate();
        self.changes.mass(v);
        self.changes.pins();
        surface.positions[v.index()][3] = inverse(self.mass[v.index()]);
        Ok(())
    }

    /// Where a pinned vertex is to be at the end of the next frame \[m\]; it gets there in equal parts
    /// over the substeps.
    ///
    /// # Errors
    /// [`ConstraintError`] when the vertex is not pinned or the target is not finite.
    pub fn set_pin_target(&mut self, v: VertexId, to: [f32; 3]) -> Result<(), ConstraintError> {
        check_value(v, to)?;
        let i = self.pin_of(v)?;
        self.pins[i].target = to;
        self.changes.pins();
        Ok(())
    }

    /// The pinned vertices, ascending.
    #[must_use]
    pub fn pins(&self) -> &[Pin] {
        &self.pins
    }

    /// The mass of the body \[kg\], pinned vertices included.
    #[must_use]
    pub fn total_mass(&self) -> f64 {
        self.mass.iter().map(|&m| f64::from(m)).sum()
    }

    /// The body's linear momentum [kg m/s].
    #[must_use]
    pub fn momentum(&self) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for (&mass, v) in self.mass.iter().zip(&self.velocities) {
            for k in 0..3 {
                sum[k] += f64::from(mass) * f64::from(v[k]);
            }
        }
        sum
    }

    /// The body's angular momentum about a fixed point \[m\] [kg m^2/s].
    ///
    /// # Panics
    /// When the surface has fewer vertex slots than the body.
    #[must_use]
    pub fn angular_momentum(&self, surface: &Surface, about: [f64; 3]) -> [f64; 3] {
        let mut sum = Vec3::zeros();
        for (i, (&mass, v)) in self.mass.iter().zip(&self.velocities).enumerate() {
            if mass > 0.0 {
                let arm = surface.position(VertexId::from_index(i)) - Vec3::from(about);
                let velocity = Vec3::new(v[0].into(), v[1].into(), v[2].into());
                sum += arm.cross(&velocity) * f64::from(mass);
            }
        }
        sum.into()
    }

    /// The body's kinetic energy \[J\].
    #[must_use]
    pub fn kinetic_energy(&self) -> f64 {
        self.mass
            .iter()
            .zip(&self.velocities)
            .map(|(&mass, v)| {
                let square: f64 = v.iter().map(|&c| f64::from(c) * f64::from(c)).sum();
                f64::from(mass) * square / 2.0
            })
            .sum()
    }

    /// How far edges are from their rest lengths, weighted by length: the sum of `|l - l0|` over the
    /// sum of `l0`. An edge that is next to nothing at rest counts for as little. 0 without edges or
    /// when all rest lengths are 0.
    #[must_use]
    pub fn stretch_error(&self, surface: &Surface) -> f64 {
        let (mut off, mut total) = (0.0, 0.0);
        for batch in self.stretch.all() {
            for (&[a, b], &rest) in batch.vertices().iter().zip(batch.rest()) {
                let length = (surface.position(a) - surface.position(b)).norm();
                off += (length - f64::from(rest)).abs();
                total += f64::from(rest);
            }
        }
        if total > 0.0 { off / total } else { 0.0 }
    }

    /// The mean rest length of edges \[m\]; 0 without any. Looks at every edge.
    #[must_use]
    pub fn mean_rest_length(&self) -> f64 {
        let lengths = self.stretch.all().flat_map(|batch| batch.rest());
        let (sum, count) = lengths.fold((0.0, 0_u32), |(sum, count), &rest| {
            (sum + f64::from(rest), count + 1)
        });
        sum / f64::from(count.max(1))
    }

    fn check_vertex(&self, vertex: VertexId) -> Result<(), ConstraintError> {
        if self.is_vertex(vertex) {
            Ok(())
        } else {
            Err(ConstraintError::UnknownVertex { vertex })
        }
    }

    fn pin_of(&self, vertex: VertexId) -> Result<usize, ConstraintError> {
        self.pins
            .binary_search_by_key(&vertex, |pin| pin.vertex)
            .map_err(|_| ConstraintError::NotPinned { vertex })
    }
}

fn check_value(vertex: VertexId, value: [f32; 3]) -> Result<(), ConstraintError> {
    if value.iter().all(|c| c.is_finite()) {
        Ok(())
    } else {
        Err(ConstraintError::NonFiniteValue { vertex })
    }
}
