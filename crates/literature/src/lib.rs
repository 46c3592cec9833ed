//! Equations of state, reference data, and comparison with error bars
