//! Tests of observables and of their statistics from outside.

mod every_observable;
