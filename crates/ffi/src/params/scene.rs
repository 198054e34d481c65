//! Parameters of scenes, materials and colliders.

use super::CutParams;
use crate::status::Error;
use incise::pbd::{self, Density, InteriorSprings, Solid, Stiffness, Volume};
use incise::scene::{self, BackendChoice, BladeMode};
use std::num::NonZeroUsize;

/// Steps all bodies on the CPU.
pub const INCISE_BACKEND_CPU: u32 = 0;
/// Steps all bodies on a GPU; an error without one, and in a library without the feature `gpu`.
pub const INCISE_BACKEND_GPU: u32 = 1;
/// Steps bodies on a GPU where that is faster, else on the CPU.
pub const INCISE_BACKEND_AUTO: u32 = 2;

/// Parameters of a scene; `incise_scene_params_init` writes the defaults.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SceneParams {
    /// Duration of a frame in seconds.
    pub dt: f32,
    /// Gravitational acceleration in meters per second squared; 0, -9.81, 0 by default.
    pub gravity: [f32; 3],
    /// Length of a substep in seconds; 0 for one substep per frame.
    pub substep: f32,
    /// Iterations per substep; each one projects edges, hinges and springs forward and back.
    pub iterations: u32,
    /// Maximum number of threads; 0 for all. The results do not depend on it.
    pub threads: u32,
    /// 1 for contacts between bodies, pieces and blade faces, 0 (default) for none.
    pub contacts: u32,
    /// Minimum distance between surfaces in mean edge lengths.
    pub contact_thickness: f32,
    /// 1 if the triangles of one piece collide with each other.
    pub self_collision: u32,
    /// 1 if bodies at rest fall asleep.
    pub sleep: u32,
    /// 1 if blades may stop inside bodies, 0 if a sweep that ends inside is refused.
    pub progressive: u32,
    /// Maximum number of cuts that `incise_scene_undo` can undo; 0 keeps none.
    pub undo_limit: u32,
    /// `INCISE_BACKEND_CPU`, `INCISE_BACKEND_GPU` or `INCISE_BACKEND_AUTO`; fixed when the scene is
    /// made.
    pub backend: u32,
    /// Parameters of cuts.
    pub cut: CutParams,
}

impl From<&scene::SceneParams> for SceneParams {
    fn from(params: &scene::SceneParams) -> Self {
        let contacts = params.contacts.unwrap_or_default();
        let solver = &params.solver;
        let threads = solver.threads.map_or(0, NonZeroUsize::get);
        Self {
            dt: params.dt,
            gravity: solver.gravity,
            substep: solver.substep.unwrap_or_default(),
            iterations: solver.iterations,
            threads: crate::memory::count(threads),
            contacts: u32::from(params.contacts.is_some()),
            contact_thickness: contacts.thickness,
            self_collision: u32::from(contacts.self_collision),
            sleep: u32::from(params.sleep.is_some()),
            progressive: u32::from(BladeMode::default() == BladeMode::Progressive),
            undo_limit: 256,
            backend: INCISE_BACKEND_CPU,
            cut: CutParams::from(&params.cut),
        }
    }
}

impl SceneParams {
    /// Returns the parameters of the library; `base` has the ones without a field here.
    pub(crate) fn check(&self, base: scene::SceneParams) -> Result<scene::SceneParams, Error> {
        let mut contacts = base.contacts.unwrap_or_default();
        contacts.thickness = self.contact_thickness;
        contacts.self_collision = flag(self.self_collision, "self_collision")?;
        let sleep = base.sleep.unwrap_or_default();
        let params = scene::SceneParams {
            dt: self.dt,
            solver: pbd::SolverParams {
                gravity: self.gravity,
                substep: (self.substep != 0.0).then_some(self.substep),
                iterations: self.iterations,
                threads: NonZeroUsize::new(self.threads as usize),
                ..base.solver
            },
            cut: self.cut.check(base.cut)?,
            contacts: flag(self.contacts, "contacts")?.then_some(contacts),
            sleep: flag(self.sleep, "sleep")?.then_some(sleep),
            ..base
        };
        params.check()?;
        Ok(params)
    }

