//! The body of `frames` for libFuzzer.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    lennard_fuzz::frames(bytes);
});
