//! Potentials, truncations, tail corrections and pair kernels