    /// Returns the backend.
    pub(crate) fn backend(&self) -> Result<BackendChoice, Error> {
        Ok(match self.backend {
            INCISE_BACKEND_CPU => BackendChoice::Cpu,
            INCISE_BACKEND_GPU => BackendChoice::Gpu,
            INCISE_BACKEND_AUTO => BackendChoice::Auto,
            backend => return Err(Error::constant("backend", backend)),
        })
    }

    /// Returns the mode of blades.
    pub(crate) fn blade_mode(&self) -> Result<BladeMode, Error> {
        Ok(match flag(self.progressive, "progressive")? {
            true => BladeMode::Progressive,
            false => BladeMode::FullSlices,
        })
    }
}

/// Returns a yes or no of the header, 1 or 0.
fn flag(value: u32, name: &str) -> Result<bool, Error> {
    match value {
        0 => Ok(false),
        1 => Ok(true),
        _ => Err(Error::argument(format_args!(
            "{name} is {value}; pass 0 or 1"
        ))),
    }
}

/// A solid as heavy as water, 100 kPa.
pub const INCISE_MATERIAL_SOFT_BODY: u32 = 0;
/// A stiff shell that keeps its curvature.
pub const INCISE_MATERIAL_SHELL: u32 = 1;
/// Cloth that does not stretch and bends freely.
pub const INCISE_MATERIAL_CLOTH: u32 = 2;
/// A stiff shell that bends freely.
pub const INCISE_MATERIAL_LIMP_SHELL: u32 = 3;
/// Human skin, 420 kPa.
pub const INCISE_MATERIAL_SKIN: u32 = 4;
/// A healthy human liver, 5.4 kPa.
pub const INCISE_MATERIAL_LIVER: u32 = 5;
/// Relaxed skeletal muscle, 12 kPa.
pub const INCISE_MATERIAL_MUSCLE: u32 = 6;
/// Gelatin of 5 %, 12.5 kPa.
pub const INCISE_MATERIAL_JELLY: u32 = 7;
/// Natural rubber, 2,000 kPa.
pub const INCISE_MATERIAL_RUBBER: u32 = 8;

/// Mass per area, in kg/m^2.
pub const INCISE_DENSITY_AREA: u32 = 0;
/// Mass per volume, in kg/m^3.
pub const INCISE_DENSITY_VOLUME: u32 = 1;

/// No constraints of this kind.
pub const INCISE_STIFFNESS_NONE: u32 = 0;
/// Stiffness of position based dynamics, 0 to 1.
pub const INCISE_STIFFNESS_PBD: u32 = 1;
/// Inverse stiffness of XPBD in m/N, for bending in rad/(N m); 0 is rigid.
pub const INCISE_STIFFNESS_COMPLIANCE: u32 = 2;

/// Material of a body; `incise_material_init` writes a starting point.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Material {
    /// `INCISE_DENSITY_AREA` or `INCISE_DENSITY_VOLUME`.
    pub density_kind: u32,
    /// The density in the unit of its kind.
    pub density: f32,
    /// Kind of the resistance of edges to a change of length; not `INCISE_STIFFNESS_NONE`.
    pub stretch_kind: u32,
    /// Stiffness from 0 to 1, or compliance in m/N.
    pub stretch: f32,
    /// Kind of the resistance of edges to a change of angle.
    pub bending_kind: u32,
    /// Stiffness from 0 to 1, or compliance in rad/(N m).
    pub bending: f32,
    /// 1 if closed pieces resist a change of volume.
    pub has_volume: u32,
    /// Inverse bulk modulus in 1/Pa; 0 is incompressible.
    pub compressibility: f32,
    /// Target volume over rest volume.
    pub pressure: f32,
    /// Kind of springs through the body, which keep its shape.
    pub spring_kind: u32,
    /// Their stiffness from 0 to 1, or compliance in m/N.
    pub spring: f32,
    /// Fraction of vertices with a spring of their own, 0 to 1.
    pub spring_density: f32,
    /// 1 if the body is a solid, whose elasticity replaces stretch, bending, volume and springs.
    pub has_solid: u32,
    /// Young's modulus in Pa.
    pub young_modulus: f32,
    /// Poisson's ratio, 0 to 0.495.
    pub poisson_ratio: f32,
    /// Relaxation time of the viscosity, in s.
    pub relaxation_time: f32,
    /// Length of the edges of a cell in m; 0 for a third of the thickness of the body.
    pub cell_size: f32,
    /// Maximum number of cells along the longest side of the body.
    pub cells_across: u32,
    /// Decay rate of velocities relative to the rigid motion of a piece, in 1/s.
    pub damping: f32,
    /// Coulomb friction coefficient.
    pub friction: f32,
}

