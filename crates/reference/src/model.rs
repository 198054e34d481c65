//! The model of the reference, masses and constraints as plain arrays, and its state.

use super::error::ReferenceError;
use super::volume::{Piece, Volumes};
use incise_mesh::Surface;
use incise_pbd_gpu::{Collider, ConstraintSet, MovingCollider, Solver, SolverParams, Stiffness};
use nalgebra::Vector3;

/// Constraints of one kind over `N` vertices each.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Constraints<const N: usize> {
    /// The vertices of every constraint, shape \[constraints\].
    pub vertices: Vec<[usize; N]>,
    /// The rest values, shape \[constraints\].
    pub rest: Vec<f64>,
    /// Compliance of all: [m/N] for edges, [rad/(N m)] for hinges. 0 is rigid.
    pub compliance: f64,
}

/// A body without its state.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Model {
    /// Mass of every vertex \[kg\], shape \[vertices\]; 0 for a held one.
    pub mass: Vec<f64>,
    /// Edges with rest lengths \[m\].
    pub stretch: Constraints<2>,
    /// Hinges with rest angles \[rad\].
    pub bending: Constraints<4>,
    /// Volume constraints of closed pieces.
    pub volumes: Volumes,
    /// Acceleration of all vertices [m/s^2].
    pub gravity: Vector3<f64>,
    /// Decay rate of velocities [1/s].
    pub damping: f64,
    /// A plane without friction at rest.
    pub plane: Option<Plane>,
}

/// A plane that vertices do not pass.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plane {
    /// Outward unit normal.
    pub normal: Vector3<f64>,
    /// Distance from the origin along the normal \[m\].
    pub offset: f64,
}

impl Plane {
    /// Returns the plane of a solver's only collider, if it has one.
    fn of(solver: &Solver) -> Result<Option<Self>, ReferenceError> {
        let wide = |p: [f32; 3]| Vector3::from(p.map(f64::from));
        match solver.colliders() {
            [] => Ok(None),
            &[
                MovingCollider {
                    start: Collider::Plane { point, normal },
                    velocity: [0.0, 0.0, 0.0],
                },
            ] => {
                let normal = wide(normal).normalize();
                let offset = normal.dot(&wide(point));
                Ok(Some(Self { normal, offset }))
            }
            _ => Err(ReferenceError::Collider),
        }
    }
}

/// Positions and velocities of a body.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct State {
    /// Positions \[m\], shape \[vertices\].
    pub x: Vec<Vector3<f64>>,
    /// Velocities [m/s], shape \[vertices\].
    pub v: Vec<Vector3<f64>>,
}

impl Model {
    /// Copies a solver's body: inverse masses, rest values and parameters as they are stored.
    ///
    /// # Errors
    /// [`ReferenceError::NoEnergy`] for a stiffness other than a compliance or 1,
    /// [`ReferenceError::Damping`], [`ReferenceError::Friction`] for a plane with friction,
    /// [`ReferenceError::Collider`] for other colliders.
    pub fn of(
        solver: &Solver,
        surface: &Surface,
        params: &SolverParams,
    ) -> Result<Self, ReferenceError> {
        let material = solver.material();
        if material.damping > 0.0 {
            let damping = material.damping;
            return Err(ReferenceError::Damping { damping });
        }
        let plane = Plane::of(solver)?;
        if plane.is_some() && material.friction > 0.0 {
            let coefficient = material.friction;
            return Err(ReferenceError::Friction { coefficient });
        }
        let mass = (surface.positions().iter())
            .map(|p| {
                if p[3] > 0.0 {
                    1.0 / f64::from(p[3])
                } else {
                    0.0
                }
            })
            .collect();
        let bending = match (solver.bending(), material.bending) {
            (Some(set), Some(stiffness)) => constraints(set, compliance(stiffness)?),
            _ => Constraints::default(),
        };
        Ok(Self {
            mass,
            stretch: constraints(solver.stretch(), compliance(material.stretch)?),
            bending,
            volumes: volumes(solver, surface)?,
            gravity: params.gravity.map(f64::from).into(),
            damping: 0.0,
            plane,
        })
    }
}

impl State {
    /// Copies the state of a solver's body.
    #[must_use]
    pub fn of(solver: &Solver, surface: &Surface) -> Self {
        let wide = |p: &[f32; 4]| Vector3::new(p[0].into(), p[1].into(), p[2].into());
        Self {
            x: surface.positions().iter().map(wide).collect(),
            v: solver.velocities().iter().map(wide).collect(),
        }
    }

    /// Returns the state at rest at `x` \[m\].
    #[must_use]
    pub fn at(x: Vec<Vector3<f64>>) -> Self {
        let v = vec![Vector3::zeros(); x.len()];
        Self { x, v }
    }
}

fn compliance(stiffness: Stiffness) -> Result<f64, ReferenceError> {
    match stiffness {
        Stiffness::Compliance(value) => Ok(value.into()),
        Stiffness::Pbd(k) if k >= 1.0 => Ok(0.0),
        Stiffness::Pbd(k) => Err(ReferenceError::NoEnergy { k }),
    }
}

/// Copies a solver's volume constraints.
fn volumes(solver: &Solver, surface: &Surface) -> Result<Volumes, ReferenceError> {
    let Some(volume) = solver.material().volume else {
        return Ok(Volumes::default());
    };
    let topology = surface.topology();
    let of = |number: u32| -> Vec<[usize; 3]> {
        let triangles = topology.triangles().filter(|&t| surface.piece(t) == number);
        triangles
            .map(|t| topology.triangle(t).map(|v| v.index()))
            .collect()
    };
    let pieces = solver.volumes().pieces().iter();
    let pieces = pieces.map(|piece| Piece::new(of(piece.piece()), piece.rest().into()));
    Ok(Volumes {
        pieces: pieces.collect::<Result<_, _>>()?,
        compressibility: volume.compressibility.into(),
        pressure: volume.pressure.into(),
    })
}

fn constraints<const N: usize>(set: &ConstraintSet<N>, compliance: f64) -> Constraints<N> {
    let mut out = Constraints {
        vertices: Vec::with_capacity(set.len()),
        rest: Vec::with_capacity(set.len()),
        compliance,
    };
    for batch in set.batches().iter().chain([set.overflow()]) {
        let vertices = batch.vertices().iter();
        out.vertices.extend(vertices.map(|v| v.map(|v| v.index())));
        out.rest.extend(batch.rest().iter().map(|&r| f64::from(r)));
    }
    out
}
