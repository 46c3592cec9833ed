//! Criterion benchmarks and the comparison with other engines.
