//! Properties of framing, projection and rays, for random cameras.

use super::*;
use proptest::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI};

prop_compose! {
    fn any_camera()(
        azimuth in -PI..PI,
        elevation in prop_oneof![Just(-FRAC_PI_2), Just(FRAC_PI_2), -FRAC_PI_2..FRAC_PI_2],
        field_of_view in 0.1..2.0,
    ) -> Camera {
        Camera { field_of_view, ..Camera::from_angles(azimuth, elevation) }
    }
}

prop_compose! {
    /// Boxes of any position and size, flat boxes included.
    fn any_box()(
        center in prop::array::uniform3(-10.0_f32..10.0),
        half in prop::array::uniform3(prop_oneof![Just(0.0_f32), 1e-3_f32..5.0]),
    ) -> Aabb {
        Aabb::around([-1.0, 1.0].map(|s| [0, 1, 2].map(|k| center[k] + s * half[k])))
    }
}

fn any_size() -> impl Strategy<Value = [u32; 2]> {
    prop::array::uniform2(1_u32..3000)
}

fn aspect([width, height]: [u32; 2]) -> f64 {
    f64::from(width) / f64::from(height)
}

fn is_inside([x, y]: [f64; 2], [width, height]: [u32; 2]) -> bool {
    (0.0..=f64::from(width)).contains(&x) && (0.0..=f64::from(height)).contains(&y)
}

proptest! {
    #[test]
    fn fit_shows_all_eight_corners_of_a_box(
        camera in any_camera(), bounds in any_box(), size in any_size(),
    ) {
        let camera = camera.fit(&bounds, aspect(size));
        for corner in corners(&bounds) {
            let at = camera.project(corner, size);
            prop_assert!(at.is_some_and(|at| is_inside(at, size)), "{corner} at {at:?}");
        }
        let middle = camera.project(bounds.center(), size).expect("it is in front");
        prop_assert!((middle[0] - f64::from(size[0]) / 2.0).abs() < 1e-6);
        prop_assert!((middle[1] - f64::from(size[1]) / 2.0).abs() < 1e-6);
    }

    #[test]
    fn frame_shows_all_points_and_fills_the_image(
        camera in any_camera(),
        points in prop::collection::vec(prop::array::uniform3(-5.0_f32..5.0), 2..20),
        size in any_size(),
    ) {
        let framed = camera.frame(points.iter().copied(), aspect(size));
        let [width, height] = size.map(f64::from);
        let (mut left, mut top) = (f64::INFINITY, f64::INFINITY);
        let (mut right, mut bottom) = (0.0_f64, 0.0_f64);
        for &p in &points {
            let at = framed.project(incise_mesh::geometry::to_f64(p), size);
            prop_assert!(at.is_some_and(|at| is_inside(at, size)), "{p:?} at {at:?}");
            let [x, y] = at.expect("just seen");
            (left, right) = (left.min(x), right.max(x));
            (top, bottom) = (top.min(y), bottom.max(y));
        }
        let fills = ((right - left) / width).max((bottom - top) / height);
        prop_assert!(fills <= 1.0 / MARGIN + 1e-6, "{fills}");
        // The points fill the frame within the margin, unless the camera would be too close to the
        // first one.
        let back = framed.axes()[2];
        let depths = points.iter().map(|&p| {
            (framed.eye() - incise_mesh::geometry::to_f64(p)).dot(&back)
        });
        let nearest = depths.clone().fold(f64::INFINITY, f64::min);
        let farthest = depths.fold(f64::NEG_INFINITY, f64::max);
        let has_room = nearest > 1.001 * CLEARANCE * (farthest - nearest);
        prop_assert!(!has_room || fills >= 1.0 / MARGIN - 1e-6, "{fills}");
    }

    #[test]
    fn ray_through_a_projected_point_meets_the_point(
        camera in any_camera(), bounds in any_box(), size in any_size(),
        weights in prop::array::uniform3(0.0..1.0),
    ) {
        let camera = camera.fit(&bounds, aspect(size));
        let [low, high] = [bounds.min, bounds.max].map(incise_mesh::geometry::to_f64);
        let point = low + (high - low).component_mul(&Vec3::from(weights));
        let at = camera.project(point, size).expect("it is in the box");
        let ray = camera.ray(at, size);
        let along = (point - ray.origin).dot(&ray.direction);
        let missed = (ray.origin + ray.direction * along - point).norm();
        prop_assert!(along > 0.0, "the ray looks forward");
        let scale = camera.distance + Vec3::from(camera.target).norm();
        prop_assert!(missed < 1e-9 * scale, "{missed}");
    }

    #[test]
    fn axes_are_orthonormal_and_right_handed(camera in any_camera()) {
        let [right, up, back] = camera.axes();
        for (u, v, w) in [(right, up, back), (up, back, right), (back, right, up)] {
            prop_assert!((u.cross(&v) - w).norm() < 1e-12);
        }
        prop_assert!(up.y >= -1e-12, "the y axis points up");
    }

    #[test]
    fn depth_decreases_from_one_at_the_near_plane(camera in any_camera(), far in 1.0..1e9) {
        let [_, _, back] = camera.axes();
        let depth = |distance: f64| {
            let p = camera.eye() - back * distance;
            let clip = camera.view_projection(1.0) * p.push(1.0);
            clip.z / clip.w
        };
        prop_assert!((depth(camera.near()) - 1.0).abs() < 1e-9);
        let (near, behind) = (depth(camera.near() * far), depth(camera.near() * far * 1.01));
        prop_assert!(0.0 < behind && behind < near && near <= 1.0 + 1e-9);
    }
}

#[test]
fn fitting_nothing_changes_nothing() {
    let camera = Camera::default();
    assert_eq!(camera.fit(&Aabb::default(), 1.0), camera);
    assert_eq!(camera.frame([], 1.0), camera);
    assert_eq!(camera.frame([[f32::NAN; 3]], 1.0), camera);
    let point = [2.0, -1.0, 0.5];
    for fitted in [
        camera.fit(&Aabb::around([point]), 1.0),
        camera.frame([point], 1.0),
    ] {
        assert_eq!(fitted.distance, 1.0, "a point is seen from somewhere");
        let off = Vec3::from(fitted.target) - incise_mesh::geometry::to_f64(point);
        assert!(off.norm() < 1e-12);
    }
}

#[test]
fn points_behind_the_camera_are_not_projected() {
    let camera = Camera::from_angles(0.0, 0.0);
    assert_eq!(camera.project(Vec3::new(0.0, 0.0, 4.0), [10, 10]), None);
    assert_eq!(camera.project(Vec3::zeros(), [10, 20]), Some([5.0, 10.0]));
    let right = camera.project(Vec3::new(0.1, 0.1, 0.0), [10, 10]).unwrap();
    assert!(right[0] > 5.0 && right[1] < 5.0, "x to the right and y up");
}
