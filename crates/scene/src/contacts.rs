//! Which vertices touch which triangles: what the pieces of a body have to do with each other, found anew in every frame.
//!
//! Boxes first: a piece whose box, grown by what may move in a frame, meets no other one is not looked at. Of the others
//! every vertex in such a box gets the nearest triangle within reach. A vertex stays on its side of what it was nearest
//! to when the frame began, so nothing gets through however fast it is; pieces that lie in each other already part
//! slowly, since to push them apart at once would throw them.

use crate::error::SceneError;
use incise_cut::{Bvh, NearestPoint};
use incise_mesh::geometry::{area_vector, widen};
use incise_mesh::{Aabb, Surface, TriangleId, Vec3, VertexId};
use incise_pbd_gpu::{Contact, Solver};

/// How much faster than at its beginning something may get within a frame: what hits something else is bent, and
/// parts of it are then faster than it was.
const SAFETY: f64 = 2.0;

/// How fast what is too near parts: by this part of what is missing [1/s]. What lies in each other by more than a thickness
/// does not part any faster.
const APART: f64 = 5.0;

/// How pieces touch. Friction is the material's.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactParams {
    /// How far surfaces stay from each other, in mean lengths of the body's edges at rest.
    pub thickness: f32,
    /// Whether a piece touches itself: what looks at each other across a fold.
    pub own: bool,
}

impl Default for ContactParams {
    /// A tenth of an edge, and no piece touches itself.
    fn default() -> Self {
        Self {
            thickness: 0.1,
            own: false,
        }
    }
}

impl ContactParams {
    /// Checks every number.
    ///
    /// # Errors
    /// [`SceneError::BadContacts`].
    pub fn check(&self) -> Result<(), SceneError> {
        let value = self.thickness;
        if value.is_finite() && value > 0.0 {
            Ok(())
        } else {
            Err(SceneError::BadContacts { value })
        }
    }
}

/// A piece as others see it.
#[derive(Debug, Clone, Copy)]
struct Piece {
    number: u32,
    /// Grown by what its own vertices may move.
    bounds: Aabb,
    /// How fast its fastest vertex is [m/s].
    speed: f64,
}

/// What a search needs, kept from frame to frame for its memory.
#[derive(Debug, Default)]
pub(crate) struct Touching {
    pieces: Vec<Piece>,
    /// By piece number: its place in `pieces`.
    places: Vec<u32>,
    /// Pairs of places whose boxes meet, both ways, ascending.
    pairs: Vec<(u32, u32)>,
    contacts: Vec<Contact>,
}

impl Clone for Touching {
    /// Scratch memory is not worth copying.
    fn clone(&self) -> Self {
        Self::default()
    }
}

/// The numbers of a frame.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Reach {
    pub(crate) params: ContactParams,
    /// \[s\]
    pub(crate) dt: f32,
    /// How fast anything may get within the frame by itself [m/s].
    pub(crate) gained: f64,
}

impl Touching {
    /// Finds the contacts of a body for the next frame and hands them to its solver. The search tree must fit. Returns how
    /// many there are.
    pub(crate) fn find(
        &mut self,
        surface: &Surface,
        solver: &mut Solver,
        bvh: &Bvh,
        reach: &Reach,
    ) -> Result<usize, SceneError> {
        let thickness = f64::from(reach.params.thickness) * solver.mean_rest_length();
        self.contacts.clear();
        self.measure(surface, solver, thickness, reach);
        self.pair();
        if !self.pairs.is_empty() || reach.params.own {
            self.search(surface, solver, bvh, (thickness, reach));
        }
        solver.set_contacts(&self.contacts)?;
        Ok(self.contacts.len())
    }

