//! Bodies in rendered images: projection, occlusion, shading, wireframe and colors.

use super::common::{BLUE, Gpu, RED, Test, WHITE, count_other, draw, facing, image, triangles};
use incise_mesh::{Surface, TriangleId, VertexId, icosphere};
use incise_pbd_gpu::wgpu;
use incise_render::{Background, BodyView, Camera, Color, Image, Light, Renderer, View, Wireframe};

pub(crate) const TESTS: &[Test] = &[
    sphere_covers_its_projection,
    nearer_bodies_occlude,
    far_from_the_origin,
    shading_follows_the_light,
    back_faces_are_tinted,
    triangles_without_color,
    removed_triangles_are_not_drawn,
    wireframe_darkens_edges,
    wireframe_fades_on_tiny_triangles,
    checkers,
    backgrounds,
    multisampling_smooths_edges,
    formats_show_the_same,
];

/// Returns a camera that looks at the origin from positive z.
fn straight(distance: f64) -> Camera {
    Camera {
        distance,
        ..Camera::from_angles(0.0, 0.0)
    }
}

/// Returns a large triangle at depth `z` that faces positive z.
fn at_depth(z: f32) -> [[f32; 3]; 3] {
    [[-1.0, -1.0, z], [1.0, -1.0, z], [0.0, 1.0, z]]
}

fn center(image: &Image) -> Color {
    let at = image.color(image.width() / 2, image.height() / 2);
    at.expect("it has a middle")
}

fn brightness(color: Color) -> f32 {
    color.linear()[..3].iter().sum()
}

fn sphere_covers_its_projection(gpu: &Gpu) {
    let (radius, size) = (0.5, [500, 400]);
    let sphere = icosphere(6, radius);
    for (distance, field_of_view) in [(3.0, 0.5), (10.0, 0.12), (1.4, 1.0)] {
        let camera = Camera {
            distance,
            field_of_view,
            ..Camera::from_angles(0.7, 0.4)
        };
        let image = image(gpu.plain(), size, &facing(camera), &sphere, |_| Some(BLUE));
        let covered = count_other(&image, WHITE);
        // The silhouette cone of the sphere; half the image height is the tangent of half the
        // field of view.
        let tangent = radius / (distance * distance - radius * radius).sqrt();
        let pixels = 200.0 * tangent / (field_of_view / 2.0).tan();
        let disc = std::f64::consts::PI * pixels * pixels;
        let part = f64::from(u32::try_from(covered).expect("a few")) / disc;
        assert!((part - 1.0).abs() < 0.01, "{covered} pixels of {disc}");
    }
}

fn nearer_bodies_occlude(gpu: &Gpu) {
    for (red, blue) in [(0, 1), (1, 0)] {
        // Neither the order of triangles nor the order of bodies matters.
        let depths = if red == 0 { [0.5, -0.5] } else { [-0.5, 0.5] };
        let surface = triangles(&depths.map(at_depth));
        let color_of = |t: TriangleId| Some(if t.index() == red { RED } else { BLUE });
        let view = facing(straight(6.0));
        let one = image(gpu.plain(), [64, 64], &view, &surface, color_of);
        assert_eq!(center(&one), RED);
        let renderer = gpu.plain();
        let bodies = [red, blue].map(|i| {
            let surface = triangles(&[at_depth(depths[i])]);
            BodyView::from_surface(renderer, &surface, |_| color_of(TriangleId::from_index(i)))
                .expect("a body")
        });
        for order in [[0, 1], [1, 0]] {
            let two = draw(renderer, [64, 64], &view, &order.map(|i: usize| &bodies[i]));
            assert_eq!(two, one);
        }
    }
}

/// Renders at a distance where 32-bit floats are 1/64 m apart; all vertices are multiples of that.
fn far_from_the_origin(gpu: &Gpu) {
    let step = 1.0 / 64.0;
    let far = 131_072.0;
    let mut near = icosphere(2, 0.5);
    for p in near.positions_mut() {
        *p = p.map(|x| (x / step).round() * step);
    }
    let mut away = near.clone();
    for p in away.positions_mut() {
        p[0] += far;
    }
    let view = |x: f64| {
        let camera = Camera {
            target: [x, 0.0, 0.0],
            ..Camera::from_angles(0.6, 0.3)
        };
        View::from_camera(camera)
    };
    let color = |_: TriangleId| Some(BLUE);
    let here = image(gpu.smooth(), [120, 90], &view(0.0), &near, color);
    let there = image(gpu.smooth(), [120, 90], &view(f64::from(far)), &away, color);
    assert_eq!(here, there);
}

