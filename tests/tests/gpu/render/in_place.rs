//! Images that are drawn from the GPU buffers of a solver, without readback.

use incise_cut::{CutParams, Cutter, Sweep};
use incise_mesh::{Surface, TriangleId};
use incise_models::{Model, build_model};
use incise_pbd_gpu::{Context, GpuBackend, Material, Solver, SolverParams};
use incise_render::{
    BodyView, Camera, Color, DrawList, Image, Offscreen, Renderer, View, Wireframe,
};
use incise_test_support::params::set_ground;

/// Images from the solver's buffer equal those from positions that were read back.
///
/// Two bodies share the buffer; they are compared before and after steps and a cut.
pub(crate) fn drawn_in_place(context: Context) {
    let renderer = Renderer::offscreen(context.device(), context.queue()).expect("a renderer");
    let mut gpu = GpuBackend::from_context(context).expect("a backend");
    let params = SolverParams::default();
    let mut bodies = [Model::Sphere80, Model::Bunny].map(|model| {
        let mut surface = build_model(model);
        let mut solver = Solver::new(&mut surface, &Material::default()).expect("a solver");
        set_ground(&mut solver, -0.5);
        let body = gpu.add(&surface, &mut solver).expect("room");
        (surface, solver, body)
    });
    let mut views = [(); 2].map(|()| BodyView::new(&renderer).expect("a body"));
    for (view, (surface, ..)) in views.iter_mut().zip(&bodies) {
        view.update_topology(&renderer, surface, color(surface))
            .expect("triangles");
    }
    for frame in 0..6 {
        if frame == 3 {
            for (view, (surface, solver, body)) in views.iter_mut().zip(&mut bodies) {
                gpu.read(*body, surface, solver).expect("a body");
                let sweep = Sweep::from_plane([0.2, 1.0, 0.1], -0.1, &surface.bounds());
                let sweep = sweep.expect("a plane");
                let cut = Cutter::new(surface).cut(surface, &sweep, &CutParams::default());
                let delta = cut.expect("a cut").delta;
                assert!(!delta.is_empty());
                solver
                    .apply_delta(surface, &delta)
                    .expect("a cut of this body");
                gpu.update(*body, surface, solver).expect("an update");
                view.update_topology(&renderer, surface, color(surface))
                    .expect("triangles");
            }
        }
        let stepped = bodies.iter_mut().map(|(_, solver, body)| (*body, solver));
        gpu.step(stepped, 1.0 / 60.0, &params).expect("a step");
        for (view, (surface, solver, body)) in views.iter_mut().zip(&mut bodies) {
            let (buffer, part) = gpu.positions(*body).expect("a body");
            view.bind_positions(&renderer, buffer, part)
                .expect("positions");
            let in_place = picture(&renderer, view);
            gpu.read(*body, surface, solver).expect("a body");
            let read = BodyView::from_surface(&renderer, surface, color(surface)).expect("a body");
            assert_eq!(in_place, picture(&renderer, &read), "frame {frame}");
        }
    }
}

fn color(surface: &Surface) -> impl Fn(TriangleId) -> Option<Color> {
    |t| {
        let is_cap = surface.material(t) == CutParams::default().cap_material;
        Some(if is_cap {
            Color::rgb(220, 90, 60)
        } else {
            Color::for_piece(surface.piece(t) as usize)
        })
    }
}

fn picture(renderer: &Renderer, body: &BodyView) -> Image {
    let view = View {
        wireframe: Some(Wireframe::default()),
        ..View::from_camera(Camera::default())
    };
    let content = DrawList {
        bodies: &[body],
        overlays: &[],
    };
    let offscreen = Offscreen::new(renderer, 160, 120).expect("a size");
    let picture = offscreen
        .render(renderer, &view, &content)
        .expect("a picture");
    let background = picture.color(0, 0);
    assert_ne!(
        picture.color(80, 70),
        background,
        "the body is in the picture"
    );
    picture
}
