//! Offscreen images and position buffers: determinism, bound positions, and errors.

use super::common::{BLUE, Gpu, RED, Test, draw, image};
use incise_mesh::{Surface, TriangleId, icosphere};
use incise_models::{Model, build_model};
use incise_pbd_gpu::Context;
use incise_pbd_gpu::wgpu::{self, BufferUsages};
use incise_render::{
    Attachments, Background, BodyView, Camera, Color, DrawList, Offscreen, RenderError, Renderer,
    View, Wireframe,
};
use incise_test_support::gpu::Needs;

pub(crate) const TESTS: &[Test] = &[
    rendering_is_deterministic,
    any_width,
    bound_positions,
    moving_bound_positions,
    invalid_positions,
    invalid_sizes,
    attachment_mismatch,
    renderers_share_bodies,
    too_large_body,
];

fn color(t: TriangleId) -> Option<Color> {
    Some(if t.0.is_multiple_of(3) { RED } else { BLUE })
}

fn view(surface: &Surface) -> View {
    let camera = Camera::default().fit(&surface.bounds(), 4.0 / 3.0);
    View {
        wireframe: Some(Wireframe::default()),
        ..View::from_camera(camera)
    }
}

fn rendering_is_deterministic(gpu: &Gpu) {
    let surface = build_model(Model::Bunny);
    let (renderer, view) = (gpu.smooth(), view(&surface));
    let first = image(renderer, [200, 150], &view, &surface, color);
    let body = BodyView::from_surface(renderer, &surface, color).expect("a body");
    let offscreen = Offscreen::new(renderer, 200, 150).expect("a size");
    let content = DrawList {
        bodies: &[&body],
        overlays: &[],
    };
    for _ in 0..3 {
        let again = offscreen
            .render(renderer, &view, &content)
            .expect("an image");
        assert_eq!(again, first);
    }
    let other = Renderer::offscreen(&gpu.device, &gpu.queue).expect("images can be drawn");
    assert_eq!(image(&other, [200, 150], &view, &surface, color), first);
}

