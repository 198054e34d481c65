//! GPU resources of the session's body, ground and constraint lines, updated once per redraw.

use super::DisplayOptions;

use crate::error::ViewError;
use crate::pointer::OrbitCamera;
use crate::session::Session;
use incise_cut::CutParams;
use incise_mesh::geometry::{to_f32, to_f64};
use incise_mesh::{Surface, Vec3, VertexId};
use incise_pbd_gpu::ConstraintSet;
use incise_render::{
    BodyView, Color, DrawList, Line, Overlay, OverlayTriangle, Renderer, View, Wireframe,
};

const BODY: Color = Color::rgb(154, 174, 198);
const CAPS: Color = Color::rgb(222, 92, 66);
const GROUND: Color = Color::rgb(120, 128, 138);

/// Relative shift of constraint lines toward the camera, so that the surface does not hide them.
const DEPTH_SHIFT: f64 = 0.004;

/// Cells of the ground grid from its center to its edge.
const CELLS: i16 = 8;
/// Size of a cell relative to the diagonal of the body.
const CELL: f32 = 0.25;

/// GPU resources that show a session.
pub(super) struct SceneView {
    body: BodyView,
    ground: Overlay,
    batches: Option<Overlay>,
    has_ground: bool,
    /// Version of the topology and the color options that were uploaded.
    topology: Option<(u64, bool, bool)>,
    /// Version of the uploaded positions; `None` while the solver's buffer is bound.
    positions: Option<u64>,
}

impl SceneView {
    pub(super) fn new(renderer: &Renderer, session: &Session) -> Result<Self, ViewError> {
        Ok(Self {
            body: BodyView::new(renderer)?,
            ground: ground(renderer, session)?,
            batches: None,
            has_ground: true,
            topology: None,
            positions: None,
        })
    }

    /// Updates the GPU resources that have changed.
    pub(super) fn update(
        &mut self,
        renderer: &Renderer,
        session: &mut Session,
        display: DisplayOptions,
        orbit: &OrbitCamera,
    ) -> Result<(), ViewError> {
        // The lines need CPU positions. A failed readback has been reported; no lines are drawn.
        let has_batches = display.batches && session.read().is_ok();
        self.has_ground = session.settings().ground;
        let surface = session.surface();
        let topology = (session.topology_version(), display.pieces, display.caps);
        if self.topology != Some(topology) {
            let cap = CutParams::default().cap_material;
            self.body.update_topology(renderer, surface, |t| {
                let is_cap = display.caps && surface.material(t) == cap;
                Some(match (is_cap, display.pieces) {
                    (true, _) => CAPS,
                    (false, true) => Color::for_piece(surface.piece(t) as usize),
                    (false, false) => BODY,
                })
            })?;
            self.topology = Some(topology);
        }
        let scene = session.scene();
        let on_device = scene.gpu().zip(scene.gpu_body(session.body())?);
        match on_device {
            Some((gpu, body)) if !scene.residency(session.body())?.is_cpu_current() => {
                let (buffer, part) = gpu.positions(body)?;
                self.body.bind_positions(renderer, buffer, part)?;
                self.positions = None;
            }
            _ => {
                let version = session.positions_version();
                if self.positions != Some(version) {
                    self.body.update_positions(renderer, surface.positions())?;
                    self.positions = Some(version);
                }
            }
        }
        self.batches = if has_batches {
            Some(batches(renderer, session, orbit)?)
        } else {
            None
        };
        Ok(())
    }

    pub(super) fn view(&self, orbit: &OrbitCamera, display: DisplayOptions) -> View {
        View {
            wireframe: display.wireframe.then(Wireframe::default),
            ..View::from_camera(orbit.window_camera())
        }
    }

    pub(super) fn draw_list(&self) -> DrawListStorage<'_> {
        let mut overlays = Vec::new();
        if self.has_ground {
            overlays.push(&self.ground);
        }
        overlays.extend(&self.batches);
        DrawListStorage {
            bodies: [&self.body],
            overlays,
        }
    }
}

/// Storage of the slices of a [`DrawList`].
pub(super) struct DrawListStorage<'a> {
    bodies: [&'a BodyView; 1],
    overlays: Vec<&'a Overlay>,
}

impl DrawListStorage<'_> {
    pub(super) fn as_draw_list(&self) -> DrawList<'_> {
        DrawList {
            bodies: &self.bodies,
            overlays: &self.overlays,
        }
    }
}

/// Creates the ground: a translucent square with a grid around the initial body.
fn ground(renderer: &Renderer, session: &Session) -> Result<Overlay, ViewError> {
    let [x, _, z]: [f32; 3] = to_f32(session.surface().bounds().center());
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
    let sheets = [[a, b, c], [a, c, d]].map(|corners| OverlayTriangle { corners, color });
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
    Ok(Overlay::new(renderer, &sheets, &lines)?)
}

/// Creates lines for the stretch constraints in the colors of their batches.
fn batches(
    renderer: &Renderer,
    session: &Session,
    orbit: &OrbitCamera,
) -> Result<Overlay, ViewError> {
    let body = session.scene().body(session.body())?;
    let lines = lines(
        body.solver().stretch(),
        body.surface(),
        orbit.window_camera().eye(),
    );
    Ok(Overlay::new(renderer, &[], &lines)?)
}

fn lines(set: &ConstraintSet<2>, surface: &Surface, eye: Vec3) -> Vec<Line> {
    let nearer = |v: VertexId| {
        let [x, y, z, _] = surface.positions()[v.index()];
        let p = to_f64([x, y, z]);
        to_f32(p + (eye - p) * DEPTH_SHIFT)
    };
    let colored = set.batches().iter().enumerate();
    let of_batch = colored.flat_map(|(i, batch)| {
        let color = batch_color(i);
        let ends = batch.vertices().iter();
        ends.map(move |&[a, b]| Line {
            ends: [nearer(a), nearer(b)],
            color,
            width: 1.6,
        })
    });
    of_batch.collect()
}

/// Returns the color of a batch; hues advance by the golden angle, so that they differ clearly.
pub(super) fn batch_color(batch: usize) -> Color {
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
