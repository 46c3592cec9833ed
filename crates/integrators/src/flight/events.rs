//! The event loop of all flights: units fly, hit planes and meet each other in the order of time.

use lennard_core::StepError;

/// Events of one unit in one flight, after which it comes to rest at what it hits.
const MOST_HITS: u32 = 16;
/// Events of a flight for each unit, after which the flight goes on without events.
const MOST_EVENTS: usize = 1000;

/// The arrival of a unit at a plane.
#[derive(Debug, Clone, Copy)]
pub(super) struct Arrival {
    /// The time until then, τ, from the last event of the unit.
    pub after: f64,
    /// The site of the unit that arrives: 0 for a single particle.
    pub site: usize,
    /// The index of the plane in [`lennard_core::ForceTerm::walls`].
    pub plane: usize,
}

/// How units move between events, and what events do to them.
pub(super) trait Mover {
    /// The first arrival of a unit at a plane within a time, from where it is now.
    fn arrival(&mut self, unit: usize, left: f64) -> Result<Option<Arrival>, StepError>;

    /// Moves a unit over a time without events.
    fn advance(&mut self, unit: usize, by: f64) -> Result<(), StepError>;

    /// The hit of a unit at a plane, with the time that is left. A tired unit keeps no speed across the plane.
    fn hit(&mut self, unit: usize, arrival: Arrival, left: f64, is_tired: bool);

    /// The pairs of units that may meet within a time, from where all units are now.
    fn pairs(&mut self, left: f64) -> Vec<[usize; 2]> {
        let _ = left;
        Vec::new()
    }

    /// The time until a pair meets, where each unit is `behind` by a time; infinite for never.
    fn meeting(&self, pair: [usize; 2], behind: [f64; 2]) -> f64 {
        let _ = (pair, behind);
        f64::INFINITY
    }

    /// The impact of a pair that meets.
    fn meet(&mut self, pair: [usize; 2]) {
        let _ = pair;
    }

    /// Whether a unit is faster than the pairs were looked for.
    fn outruns_pairs(&self, unit: usize) -> bool {
        let _ = unit;
        false
    }

    /// Brings all units that touch to rest on each other; returns whether it did, so that events count anew.
    fn come_to_rest(&mut self, pairs: &[[usize; 2]]) -> bool {
        let _ = pairs;
        false
    }
}

/// A unit in flight.
#[derive(Debug, Clone, Default)]
struct Unit {
    /// The time up to which it has flown, τ.
    flown: f64,
    /// Its next arrival at a plane, with the time since the start of the flight.
    arrival: Option<(f64, Arrival)>,
    /// Its events so far.
    events: u32,
}

/// What happens next.
#[derive(Debug, Clone, Copy)]
enum Event {
    /// The units of a pair of the list meet.
    Meeting(usize),
    /// A unit hits a plane.
    Hit(usize, Arrival),
}

struct Events<'m, M> {
    mover: &'m mut M,
    units: Vec<Unit>,
    /// The pairs that may meet.
    pairs: Vec<[usize; 2]>,
    /// When each of them meets, τ since the start of the flight.
    meetings: Vec<f64>,
    h: f64,
}

/// Flies so many units over a time h from event to event.
///
/// # Errors
/// [`StepError`] where a unit cannot fly.
pub(super) fn fly<M: Mover>(mover: &mut M, units: usize, h: f64) -> Result<(), StepError> {
    let units = vec![Unit::default(); units];
    let mut events = Events { mover, units, pairs: Vec::new(), meetings: Vec::new(), h };
    events.look_ahead(0.0)?;
    for _ in 0..MOST_EVENTS * events.units.len() {
        let Some((time, event)) = events.next() else {
            break;
        };
        events.happen(time, event)?;
    }
    events.advance_all(h)
}

impl<M: Mover> Events<'_, M> {
    fn advance(&mut self, unit: usize, time: f64) -> Result<(), StepError> {
        let by = time - self.units[unit].flown;
        self.units[unit].flown = time;
        self.mover.advance(unit, by)
    }

    fn advance_all(&mut self, time: f64) -> Result<(), StepError> {
        (0..self.units.len()).try_for_each(|unit| self.advance(unit, time))
    }

    /// Finds all that may happen from a time on at which all units stand.
    fn look_ahead(&mut self, time: f64) -> Result<(), StepError> {
        self.pairs = self.mover.pairs(self.h - time);
        self.meetings = self.pairs.iter().map(|pair| self.meeting(*pair, time)).collect();
        (0..self.units.len()).try_for_each(|unit| self.look_for_plane(unit))
    }

    fn meeting(&self, pair: [usize; 2], time: f64) -> f64 {
        time + self.mover.meeting(pair, pair.map(|unit| time - self.units[unit].flown))
    }

    fn look_for_plane(&mut self, unit: usize) -> Result<(), StepError> {
        let flown = self.units[unit].flown;
        let arrival = self.mover.arrival(unit, self.h - flown)?;
        self.units[unit].arrival = arrival.map(|arrival| (flown + arrival.after, arrival));
        Ok(())
    }

    /// The earliest event of the flight that is still to come.
    fn next(&self) -> Option<(f64, Event)> {
        let meetings = self.meetings.iter().enumerate();
        let meetings = meetings.map(|(pair, time)| (*time, Event::Meeting(pair)));
        let units = self.units.iter().enumerate();
        let hits = units.filter_map(|(unit, state)| {
            state.arrival.map(|(time, arrival)| (time, Event::Hit(unit, arrival)))
        });
        let in_time = meetings.chain(hits).filter(|(time, _)| *time <= self.h);
        in_time.reduce(|first, other| if other.0 < first.0 { other } else { first })
    }

    fn happen(&mut self, time: f64, event: Event) -> Result<(), StepError> {
        let (both, number) = match event {
            Event::Meeting(pair) => (self.pairs[pair], 2),
            Event::Hit(unit, _) => ([unit; 2], 1),
        };
        let struck = &both[..number];
        for unit in struck {
            self.advance(*unit, time)?;
            self.units[*unit].events += 1;
        }
        let is_tired = struck.iter().any(|unit| self.units[*unit].events > MOST_HITS);
        match event {
            Event::Meeting(_) => self.mover.meet(both),
            Event::Hit(unit, arrival) => self.mover.hit(unit, arrival, self.h - time, is_tired),
        }
        if is_tired || struck.iter().any(|unit| self.mover.outruns_pairs(*unit)) {
            self.advance_all(time)?;
            if is_tired && self.mover.come_to_rest(&self.pairs) {
                self.units.iter_mut().for_each(|unit| unit.events = 0);
            }
            return self.look_ahead(time);
        }
        for k in 0..self.pairs.len() {
            if self.pairs[k].iter().any(|unit| struck.contains(unit)) {
                self.meetings[k] = self.meeting(self.pairs[k], time);
            }
        }
        struck.iter().try_for_each(|unit| self.look_for_plane(*unit))
    }
}
