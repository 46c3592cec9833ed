//! What a rank would need of others, as a list of all particles tells it.

use std::ops::Range;

use glam::DVec3;
use lennard_core::HaloSize;
use lennard_core::parallel::equal_parts;
use lennard_neighbor::PairList;

use super::rank_of;

/// Bytes of each particle in the buffers of a rank: its number, and its force by slot.
const BUFFER_BYTES: f64 = (size_of::<u32>() + size_of::<DVec3>()) as f64;
/// Bytes of each particle in the halo of a rank: slot and position, of the halo and of what the rank gives.
const HALO_BYTES: f64 = 2.0 * (size_of::<u32>() + size_of::<DVec3>()) as f64;
/// Ranks whose halos are counted, at most; halos of many ranks are much alike.
const COUNTED: usize = 8;

/// What a rank would need of others, if so many ranks shared a list of `n` particles; `None` where some had no chunk.
///
/// `halo` has the slots that the lists of some slots may name beside these.
pub fn halo_on<P: PairList>(
    list: &P,
    halo: impl Fn(&Range<usize>) -> Vec<u32>,
    n: usize,
    ranks: usize,
) -> Option<HaloSize> {
    let chunks = list.chunk_slots().count();
    if ranks == 0 || ranks > chunks {
        return None;
    }
    let shares = equal_parts(chunks, ranks);
    let slots: Vec<Range<usize>> =
        shares.into_iter().map(|chunks| list.chunk_slots().of(chunks)).collect();
    let counted = ranks.min(COUNTED);
    let mut sum = HaloSize::default();
    for k in 0..counted {
        let rank = k * ranks / counted;
        let halo = halo(&slots[rank]);
        sum.particles += halo.len() as f64;
        let mut partners: Vec<usize> = halo.iter().map(|slot| rank_of(&slots, *slot)).collect();
        partners.dedup();
        sum.partners += partners.len() as f64;
    }
    let particles = sum.particles / counted as f64;
    Some(HaloSize {
        particles,
        partners: sum.partners / counted as f64,
        lists: list.list_bytes() as f64 / ranks as f64,
        buffers: match ranks {
            1 => 0.0,
            _ => BUFFER_BYTES * n as f64 + HALO_BYTES * particles,
        },
    })
}