    /// Finds the boxes and speeds of all pieces.
    fn measure(&mut self, surface: &Surface, solver: &Solver, thickness: f64, reach: &Reach) {
        let topology = surface.topology();
        self.pieces.clear();
        self.places.clear();
        self.places.resize(surface.piece_bound() as usize, u32::MAX);
        for v in topology.vertices() {
            let number = surface.piece(topology.outgoing(v).triangle());
            let place = &mut self.places[number as usize];
            if *place == u32::MAX {
                *place = narrow(self.pieces.len());
                self.pieces.push(Piece {
                    number,
                    bounds: Aabb::default(),
                    speed: 0.0,
                });
            }
            let piece = &mut self.pieces[*place as usize];
            let [x, y, z, _] = surface.positions[v.index()];
            for (k, c) in [x, y, z].into_iter().enumerate() {
                piece.bounds.min[k] = piece.bounds.min[k].min(c);
                piece.bounds.max[k] = piece.bounds.max[k].max(c);
            }
            piece.speed = piece.speed.max(widen(solver.velocity(v)).norm());
        }
        for piece in &mut self.pieces {
            let grown = thickness + SAFETY * (piece.speed + reach.gained) * f64::from(reach.dt);
            grow(&mut piece.bounds, grown);
        }
    }

    /// Finds the pieces whose boxes meet: sorted along x, each is compared with those that begin before it ends.
    fn pair(&mut self) {
        self.pairs.clear();
        let x = |piece: &Piece| piece.bounds.min[0];
        self.pieces.sort_unstable_by(|a, b| {
            let by_place = x(a).total_cmp(&x(b));
            by_place.then(a.number.cmp(&b.number))
        });
        for (i, a) in (0..).zip(&self.pieces) {
            self.places[a.number as usize] = i;
            let later = self.pieces.iter().enumerate().skip(i as usize + 1);
            for (j, b) in later.take_while(|(_, b)| x(b) <= a.bounds.max[0]) {
                if a.bounds.overlaps(&b.bounds) {
                    self.pairs.extend([(i, narrow(j)), (narrow(j), i)]);
                }
            }
        }
        self.pairs.sort_unstable();
    }

    fn search(
        &mut self,
        surface: &Surface,
        solver: &Solver,
        bvh: &Bvh,
        (thickness, reach): (f64, &Reach),
    ) {
        let topology = surface.topology();
        let dt = f64::from(reach.dt);
        let own = reach.params.own;
        for v in topology.vertices() {
            let number = surface.piece(topology.outgoing(v).triangle());
            let place = self.places[number as usize];
            let at = surface.position(v);
            let own_speed = widen(solver.velocity(v)).norm() + reach.gained;
            let way = SAFETY * own_speed * dt;
            // Of all pieces that may come here, the fastest.
            let first = self.pairs.partition_point(|pair| pair.0 < place);
            let others = self.pairs[first..].iter();
            let others = others
                .take_while(|pair| pair.0 == place)
                .map(|pair| &self.pieces[pair.1 as usize]);
            let mut towards = own.then(|| self.pieces[place as usize].speed);
            for other in others.filter(|other| is_near(&other.bounds, at, way)) {
                towards = Some(towards.map_or(other.speed, |speed| speed.max(other.speed)));
            }
            let Some(towards) = towards else { continue };
            let within = thickness + way + SAFETY * towards * dt;
            let found = bvh.nearest(surface, at, within, |t| {
                surface.piece(t) != number || own && is_apart(surface, v, t)
            });
            if let Some(found) = found {
                let thickness = thickness_at(surface, v, &found, thickness);
                let velocity = relative_velocity(surface, solver, v, &found);
                let plane = plane(surface, at, &found, velocity * dt);
                self.contacts
                    .push(contact(surface, v, &found, plane, thickness));
            }
        }
    }
}

/// How fast a vertex is as seen from where it is nearest [m/s].
fn relative_velocity(
    surface: &Surface,
    solver: &Solver,
    v: VertexId,
    found: &NearestPoint,
) -> Vec3 {
    let corners = surface.topology().triangle(found.triangle).into_iter();
    let of_point = corners
        .zip(found.weights)
        .map(|(c, weight)| widen(solver.velocity(c)) * weight);
    widen(solver.velocity(v)) - of_point.sum::<Vec3>()
}

