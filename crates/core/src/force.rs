//! Forces: terms that add, and the backend that an integrator asks for their sum.

use glam::DVec3;

use crate::parallel::for_each_piece;
use crate::{
    Boundary, Configuration, Energetics, ForceError, FusedBath, Masses, Own, Part, PeriodicBox,
    Persist, RestoreError, StateReader, StateWriter, Team, TooManyRanks, WallReading, Want,
};

/// What kind of force it is.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct ForceProperties {
    /// F depends on velocities: methods that assume F(x) refuse it.
    pub velocity_dependent: bool,
    /// F = −K·x with a constant matrix K: implicit methods may solve exactly.
    pub linear: bool,
    /// [`Part::Near`] and [`Part::Far`] are available.
    pub splits: bool,
    /// Axes x, y, z along which the force changes the total momentum: walls and fields do, pairs do not.
    pub breaks_momentum: [bool; 3],
    /// Particles hit something in flight, or a dashpot acts there ([`ForceTerm::boundary`]).
    pub bounds_flight: bool,
    /// Contacts are unilateral constraints, which the step of SPOOK alone solves for in its flight.
    pub needs_solved_contacts: bool,
    /// What solves for the contacts holds the bonds of molecules too.
    pub holds_bonds: bool,
}

impl ForceProperties {
    /// Whether the force acts in flights: by hits, dashpots or unilateral contacts.
    #[must_use]
    pub fn acts_in_flight(self) -> bool {
        self.bounds_flight || self.needs_solved_contacts
    }

    /// The properties of a sum of two forces.
    #[must_use]
    pub fn with_term(self, other: Self) -> Self {
        Self {
            velocity_dependent: self.velocity_dependent || other.velocity_dependent,
            linear: self.linear && other.linear,
            splits: self.splits && other.splits,
            breaks_momentum: std::array::from_fn(|axis| {
                self.breaks_momentum[axis] || other.breaks_momentum[axis]
            }),
            bounds_flight: self.bounds_flight || other.bounds_flight,
            needs_solved_contacts: self.needs_solved_contacts || other.needs_solved_contacts,
            holds_bonds: self.holds_bonds || other.holds_bonds,
        }
    }
}

/// What the forces did so far, for the run record.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct ForceStatistics {
    /// Evaluations so far.
    pub evaluations: u64,
    /// Neighbor-list builds so far.
    pub builds: u64,
    /// The skin in use, σ; 0 for a direct sum.
    pub skin: f64,
    /// Seconds spent in pair loops.
    pub force_seconds: f64,
    /// Seconds spent building lists.
    pub neighbor_seconds: f64,
    /// Pairs (counted once each) in the current list.
    pub listed_pairs: u64,
    /// Bytes held by lists and private copies.
    pub bytes: u64,
}

/// Writes [`ForceTerm::evaluate`] for a term that has an `add` of its own: zero, then its forces.
///
/// A default method of the trait cannot say it: the default of `add` calls `evaluate`.
#[macro_export]
macro_rules! evaluate_by_adding {
    () => {
        fn evaluate(
            &mut self,
            at: $crate::Configuration<'_>,
            part: $crate::Part,
            want: $crate::Want,
            forces: &mut [$crate::DVec3],
        ) -> Result<$crate::Energetics, $crate::ForceError> {
            forces.fill($crate::DVec3::ZERO);
            self.add(at, part, want, &mut Vec::new(), forces)
        }
    };
}

/// One kind of force: pairs, bonds, walls, fields. Terms add; none of them moves a particle.
pub trait ForceTerm: Persist + Send {
    /// Writes F = −∂U/∂r at `at` to `forces` (`[N]`, ε/σ) and returns what `want` asks for.
    ///
    /// Forces are the same to the bit whatever `want` asks for.
    ///
    /// # Errors
    /// [`ForceError`] where a position or a force is not finite, or the part does not exist.
    fn evaluate(
        &mut self,
        at: Configuration<'_>,
        part: Part,
        want: Want,
        forces: &mut [DVec3],
    ) -> Result<Energetics, ForceError>;

    /// Adds its forces to those in `forces`; `scratch` is working space, whose content means nothing before and after.
    ///
    /// The default evaluates into the scratch. A term that touches few particles adds to these alone.
    ///
    /// # Errors
    /// As [`ForceTerm::evaluate`].
    fn add(
        &mut self,
        at: Configuration<'_>,
        part: Part,
        want: Want,
        scratch: &mut Vec<DVec3>,
        forces: &mut [DVec3],
    ) -> Result<Energetics, ForceError> {
        scratch.resize(forces.len(), DVec3::ZERO);
        let found = self.evaluate(at, part, want, scratch)?;
        let term = &scratch[..];
        for_each_piece(forces, |first, sums| {
            for (sum, f) in sums.iter_mut().zip(&term[first..]) {
                *sum += *f;
            }
        });
        Ok(found)
    }

