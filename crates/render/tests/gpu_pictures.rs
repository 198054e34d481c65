//! Pictures and buffers: the same bytes again, positions of somebody else, and what is refused.

#![expect(
    clippy::missing_assert_message,
    reason = "these are tests, which the lint knows by an attribute only"
)]

mod common;

use common::{BLUE, Gpu, RED, draw, picture};
use incise_mesh::{Model, Surface, TriangleId, build_model, icosphere};
use incise_render::{
    Background, BodyView, Camera, Canvas, Color, Content, Offscreen, RenderError, Renderer, View,
    Wireframe,
};
use std::process::ExitCode;
use wgpu::BufferUsages;

fn main() -> ExitCode {
    common::run(&[
        ("the_same_picture_is_the_same_bytes", the_same_again),
        ("any_width_comes_back_whole", any_width_comes_back),
        (
            "borrowed_positions_look_as_uploaded_ones",
            borrowed_positions,
        ),
        (
            "borrowed_positions_are_seen_where_they_are_now",
            positions_that_move,
        ),
        (
            "positions_that_are_none_are_refused",
            positions_that_are_none,
        ),
        ("sizes_that_are_none_are_refused", sizes_that_are_none),
        ("canvases_and_formats_must_fit", canvases_must_fit),
        ("renderers_share_bodies", renderers_share_bodies),
        ("a_body_too_large_is_refused", a_body_too_large),
    ])
}

fn color(t: TriangleId) -> Option<Color> {
    Some(if t.0.is_multiple_of(3) { RED } else { BLUE })
}

fn view(surface: &Surface) -> View {
    let camera = Camera::default().fit(&surface.bounds(), 4.0 / 3.0);
    View {
        wireframe: Some(Wireframe::default()),
        ..View::of(camera)
    }
}

fn the_same_again(gpu: &Gpu) {
    let surface = build_model(Model::Bunny);
    let (renderer, view) = (gpu.smooth(), view(&surface));
    let first = picture(&renderer, [200, 150], &view, &surface, color);
    let body = BodyView::of(&renderer, &surface, color).expect("a body");
    let offscreen = Offscreen::new(&renderer, 200, 150).expect("a size");
    let content = Content {
        bodies: &[&body],
        overlays: &[],
    };
    for _ in 0..3 {
        let again = offscreen
            .picture(&renderer, &view, &content)
            .expect("a picture");
        assert_eq!(again, first);
    }
    assert_eq!(
        picture(&gpu.smooth(), [200, 150], &view, &surface, color),
        first
    );
}

/// Rows come back in pieces of 256 bytes, and pictures are as wide as they like. A background has one color a row and
/// another one in the next, so nothing may be shifted or left over.
fn any_width_comes_back(gpu: &Gpu) {
    let (top, bottom) = (Color::rgb(250, 200, 250), Color::rgb(10, 20, 10));
    let background = Background::Gradient { top, bottom };
    let view = View {
        background,
        ..View::of(Camera::default())
    };
    for size in [
        [1, 1],
        [63, 5],
        [64, 64],
        [65, 30],
        [1, 40],
        [300, 2],
        [257, 33],
    ] {
        let picture = draw(&gpu.smooth(), size, &view, &[]);
        assert_eq!([picture.width(), picture.height()], size);
        let rows: Vec<&[u8]> = picture.pixels().chunks(4 * size[0] as usize).collect();
        assert_eq!(rows.len(), size[1] as usize);
        for row in &rows {
            let pixels = row.as_chunks::<4>().0;
            assert!(
                pixels.iter().all(|p| *p == pixels[0] && p[3] == 255),
                "{size:?}"
            );
        }
        assert!(
            rows.windows(2).all(|pair| pair[0][0] > pair[1][0]),
            "{size:?}"
        );
    }
}

/// A buffer with these positions after `before` others.
fn solver_buffer(
    gpu: &Gpu,
    surface: &Surface,
    before: u64,
) -> (wgpu::Buffer, std::ops::Range<u64>) {
    let bytes: &[u8] = bytemuck::cast_slice(&surface.positions);
    let start = 16 * before;
    let end = start + bytes.len() as u64;
    let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: end + 160,
        usage: BufferUsages::STORAGE | BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    gpu.queue.write_buffer(&buffer, start, bytes);
    (buffer, start..end)
}

