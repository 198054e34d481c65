//! Particles of a solver: masses, velocities, pins, energy and momentum.

use super::Solver;
use crate::error::ConstraintError;
use crate::particles::{Pin, inverse};
use incise_mesh::{Surface, Vec3, VertexId};

impl Solver {
    /// Returns the velocity of `v` [m/s].
    ///
    /// # Panics
    /// If the vertex slot does not exist.
    #[must_use]
    pub fn velocity(&self, v: VertexId) -> [f32; 3] {
        let [x, y, z, _] = self.particles.velocities[v.index()];
        [x, y, z]
    }

    /// Returns all velocities [m/s], last component 0, shape [vertex slots].
    #[must_use]
    pub fn velocities(&self) -> &[[f32; 4]] {
        &self.particles.velocities
    }

    /// Returns masses, velocities and pins.
    #[cfg(feature = "gpu")]
    pub(crate) fn particles(&self) -> &crate::particles::Particles {
        &self.particles
    }

    /// Returns the particles for the readback from a GPU, which the log does not record.
    #[cfg(feature = "gpu")]
    pub(crate) fn particles_mut(&mut self) -> &mut crate::particles::Particles {
        &mut self.particles
    }

    /// Returns all masses \[kg\], also of pinned vertices, shape [vertex slots].
    ///
    /// Nodes carry the mass of a [solid](crate::Solid): its vertices have shares by area.
    #[must_use]
    pub fn masses(&self) -> &[f32] {
        &self.particles.mass
    }

    /// Sets the velocity of `v` [m/s].
    ///
    /// # Errors
    /// [`ConstraintError`] if the vertex is unknown or the velocity is not finite.
    pub fn set_velocity(&mut self, v: VertexId, to: [f32; 3]) -> Result<(), ConstraintError> {
        self.check_vertex(v)?;
        check_value(v, to)?;
        self.particles.velocities[v.index()] = [to[0], to[1], to[2], 0.0];
        match &mut self.constraints.interior {
            Some(interior) => {
                interior.has_new_velocities = true;
                // Its nodes get other velocities.
                self.follow.log.mark_all();
            }
            None => self.follow.log.mark_velocity(v),
        }
        Ok(())
    }

    /// Copies masses, velocities, pins and the state between substeps of another solver.
    ///
    /// `pairs` are vertices of the other solver, ascending, each with one of this solver.
    ///
    /// # Errors
    /// [`ConstraintError::UnknownVertex`] for a vertex that one of both lacks.
    pub fn copy_motion(
        &mut self,
        surface: &mut Surface,
        from: &Self,
        pairs: &[(VertexId, VertexId)],
    ) -> Result<(), ConstraintError> {
        self.step.time_left = from.step.time_left;
        let mut pins = from.pins().iter().peekable();
        for &(old, new) in pairs {
            from.check_vertex(old)?;
            self.set_mass(surface, new, from.particles.mass[old.index()])?;
            self.set_velocity(new, from.velocity(old))?;
            self.particles.corrections[new.index()] = from.particles.corrections[old.index()];
            while pins.next_if(|pin| pin.vertex < old).is_some() {}
            if let Some(pin) = pins.next_if(|pin| pin.vertex == old) {
                self.pin(surface, new)?;
                self.set_pin_target(new, pin.target)?;
            }
        }
        Ok(())
    }

    /// Sets the mass of `v` \[kg\], for example to add a load.
    ///
    /// By default it follows from material and rest area. An edit at `v` redistributes the mass.
    ///
    /// # Errors
    /// [`ConstraintError`] if the vertex is unknown, or the mass or its inverse is not positive and
    /// finite.
    pub fn set_mass(
        &mut self,
        surface: &mut Surface,
        v: VertexId,
        mass: f32,
    ) -> Result<(), ConstraintError> {
        self.check_surface(surface)?;
        self.check_vertex(v)?;
        let inverse_mass = inverse(mass);
        if !(mass.is_finite() && inverse_mass > 0.0 && inverse_mass.is_finite()) {
            return Err(ConstraintError::BadMass {
                vertex: v,
                value: mass,
            });
        }
        self.particles.mass[v.index()] = mass;
        if self.pin_of(v).is_err() {
            surface.positions_mut()[v.index()][3] = inverse_mass;
        }
        self.mark_mass(v);
        Ok(())
    }