    /// Its force on one particle, ε/σ: what the watchdog adds to the sum over pairs that it checks a force by.
    ///
    /// The default is none, as suits the first term of a sum.
    fn force_on(&self, particle: usize, at: Configuration<'_>) -> DVec3 {
        let _ = (particle, at);
        DVec3::ZERO
    }

    /// What kind of force this is.
    fn properties(&self) -> ForceProperties;

    /// What was done so far.
    fn statistics(&self) -> ForceStatistics {
        ForceStatistics::default()
    }

    /// Tells the term which particles this process keeps, where ranks share a run. Its totals are then sums over all ranks.
    /// All ranks meet an error of one, with the number of the particle among all ([`Own::agree`]).
    ///
    /// The default suits a term without totals and errors of its own.
    fn keep(&mut self, own: &Own) {
        let _ = own;
    }

    /// The walls of this term with what they have felt; none as a rule.
    fn walls(&self) -> &[WallReading] {
        &[]
    }

    /// The walls that particles hit in flight; none as a rule.
    fn boundary(&mut self) -> Option<&mut dyn Boundary> {
        None
    }

    /// Applies the Hessian to a direction, `out = ∂²U/∂x² · d`, as implicit methods need it.
    ///
    /// The default takes a central difference of forces, −(F(x + η·d) − F(x − η·d))/(2η), with
    /// η = ε_machine^{1/3}/max|d|, whose error is of the order η²·U⁗.
    ///
    /// # Errors
    /// As [`ForceTerm::evaluate`].
    fn hessian_vector(
        &mut self,
        at: Configuration<'_>,
        direction: &[DVec3],
        out: &mut [DVec3],
    ) -> Result<(), ForceError> {
        let largest = direction.iter().fold(0.0_f64, |m, d| m.max(d.abs().max_element()));
        if largest == 0.0 {
            out.fill(DVec3::ZERO);
            return Ok(());
        }
        let eta = f64::EPSILON.cbrt() / largest;
        let displaced_by = |eta: f64| -> Vec<DVec3> {
            let moved = at.positions.iter().zip(direction);
            moved.map(|(x, d)| *x + eta * *d).collect()
        };
        let mut forces_at = |positions: &[DVec3], forces: &mut [DVec3]| {
            let at = Configuration { positions, ..at };
            self.evaluate(at, Part::All, Want::NOTHING, forces)
        };
        forces_at(&displaced_by(eta), out)?;
        let mut backward = vec![DVec3::ZERO; out.len()];
        forces_at(&displaced_by(-eta), &mut backward)?;
        for (o, b) in out.iter_mut().zip(&backward) {
            *o = (*b - *o) / (2.0 * eta);
        }
        Ok(())
    }
}

/// Steps of kick-drift-kick that follow each other without a look in between.
///
/// They begin where forces are due: after a drift, with half a kick given. Each step takes F at x and adds (h/2m)·F to v
/// twice: the last half kick of one step, and the first of the next. The drift x ← x + h·v follows. The steps thus end
/// where forces are due again. A bath scales the velocities between the two half kicks of the steps after which it acts.
pub struct FusedSteps<'a> {
    /// The box.
    pub cell: &'a PeriodicBox,
    /// Unwrapped positions, `[N]`, σ.
    pub positions: &'a mut [DVec3],
    /// Velocities, `[N]`, σ/τ.
    pub velocities: &'a mut [DVec3],
    /// The room of forces, `[N]`: the backend may write there what it likes.
    pub forces: &'a mut [DVec3],
    /// The masses.
    pub masses: &'a Masses,
    /// The step h, τ.
    pub dt: f64,
    /// How many steps to take.
    pub steps: u64,
    /// The step that is under way when they begin.
    pub first: u64,
    /// The bath, where there is one. With noise a drift is two half drifts.
    pub bath: Option<FusedBath<'a>>,
}

/// When speeds are checked. Ranks check them themselves inside of fused steps, so that steps need not end for it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SpeedLimit {
    /// Steps between two checks.
    pub every: u64,
    /// The largest distance in a step, σ.
    pub largest: f64,
}

/// The machine that evaluates the sum of all force terms, and may take several steps at once.
pub trait Backend: ForceTerm {
    /// Takes steps in one go and returns how many: all of them, fewer, or none. Positions and velocities then have the bits
    /// of that many steps by [`ForceTerm::evaluate`] and [`Moving`](crate::Moving); forces have no meaning. It never fails: the caller
    /// takes the steps that are left one by one, and meets any error there. Where it takes none, the bath may have acted in
    /// vain, and the caller gives it its memory back.
    ///
    /// The default takes none.
    fn advance(&mut self, steps: &mut FusedSteps<'_>) -> u64 {
        let _ = steps;
        0
    }

    /// Shares its work with the other ranks of a team from now on; returns whether it does. Each rank has the particles of some
    /// consecutive numbers, and gets their forces, to the bit of one process alone.
    ///
    /// The default shares nothing: each rank computes everything.
    ///
    /// # Errors
    /// [`TooManyRanks`] where a rank would have nothing to do.
    fn share(
        &mut self,
        team: &Team,
        cell: &PeriodicBox,
        limit: SpeedLimit,
    ) -> Result<bool, TooManyRanks> {
        let _ = (team, cell, limit);
        Ok(false)
    }
}

