//! Equations that are made once for each value of a parameter and stay for the rest of the program.

use std::collections::BTreeMap;
use std::sync::Mutex;

/// What was made so far, by the bits of its parameters.
pub(crate) struct Made<const N: usize, T: 'static>(Mutex<BTreeMap<[u64; N], &'static T>>);

impl<const N: usize, T> Made<N, T> {
    /// Nothing made yet.
    pub(crate) const fn new() -> Self {
        Self(Mutex::new(BTreeMap::new()))
    }

    /// The one for these parameters, made where there is none.
    pub(crate) fn for_parameters(
        &self,
        parameters: [f64; N],
        make: impl FnOnce() -> T,
    ) -> &'static T {
        let mut made = self.0.lock().expect("no thread panics while it holds this");
        made.entry(parameters.map(f64::to_bits)).or_insert_with(|| Box::leak(Box::new(make())))
    }
}
