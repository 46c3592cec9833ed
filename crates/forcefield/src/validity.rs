//! The validity of a list: the box and the positions of its build, and when it may be used.

pub mod build;

use std::ops::Range;
use std::sync::Arc;

use glam::DVec3;
use lennard_core::{ForceError, HaloSize, PeriodicBox, Team, TooManyRanks};
use lennard_neighbor::{Around, Criterion, GridError, PairList, Positions, Reach};

use self::build::Build;
use crate::interaction::Pairwise;
use crate::share::Share;
use crate::share::foreseen::halo_on;
use crate::simd::{Level, ListInUse, PackedList, by_slot};

/// When a list may be used, and the record of its last build.
pub struct ListValidity {
    /// The force that the list serves, which has the cutoff.
    pairwise: Arc<Pairwise>,
    /// The skin of the plan, σ. A build in a smaller box may have a thinner one.
    skin: f64,
    level: Level,
    /// The last build. It is none before the first, and after a failed one.
    build: Option<Build>,
    /// Positions of the last build by slot, σ; their room is reused.
    pub built: Vec<DVec3>,
    /// Whether all of them are known to this rank, not only the ones around its particles.
    knows_all_built: bool,
    /// The species at each slot of the last build, where there are several.
    species: Vec<u8>,
    /// The pairs of slots that were inserted since the build, in their order.
    pub inserted: Vec<[u32; 2]>,
    /// Number of builds so far.
    pub builds: u64,
    /// The share of this rank, where there are several.
    pub share: Option<Share>,
}

impl ListValidity {
    /// The validity of a list that is not built yet, which serves a force, with a skin, σ.
    pub fn new(pairwise: Arc<Pairwise>, skin: f64, level: Level) -> Self {
        Self {
            pairwise,
            skin,
            level,
            build: None,
            built: Vec::new(),
            knows_all_built: true,
            species: Vec::new(),
            inserted: Vec::new(),
            builds: 0,
            share: None,
        }
    }

    /// Shares a list of `n` particles with the other ranks of a team.
    pub fn share<P: PairList>(
        &mut self,
        list: &mut P,
        team: &Team,
        n: usize,
    ) -> Result<(), TooManyRanks> {
        let mut share = Share::new(team, n)?;
        if let Some(build) = &self.build {
            share.cut(list);
            // No search follows: it needs no other columns than the ones around the slots.
            let (lengths, r_list) = (build.cell.lengths(), build.r_list);
            let found = Around::new(list.cells(), lengths, r_list, &share.own());
            share.agree(list, &found, &self.built);
        }
        self.share = Some(share);
        Ok(())
    }

    /// The box of the last build; none before the first.
    pub fn build_cell(&self) -> Option<&PeriodicBox> {
        self.build.as_ref().map(|build| &build.cell)
    }

    /// Lets this rank know the positions of the last build of all particles. All ranks call it together.
    pub fn know_all_built(&mut self) {
        if let (Some(share), false) = (&self.share, self.knows_all_built) {
            share.team().gather(&mut self.built, share.slots());
            self.knows_all_built = true;
        }
    }

    /// Forgets the last build.
    pub fn forget(&mut self) {
        self.build = None;
    }

    /// Number of bytes held.
    pub fn bytes(&self) -> usize {
        let share = self.share.as_ref().map_or(0, Share::bytes);
        size_of::<DVec3>() * self.built.capacity() + self.species.capacity() + share
    }

    /// Builds a list in a box, which may use the room of its `rows`: rows have no meaning afterwards.
    ///
    /// Where half the shortest side leaves no room for the skin of the plan, the build has a thinner skin.
    pub fn build<P: PackedList>(
        &mut self,
        (list, rows): (&mut P, &mut Vec<P::Row>),
        cell: &PeriodicBox,
        positions: Positions<'_>,
    ) -> Result<(), ForceError> {
        list.swap_room(rows);
        let built = self.build_there(list, cell, positions);
        list.swap_room(rows);
        built
    }