fn borrowed_positions(gpu: &Gpu) {
    let surface = build_model(Model::Bunny);
    let (renderer, view) = (gpu.smooth(), view(&surface));
    let uploaded = picture(&renderer, [200, 150], &view, &surface, color);
    let mut body = BodyView::new(&renderer).expect("a body");
    body.update_topology(&renderer, &surface, color)
        .expect("triangles");
    // At places that devices allow bindings to begin at, and between them.
    for before in [0, 1, 15, 16, 17, 1000] {
        let (buffer, part) = solver_buffer(gpu, &surface, before);
        body.borrow_positions(&renderer, &buffer, part.clone())
            .expect("positions");
        assert_eq!(
            draw(&renderer, [200, 150], &view, &[&body]),
            uploaded,
            "{before} before"
        );
        body.borrow_positions(&renderer, &buffer, part)
            .expect("the same again");
        assert_eq!(draw(&renderer, [200, 150], &view, &[&body]), uploaded);
    }
    let mut moved = surface.clone();
    for p in &mut moved.positions {
        p[0] += 0.1;
    }
    body.update_positions(&renderer, &moved.positions)
        .expect("positions");
    let own = draw(&renderer, [200, 150], &view, &[&body]);
    assert_eq!(own, picture(&renderer, [200, 150], &view, &moved, color));
    assert_ne!(own, uploaded);
}

fn positions_that_move(gpu: &Gpu) {
    let surface = icosphere(2, 0.5);
    let (renderer, view) = (gpu.smooth(), view(&surface));
    let mut body = BodyView::new(&renderer).expect("a body");
    body.update_topology(&renderer, &surface, color)
        .expect("triangles");
    let (buffer, part) = solver_buffer(gpu, &surface, 3);
    body.borrow_positions(&renderer, &buffer, part.clone())
        .expect("positions");
    let mut moved = surface.clone();
    for step in 0..3 {
        for p in &mut moved.positions {
            p[1] += 0.07;
        }
        gpu.queue
            .write_buffer(&buffer, part.start, bytemuck::cast_slice(&moved.positions));
        let seen = draw(&renderer, [100, 100], &view, &[&body]);
        assert_eq!(
            seen,
            picture(&renderer, [100, 100], &view, &moved, color),
            "{step}"
        );
    }
}

fn positions_that_are_none(gpu: &Gpu) {
    let renderer = gpu.plain();
    let surface = icosphere(1, 0.5);
    let mut body = BodyView::of(&renderer, &surface, color).expect("a body");
    let before = draw(&renderer, [64, 64], &view(&surface), &[&body]);
    let (buffer, part) = solver_buffer(gpu, &surface, 0);
    let size = buffer.size();
    #[expect(
        clippy::reversed_empty_ranges,
        reason = "it is one of those that are refused"
    )]
    for bad in [
        8..24,
        16..24,
        32..16,
        0..size + 16,
        size + 16..size + 32,
        u64::MAX - 15..u64::MAX,
    ] {
        let error = body
            .borrow_positions(&renderer, &buffer, bad.clone())
            .expect_err("no positions");
        assert!(
            matches!(error, RenderError::NoPositions { .. }),
            "{bad:?}: {error}"
        );
    }
    let other = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size,
        usage: BufferUsages::VERTEX,
        mapped_at_creation: false,
    });
    let error = body
        .borrow_positions(&renderer, &other, part.clone())
        .expect_err("no storage");
    assert!(matches!(error, RenderError::NoPositions { .. }), "{error}");
    assert_eq!(
        draw(&renderer, [64, 64], &view(&surface), &[&body]),
        before,
        "nothing has changed"
    );
    // Fewer than the triangles need, found when they are drawn.
    let drawn = |body: &BodyView| {
        let content = Content {
            bodies: &[body],
            overlays: &[],
        };
        Offscreen::new(&renderer, 8, 8).expect("a size").picture(
            &renderer,
            &view(&surface),
            &content,
        )
    };
    let few = [part.start..part.end - 16, 0..0, size..size];
    for part in few {
        body.borrow_positions(&renderer, &buffer, part.clone())
            .expect("positions, if too few");
        let error = drawn(&body).expect_err("too few");
        let have = (part.end - part.start) / 16;
        assert!(
            matches!(error, RenderError::TooFewPositions { need: 42, have: h } if h == have),
            "{error}"
        );
    }
    body.update_positions(&renderer, &surface.positions[..41])
        .expect("positions, if too few");
    assert!(matches!(
        drawn(&body),
        Err(RenderError::TooFewPositions { need: 42, have: 41 })
    ));
    body.update_positions(&renderer, &surface.positions)
        .expect("all of them");
    assert_eq!(draw(&renderer, [64, 64], &view(&surface), &[&body]), before);
    let nothing = BodyView::new(&renderer).expect("a body");
    assert_eq!(nothing.triangle_slots(), 0);
    assert!(drawn(&nothing).is_ok(), "no triangles need no positions");
}

