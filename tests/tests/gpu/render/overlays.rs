//! Overlay triangles and lines: blending, occlusion, width and clipping.

use super::common::{BLUE, Gpu, RED, Test, WHITE, count_other, facing, triangles};
use incise_mesh::Surface;
use incise_render::{
    BodyView, Camera, Color, DrawList, Image, Line, Offscreen, Overlay, OverlayTriangle, Renderer,
    View,
};

const SIZE: u32 = 64;

pub(crate) const TESTS: &[Test] = &[
    triangles_blend,
    depth_test,
    coplanar_triangles,
    triangles_blend_in_order,
    lines_have_their_width,
    lines_behind_the_camera,
];

fn straight() -> View {
    facing(Camera {
        distance: 6.0,
        ..Camera::from_angles(0.0, 0.0)
    })
}

fn at_depth(z: f32) -> [[f32; 3]; 3] {
    [[-1.0, -1.0, z], [1.0, -1.0, z], [0.0, 1.0, z]]
}

fn drawn(
    renderer: &Renderer,
    view: &View,
    surface: Option<&Surface>,
    overlay_triangles: &[OverlayTriangle],
    lines: &[Line],
) -> Image {
    let body =
        surface.map(|s| BodyView::from_surface(renderer, s, |_| Some(BLUE)).expect("a body"));
    let bodies: Vec<&BodyView> = body.iter().collect();
    let overlay = Overlay::new(renderer, overlay_triangles, lines).expect("an overlay");
    let content = DrawList {
        bodies: &bodies,
        overlays: &[&overlay],
    };
    let offscreen = Offscreen::new(renderer, SIZE, SIZE).expect("a size");
    offscreen
        .render(renderer, view, &content)
        .expect("an image")
}

fn center(image: &Image) -> Color {
    image.color(SIZE / 2, SIZE / 2).expect("it has a middle")
}

/// Returns the blended color in linear light.
fn blended(over: Color, under: Color) -> [f32; 3] {
    let (a, b) = (over.linear(), under.linear());
    [0, 1, 2].map(|k| a[k] * a[3] + b[k] * (1.0 - a[3]))
}

fn assert_is(found: Color, expected: [f32; 3]) {
    let found = found.linear();
    for k in 0..3 {
        // About two steps of an 8-bit channel.
        assert!(
            (found[k] - expected[k]).abs() < 0.02,
            "{found:?} {expected:?}"
        );
    }
}

fn triangles_blend(gpu: &Gpu) {
    let body = triangles(&[at_depth(-0.5)]);
    for alpha in [0, 64, 128, 200, 255] {
        let color = RED.with_alpha(alpha);
        let triangle = OverlayTriangle {
            corners: at_depth(0.5),
            color,
        };
        let renderer = gpu.plain();
        let over_body = center(&drawn(renderer, &straight(), Some(&body), &[triangle], &[]));
        assert_is(over_body, blended(color, BLUE));
        let over_white = center(&drawn(renderer, &straight(), None, &[triangle], &[]));
        assert_is(over_white, blended(color, WHITE));
        assert_eq!(over_white.0[3], 255, "the image is opaque");
    }
}

fn depth_test(gpu: &Gpu) {
    let renderer = gpu.plain();
    let body = triangles(&[at_depth(0.5)]);
    let behind = OverlayTriangle {
        corners: at_depth(-0.5),
        color: RED,
    };
    assert_eq!(
        center(&drawn(renderer, &straight(), Some(&body), &[behind], &[])),
        BLUE
    );
    // Opaque triangles write no depth either: the one behind is drawn over the first.
    let front = OverlayTriangle {
        corners: at_depth(0.5),
        color: RED,
    };
    let other = OverlayTriangle {
        color: BLUE,
        ..behind
    };
    assert_eq!(
        center(&drawn(renderer, &straight(), None, &[front, other], &[])),
        BLUE
    );
}

fn coplanar_triangles(gpu: &Gpu) {
    let renderer = gpu.plain();
    // Corners that are not exactly representable.
    let corners = [
        [-1.03, -0.97, 0.31],
        [1.01, -0.83, -0.17],
        [0.07, 1.13, 0.023],
    ];
    let body = triangles(&[corners]);
    let triangle = OverlayTriangle {
        corners,
        color: RED,
    };
    for azimuth in [0.0, 0.6, std::f64::consts::PI, -2.5] {
        let camera = Camera {
            distance: 6.0,
            ..Camera::from_angles(azimuth, 0.3)
        };
        let with = drawn(renderer, &facing(camera), Some(&body), &[triangle], &[]);
        let alone = drawn(renderer, &facing(camera), None, &[triangle], &[]);
        assert!(count_other(&alone, WHITE) > 100);
        assert_eq!(with, alone, "the whole triangle is visible");
    }
}

fn triangles_blend_in_order(gpu: &Gpu) {
    let (red, blue) = (RED.with_alpha(128), BLUE.with_alpha(128));
    let blend = |first, second| {
        let triangle = |color| OverlayTriangle {
            corners: at_depth(0.0),
            color,
        };
        center(&drawn(
            gpu.plain(),
            &straight(),
            None,
            &[triangle(first), triangle(second)],
            &[],
        ))
    };
    let over = |over: Color, under: [f32; 3]| {
        let (a, alpha) = (over.linear(), over.linear()[3]);
        [0, 1, 2].map(|k| a[k] * alpha + under[k] * (1.0 - alpha))
    };
    assert_is(blend(red, blue), over(blue, blended(red, WHITE)));
    assert_is(blend(blue, red), over(red, blended(blue, WHITE)));
}

fn lines_have_their_width(gpu: &Gpu) {
    let black = Color::rgb(0, 0, 0);
    for width in [2.0, 6.0] {
        // Across the whole image, at several depths.
        for z in [-3.0_f32, 0.0, 3.0] {
            let ends = [[-9.0, 0.0, z], [9.0, 0.0, z]];
            let line = Line {
                ends,
                color: black,
                width,
            };
            let image = drawn(gpu.plain(), &straight(), None, &[], &[line]);
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "whole numbers"
            )]
            let expected = (f64::from(width) * f64::from(SIZE)) as usize;
            assert_eq!(count_other(&image, WHITE), expected);
        }
    }
    let point = Line {
        ends: [[0.0; 3]; 2],
        color: black,
        width: 4.0,
    };
    assert_eq!(
        count_other(&drawn(gpu.plain(), &straight(), None, &[], &[point]), WHITE),
        0
    );
}

fn lines_behind_the_camera(gpu: &Gpu) {
    // From a point ahead, through the right half of the image, to a point behind the camera.
    let ends = [[0.0, 0.0, -5.0], [1.0, 0.0, 40.0]];
    let color = Color::rgb(0, 0, 0);
    for ends in [ends, [ends[1], ends[0]]] {
        let line = Line {
            ends,
            color,
            width: 2.0,
        };
        let image = drawn(gpu.plain(), &straight(), None, &[], &[line]);
        let dark = |x: u32| {
            (0..SIZE)
                .filter(|&y| image.color(x, y) == Some(color))
                .count()
        };
        assert!(
            (0..SIZE / 2 - 1).all(|x| dark(x) == 0),
            "nothing on the other side"
        );
        assert!(
            (SIZE / 2 + 1..SIZE).all(|x| dark(x) == 2),
            "all the way to the edge"
        );
    }
}