fn shading_follows_the_light(gpu: &Gpu) {
    let sphere = icosphere(3, 0.5);
    let gray = Color::rgb(200, 200, 200);
    let light = Light {
        direction: [-1.0, 0.0, 0.3],
        fill: 0.0,
        ..Light::default()
    };
    let view = View {
        light,
        ..facing(straight(3.0))
    };
    let image = image(gpu.plain(), [200, 200], &view, &sphere, |_| Some(gray));
    let at = |x| brightness(image.color(x, 100).expect("inside"));
    assert!(
        at(50) > 1.3 * at(100),
        "from the left: {} {}",
        at(50),
        at(100)
    );
    assert!(at(100) > 1.2 * at(150), "{} {}", at(100), at(150));
}

fn back_faces_are_tinted(gpu: &Gpu) {
    let renderer = gpu.plain();
    let surface = triangles(&[at_depth(0.0)]);
    let mut body = BodyView::from_surface(renderer, &surface, |_| Some(RED)).expect("a body");
    let front = straight(6.0);
    let back = Camera {
        azimuth: std::f64::consts::PI,
        ..front
    };
    let of = |body: &BodyView, camera| {
        center(&draw(
            renderer,
            [32, 32],
            &View::from_camera(camera),
            &[body],
        ))
    };
    let (outer, inner) = (of(&body, front), of(&body, back));
    assert!(outer.0[0] > 2 * outer.0[2], "{outer} is red");
    assert!(inner.0[0] < 2 * inner.0[2], "{inner} is not");
    body.set_back_face_color(renderer, Color::rgb(0, 200, 0))
        .expect("a color");
    assert_eq!(of(&body, front), outer);
    let green = of(&body, back);
    assert!(
        green.0[1] > green.0[0] && green.0[1] > green.0[2],
        "{green}"
    );
}

fn triangles_without_color(gpu: &Gpu) {
    let surface = triangles(&[at_depth(0.5), at_depth(0.0)]);
    let view = facing(straight(6.0));
    let shown = |first, second| {
        let color_of = |t: TriangleId| if t.index() == 0 { first } else { second };
        image(gpu.plain(), [64, 64], &view, &surface, color_of)
    };
    let clear = Some(RED.with_alpha(0));
    let without = shown(None, Some(BLUE));
    assert!(count_other(&without, WHITE) > 100);
    assert_eq!(shown(clear, Some(BLUE)), without, "no alpha is no triangle");
    assert_eq!(
        shown(Some(BLUE.with_alpha(9)), None),
        shown(Some(BLUE), None),
        "bodies are opaque"
    );
    assert_eq!(count_other(&shown(None, None), WHITE), 0);
}

