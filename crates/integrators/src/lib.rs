//! Integrators, thermostats and minimisers, one file a method
