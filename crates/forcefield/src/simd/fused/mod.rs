//! Fused steps: forces, kicks and drift of each chunk in one pass over memory.

mod pack_ahead;
mod steps;

pub use pack_ahead::{ChunkDisplacement, NextRows};
pub use steps::{SlotState, fused_step};