fn sizes_that_are_none(gpu: &Gpu) {
    let renderer = gpu.smooth();
    let limit = gpu.device.limits().max_texture_dimension_2d;
    for (width, height) in [
        (0, 1),
        (1, 0),
        (limit + 1, 1),
        (1, limit + 1),
        (u32::MAX, u32::MAX),
    ] {
        let error = Offscreen::new(&renderer, width, height).expect_err("no size");
        assert!(
            matches!(error, RenderError::Size { width: w, height: h, limit: l } if (w, h, l) == (width, height, limit)),
            "{error}"
        );
        let error = Canvas::new(&renderer, width, height).expect_err("no size");
        assert!(matches!(error, RenderError::Size { .. }), "{error}");
    }
    for (width, height) in [(limit, 1), (1, limit)] {
        let longest = draw(
            &renderer,
            [width, height],
            &View::of(Camera::default()),
            &[],
        );
        assert_eq!([longest.width(), longest.height()], [width, height]);
    }
}

fn canvases_must_fit(gpu: &Gpu) {
    let (plain, smooth) = (gpu.plain(), gpu.smooth());
    let new = |format, samples| Renderer::new(&gpu.device, &gpu.queue, format, samples);
    for samples in [0, 3, 1 << 20] {
        let error = new(plain.format(), samples).expect_err("no number of samples");
        assert!(matches!(error, RenderError::Format { .. }), "{error}");
    }
    let error = new(wgpu::TextureFormat::Depth32Float, 1).expect_err("no colors");
    assert!(
        matches!(
            error,
            RenderError::Validation { .. } | RenderError::Format { .. }
        ),
        "{error}"
    );
    let window = new(wgpu::TextureFormat::Bgra8Unorm, 1).expect("a window's");
    let error = Offscreen::new(&window, 8, 8).expect_err("not what pictures are made of");
    assert!(matches!(error, RenderError::Format { .. }), "{error}");
    if smooth.samples() > 1 {
        let offscreen = Offscreen::new(&smooth, 8, 8).expect("a size");
        let error = offscreen.picture(&plain, &View::of(Camera::default()), &Content::default());
        assert!(matches!(error, Err(RenderError::ForeignCanvas)));
    }
}

fn renderers_share_bodies(gpu: &Gpu) {
    let surface = icosphere(2, 0.5);
    let view = view(&surface);
    let body = BodyView::of(&gpu.plain(), &surface, color).expect("a body");
    let smooth = gpu.smooth();
    let shared = draw(&smooth, [64, 64], &view, &[&body]);
    assert_eq!(shared, picture(&smooth, [64, 64], &view, &surface, color));
}

fn a_body_too_large(gpu: &Gpu) {
    let adapter_limit = gpu.device.limits().max_storage_buffer_binding_size;
    let renderer = gpu.plain();
    let mut body = BodyView::of(&renderer, &icosphere(1, 0.5), color).expect("a body");
    // WebGPU's own limit is 128 MiB, so one more position is a test's worth of memory.
    let count = usize::try_from(adapter_limit / 16 + 1).expect("it is on this machine");
    let positions = vec![[0.0; 4]; count];
    let error = body
        .update_positions(&renderer, &positions)
        .expect_err("too many");
    assert!(
        matches!(error, RenderError::BufferTooLarge { limit, .. } if limit == adapter_limit),
        "{error}"
    );
}