/// No force at all: free flight.
#[derive(Debug, Clone, Copy, Default)]
pub struct NoForces;

crate::remembers_nothing!(NoForces);

impl ForceTerm for NoForces {
    fn evaluate(
        &mut self,
        _at: Configuration<'_>,
        _part: Part,
        want: Want,
        forces: &mut [DVec3],
    ) -> Result<Energetics, ForceError> {
        forces.fill(DVec3::ZERO);
        Ok(Energetics::of(want, 0.0, glam::DMat3::ZERO, 0.0))
    }

    fn properties(&self) -> ForceProperties {
        ForceProperties { linear: true, splits: true, ..ForceProperties::default() }
    }
}

impl Backend for NoForces {}

// The sum of several force terms.

/// Forces that add, in a fixed order: the first may be a backend of its own, which alone takes several steps at once.
pub struct ForceSum<B> {
    first: B,
    others: Vec<Box<dyn ForceTerm>>,
    scratch: Vec<DVec3>,
}

impl<B: Backend> ForceSum<B> {
    /// One term, at the cost of that term.
    #[must_use]
    pub fn new(first: B) -> Self {
        Self { first, others: Vec::new(), scratch: Vec::new() }
    }

    /// The same sum with one term more.
    #[must_use]
    pub fn with(mut self, term: impl ForceTerm + 'static) -> Self {
        self.push(Box::new(term));
        self
    }

    /// Adds one term more.
    pub fn push(&mut self, term: Box<dyn ForceTerm>) {
        self.others.push(term);
    }

    /// The first term.
    #[must_use]
    pub fn first(&self) -> &B {
        &self.first
    }
}

impl<B: Backend> ForceTerm for ForceSum<B> {
    fn evaluate(
        &mut self,
        at: Configuration<'_>,
        part: Part,
        want: Want,
        forces: &mut [DVec3],
    ) -> Result<Energetics, ForceError> {
        let mut all = self.first.evaluate(at, part, want, forces)?;
        for term in &mut self.others {
            let found = term.add(at, part, want, &mut self.scratch, forces)?;
            all = all.with_term(&found);
        }
        Ok(all)
    }

    /// The force of all terms but the first, which is checked.
    fn force_on(&self, particle: usize, at: Configuration<'_>) -> DVec3 {
        let others = self.others.iter();
        others.map(|term| term.force_on(particle, at)).sum()
    }

    fn keep(&mut self, own: &Own) {
        self.first.keep(own);
        self.others.iter_mut().for_each(|term| term.keep(own));
    }

    fn properties(&self) -> ForceProperties {
        self.others
            .iter()
            .fold(self.first.properties(), |all, term| all.with_term(term.properties()))
    }

    fn statistics(&self) -> ForceStatistics {
        self.first.statistics()
    }

    /// One term holds all walls.
    fn walls(&self) -> &[WallReading] {
        let walls = self.others.iter().map(|term| term.walls());
        walls.max_by_key(|walls| walls.len()).unwrap_or_default()
    }

    fn boundary(&mut self) -> Option<&mut dyn Boundary> {
        self.others.iter_mut().find_map(|term| term.boundary())
    }

    fn hessian_vector(
        &mut self,
        at: Configuration<'_>,
        direction: &[DVec3],
        out: &mut [DVec3],
    ) -> Result<(), ForceError> {
        self.first.hessian_vector(at, direction, out)?;
        for term in &mut self.others {
            self.scratch.resize(out.len(), DVec3::ZERO);
            term.hessian_vector(at, direction, &mut self.scratch)?;
            for (sum, one) in out.iter_mut().zip(&self.scratch) {
                *sum += *one;
            }
        }
        Ok(())
    }
}

impl<B: Backend> Backend for ForceSum<B> {
    fn advance(&mut self, steps: &mut FusedSteps<'_>) -> u64 {
        // The first term knows nothing of the others.
        if self.others.is_empty() { self.first.advance(steps) } else { 0 }
    }

    /// The first term alone is shared: the others act on the particles of this rank.
    fn share(
        &mut self,
        team: &Team,
        cell: &PeriodicBox,
        limit: SpeedLimit,
    ) -> Result<bool, TooManyRanks> {
        self.first.share(team, cell, limit)
    }
}

impl<B: Backend> Persist for ForceSum<B> {
    fn save(&self, to: &mut StateWriter<'_>) {
        let Self { first, others, scratch: _ } = self;
        first.save(to);
        for (i, term) in others.iter().enumerate() {
            term.save(&mut to.section(&format!("term-{}", i + 1)));
        }
    }

    fn restore(&mut self, from: &StateReader<'_>) -> Result<(), RestoreError> {
        self.first.restore(from)?;
        for (i, term) in self.others.iter_mut().enumerate() {
            term.restore(&from.section(&format!("term-{}", i + 1)))?;
        }
        Ok(())
    }
}