impl From<&pbd::Material> for Material {
    fn from(material: &pbd::Material) -> Self {
        let (density_kind, density) = match material.density {
            Density::Area(density) => (INCISE_DENSITY_AREA, density),
            Density::Volume(density) => (INCISE_DENSITY_VOLUME, density),
        };
        let (stretch_kind, stretch) = kind_and_value(Some(material.stretch));
        let (bending_kind, bending) = kind_and_value(material.bending);
        let volume = material.volume.unwrap_or_default();
        let (spring_kind, spring) =
            kind_and_value(material.interior_springs.map(|springs| springs.stiffness));
        let springs = material.interior_springs.unwrap_or_default();
        let solid = material.solid.unwrap_or_default();
        Self {
            density_kind,
            density,
            stretch_kind,
            stretch,
            bending_kind,
            bending,
            has_volume: u32::from(material.volume.is_some()),
            compressibility: volume.compressibility,
            pressure: volume.pressure,
            spring_kind,
            spring,
            spring_density: springs.density,
            has_solid: u32::from(material.solid.is_some()),
            young_modulus: solid.young_modulus,
            poisson_ratio: solid.poisson_ratio,
            relaxation_time: solid.relaxation_time,
            cell_size: solid.cell_size.unwrap_or(0.0),
            cells_across: solid.cells_across,
            damping: material.damping,
            friction: material.friction,
        }
    }
}

impl Material {
    /// Returns a starting point by its constant.
    pub(crate) fn preset(preset: u32) -> Result<Self, Error> {
        let name = pbd::Material::PRESETS.get(preset as usize);
        let material = name.and_then(|name| pbd::Material::preset(name));
        let material = material.ok_or_else(|| Error::constant("preset", preset))?;
        Ok(Self::from(&material))
    }

    /// Returns the material of the library. Ranges are checked when a body is added.
    pub(crate) fn check(&self) -> Result<pbd::Material, Error> {
        let stretch = stiffness(self.stretch_kind, self.stretch, "stretch_kind")?;
        let springs = stiffness(self.spring_kind, self.spring, "spring_kind")?;
        Ok(pbd::Material {
            density: match self.density_kind {
                INCISE_DENSITY_AREA => Density::Area(self.density),
                INCISE_DENSITY_VOLUME => Density::Volume(self.density),
                kind => return Err(Error::constant("density_kind", kind)),
            },
            stretch: stretch.ok_or_else(|| Error::constant("stretch_kind", self.stretch_kind))?,
            bending: stiffness(self.bending_kind, self.bending, "bending_kind")?,
            volume: flag(self.has_volume, "has_volume")?.then_some(Volume {
                compressibility: self.compressibility,
                pressure: self.pressure,
            }),
            interior_springs: springs.map(|stiffness| InteriorSprings {
                density: self.spring_density,
                stiffness,
            }),
            solid: flag(self.has_solid, "has_solid")?.then_some(Solid {
                young_modulus: self.young_modulus,
                poisson_ratio: self.poisson_ratio,
                relaxation_time: self.relaxation_time,
                cell_size: Some(self.cell_size).filter(|&size| size != 0.0),
                cells_across: self.cells_across,
            }),
            damping: self.damping,
            friction: self.friction,
        })
    }
}

fn kind_and_value(stiffness: Option<Stiffness>) -> (u32, f32) {
    match stiffness {
        None => (INCISE_STIFFNESS_NONE, 0.0),
        Some(Stiffness::Pbd(value)) => (INCISE_STIFFNESS_PBD, value),
        Some(Stiffness::Compliance(value)) => (INCISE_STIFFNESS_COMPLIANCE, value),
    }
}

fn stiffness(kind: u32, value: f32, name: &str) -> Result<Option<Stiffness>, Error> {
    match kind {
        INCISE_STIFFNESS_NONE => Ok(None),
        INCISE_STIFFNESS_PBD => Ok(Some(Stiffness::Pbd(value))),
        INCISE_STIFFNESS_COMPLIANCE => Ok(Some(Stiffness::Compliance(value))),
        kind => Err(Error::constant(name, kind)),
    }
}