/// The readback removes the padding of rows to 256 bytes: each row of a gradient has one color.
fn any_width(gpu: &Gpu) {
    let (top, bottom) = (Color::rgb(250, 200, 250), Color::rgb(10, 20, 10));
    let background = Background::Gradient { top, bottom };
    let view = View {
        background,
        ..View::from_camera(Camera::default())
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
        let image = draw(gpu.smooth(), size, &view, &[]);
        assert_eq!([image.width(), image.height()], size);
        let rows: Vec<&[u8]> = image.pixels().chunks(4 * size[0] as usize).collect();
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

/// Returns a storage buffer with the positions after `before` other vertices, and their range.
fn solver_buffer(
    gpu: &Gpu,
    surface: &Surface,
    before: u64,
) -> (wgpu::Buffer, std::ops::Range<u64>) {
    let bytes: &[u8] = bytemuck::cast_slice(surface.positions());
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

fn bound_positions(gpu: &Gpu) {
    let surface = build_model(Model::Bunny);
    let (renderer, view) = (gpu.smooth(), view(&surface));
    let uploaded = image(renderer, [200, 150], &view, &surface, color);
    let mut body = BodyView::new(renderer).expect("a body");
    body.update_topology(renderer, &surface, color)
        .expect("triangles");
    // Offsets that are aligned for bindings, and offsets that are not.
    for before in [0, 1, 15, 16, 17, 1000] {
        let (buffer, part) = solver_buffer(gpu, &surface, before);
        body.bind_positions(renderer, &buffer, part.clone())
            .expect("positions");
        assert_eq!(
            draw(renderer, [200, 150], &view, &[&body]),
            uploaded,
            "{before} before"
        );
        body.bind_positions(renderer, &buffer, part)
            .expect("the same again");
        assert_eq!(draw(renderer, [200, 150], &view, &[&body]), uploaded);
    }
    let mut moved = surface.clone();
    for p in moved.positions_mut() {
        p[0] += 0.1;
    }
    body.update_positions(renderer, moved.positions())
        .expect("positions");
    let own = draw(renderer, [200, 150], &view, &[&body]);
    assert_eq!(own, image(renderer, [200, 150], &view, &moved, color));
    assert_ne!(own, uploaded);
}

fn moving_bound_positions(gpu: &Gpu) {
    let surface = icosphere(2, 0.5);
    let (renderer, view) = (gpu.smooth(), view(&surface));
    let mut body = BodyView::new(renderer).expect("a body");
    body.update_topology(renderer, &surface, color)
        .expect("triangles");
    let (buffer, part) = solver_buffer(gpu, &surface, 3);
    body.bind_positions(renderer, &buffer, part.clone())
        .expect("positions");
    let mut moved = surface.clone();
    for step in 0..3 {
        for p in moved.positions_mut() {
            p[1] += 0.07;
        }
        gpu.queue
            .write_buffer(&buffer, part.start, bytemuck::cast_slice(moved.positions()));
        let seen = draw(renderer, [100, 100], &view, &[&body]);
        assert_eq!(
            seen,
            image(renderer, [100, 100], &view, &moved, color),
            "{step}"
        );
    }
}

fn invalid_positions(gpu: &Gpu) {
    let renderer = gpu.plain();
    let surface = icosphere(1, 0.5);
    let mut body = BodyView::from_surface(renderer, &surface, color).expect("a body");
    let before = draw(renderer, [64, 64], &view(&surface), &[&body]);
    let (buffer, part) = solver_buffer(gpu, &surface, 0);
    let size = buffer.size();
    #[expect(clippy::reversed_empty_ranges, reason = "one of the invalid ranges")]
    for bad in [
        8..24,
        16..24,
        32..16,
        0..size + 16,
        size + 16..size + 32,
        u64::MAX - 15..u64::MAX,
    ] {
        let error = body
            .bind_positions(renderer, &buffer, bad.clone())
            .expect_err("no positions");
        assert!(
            matches!(error, RenderError::InvalidPositionRange { .. }),
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
        .bind_positions(renderer, &other, part.clone())
        .expect_err("no storage");
    assert!(
        matches!(error, RenderError::InvalidPositionRange { .. }),
        "{error}"
    );
    assert_eq!(
        draw(renderer, [64, 64], &view(&surface), &[&body]),
        before,
        "nothing has changed"
    );
    // Too few positions are an error when the body is drawn.
    let drawn = |body: &BodyView| {
        let content = DrawList {
            bodies: &[body],
            overlays: &[],
        };
        Offscreen::new(renderer, 8, 8)
            .expect("a size")
            .render(renderer, &view(&surface), &content)
    };
    let few = [part.start..part.end - 16, 0..0, size..size];
    for part in few {
        body.bind_positions(renderer, &buffer, part.clone())
            .expect("positions, if too few");
        let error = drawn(&body).expect_err("too few");
        let have = (part.end - part.start) / 16;
        assert!(
            matches!(error, RenderError::TooFewPositions { need: 42, have: h } if h == have),
            "{error}"
        );
    }
    body.update_positions(renderer, &surface.positions()[..41])
        .expect("positions, if too few");
    assert!(matches!(
        drawn(&body),
        Err(RenderError::TooFewPositions { need: 42, have: 41 })
    ));
    body.update_positions(renderer, surface.positions())
        .expect("all of them");
    assert_eq!(draw(renderer, [64, 64], &view(&surface), &[&body]), before);
    let nothing = BodyView::new(renderer).expect("a body");
    assert_eq!(nothing.triangle_slots(), 0);
    assert!(drawn(&nothing).is_ok(), "no triangles need no positions");
}

fn invalid_sizes(gpu: &Gpu) {
    let renderer = gpu.smooth();
    let limit = gpu.device.limits().max_texture_dimension_2d;
    for (width, height) in [
        (0, 1),
        (1, 0),
        (limit + 1, 1),
        (1, limit + 1),
        (u32::MAX, u32::MAX),
    ] {
        let error = Offscreen::new(renderer, width, height).expect_err("no size");
        let RenderError::InvalidSize {
            width: w,
            height: h,
            limit: l,
        } = error
        else {
            panic!("{error}");
        };
        assert_eq!((w, h, l), (width, height, limit));
        let error = Attachments::new(renderer, width, height).expect_err("no size");
        assert!(matches!(error, RenderError::InvalidSize { .. }), "{error}");
    }
    for (width, height) in [(limit, 1), (1, limit)] {
        let longest = draw(
            renderer,
            [width, height],
            &View::from_camera(Camera::default()),
            &[],
        );
        assert_eq!([longest.width(), longest.height()], [width, height]);
    }
}

fn attachment_mismatch(gpu: &Gpu) {
    let (plain, smooth) = (gpu.plain(), gpu.smooth());
    let new = |format, samples| Renderer::new(&gpu.device, &gpu.queue, format, samples);
    for samples in [0, 3, 1 << 20] {
        let error = new(plain.format(), samples).expect_err("no number of samples");
        assert!(
            matches!(error, RenderError::UnsupportedFormat { .. }),
            "{error}"
        );
    }
    let error = new(wgpu::TextureFormat::Depth32Float, 1).expect_err("no colors");
    assert!(
        matches!(
            error,
            RenderError::Validation { .. } | RenderError::UnsupportedFormat { .. }
        ),
        "{error}"
    );
    let window = new(wgpu::TextureFormat::Bgra8Unorm, 1).expect("a window's");
    let error = Offscreen::new(&window, 8, 8).expect_err("not what images are made of");
    assert!(
        matches!(error, RenderError::UnsupportedFormat { .. }),
        "{error}"
    );
    if smooth.samples() > 1 {
        let offscreen = Offscreen::new(smooth, 8, 8).expect("a size");
        let error = offscreen.render(
            plain,
            &View::from_camera(Camera::default()),
            &DrawList::default(),
        );
        assert!(matches!(error, Err(RenderError::AttachmentMismatch)));
    }
}

fn renderers_share_bodies(gpu: &Gpu) {
    let surface = icosphere(2, 0.5);
    let view = view(&surface);
    let body = BodyView::from_surface(gpu.plain(), &surface, color).expect("a body");
    let smooth = gpu.smooth();
    let shared = draw(smooth, [64, 64], &view, &[&body]);
    assert_eq!(shared, image(smooth, [64, 64], &view, &surface, color));
}

fn too_large_body(_: &Gpu) {
    let context = Context::open(&Needs::AnyDevice.portable_request()).expect("an adapter");
    let gpu = Gpu::new(&context);
    let adapter_limit = gpu.device.limits().max_storage_buffer_binding_size;
    let renderer = gpu.plain();
    let mut body = BodyView::from_surface(renderer, &icosphere(1, 0.5), color).expect("a body");
    // The default limit of WebGPU is 128 MiB; the test needs one more position.
    let count = usize::try_from(adapter_limit / 16 + 1).expect("it is on this machine");
    let positions = vec![[0.0; 4]; count];
    let error = body
        .update_positions(renderer, &positions)
        .expect_err("too many");
    assert!(
        matches!(error, RenderError::BufferTooLarge { limit, .. } if limit == adapter_limit),
        "{error}"
    );
}
