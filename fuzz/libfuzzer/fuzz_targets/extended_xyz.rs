//! The body of `extended_xyz` for libFuzzer.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    lennard_fuzz::start(bytes);
});
