//! Rendered images on every adapter, offscreen and from the buffers of a solver.

mod common;
mod images;
mod in_place;
mod overlays;
mod surfaces;

use common::{Gpu, Test};
use incise_pbd_gpu::Context;
use incise_test_support::gpu::on_every_adapter;

/// Bodies and overlays in images.
pub(crate) fn content(_: Context) {
    run(&[surfaces::TESTS, overlays::TESTS].concat());
}

/// Images as such: determinism, sizes, bound buffers and errors; buffers of a solver.
pub(crate) fn images(context: Context) {
    run(images::TESTS);
    in_place::drawn_in_place(context);
}

/// Runs tests on every adapter, with renderers that they share.
fn run(tests: &[Test]) {
    on_every_adapter(|context| {
        let gpu = Gpu::new(&context);
        tests.iter().for_each(|test| test(&gpu));
    });
}
