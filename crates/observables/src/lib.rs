//! Observables and the statistics of their averages
