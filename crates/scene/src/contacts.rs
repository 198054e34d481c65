//! Which vertices touch which triangles: what the pieces of a body have to do with each other, found anew in every frame.
//!
//! Boxes first: a piece whose box, grown by what may move in a frame, meets no other one is not looked at. Of the others
//! every vertex in such a box gets the nearest triangle within reach that faces it, so that nothing is pushed out through the
//! other side of a thin piece. A vertex stays on its side of what it was nearest
//! to when the frame began, as far as anything of it gets no more than [`SAFETY`] times as fast within the frame; pieces that lie in each
//! other already part slowly, since to push them apart at once would throw them.

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

/// A contact is the same still if its vertex has moved no farther than this along the triangle and off it, in thicknesses,
/// and the triangle has turned by no more than that angle \[rad\].
const AGAIN: f64 = 0.1;
const TURNED: f64 = 0.02;

/// How pieces touch. Friction is the material's. A surface has one outside: open sheets touch each other only where those meet, and a
/// vertex is compared with triangles, not edges with edges.
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

/// What a search found and needs, kept from frame to frame.
#[derive(Debug, Clone, Default)]
pub(crate) struct Touching {
    pieces: Vec<Piece>,
    /// By piece number: its place in `pieces`.
    places: Vec<u32>,
    /// Pairs of places whose boxes meet, both ways, ascending.
    pairs: Vec<(u32, u32)>,
    contacts: Vec<Contact>,
    /// What was found, by contact, and in the frame before.
    found: Vec<Touch>,
    before: Vec<Touch>,
    /// By vertex: its place in `before`.
    known: Vec<u32>,
    /// The vertex at hand and its neighbors, with whose triangles it does not touch.
    ring: Vec<VertexId>,
}

/// A contact as it was found, so that who rests finds the same again: were it looked for anew, triangles that are as near
/// would take turns, and what rests would tremble.
#[derive(Debug, Clone, Copy)]
struct Touch {
    vertex: VertexId,
    triangle: TriangleId,
    corners: [VertexId; 3],
    weights: [f64; 3],
    /// The way out.
    out: Vec3,
    /// How far the vertex is to stay \[m\]. Grows while there is a contact, up to the thickness.
    goal: f64,
    /// Where the vertex was, as seen from the point \[m\].
    at: Vec3,
    /// The triangle's normal then.
    facing: Vec3,
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
        self.remember(surface.positions.len());
        self.measure(surface, solver, thickness, reach);
        self.pair();
        if !self.pairs.is_empty() || reach.params.own {
            self.search(surface, solver, bvh, (thickness, reach));
        }
        solver.set_contacts(&self.contacts)?;
        Ok(self.contacts.len())
    }

    /// Makes what was found what was found before.
    fn remember(&mut self, vertex_slots: usize) {
        std::mem::swap(&mut self.found, &mut self.before);
        self.found.clear();
        self.known.clear();
        self.known.resize(vertex_slots, u32::MAX);
        for (i, touch) in (0..).zip(&self.before) {
            if let Some(known) = self.known.get_mut(touch.vertex.index()) {
                *known = i;
            }
        }
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
            let before = self.before.get(self.known[v.index()] as usize).copied();
            let kept = before.filter(|touch| touch.holds(surface, at, thickness));
            let touch = kept.or_else(|| {
                let within = thickness + way + SAFETY * towards * dt;
                self.ring.clear();
                if own {
                    self.ring.push(v);
                    for h in topology.outgoing_fan(v) {
                        self.ring
                            .extend([topology.target(h), topology.origin(h.prev())]);
                    }
                }
                let ring = &self.ring;
                let outward = outward(surface, v);
                let faces = |t| outward.dot(&normal(surface, t)) < 0.0;
                let is_fold =
                    |t| own && faces(t) && !topology.triangle(t).iter().any(|c| ring.contains(c));
                let is_other = |t| surface.piece(t) != number;
                let facing = |t| is_other(t) && faces(t) || is_fold(t);
                let mut found = bvh.nearest(surface, at, within, facing)?;
                if found.distance < 0.0 {
                    // Inside of what faces it, or outside of what does not: a collapsed skin comes from behind.
                    let all = |t| is_other(t) || is_fold(t);
                    let any = bvh.nearest(surface, at, -found.distance, all);
                    found = any.filter(|any| any.distance > 0.0).unwrap_or(found);
                }
                let velocity = relative_velocity(surface, solver, v, &found);
                Some(Touch::new(surface, (v, at), &found, velocity * dt))
            });
            if let Some(mut touch) = touch {
                let thickness = thickness_at(surface, &touch, thickness);
                // Who cannot follow is not pushed the harder for it.
                let near = touch.height(surface, at) + AGAIN * thickness;
                touch.goal = touch.goal.min(near).min(thickness);
                let rise = APART * (thickness - touch.goal).min(2.0 * thickness);
                self.contacts.push(touch.contact(rise));
                touch.goal += rise * dt;
                self.found.push(touch);
            }
        }
    }
}

