//! Pieces as others see them: where they may get to within a frame, and whom they may meet there.

use super::{Flat, Reach, SAFETY, Velocities, narrow};
use incise_mesh::geometry::widen;
use incise_mesh::{Aabb, Surface, Vec3, VertexId};
use incise_pbd_gpu::Collider;

/// A piece.
#[derive(Debug, Clone, Copy)]
pub(super) struct Piece {
    pub(super) number: u32,
    pub(super) bounds: Aabb,
    /// The same, grown by what its own vertices may move and a thickness.
    grown: Aabb,
    /// The box of its vertices' velocities [m/s].
    velocities: [Vec3; 2],
    /// Whether something that nothing here moves may stop it.
    is_held: bool,
    /// The first piece of its group, a place.
    group: u32,
    /// What pieces of its group move with, if it is the first one there [m/s].
    flow: Vec3,
    /// How far the farthest of its vertices may move beside that \[m\].
    pub(super) way: f64,
}

/// All pieces of a body, kept from frame to frame for its room.
///
/// Pieces that may touch, directly or through others, are a group. One that may hit what nothing here moves may be stopped, and
/// stop others; a group that flies goes on as one, so that only what moves in it is looked at.
#[derive(Debug, Clone, Default)]
pub(super) struct Pieces {
    list: Vec<Piece>,
    /// By piece number: its place in `list`.
    places: Vec<u32>,
    /// Pairs of places whose grown boxes meet, both ways, ascending.
    pairs: Vec<(u32, u32)>,
    /// By place of a group's first piece: the box of its velocities [m/s].
    boxes: Vec<[Vec3; 2]>,
    /// By vertex: how far it may move beside its group \[m\].
    ways: Vec<f64>,
}

impl Pieces {
    /// Finds boxes, velocities, pairs and groups.
    pub(super) fn find(
        &mut self,
        surface: &Surface,
        velocities: &Velocities<'_>,
        (thickness, reach): (f64, &Reach<'_>),
    ) {
        self.measure(surface, velocities);
        for piece in &mut self.list {
            piece.grown = piece.bounds;
            let speed = farthest(piece.velocities, Vec3::zeros());
            let way = (SAFETY * speed + reach.gained) * reach.dt;
            grow(&mut piece.grown, thickness + way);
            let on_ground = reach
                .ground
                .is_some_and(|ground| piece.grown.min[1] <= ground);
            let at_collider = |c: &Collider| c.bounds().overlaps(&piece.grown);
            let at_flat = |flat: &Flat| flat.bounds().overlaps(&piece.grown);
            piece.is_held |= on_ground
                || reach.colliders.iter().any(at_collider)
                || reach.flats.iter().any(at_flat);
        }
        self.pair();
        self.group();
        self.find_ways(surface, velocities, reach.dt);
    }

    /// Whether any two may touch.
    pub(super) fn meet(&self) -> bool {
        !self.pairs.is_empty()
    }

    /// By vertex: how far it may move beside what its group does \[m\].
    pub(super) fn ways(&self) -> &[f64] {
        &self.ways
    }

    /// The place of a piece.
    pub(super) fn place(&self, number: u32) -> u32 {
        self.places[number as usize]
    }

    /// The pieces that one may touch, by its place.
    pub(super) fn others(&self, place: u32) -> impl Iterator<Item = &Piece> {
        let first = self.pairs.partition_point(|pair| pair.0 < place);
        let pairs = self.pairs[first..].iter();
        pairs
            .take_while(move |pair| pair.0 == place)
            .map(|pair| &self.list[pair.1 as usize])
    }

    /// Finds the boxes and velocities of all pieces.
    fn measure(&mut self, surface: &Surface, velocities: &Velocities<'_>) {
        let topology = surface.topology();
        self.list.clear();
        self.places.clear();
        self.places.resize(surface.piece_bound() as usize, u32::MAX);
        for v in topology.vertices() {
            let number = surface.piece(topology.outgoing(v).triangle());
            let place = &mut self.places[number as usize];
            if *place == u32::MAX {
                *place = narrow(self.list.len());
                self.list.push(Piece {
                    number,
                    bounds: Aabb::default(),
                    grown: Aabb::default(),
                    velocities: [Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY)],
                    is_held: false,
                    group: 0,
                    flow: Vec3::zeros(),
                    way: 0.0,
                });
            }
            let piece = &mut self.list[*place as usize];
            let [x, y, z, _] = surface.positions[v.index()];
            for (k, c) in [x, y, z].into_iter().enumerate() {
                piece.bounds.min[k] = piece.bounds.min[k].min(c);
                piece.bounds.max[k] = piece.bounds.max[k].max(c);
            }
            let velocity = velocities.of(v);
            let [least, most] = piece.velocities;
            piece.velocities = [least.inf(&velocity), most.sup(&velocity)];
        }
        for pin in velocities.pins {
            if let Some(number) = piece_of(surface, pin.vertex) {
                let place = self.places[number as usize];
                self.list[place as usize].is_held = true;
            }
        }
    }

