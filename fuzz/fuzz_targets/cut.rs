//! `cargo +nightly fuzz run cut`: see the README.
#![no_main]

use incise_fuzz::Case;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|case: Case| case.run());
