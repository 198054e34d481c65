//! The session as the renderer draws it.

use super::Look;
use super::screen::Screen;
use crate::error::ViewError;
use crate::pointer::Eye;
use crate::session::Session;
use incise_cut::CutParams;
use incise_mesh::geometry::{round, widen};
use incise_mesh::{Surface, Vec3, VertexId};
use incise_pbd_gpu::ConstraintSet;
use incise_render::{BodyView, Color, Content, Line, Overlay, Sheet, View, Wireframe};

const BODY: Color = Color::rgb(154, 174, 198);
const CAPS: Color = Color::rgb(222, 92, 66);
const GROUND: Color = Color::rgb(120, 128, 138);

/// Constraints are drawn this much nearer to the eye than they are, so that the surface that they lie in does not hide them.
const NEARER: f64 = 0.004;

/// The grid on the ground: cells from its middle to its edge, and of how many diagonals each.
const CELLS: i16 = 8;
const CELL: f32 = 0.25;

/// What the renderer knows of a session.
pub(super) struct Picture {
    body: BodyView,
    ground: Overlay,
    batches: Option<Overlay>,
    has_ground: bool,
    /// Of which triangles and colors the view is.
    topology: Option<(u64, bool, bool)>,
    /// Of which positions; none while they are the solver's own.
    positions: Option<u64>,
}

impl Picture {
    pub(super) fn new(screen: &Screen, session: &Session) -> Result<Self, ViewError> {
        let renderer = screen.renderer();
        Ok(Self {
            body: BodyView::new(renderer)?,
            ground: ground(screen, session)?,
            batches: None,
            has_ground: true,
            topology: None,
            positions: None,
        })
    }

    /// Brings everything up to date, and only what has changed.
    pub(super) fn update(
        &mut self,
        screen: &Screen,
        session: &mut Session,
        look: Look,
        eye: &Eye,
    ) -> Result<(), ViewError> {
        let renderer = screen.renderer();
        // Lines are made by the processor. Of a body that cannot be read, it has said so, there are none.
        let has_batches = look.batches && session.read().is_ok();
        self.has_ground = session.settings().ground;
        let surface = session.surface();
        let topology = (session.topology_version(), look.pieces, look.caps);
        if self.topology != Some(topology) {
            let cap = CutParams::default().cap_material;
            self.body.update_topology(renderer, surface, |t| {
                let is_cap = look.caps && surface.material(t) == cap;
                Some(match (is_cap, look.pieces) {
                    (true, _) => CAPS,
                    (false, true) => Color::of_piece(surface.piece(t) as usize),
                    (false, false) => BODY,
                })
            })?;
            self.topology = Some(topology);
        }
        let scene = session.scene();
        let on_device = scene.gpu().zip(scene.gpu_body(session.body()));
        match on_device {
            Some((gpu, body)) if !scene.is_fresh(session.body()) => {
                let (buffer, part) = gpu.positions(body)?;
                self.body.borrow_positions(renderer, buffer, part)?;
                self.positions = None;
            }
            _ => {
                let version = session.positions_version();
                if self.positions != Some(version) {
                    self.body.update_positions(renderer, &surface.positions)?;
                    self.positions = Some(version);
                }
            }
        }
        self.batches = if has_batches {
            Some(batches(screen, session, eye)?)
        } else {
            None
        };
        Ok(())
    }

    pub(super) fn view(&self, eye: &Eye, look: Look) -> View {
        View {
            wireframe: look.wireframe.then(Wireframe::default),
            ..View::of(eye.shown())
        }
    }

    pub(super) fn content(&self) -> Drawn<'_> {
        let mut overlays = Vec::new();
        if self.has_ground {
            overlays.push(&self.ground);
        }
        overlays.extend(&self.batches);
        Drawn {
            bodies: [&self.body],
            overlays,
        }
    }
}

/// What is in the picture.
pub(super) struct Drawn<'a> {
    bodies: [&'a BodyView; 1],
    overlays: Vec<&'a Overlay>,
}

impl Drawn<'_> {
    pub(super) fn content(&self) -> Content<'_> {
        Content {
            bodies: &self.bodies,
            overlays: &self.overlays,
        }
    }
}

/// A square with a grid, around what lies above it at first.
fn ground(screen: &Screen, session: &Session) -> Result<Overlay, ViewError> {
    let [x, _, z]: [f32; 3] = round(session.surface().bounds().center());
    let y = session.ground();
    let cell = CELL * session.diagonal();
    let reach = cell * f32::from(CELLS);
    let at = |i: f32, j: f32| [x + i, y, z + j];
    let [a, b, c, d] = [
        at(-reach, -reach),
        at(reach, -reach),
        at(reach, reach),
        at(-reach, reach),
    ];
    let color = GROUND.with_alpha(26);
    let sheets = [[a, b, c], [a, c, d]].map(|corners| Sheet { corners, color });
    let lines: Vec<Line> = (-CELLS..=CELLS)
        .flat_map(|i| {
            let i = f32::from(i) * cell;
            let across = [at(i, -reach), at(i, reach)];
            [across, [at(-reach, i), at(reach, i)]]
        })
        .map(|ends| Line {
            ends,
            color: GROUND.with_alpha(90),
            width: 1.0,
        })
        .collect();
    Ok(Overlay::new(screen.renderer(), &sheets, &lines)?)
}

/// Every edge in the color of the batch that its constraint is projected in.
fn batches(screen: &Screen, session: &Session, eye: &Eye) -> Result<Overlay, ViewError> {
    let body = session.scene().body(session.body());
    let lines = lines(body.solver().stretch(), body.surface(), eye.shown().eye());
    Ok(Overlay::new(screen.renderer(), &[], &lines)?)
}

fn lines(set: &ConstraintSet<2>, surface: &Surface, eye: Vec3) -> Vec<Line> {
    let nearer = |v: VertexId| {
        let [x, y, z, _] = surface.positions[v.index()];
        let p = widen([x, y, z]);
        round(p + (eye - p) * NEARER)
    };
    let colored = set.batches().iter().enumerate();
    let of_batch = colored.flat_map(|(i, batch)| {
        let color = color_of_batch(i);
        let ends = batch.vertices().iter();
        ends.map(move |&[a, b]| Line {
            ends: [nearer(a), nearer(b)],
            color,
            width: 1.6,
        })
    });
    of_batch.collect()
}

/// Colors that go around the hues by the golden angle, so that neighbors in number are far apart.
pub(super) fn color_of_batch(batch: usize) -> Color {
    let turns = f64::from(u32::try_from(batch).unwrap_or(0)) * 0.381_966_011_250_105;
    let hue = 6.0 * turns.fract();
    let channel = |shift: f64| {
        let k = (shift + hue) % 6.0;
        let strength = 1.0 - 0.85 * k.min(4.0 - k).clamp(0.0, 1.0);
        to_byte(0.88 * strength)
    };
    Color::rgb(channel(5.0), channel(3.0), channel(1.0))
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "from 0 to 1"
)]
fn to_byte(x: f64) -> u8 {
    (255.0 * x).round() as u8
}
