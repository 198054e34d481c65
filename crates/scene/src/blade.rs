//! The dissecting edge of a cutting tool.

use crate::contacts::Flat;
use crate::scene::Scene;
use incise_cut::{CutError, Sweep};
use incise_mesh::Aabb;

/// A blade of a scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BladeId(pub(crate) usize);

/// A cutting edge and where it was a frame ago.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Blade {
    edge: [[f32; 3]; 2],
    previous: [[f32; 3]; 2],
    /// The edge and the back when bodies touched the flat last; none if there was none.
    touched: Option<([[f32; 3]; 2], [f32; 3])>,
    /// The way from the edge to the back of the blade \[m\], if it has a flat that pieces touch, see
    /// [`Scene::set_blade_back`].
    pub back: Option<[f32; 3]>,
    /// The piece that the blade cuts, if it is to pass through all others.
    pub only_piece: Option<u32>,
}

impl Blade {
    pub(crate) const fn new(edge: [[f32; 3]; 2]) -> Self {
        Self {
            edge,
            previous: edge,
            touched: None,
            back: None,
            only_piece: None,
        }
    }

    /// Where the edge is: start and end \[m\].
    #[must_use]
    pub const fn edge(&self) -> [[f32; 3]; 2] {
        self.edge
    }

    pub(crate) fn move_to(&mut self, edge: [[f32; 3]; 2]) {
        self.edge = edge;
    }

    /// Puts the edge elsewhere without sweeping.
    pub(crate) fn jump_to(&mut self, edge: [[f32; 3]; 2]) {
        self.edge = edge;
        self.previous = edge;
        self.touched = None;
    }

    /// The sweep since the last frame; none when the blade is at rest or moved along itself.
    ///
    /// # Errors
    /// [`CutError::SweepNotFinite`] when a pose is not finite.
    pub(crate) fn sweep(&self) -> Result<Option<Sweep>, CutError> {
        match Sweep::new(self.previous, self.edge) {
            Ok(sweep) => Ok(Some(sweep)),
            Err(CutError::BladeDegenerate) => Ok(None),
            Err(error) => Err(error),
        }
    }

    pub(crate) fn end_sweep(&mut self) {
        self.previous = self.edge;
    }

    /// The flat and its way since bodies touched it last; none without a back, or one of no area.
    fn flat(&self) -> Option<Flat> {
        let now = (self.edge, self.back?);
        Flat::new([self.touched.unwrap_or(now), now])
    }
}

impl Scene {
    /// Notes where the flats of blades are, and wakes bodies beside those that came, went or moved. Nobody touches them
    /// while the scene has no contacts.
    pub(crate) fn find_flats(&mut self) {
        self.known_flats.clone_from(&self.flats);
        self.flats.clear();
        if self.params.contacts.is_some() {
            self.flats
                .extend(self.blades.iter().filter_map(Blade::flat));
        }
        for blade in &mut self.blades {
            blade.touched = blade.back.map(|back| (blade.edge, back));
        }
        let is_still = |flat: &Flat| !flat.moves();
        if self.flats == self.known_flats && self.flats.iter().all(is_still) {
            return;
        }
        for flat in self.flats.iter().chain(&self.known_flats) {
            // What lies on a flat is up to a thickness off.
            let bounds = widened(flat.bounds());
            for i in 0..self.bodies.len() {
                if self.sleep.is_asleep(i) && !self.sleep.is_far(i, &bounds) {
                    self.sleep.wake(i);
                }
            }
        }
    }
}

/// A box and half of its longest side around: that of a flat may have no height.
fn widened(bounds: Aabb) -> Aabb {
    let sides = [0, 1, 2].map(|k| bounds.max[k] - bounds.min[k]);
    let longest = sides.into_iter().fold(0.0, f32::max);
    Aabb {
        min: bounds.min.map(|c| c - longest / 2.0),
        max: bounds.max.map(|c| c + longest / 2.0),
    }
}