    /// Finds the pieces whose boxes meet: sorted along x, each is compared with those that begin before it ends.
    fn pair(&mut self) {
        self.pairs.clear();
        let x = |piece: &Piece| piece.grown.min[0];
        self.list.sort_unstable_by(|a, b| {
            let by_place = x(a).total_cmp(&x(b));
            by_place.then(a.number.cmp(&b.number))
        });
        for (i, a) in (0..).zip(&self.list) {
            self.places[a.number as usize] = i;
            let later = self.list.iter().enumerate().skip(i as usize + 1);
            for (j, b) in later.take_while(|(_, b)| x(b) <= a.grown.max[0]) {
                if a.grown.overlaps(&b.grown) {
                    self.pairs.extend([(i, narrow(j)), (narrow(j), i)]);
                }
            }
        }
        self.pairs.sort_unstable();
    }

    /// Finds the groups and what each moves with.
    fn group(&mut self) {
        let list = &mut self.list;
        for (i, piece) in (0..).zip(list.iter_mut()) {
            piece.group = i;
        }
        for &(a, b) in &self.pairs {
            let (a, b) = (first_of(list, a), first_of(list, b));
            list[a.max(b) as usize].group = a.min(b);
        }
        let boxes = &mut self.boxes;
        boxes.clear();
        boxes.extend(list.iter().map(|piece| piece.velocities));
        for i in 0..narrow(list.len()) {
            let first = first_of(list, i);
            let piece = list[i as usize];
            list[i as usize].group = first;
            list[first as usize].is_held |= piece.is_held;
            let [least, most] = boxes[first as usize];
            let [low, high] = piece.velocities;
            boxes[first as usize] = [least.inf(&low), most.sup(&high)];
        }
        for (group, &[least, most]) in list.iter_mut().zip(boxes.iter()) {
            group.flow = if group.is_held {
                Vec3::zeros()
            } else {
                (least + most) / 2.0
            };
        }
    }

    /// Finds how far vertices and pieces may move beside their groups.
    fn find_ways(&mut self, surface: &Surface, velocities: &Velocities<'_>, dt: f64) {
        let topology = surface.topology();
        self.ways.clear();
        self.ways.resize(surface.positions.len(), 0.0);
        for v in topology.vertices() {
            let number = surface.piece(topology.outgoing(v).triangle());
            let place = self.places[number as usize] as usize;
            let flow = self.list[self.list[place].group as usize].flow;
            let way = SAFETY * (velocities.of(v) - flow).norm() * dt;
            self.ways[v.index()] = way;
            self.list[place].way = self.list[place].way.max(way);
        }
    }
}

impl Piece {
    /// Whether a point is within its box grown by so much \[m\].
    pub(super) fn is_near(&self, p: Vec3, by: f64) -> bool {
        let (min, max) = (widen(self.bounds.min), widen(self.bounds.max));
        (0..3).all(|k| min[k] - by <= p[k] && p[k] <= max[k] + by)
    }
}

/// What a velocity in a box differs from another one by at most [m/s].
fn farthest([least, most]: [Vec3; 2], from: Vec3) -> f64 {
    (least - from).abs().sup(&(most - from).abs()).norm()
}

/// The first piece of the group of one, by place.
fn first_of(list: &mut [Piece], mut at: u32) -> u32 {
    while list[at as usize].group != at {
        // Half of the way is gone the next time.
        let next = list[list[at as usize].group as usize].group;
        list[at as usize].group = next;
        at = next;
    }
    at
}

/// The number of a vertex' piece, none of a vertex that is no more.
fn piece_of(surface: &Surface, v: VertexId) -> Option<u32> {
    let h = surface.topology().outgoing(v);
    (!h.is_null()).then(|| surface.piece(h.triangle()))
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
