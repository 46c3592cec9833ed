//! Whether the chosen settings are faster than the usual ones, as far as timings on this machine tell.

use crate::report::significant;
use lennard_engine::stopwatch::{BUSY, Spread};
use serde::Serialize;

use crate::lab::Cost;

/// The chosen settings beside the usual ones, timed in turn.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Speed {
    /// Median time of the chosen settings over the median time of the usual ones; absent where the usual ones do not fit.
    pub over_usual: Option<f64>,
    /// Whether every timing of the chosen settings is shorter than every one of the usual; absent likewise.
    pub is_faster: Option<bool>,
    /// The widest range of repeated timings, over their median.
    pub scatter: f64,
    /// What is to be said of it, in sentences; empty where timings are quiet and the chosen settings are faster.
    pub remarks: Vec<String>,
}

impl Speed {
    /// From the costs of chosen, safest and usual settings. `missed` names what the usual ones do not keep.
    pub(super) fn of(chosen: &Cost, safest: &Cost, usual: Option<(&Cost, &[String])>) -> Self {
        let all = [Some(chosen), Some(safest), usual.map(|u| u.0)];
        let scatter = all.into_iter().flatten().map(|c| c.wall.scatter());
        let mut speed = Self {
            over_usual: None,
            is_faster: None,
            scatter: scatter.fold(0.0, f64::max),
            remarks: Vec::new(),
        };
        if let Some((usual, missed)) = usual {
            speed.beside(&chosen.wall, &usual.wall, missed);
        }
        if speed.scatter > BUSY {
            speed.remarks.push(format!(
                "timings of the same settings differ by up to {:.0} %: this machine was busy, and the choice rests on its timings. \
                 Tune again when it is idle",
                100.0 * speed.scatter
            ));
        }
        speed
    }

    fn beside(&mut self, chosen: &Spread, usual: &Spread, missed: &[String]) {
        let ratio = chosen.median / usual.median;
        let is_faster = chosen.highest < usual.lowest;
        self.over_usual = Some(ratio);
        self.is_faster = Some(is_faster);
        if is_faster {
            return;
        }
        let range = |s: &Spread| format!("{} to {}", micro(s.lowest), micro(s.highest));
        let told = if ratio < 1.0 { "not told to be faster" } else { "not faster" };
        let usual_errs = match missed {
            [] => "the usual ones are predicted to keep the targets of U and P too".to_owned(),
            missed => format!("the usual ones miss the target of {}", missed.join(" and ")),
        };
        self.remarks.push(format!(
            "the chosen settings are {told} than the usual ones on this machine now: {ratio:.2} × their time, {} beside {} µs per atom and τ; {usual_errs}",
            range(chosen),
            range(usual)
        ));
    }
}

fn micro(seconds: f64) -> String {
    significant(1e6 * seconds, 3)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cost(walls: [f64; 3]) -> Cost {
        Cost {
            wall: Spread::of(walls.map(|w| 1e-6 * w)).unwrap(),
            evaluations_per_tau: 100.0,
            pair_forces_per_atom_tau: 1000.0,
        }
    }

    #[test]
    fn settings_that_are_not_faster_are_said_not_to_be() {
        let safest = cost([9.0, 9.0, 9.1]);
        let usual = cost([2.0, 2.1, 2.2]);
        let beside =
            |walls, missed: &[String]| Speed::of(&cost(walls), &safest, Some((&usual, missed)));
        let faster = beside([1.5, 1.6, 1.7], &[]);
        assert_eq!((faster.is_faster, faster.remarks.len()), (Some(true), 0));
        // The ranges overlap.
        let alike = beside([1.9, 2.0, 2.05], &[]);
        assert_eq!(alike.is_faster, Some(false));
        assert!(
            alike.remarks[0].contains("not told to be faster")
                && alike.remarks[0].contains("1.90 to 2.05 beside 2.00 to 2.20 µs per atom and τ"),
            "{alike:?}"
        );
        assert!(alike.remarks[0].contains("predicted to keep the targets"));
        let slower = beside([2.9, 2.94, 3.0], &["`pressure`".to_owned()]);
        assert!(
            slower.remarks[0]
                .contains("not faster than the usual ones on this machine now: 1.40 × their time")
                && slower.remarks[0].contains("miss the target of `pressure`"),
            "{slower:?}"
        );
        assert_eq!(slower.remarks.len(), 1);
    }

    #[test]
    fn a_busy_machine_is_named() {
        let quiet = Speed::of(&cost([1.0, 1.1, 1.15]), &cost([2.0, 2.0, 2.1]), None);
        assert!(quiet.remarks.is_empty() && quiet.is_faster.is_none(), "{quiet:?}");
        // Whichever it is that scatters.
        let busy = Speed::of(&cost([1.0, 1.0, 1.0]), &cost([2.0, 2.0, 3.0]), None);
        assert!((busy.scatter - 0.5).abs() < 1e-12);
        assert!(
            busy.remarks[0].contains("differ by up to 50 %: this machine was busy"),
            "{busy:?}"
        );
    }
}
