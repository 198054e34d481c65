//! libFuzzer target: runs a decoded [`PathCase`] with `cargo +nightly fuzz run path`.
#![no_main]

use incise_tests::fuzz::PathCase;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|case: PathCase| case.run());
