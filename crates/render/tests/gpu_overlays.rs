//! Sheets and lines over bodies.

#![expect(
    clippy::missing_assert_message,
    reason = "these are tests, which the lint knows by an attribute only"
)]

mod common;

use common::{BLUE, Gpu, RED, WHITE, facing, others, triangles};
use incise_mesh::Surface;
use incise_render::{
    BodyView, Camera, Color, Content, Line, Offscreen, Overlay, Picture, Renderer, Sheet, View,
};
use std::process::ExitCode;

const SIZE: u32 = 64;

fn main() -> ExitCode {
    common::run(&[
        ("a_sheet_mixes_by_its_alpha", a_sheet_mixes),
        ("a_sheet_hides_nothing_and_is_hidden", a_sheet_is_hidden),
        (
            "a_sheet_in_a_surface_is_seen_from_both_sides",
            a_sheet_in_a_surface,
        ),
        ("sheets_are_mixed_in_order", sheets_are_mixed_in_order),
        (
            "a_line_is_as_wide_as_it_is_asked_to_be",
            a_line_has_its_width,
        ),
        (
            "a_line_that_passes_the_eye_ends_there",
            a_line_that_passes_the_eye,
        ),
    ])
}

fn straight() -> View {
    facing(Camera {
        distance: 6.0,
        ..Camera::looking(0.0, 0.0)
    })
}

fn at_depth(z: f32) -> [[f32; 3]; 3] {
    [[-1.0, -1.0, z], [1.0, -1.0, z], [0.0, 1.0, z]]
}

fn drawn(
    renderer: &Renderer,
    view: &View,
    surface: Option<&Surface>,
    sheets: &[Sheet],
    lines: &[Line],
) -> Picture {
    let body = surface.map(|s| BodyView::of(renderer, s, |_| Some(BLUE)).expect("a body"));
    let bodies: Vec<&BodyView> = body.iter().collect();
    let overlay = Overlay::new(renderer, sheets, lines).expect("an overlay");
    let content = Content {
        bodies: &bodies,
        overlays: &[&overlay],
    };
    let offscreen = Offscreen::new(renderer, SIZE, SIZE).expect("a size");
    offscreen
        .picture(renderer, view, &content)
        .expect("a picture")
}

fn center(picture: &Picture) -> Color {
    picture.color(SIZE / 2, SIZE / 2).expect("it has a middle")
}

/// Both colors as light, and back.
fn mixed(over: Color, under: Color) -> [f32; 3] {
    let (a, b) = (over.linear(), under.linear());
    [0, 1, 2].map(|k| a[k] * a[3] + b[k] * (1.0 - a[3]))
}

fn assert_is(found: Color, expected: [f32; 3]) {
    let found = found.linear();
    for k in 0..3 {
        // Two steps of the darkest or brightest color.
        assert!(
            (found[k] - expected[k]).abs() < 0.02,
            "{found:?} {expected:?}"
        );
    }
}

fn a_sheet_mixes(gpu: &Gpu) {
    let body = triangles(&[at_depth(-0.5)]);
    for alpha in [0, 64, 128, 200, 255] {
        let color = RED.with_alpha(alpha);
        let sheet = Sheet {
            corners: at_depth(0.5),
            color,
        };
        let renderer = gpu.plain();
        let over_body = center(&drawn(&renderer, &straight(), Some(&body), &[sheet], &[]));
        assert_is(over_body, mixed(color, BLUE));
        let over_white = center(&drawn(&renderer, &straight(), None, &[sheet], &[]));
        assert_is(over_white, mixed(color, WHITE));
        assert_eq!(over_white.0[3], 255, "the picture itself is opaque");
    }
}

fn a_sheet_is_hidden(gpu: &Gpu) {
    let renderer = gpu.plain();
    let body = triangles(&[at_depth(0.5)]);
    let behind = Sheet {
        corners: at_depth(-0.5),
        color: RED,
    };
    assert_eq!(
        center(&drawn(&renderer, &straight(), Some(&body), &[behind], &[])),
        BLUE
    );
    // Opaque ones too leave no depth: the second is seen through the first's place.
    let front = Sheet {
        corners: at_depth(0.5),
        color: RED,
    };
    let other = Sheet {
        color: BLUE,
        ..behind
    };
    assert_eq!(
        center(&drawn(&renderer, &straight(), None, &[front, other], &[])),
        BLUE
    );
}

fn a_sheet_in_a_surface(gpu: &Gpu) {
    let renderer = gpu.plain();
    // A place and a tilt whose corners have no few digits.
    let corners = [
        [-1.03, -0.97, 0.31],
        [1.01, -0.83, -0.17],
        [0.07, 1.13, 0.023],
    ];
    let body = triangles(&[corners]);
    let sheet = Sheet {
        corners,
        color: RED,
    };
    for azimuth in [0.0, 0.6, std::f64::consts::PI, -2.5] {
        let camera = Camera {
            distance: 6.0,
            ..Camera::looking(azimuth, 0.3)
        };
        let with = drawn(&renderer, &facing(camera), Some(&body), &[sheet], &[]);
        let alone = drawn(&renderer, &facing(camera), None, &[sheet], &[]);
        assert!(others(&alone, WHITE) > 100);
        assert_eq!(with, alone, "all of it is seen");
    }
}

fn sheets_are_mixed_in_order(gpu: &Gpu) {
    let (red, blue) = (RED.with_alpha(128), BLUE.with_alpha(128));
    let sheets = |first, second| {
        let sheet = |color| Sheet {
            corners: at_depth(0.0),
            color,
        };
        center(&drawn(
            &gpu.plain(),
            &straight(),
            None,
            &[sheet(first), sheet(second)],
            &[],
        ))
    };
    let over = |over: Color, under: [f32; 3]| {
        let (a, alpha) = (over.linear(), over.linear()[3]);
        [0, 1, 2].map(|k| a[k] * alpha + under[k] * (1.0 - alpha))
    };
    assert_is(sheets(red, blue), over(blue, mixed(red, WHITE)));
    assert_is(sheets(blue, red), over(red, mixed(blue, WHITE)));
}

fn a_line_has_its_width(gpu: &Gpu) {
    let black = Color::rgb(0, 0, 0);
    for width in [2.0, 6.0] {
        // From the left to the right edge and on, at whatever depth.
        for z in [-3.0_f32, 0.0, 3.0] {
            let ends = [[-9.0, 0.0, z], [9.0, 0.0, z]];
            let line = Line {
                ends,
                color: black,
                width,
            };
            let picture = drawn(&gpu.plain(), &straight(), None, &[], &[line]);
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "whole numbers"
            )]
            let expected = (f64::from(width) * f64::from(SIZE)) as usize;
            assert_eq!(others(&picture, WHITE), expected);
        }
    }
    let point = Line {
        ends: [[0.0; 3]; 2],
        color: black,
        width: 4.0,
    };
    assert_eq!(
        others(
            &drawn(&gpu.plain(), &straight(), None, &[], &[point]),
            WHITE
        ),
        0
    );
}

fn a_line_that_passes_the_eye(gpu: &Gpu) {
    // From far ahead, through the picture's right half, to a place behind the eye.
    let ends = [[0.0, 0.0, -5.0], [1.0, 0.0, 40.0]];
    let color = Color::rgb(0, 0, 0);
    for ends in [ends, [ends[1], ends[0]]] {
        let line = Line {
            ends,
            color,
            width: 2.0,
        };
        let picture = drawn(&gpu.plain(), &straight(), None, &[], &[line]);
        let dark = |x: u32| {
            (0..SIZE)
                .filter(|&y| picture.color(x, y) == Some(color))
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
