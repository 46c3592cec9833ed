//! The reader with the name of the target, for libFuzzer.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    lennard_fuzz::read(env!("CARGO_BIN_NAME"), bytes);
});