/// Free triangle slots after an edit are not drawn, and added triangles are.
fn removed_triangles_are_not_drawn(gpu: &Gpu) {
    let renderer = gpu.plain();
    let view = facing(straight(6.0));
    let color = |_: TriangleId| Some(BLUE);
    let mut surface = icosphere(1, 0.9);
    let mut body = BodyView::from_surface(renderer, &surface, color).expect("a body");
    let bodies = |body: &BodyView| draw(renderer, [64, 64], &view, &[body]);
    let whole = count_other(&bodies(&body), WHITE);
    let gone: Vec<TriangleId> = surface.topology().triangles().take(79).collect();
    surface.remove_triangles(&gone);
    body.update_topology(renderer, &surface, color)
        .expect("a change");
    let rest = count_other(&bodies(&body), WHITE);
    assert!(rest < whole / 10, "{rest} of {whole}");
    let a = [[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [0.0, 1.0, 0.0]];
    let corners = a.map(|[x, y, z]| surface.add_vertex([x, y, z, 1.0], [x, y, z]));
    surface.add_triangle(corners, 0).expect("a triangle");
    body.update_topology(renderer, &surface, color)
        .expect("a change");
    body.update_positions(renderer, surface.positions())
        .expect("positions");
    let grown = bodies(&body);
    assert!(count_other(&grown, WHITE) > 2 * rest);
    assert_eq!(grown, image(renderer, [64, 64], &view, &surface, color));
}

/// Four squares on a square sheet: two are darker, and none without texture coordinates.
fn checkers(gpu: &Gpu) {
    let renderer = gpu.plain();
    let view = facing(straight(6.0));
    let mut surface = triangles(&[
        [[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0]],
        [[-1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]],
    ]);
    let draw_with = |surface: &Surface, squares| {
        let mut body = BodyView::from_surface(renderer, surface, |_| Some(BLUE)).expect("a body");
        body.set_checkers(renderer, surface, squares)
            .expect("a pattern");
        draw(renderer, [64, 64], &view, &[&body])
    };
    let plain = draw_with(&surface, 4.0);
    assert_eq!(
        plain,
        image(renderer, [64, 64], &view, &surface, |_| Some(BLUE))
    );
    let corners = surface.topology().corners().iter();
    let uvs = corners.map(|v| {
        let [x, y, ..] = surface.positions()[v.index()];
        [0.25 + 0.25 * x, 0.25 + 0.25 * y]
    });
    surface
        .set_corner_uvs(uvs.collect())
        .expect("three per triangle");
    assert_eq!(plain, draw_with(&surface, 0.0));
    let squares = draw_with(&surface, 4.0);
    let covered = count_other(&plain, WHITE);
    let changed = (0..64 * 64)
        .filter(|i| plain.color(i % 64, i / 64) != squares.color(i % 64, i / 64))
        .count();
    let part = changed as f64 / covered as f64;
    assert!((0.45..0.6).contains(&part), "{part} of the pixels");
    // Opposite squares are alike, and the others are darker.
    let at = |x, y| squares.color(x, y);
    assert_eq!(at(27, 27), at(37, 37));
    assert_eq!(at(27, 37), at(37, 27));
    assert_ne!(at(27, 27), at(37, 27));
}

fn wireframe_darkens_edges(gpu: &Gpu) {
    // Rotated, so that edges cover many different fractions of a pixel.
    let (sin, cos) = 0.2913_f32.sin_cos();
    let turned = |[x, y, z]: [f32; 3]| [cos * x - sin * y, sin * x + cos * y, z];
    let surface = triangles(&[at_depth(0.0).map(turned)]);
    let view = View {
        background: Background::Plain(WHITE),
        ..View::from_camera(straight(5.0))
    };
    let width = 4.0;
    let color = Color::rgb(0, 0, 0);
    let wired = View {
        wireframe: Some(Wireframe { color, width }),
        ..view
    };
    let size = [300, 300];
    let shown = |view: &View| image(gpu.plain(), size, view, &surface, |_| Some(WHITE));
    let (plain, wired) = (shown(&view), shown(&wired));
    // The pixel at a point of the triangle, `above` its lower edge.
    let pixel = |image: &Image, x: f32, above: f32| {
        let point = turned([x, -1.0 + above, 0.0]).map(f64::from);
        let at = view.camera.project(point.into(), size).expect("in front");
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "pixels have whole numbers"
        )]
        let [x, y] = at.map(|x| x as u32);
        image.color(x, y).expect("inside")
    };
    let pixels_a_meter = 150.0 / (5.0 * (view.camera.field_of_view / 2.0).tan());
    #[expect(clippy::cast_possible_truncation, reason = "a few digits will do")]
    let a_pixel = (1.0 / pixels_a_meter) as f32;
    for x in [-0.5, -0.2, 0.1, 0.4] {
        for (above, is_dark) in [(0.8, true), (10.0, false), (70.0, false)] {
            let [before, after] = [&plain, &wired].map(|p| pixel(p, x, above * a_pixel));
            if is_dark {
                assert!(
                    brightness(after) < 0.1 * brightness(before),
                    "{after} at {x}"
                );
            } else {
                assert_eq!(before, after);
            }
        }
    }
    // Half of the line's width is on the triangle's side of each edge.
    let pixels = |image: &Image| -> Vec<f32> {
        let pixels = image.pixels().as_chunks::<4>().0.iter();
        pixels.map(|&p| brightness(Color(p))).collect()
    };
    let (before, after) = (pixels(&plain), pixels(&wired));
    let lost: f32 = before.iter().zip(&after).map(|(a, b)| 1.0 - b / a).sum();
    let around = 2.0 + 2.0 * 5.0_f64.sqrt();
    let expected = f64::from(width) / 2.0 * pixels_a_meter * around;
    let part = f64::from(lost) / expected;
    // The lines overlap at the corners, by 21 pixels in total.
    assert!((0.95..1.01).contains(&part), "{lost} of {expected}");
}