    /// Pins `v` at its current position by setting its inverse mass to 0.
    ///
    /// A pinned vertex gets its current position as target.
    ///
    /// # Errors
    /// [`ConstraintError::UnknownVertex`].
    pub fn pin(&mut self, surface: &mut Surface, v: VertexId) -> Result<(), ConstraintError> {
        self.check_surface(surface)?;
        self.check_vertex(v)?;
        let position = &mut surface.positions_mut()[v.index()];
        position[3] = 0.0;
        let target = [position[0], position[1], position[2]];
        self.particles.velocities[v.index()] = [0.0; 4];
        self.mark_mass(v);
        if !self.is_solid() {
            self.follow.log.mark_velocity(v);
        }
        self.follow.log.mark_pins();
        match self.particles.find_pin(v) {
            Ok(i) => self.particles.pins[i].target = target,
            Err(i) => {
                self.particles.pins.insert(i, Pin { vertex: v, target });
                self.constraints.attachments.invalidate();
            }
        }
        Ok(())
    }

    /// Releases `v` with its current velocity.
    ///
    /// # Errors
    /// [`ConstraintError::NotPinned`].
    pub fn unpin(&mut self, surface: &mut Surface, v: VertexId) -> Result<(), ConstraintError> {
        self.check_surface(surface)?;
        let i = self.pin_of(v)?;
        self.particles.pins.remove(i);
        self.constraints.attachments.invalidate();
        self.mark_mass(v);
        self.follow.log.mark_pins();
        let inverse_mass = match &self.constraints.interior {
            Some(interior) => interior.inverse_masses[v.index()],
            None => self.particles.inverse_mass(v),
        };
        surface.positions_mut()[v.index()][3] = inverse_mass;
        Ok(())
    }

    /// Logs a new inverse mass of a vertex; no node of a solid has another one then.
    fn mark_mass(&mut self, v: VertexId) {
        if !self.is_solid() {
            self.follow.log.mark_mass(v);
        }
    }

    /// Sets the position of a pinned vertex at the end of the next frame \[m\].
    ///
    /// The vertex moves there in equal parts over the substeps.
    ///
    /// # Errors
    /// [`ConstraintError`] if the vertex is not pinned or the target is not finite.
    pub fn set_pin_target(&mut self, v: VertexId, to: [f32; 3]) -> Result<(), ConstraintError> {
        check_value(v, to)?;
        let i = self.pin_of(v)?;
        self.particles.has_moving_pins |= self.particles.pins[i].target != to;
        self.particles.pins[i].target = to;
        self.follow.log.mark_pins();
        Ok(())
    }

    /// Returns the pinned vertices, ascending.
    #[must_use]
    pub fn pins(&self) -> &[Pin] {
        &self.particles.pins
    }

    /// Returns the mass of the body \[kg\], including pinned vertices.
    #[must_use]
    pub fn total_mass(&self) -> f64 {
        let (masses, _) = self.moving_masses();
        masses.iter().map(|&m| f64::from(m)).sum()
    }

    /// Returns the linear momentum of the body [kg m/s].
    ///
    /// Of a solid, that of its nodes, which take velocities that were set in the next step. So do
    /// [`Self::angular_momentum`] and [`Self::kinetic_energy`].
    #[must_use]
    pub fn momentum(&self) -> [f64; 3] {
        let (masses, velocities) = self.moving_masses();
        let mut sum = [0.0; 3];
        for (&mass, v) in masses.iter().zip(velocities) {
            for k in 0..3 {
                sum[k] += f64::from(mass) * f64::from(v[k]);
            }
        }
        sum
    }