    fn build_there<P: PackedList>(
        &mut self,
        list: &mut P,
        cell: &PeriodicBox,
        positions: Positions<'_>,
    ) -> Result<(), ForceError> {
        // A list that failed to build must not look valid.
        self.build = None;
        let largest = cell.largest_cutoff();
        let r_cut = self.pairwise.r_cut();
        let skin = if r_cut + self.skin > largest { (largest - r_cut).max(0.0) } else { self.skin };
        let reach = Reach { r_cut, r_list: r_cut + skin + P::rounding(cell, r_cut) };
        list.order(cell, reach, positions).map_err(|GridError::BadPosition { particle }| {
            ForceError::NonFinitePosition { particle }
        })?;
        if let Some(share) = &mut self.share {
            share.cut(list);
        }
        let values = positions.values();
        self.built.resize(values.len(), DVec3::ZERO);
        self.knows_all_built = true;
        let mut surroundings = None;
        match (positions, &mut self.share) {
            (Positions::Parted(..), Some(share)) => {
                share.plan_moves(list.source());
                share.migrate(list.source(), values, &mut self.built);
                list.place(cell, &[share.own()], &self.built);
                let found = around(self.level, list, (cell, reach), &share.own());
                let near = found.near();
                share.fetch_near(&near, &mut self.built);
                list.place(cell, &near, &self.built);
                self.knows_all_built = false;
                surroundings = Some(found);
            }
            _ => {
                let all = 0..values.len();
                by_slot(list.source(), all.clone(), values, &mut self.built);
                list.place(cell, &[all], &self.built);
            }
        }
        list.fill(self.level.scanner(), cell, reach);
        debug_assert!(list.is_valid(), "the loops rely on valid lists");
        if let Some(of_particle) = self.pairwise.of_particle() {
            let of_slots = list.particles().iter().map(|p| of_particle[*p as usize]);
            self.species.clear();
            self.species.extend(of_slots);
        }
        self.inserted.clear();
        self.builds += 1;
        if let Some(share) = &mut self.share {
            let found = surroundings
                .unwrap_or_else(|| around(self.level, list, (cell, reach), &share.own()));
            share.agree(list, &found, &self.built);
        }
        self.build = Some(Build { cell: *cell, skin, r_list: reach.r_list });
        Ok(())
    }

    /// What a rank would need of others, if so many ranks shared the list as it is.
    pub fn halo_on<P: PairList>(&self, list: &P, n: usize, ranks: usize) -> Option<HaloSize> {
        let Build { cell, r_list, .. } = self.build.as_ref()?;
        let lengths = cell.lengths();
        let halo = |own: &_| {
            let around = Around::new(list.cells(), lengths, *r_list, own);
            around.halo(list.cells(), |slot| self.built[slot])
        };
        halo_on(list, halo, n, ranks)
    }

    /// Inserts pairs that a list lacks; returns whether the list can take them.
    pub fn insert<P: PairList>(&mut self, list: &mut P, pairs: &[[u32; 2]]) -> bool {
        if P::INSERTS {
            pairs.iter().for_each(|pair| list.insert(*pair));
            self.inserted.extend(pairs);
            if let Some(share) = &mut self.share {
                share.include(list, pairs);
            }
            debug_assert!(list.is_valid(), "the loops rely on valid lists");
        }
        P::INSERTS
    }

    /// Whether the list was built for `n` particles, and may be valid at some positions in a box.
    pub fn may_be_valid<P: PairList>(&self, cell: &PeriodicBox, n: usize) -> bool {
        let criterion = self.build.as_ref().map(|b| self.criterion::<P>(b, cell));
        self.built.len() == n && criterion.is_some_and(|criterion| criterion.far2() >= 0.0)
    }

    /// The criterion in a box.
    fn criterion<P: PairList>(&self, build: &Build, cell: &PeriodicBox) -> Criterion {
        if *cell == build.cell {
            return Criterion::new(build.skin);
        }
        let shortest = (cell.lengths() / build.cell.lengths()).min_element();
        let r_cut = self.pairwise.r_cut();
        let inner = r_cut + P::rounding(cell, r_cut);
        Criterion::in_changed_box(shortest * build.r_list - inner)
    }

    /// A list in use in a box.
    ///
    /// # Panics
    /// Where the list was never built: that is a bug of the caller.
    pub fn in_use<'a, P: PairList>(
        &'a self,
        list: &'a P,
        cell: &'a PeriodicBox,
    ) -> ListInUse<'a, P> {
        let build = self.build.as_ref().expect("a list is built before its use");
        ListInUse {
            list,
            level: self.level,
            cell,
            pairwise: &self.pairwise,
            build,
            built: &self.built,
            species: self.pairwise.of_particle().is_some().then_some(&self.species[..]),
            stretch: cell.lengths() / build.cell.lengths(),
            criterion: self.criterion::<P>(build, cell),
            share: self.share.as_ref(),
        }
    }
}

/// What lies around some slots in a list that is being built.
fn around<P: PackedList>(
    level: Level,
    list: &P,
    (cell, reach): (&PeriodicBox, Reach),
    own: &Range<usize>,
) -> Around {
    let mut around = Around::new(list.cells(), cell.lengths(), reach.r_list, own);
    list.mark_near(level.scanner(), cell, reach, &mut around);
    around
}
