//! libFuzzer target: runs a decoded [`Case`] with `cargo +nightly fuzz run cut`.
#![no_main]

use incise_tests::fuzz::Case;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|case: Case| case.run());