fn wireframe_fades_on_tiny_triangles(gpu: &Gpu) {
    let mean = |image: &Image| {
        let pixels = image.pixels().as_chunks::<4>().0.iter();
        pixels
            .map(|&p| f64::from(brightness(Color(p))))
            .sum::<f64>()
    };
    let view = facing(straight(3.0));
    let view = View {
        light: Light::default(),
        background: Background::Plain(Color::rgb(0, 0, 0)),
        ..view
    };
    let wired = View {
        wireframe: Some(Wireframe::default()),
        ..view
    };
    let sphere = icosphere(6, 0.5);
    let shown = |view: &View| image(gpu.smooth(), [80, 80], view, &sphere, |_| Some(WHITE));
    let (plain, wired) = (mean(&shown(&view)), mean(&shown(&wired)));
    assert!(
        wired > 0.97 * plain,
        "triangles of less than a pixel have no edges: {wired} of {plain}"
    );
}

fn backgrounds(gpu: &Gpu) {
    let nothing = |background| {
        let view = View {
            background,
            ..View::from_camera(Camera::default())
        };
        draw(gpu.smooth(), [37, 21], &view, &[])
    };
    for color in [RED, WHITE, Color::rgb(0, 1, 254), Color::rgb(119, 3, 40)] {
        let plain = nothing(Background::Plain(color));
        assert_eq!((plain.width(), plain.height()), (37, 21));
        assert_eq!(count_other(&plain, color), 0, "{color}");
    }
    let (top, bottom) = (Color::rgb(250, 250, 250), Color::rgb(50, 50, 50));
    let gradient = nothing(Background::Gradient { top, bottom });
    let row = |y| gradient.color(5, y).expect("inside").0[0];
    assert!(
        (1..21).all(|y| row(y) < row(y - 1)),
        "darker from row to row"
    );
    assert!(row(0) > 235 && row(20) < 65, "{} {}", row(0), row(20));
}

fn multisampling_smooths_edges(gpu: &Gpu) {
    let renderer = gpu.smooth();
    let surface = triangles(&[at_depth(0.0)]);
    let between = |renderer: &Renderer| {
        let image = image(renderer, [64, 64], &facing(straight(6.0)), &surface, |_| {
            Some(BLUE)
        });
        let inner = center(&image).0;
        let pixels = image.pixels().as_chunks::<4>().0.iter();
        pixels.filter(|&&p| p != inner && p != WHITE.0).count()
    };
    assert_eq!(between(gpu.plain()), 0);
    assert_eq!(between(renderer) > 20, renderer.samples() > 1);
}

/// Linear and sRGB formats show the same colors, up to one step of rounding.
fn formats_show_the_same(gpu: &Gpu) {
    let surface: Surface = icosphere(2, 0.6);
    let view = View::from_camera(Camera::default());
    let color = |t: TriangleId| {
        Some(if surface.topology().triangle(t)[0] < VertexId(20) {
            RED
        } else {
            BLUE
        })
    };
    let reference = image(gpu.plain(), [64, 64], &view, &surface, color);
    let format = wgpu::TextureFormat::Rgba8Unorm;
    let renderer = Renderer::new(&gpu.device, &gpu.queue, format, 1).expect("a format");
    let body = BodyView::from_surface(gpu.plain(), &surface, color).expect("a body");
    let pixels = super::common::draw_raw(gpu, &renderer, [64, 64], &view, &[&body]);
    for (a, b) in pixels.iter().zip(reference.pixels()) {
        assert!(a.abs_diff(*b) <= 1, "{a} {b}");
    }
}
