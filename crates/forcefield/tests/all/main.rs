//! Tests of forces from outside: formulas, kernels, reference configurations, steps taken in one go.

mod changing_box;
mod combining;
mod common;
mod formulas;
mod kernels;
mod mixtures;
mod nist;
mod ranks;
mod ranks_wire;
mod strides;
mod tables;
mod walls;
