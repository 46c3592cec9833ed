//! Tests of figures and pages from outside.

mod messages;