/// The half-space below `position`, with the outward normal `direction`.
pub const INCISE_COLLIDER_PLANE: u32 = 0;
/// A ball of `radius` around `position`.
pub const INCISE_COLLIDER_SPHERE: u32 = 1;
/// The points within `radius` of the segment from `position` to `end`.
pub const INCISE_COLLIDER_CAPSULE: u32 = 2;
/// A box around `position` with half extents `half`, its first sides along `axes`.
pub const INCISE_COLLIDER_BOX: u32 = 3;

/// A rigid obstacle. Fields that its kind does not name are ignored.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Collider {
    /// One of the `INCISE_COLLIDER_...` constants.
    pub kind: u32,
    /// Radius in meters.
    pub radius: f32,
    /// Point, center or first end in meters.
    pub position: [f32; 3],
    /// Outward normal of a plane.
    pub direction: [f32; 3],
    /// Second end of a capsule in meters.
    pub end: [f32; 3],
    /// Half extents of a box in meters.
    pub half: [f32; 3],
    /// Directions of the first two sides of a box, 3 floats each.
    pub axes: [f32; 6],
}

impl Collider {
    /// Returns the collider of the library; `number` is its place in the caller's array.
    pub(crate) fn check(&self, number: usize) -> Result<pbd::Collider, Error> {
        let [ax, ay, az, bx, by, bz] = self.axes;
        let collider = match self.kind {
            INCISE_COLLIDER_PLANE => pbd::Collider::Plane {
                point: self.position,
                normal: self.direction,
            },
            INCISE_COLLIDER_SPHERE => pbd::Collider::Sphere {
                center: self.position,
                radius: self.radius,
            },
            INCISE_COLLIDER_CAPSULE => pbd::Collider::Capsule {
                ends: [self.position, self.end],
                radius: self.radius,
            },
            INCISE_COLLIDER_BOX => pbd::Collider::Box {
                center: self.position,
                half: self.half,
                axes: [[ax, ay, az], [bx, by, bz]],
            },
            kind => return Err(Error::constant("kind", kind)),
        };
        if collider.is_valid() {
            return Ok(collider);
        }
        Err(Error::argument(pbd::ConstraintError::BadCollider {
            number,
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use incise::scene::ContactParams;

    #[test]
    fn defaults_are_those_of_the_libraries() {
        let params = scene::SceneParams::default();
        assert_eq!(SceneParams::from(&params).check(params), Ok(params));
        let with_contacts = scene::SceneParams {
            contacts: Some(ContactParams::default()),
            ..params
        };
        let converted = SceneParams::from(&with_contacts).check(params);
        assert_eq!(converted, Ok(with_contacts));
        for (preset, material) in [
            (INCISE_MATERIAL_SOFT_BODY, pbd::Material::soft_body()),
            (INCISE_MATERIAL_SHELL, pbd::Material::shell()),
            (INCISE_MATERIAL_CLOTH, pbd::Material::cloth()),
            (INCISE_MATERIAL_LIMP_SHELL, pbd::Material::default()),
            (INCISE_MATERIAL_SKIN, pbd::Material::skin()),
            (INCISE_MATERIAL_LIVER, pbd::Material::liver()),
            (INCISE_MATERIAL_MUSCLE, pbd::Material::muscle()),
            (INCISE_MATERIAL_JELLY, pbd::Material::jelly()),
            (INCISE_MATERIAL_RUBBER, pbd::Material::rubber()),
        ] {
            let converted = Material::preset(preset).and_then(|material| material.check());
            assert_eq!(converted, Ok(material), "preset {preset}");
        }
    }

    #[test]
    fn constants_and_flags_are_checked() {
        let base = scene::SceneParams::default();
        let params = SceneParams::from(&base);
        let status = SceneParams { sleep: 2, ..params }.check(base);
        assert_eq!(status, Err(Error::argument("sleep is 2; pass 0 or 1")));
        let material = Material::preset(INCISE_MATERIAL_CLOTH).expect("a constant");
        let unstretched = Material {
            stretch_kind: INCISE_STIFFNESS_NONE,
            ..material
        };
        assert_eq!(unstretched.check(), Err(Error::constant("stretch_kind", 0)));
        assert_eq!(Material::preset(9), Err(Error::constant("preset", 9)));
    }
}
