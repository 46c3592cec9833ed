//! The validity of a list: the box and the positions of its build, and when it may be used.

pub mod build;

use std::borrow::Cow;
use std::sync::Arc;

use glam::DVec3;
use lennard_core::{ForceError, PeriodicBox};
use lennard_neighbor::{Criterion, GridError, PairList, Positions, Reach};

use self::build::Build;
use crate::interaction::Pairwise;
use crate::part::{Part, Particles};
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
    /// The species at each slot of the last build, where there are several.
    species: Vec<u8>,
    /// The pairs of particles that were inserted since the build, in their order. On a rank, its part has them.
    inserted: Vec<[u32; 2]>,
    /// Number of builds so far.
    pub builds: u64,
    /// The part of this rank, where there are several.
    pub part: Option<Part>,
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
            species: Vec::new(),
            inserted: Vec::new(),
            builds: 0,
            part: None,
        }
    }

    /// The box of the last build; none before the first.
    pub fn build_cell(&self) -> Option<&PeriodicBox> {
        self.build.as_ref().map(|build| &build.cell)
    }

    /// Forgets the last build.
    pub fn forget(&mut self) {
        self.build = None;
    }

    /// Number of bytes held.
    pub fn bytes(&self) -> usize {
        let part = self.part.as_ref().map_or(0, Part::bytes);
        size_of::<DVec3>() * self.built.capacity() + self.species.capacity() + part
    }

    /// Builds a list in a box, which may use the room of its `rows`: rows have no meaning afterwards.
    ///
    /// Where half the shortest side leaves no room for the skin of the plan, the build has a thinner skin.
    pub fn build<P: PackedList>(
        &mut self,
        (list, rows): (&mut P, &mut Vec<P::Row>),
        cell: &PeriodicBox,
        given: Given<'_>,
    ) -> Result<(), ForceError> {
        list.swap_room(rows);
        let built = self.build_there(list, cell, given);
        list.swap_room(rows);
        built
    }

    /// As [`ListValidity::build`], from positions by number, σ: on a rank, of the particles that it keeps.
    pub fn build_by_number<P: PackedList>(
        &mut self,
        into: (&mut P, &mut Vec<P::Row>),
        cell: &PeriodicBox,
        positions: &[DVec3],
    ) -> Result<(), ForceError> {
        let Some(part) = &self.part else {
            return self.build(into, cell, Given::All(Positions::ById(positions)));
        };
        let mut particles = Particles {
            numbers: part.numbers().map(|number| number as u32).collect(),
            positions: positions.to_vec(),
            ..Particles::default()
        };
        self.build(into, cell, Given::OfRank(&mut particles))
    }

    fn build_there<P: PackedList>(
        &mut self,
        list: &mut P,
        cell: &PeriodicBox,
        given: Given<'_>,
    ) -> Result<(), ForceError> {
        // A list that failed to build must not look valid.
        self.build = None;
        let reach = self.reach::<P>(cell);
        match (&mut self.part, given) {
            (None, Given::All(positions)) => {
                list.order(cell, reach, positions).map_err(
                    |GridError::BadPosition { particle }| ForceError::NonFinitePosition {
                        particle,
                    },
                )?;
                let values = positions.values();
                self.built.resize(values.len(), DVec3::ZERO);
                by_slot(list.source(), 0..values.len(), values, &mut self.built);
                list.place(cell, &self.built);
            }
            (Some(part), Given::OfRank(particles)) => {
                // Its room is given back first.
                self.built = Vec::new();
                part.settle(list, cell, reach, particles)?;
                self.built = std::mem::take(&mut particles.positions);
            }
            _ => unreachable!("a rank gives its particles, and one process gives all"),
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
        let skin = self.skin_in(cell);
        self.build = Some(Build { cell: *cell, skin, r_list: reach.r_list });
        Ok(())
    }

    /// The skin of a build in a box, σ: thinner than the plan has it where half the shortest side leaves no room.
    fn skin_in(&self, cell: &PeriodicBox) -> f64 {
        let (r_cut, largest) = (self.pairwise.r_cut(), cell.largest_cutoff());
        if r_cut + self.skin > largest { (largest - r_cut).max(0.0) } else { self.skin }
    }

    /// The radii of a build in a box.
    pub fn reach<P: PairList>(&self, cell: &PeriodicBox) -> Reach {
        let r_cut = self.pairwise.r_cut();
        Reach { r_cut, r_list: r_cut + self.skin_in(cell) + P::rounding(cell, r_cut) }
    }

    /// Inserts pairs of slots that a list lacks, or that a checkpoint has saved; returns whether the list can take them.
    pub fn insert<P: PairList>(
        &mut self,
        list: &mut P,
        pairs: &[[u32; 2]],
        are_saved: bool,
    ) -> bool {
        if P::INSERTS {
            match &mut self.part {
                Some(part) => part.include(list, pairs, are_saved),
                None => {
                    let particles = pairs.iter().map(|p| p.map(|k| list.particles()[k as usize]));
                    self.inserted.extend(particles);
                }
            }
            pairs.iter().for_each(|pair| list.insert(*pair));
            debug_assert!(list.is_valid(), "the loops rely on valid lists");
        }
        P::INSERTS
    }

    /// The pairs of particles that were inserted since the build, in their order. All ranks ask together.
    pub fn inserted(&self) -> Cow<'_, [[u32; 2]]> {
        match &self.part {
            Some(part) => part.inserted().into(),
            None => self.inserted[..].into(),
        }
    }

    /// Whether the list was built, of one process for `n` particles, and may be valid at some positions in a box.
    pub fn may_be_valid<P: PairList>(&self, cell: &PeriodicBox, n: usize) -> bool {
        let criterion = self.build.as_ref().map(|b| self.criterion::<P>(b, cell));
        (self.part.is_some() || self.built.len() == n)
            && criterion.is_some_and(|criterion| criterion.far2() >= 0.0)
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
            part: self.part.as_ref(),
        }
    }
}

/// The particles that a build is given.
pub enum Given<'a> {
    /// All, by one process.
    All(Positions<'a>),
    /// The particles of a rank. Afterwards their positions are the positions of the build.
    OfRank(&'a mut Particles),
}