impl Touch {
    fn new(
        surface: &Surface,
        (vertex, at): (VertexId, Vec3),
        found: &NearestPoint,
        moves: Vec3,
    ) -> Self {
        let (out, goal) = plane(surface, at, found, moves);
        Self {
            vertex,
            triangle: found.triangle,
            corners: surface.topology().triangle(found.triangle),
            weights: found.weights,
            out,
            goal,
            at: at - found.point,
            facing: facing(surface, found.triangle),
        }
    }

    /// Whether the vertex is at `at`, as seen from the triangle, next to where it was, and touches it still.
    fn holds(&self, surface: &Surface, at: Vec3, thickness: f64) -> bool {
        if surface.topology().outgoing(self.vertex).is_null()
            || !surface.topology().is_triangle(self.triangle)
            || surface.topology().triangle(self.triangle) != self.corners
        {
            return false;
        }
        let now = self.way(surface, at);
        (now - self.at).norm() <= AGAIN * thickness
            && now.dot(&self.out) <= (1.0 + AGAIN) * thickness
            && (facing(surface, self.triangle) - self.facing).norm() <= TURNED
    }

    /// From the point to `at` \[m\].
    fn way(&self, surface: &Surface, at: Vec3) -> Vec3 {
        let corners = self.corners.iter().zip(self.weights);
        let point: Vec3 = corners
            .map(|(&c, weight)| surface.position(c) * weight)
            .sum();
        at - point
    }

    /// How far the vertex is off along the way out \[m\].
    fn height(&self, surface: &Surface, at: Vec3) -> f64 {
        self.way(surface, at).dot(&self.out)
    }

    #[expect(
        clippy::cast_possible_truncation,
        reason = "what was found is rounded once to storage"
    )]
    fn contact(&self, rise: f64) -> Contact {
        Contact {
            vertex: self.vertex,
            corners: self.corners,
            weights: self.weights.map(|w| w as f32),
            normal: [self.out.x as f32, self.out.y as f32, self.out.z as f32],
            gap: self.goal as f32,
            rise: rise as f32,
        }
    }
}

/// A triangle's unit normal; zero of one without area.
fn facing(surface: &Surface, t: TriangleId) -> Vec3 {
    normal(surface, t).try_normalize(0.0).unwrap_or_default()
}

/// Along a triangle's normal [m^2].
fn normal(surface: &Surface, t: TriangleId) -> Vec3 {
    area_vector(surface.triangle_positions(t))
}

/// Out of the body at a vertex [m^2].
fn outward(surface: &Surface, v: VertexId) -> Vec3 {
    let fan = surface.topology().outgoing_fan(v);
    fan.map(|h| normal(surface, h.triangle())).sum()
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
    let normal = facing(surface, found.triangle);
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

/// How far a vertex is to stay from what it touches \[m\]: a fold that is thinner than that at rest is to stay one.
fn thickness_at(surface: &Surface, touch: &Touch, thickness: f64) -> f64 {
    let piece = |v: VertexId| surface.piece(surface.topology().outgoing(v).triangle());
    if piece(touch.vertex) != piece(touch.corners[0]) {
        return thickness;
    }
    let corners = touch.corners.iter().zip(touch.weights);
    let point: Vec3 = corners.map(|(&c, w)| surface.rest_position(c) * w).sum();
    thickness.min((surface.rest_position(touch.vertex) - point).norm() / 2.0)
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
