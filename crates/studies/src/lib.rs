//! Stability, speed against accuracy, force-loop benchmark and sweeps