    /// Returns the angular momentum of the body about a fixed point \[m\] [kg m^2/s].
    ///
    /// # Panics
    /// If the surface has fewer vertex slots than the body.
    #[must_use]
    pub fn angular_momentum(&self, surface: &Surface, about: [f64; 3]) -> [f64; 3] {
        let (masses, velocities) = self.moving_masses();
        let interior = self.constraints.interior.as_ref();
        let positions = interior.map_or(surface.positions(), |interior| &interior.positions);
        let mut sum = Vec3::zeros();
        for (i, (&mass, v)) in masses.iter().zip(velocities).enumerate() {
            if mass > 0.0 {
                let [x, y, z, _] = positions[i].map(f64::from);
                let arm = Vec3::new(x, y, z) - Vec3::from(about);
                let velocity = Vec3::new(v[0].into(), v[1].into(), v[2].into());
                sum += arm.cross(&velocity) * f64::from(mass);
            }
        }
        sum.into()
    }

    /// Returns the kinetic energy of the body \[J\].
    #[must_use]
    pub fn kinetic_energy(&self) -> f64 {
        let (masses, velocities) = self.moving_masses();
        let of_one = |(&mass, v): (&f32, &[f32; 4])| {
            let square: f64 = v.iter().map(|&c| f64::from(c) * f64::from(c)).sum();
            f64::from(mass) * square / 2.0
        };
        masses.iter().zip(velocities).map(of_one).sum()
    }

    /// Returns masses \[kg\] and velocities [m/s] of what moves: vertices, or nodes of a solid.
    fn moving_masses(&self) -> (&[f32], &[[f32; 4]]) {
        match &self.constraints.interior {
            Some(interior) => (&interior.mass, &interior.velocities),
            None => (&self.particles.mass, &self.particles.velocities),
        }
    }

    /// Returns the relative length error of edges: the sum of `|l - l0|` over the sum of `l0`.
    ///
    /// Returns 0 if the sum of rest lengths is 0.
    #[must_use]
    pub fn stretch_error(&self, surface: &Surface) -> f64 {
        let (mut error, mut total) = (0.0, 0.0);
        for batch in self.constraints.stretch.all() {
            for (&[a, b], &rest) in batch.vertices().iter().zip(batch.rest()) {
                let length = (surface.position(a) - surface.position(b)).norm();
                error += (length - f64::from(rest)).abs();
                total += f64::from(rest);
            }
        }
        if total > 0.0 { error / total } else { 0.0 }
    }

    /// Returns the mean rest length of edges \[m\], or 0 without edges. O(n).
    ///
    /// A solid has that of its surface at creation, O(1).
    #[must_use]
    pub fn mean_rest_length(&self) -> f64 {
        if let Some(interior) = &self.constraints.interior {
            return interior.mean_rest_length;
        }
        let lengths = self
            .constraints
            .stretch
            .all()
            .flat_map(|batch| batch.rest());
        let (sum, count) = lengths.fold((0.0, 0_u32), |(sum, count), &rest| {
            (sum + f64::from(rest), count + 1)
        });
        sum / f64::from(count.max(1))
    }

    /// Returns the length that the motion of the body resolves \[m\]: the mean rest length of its
    /// edges, of a [solid](crate::Solid) the edge of a cell.
    #[must_use]
    pub fn resolution(&self) -> f64 {
        match &self.constraints.interior {
            Some(interior) => interior.lattice.grid.cell_size(),
            None => self.mean_rest_length(),
        }
    }

    /// Checks that a surface has the vertex slots of the solver.
    pub(crate) fn check_surface(&self, surface: &Surface) -> Result<(), ConstraintError> {
        let (surface, solver) = (surface.positions().len(), self.particles.len());
        if surface == solver {
            Ok(())
        } else {
            Err(ConstraintError::SurfaceMismatch { surface, solver })
        }
    }

    fn check_vertex(&self, vertex: VertexId) -> Result<(), ConstraintError> {
        if self.particles.is_used(vertex) {
            Ok(())
        } else {
            Err(ConstraintError::UnknownVertex { vertex })
        }
    }

    fn pin_of(&self, vertex: VertexId) -> Result<usize, ConstraintError> {
        self.particles
            .find_pin(vertex)
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