/// The way out and how far along it a vertex is \[m\]: along the triangle's normal or straight from the nearest point,
/// whichever leaves the vertex more room where it is moving \[m\]. Either plane keeps the two apart; but straight
/// from an edge what slides past is held up, and along a normal what falls past.
fn plane(surface: &Surface, at: Vec3, found: &NearestPoint, moves: Vec3) -> (Vec3, f64) {
    let corners = surface.triangle_positions(found.triangle);
    let normal = area_vector(corners).try_normalize(0.0).unwrap_or_default();
    let way = at - found.point;
    let height = normal.dot(&way);
    // A way of a few roundings has no direction.
    let extent = at.amax().max(found.point.amax());
    if found.distance <= 16.0 * f64::from(f32::EPSILON) * extent {
        return (normal, found.distance);
    }
    let straight = way / found.distance;
    if found.distance + straight.dot(&moves) >= height + normal.dot(&moves) {
        (straight, found.distance)
    } else {
        (normal, height)
    }
}

/// How far a vertex is to stay from where it is nearest \[m\].
fn thickness_at(surface: &Surface, v: VertexId, found: &NearestPoint, thickness: f64) -> f64 {
    let piece = |t: TriangleId| surface.piece(t);
    let is_own = piece(surface.topology().outgoing(v).triangle()) == piece(found.triangle);
    // A fold that is thinner than that at rest is to stay one.
    if is_own {
        let corners = surface.topology().triangle(found.triangle);
        let rest = corners.map(|c| surface.rest_position(c));
        let point: Vec3 = rest.iter().zip(found.weights).map(|(p, w)| p * w).sum();
        thickness.min((surface.rest_position(v) - point).norm() / 2.0)
    } else {
        thickness
    }
}

/// A contact that keeps a vertex on its side of a plane, as far off as it is or a thickness; what is nearer than that parts.
#[expect(
    clippy::cast_possible_truncation,
    reason = "what was found is rounded once to storage"
)]
fn contact(
    surface: &Surface,
    v: VertexId,
    found: &NearestPoint,
    (out, height): (Vec3, f64),
    thickness: f64,
) -> Contact {
    let missing = (thickness - found.distance).clamp(0.0, 2.0 * thickness);
    Contact {
        vertex: v,
        corners: surface.topology().triangle(found.triangle),
        weights: found.weights.map(|w| w as f32),
        normal: [out.x as f32, out.y as f32, out.z as f32],
        gap: height.min(thickness) as f32,
        rise: (APART * missing) as f32,
    }
}

/// Whether no edge joins a vertex and a triangle.
fn is_apart(surface: &Surface, v: VertexId, t: TriangleId) -> bool {
    let topology = surface.topology();
    let mut corners = topology.triangle(t).into_iter();
    corners.all(|c| c != v && !topology.are_adjacent(v, c))
}

#[expect(
    clippy::cast_possible_truncation,
    reason = "a box may be a rounding too small, as it is grown by far more than moves"
)]
fn grow(bounds: &mut Aabb, by: f64) {
    for k in 0..3 {
        bounds.min[k] = (f64::from(bounds.min[k]) - by) as f32;
        bounds.max[k] = (f64::from(bounds.max[k]) + by) as f32;
    }
}

/// Whether a point is within a box that is grown by so much \[m\].
fn is_near(bounds: &Aabb, p: Vec3, by: f64) -> bool {
    let (min, max) = (widen(bounds.min), widen(bounds.max));
    (0..3).all(|k| min[k] - by <= p[k] && p[k] <= max[k] + by)
}

fn narrow(count: usize) -> u32 {
    u32::try_from(count).unwrap_or(u32::MAX)
}
