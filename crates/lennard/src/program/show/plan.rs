//! What a scene computes, in ten lines or in full.

use std::path::Path;

use lennard_engine::{PATIENCE, Plan, PlanItem, Ranks};
use lennard_observables::{Cell, Table};
use lennard_studies::report::Section;

use super::text::{bytes, duration, wrapped};
use crate::program::args::RATES;

/// Parts with a smaller share than this are printed together.
const SMALL_SHARE: f64 = 0.02;
/// The most parts with a line of their own.
const MOST_LINES: usize = 4;
/// What the name of a stage has before it.
const STAGE: &str = "stage ";

/// A plan; with `verbose` every part, and why the rest is off. `lock` is the file that settings come from.
pub fn plan(plan: &Plan, verbose: bool, lock: Option<&Path>) -> Section {
    let of_particles = lennard_studies::report::particles(plan.atoms, plan.molecules);
    let section = Section::new(format!(
        "{}: {of_particles} at density {:.4}, {} steps",
        plan.scene, plan.density, plan.steps
    ))
    .text(&plan.model);
    let section = match verbose {
        true => section.table(all(plan)),
        false => section.texts(lines(plan)),
    };
    let section = section
        .text(format!(
            "memory: about {} ({:.0} bytes per particle), and {} for the program",
            bytes(plan.bytes),
            plan.bytes as f64 / plan.atoms as f64,
            bytes(plan.program_bytes)
        ))
        .text(format!("time: {}", time(plan)))
        .texts(&plan.remarks);
    let section = match &plan.ranks {
        Some(ranks) => section.table(on_ranks(ranks)).texts(in_words(ranks)),
        None => section,
    };
    section.texts(lock.map(|lock| format!("settings from {}", lock.display())))
}

/// How long the run takes.
fn time(plan: &Plan) -> String {
    let threads = lennard_studies::report::counted(plan.threads, "thread");
    match plan.estimated_seconds.zip(plan.seconds_per_step) {
        Some((run, step)) => format!(
            "about {} on {threads}; a step that nothing looks at took {} here (median of {})",
            duration(run),
            duration(step),
            plan.measured_steps
        ),
        None => format!(
            "too slow to measure: in {} on {threads}, {} after the first",
            duration(PATIENCE.as_secs_f64()),
            lennard_studies::report::counted(plan.measured_steps as usize, "step")
        ),
    }
}

/// Steps on ranks, by the model.
fn on_ranks(ranks: &Ranks) -> Table {
    let whole = |x: f64| Cell::figures(format!("{x:.0}"));
    let micro = |seconds: f64| Cell::figures(format!("{:.1}", 1e6 * seconds));
    Table::rows_of("ranks", &ranks.steps)
        .column("ranks", |s| s.ranks)
        .column("particles", |s| whole(s.atoms))
        .column("halo", |s| whole(s.halo))
        .column("partners", |s| s.partners)
        .column("MB", |s| Cell::figures(format!("{:.1}", s.bytes * 1e-6)))
        .column("step, µs", |s| micro(s.seconds_per_step))
        .column("beside particles, µs", |s| micro(s.seconds_per_step - s.computing))
        .column("speedup", |s| Cell::figures(format!("{:.1}", s.speedup)))
        .column("efficiency", |s| Cell::figures(format!("{:.2}", s.efficiency)))
        .table()
}

/// Where more ranks stop paying, and what the numbers are.
fn in_words(ranks: &Ranks) -> [String; 2] {
    let why = match ranks.no_more_at {
        None => "the particles cannot be cut for twice as many".to_owned(),
        Some(more) => format!("{more} spend more than half of their time beside their particles"),
    };
    let (latency, rate) = (duration(ranks.network.latency), rate(ranks.network.bandwidth));
    let cores = lennard_studies::report::counted(ranks.network.cores, "core");
    [
        format!("ranks pay up to {}: {why}", ranks.pays_up_to),
        format!(
            "predicted from the measured step, the box, {latency}, {rate} and {cores} a rank; not measured"
        ),
    ]
}

/// A rate, bytes per second, as the command line takes it.
fn rate(bytes: f64) -> String {
    let unit = RATES.iter().find(|(_, unit)| bytes >= *unit);
    let (name, unit) = unit.unwrap_or(&("B/s", 1.0));
    format!("{} {name}", bytes / unit)
}

fn percent(share: f64) -> String {
    match 100.0 * share {
        s if s < 0.05 => "< 0.1 %".to_owned(),
        s => format!("{s:.1} %"),
    }
}

/// Every part in a table.
fn all(plan: &Plan) -> Table {
    Table::rows_of("plan", &plan.items)
        .column("part", |i| &i.part)
        .column("", |i| if i.on { "on" } else { "off" })
        .column("share", |i| Cell::figures(i.share.map_or_else(String::new, percent)))
        .column("how, or why not", |i| &i.why)
        .table()
}

/// The stages in one line, the parts that take most of the time with a line each, and the number of the others.
fn lines(plan: &Plan) -> Vec<String> {
    let on = || plan.items.iter().filter(|item| item.on);
    let stages: Vec<String> = on()
        .filter_map(|item| {
            let name = item.part.strip_prefix(STAGE)?;
            let steps = item.why.split(',').next().unwrap_or_default();
            Some(format!("{name} {steps}"))
        })
        .collect();
    let mut lines = vec![format!("stages: {}", stages.join(", "))];
    let mut parts: Vec<(&PlanItem, f64)> =
        on().filter_map(|item| Some((item, item.share?))).collect();
    parts.sort_by(|a, b| b.1.total_cmp(&a.1));
    // A plan stays at ten lines, whatever is said about the run.
    let most = match plan.remarks.iter().map(|remark| wrapped(remark).len()).sum::<usize>() {
        0 => MOST_LINES,
        remarks => MOST_LINES.saturating_sub(1 + remarks).max(1),
    };
    let large = parts.iter().take(most).take_while(|(_, share)| *share >= SMALL_SHARE);
    let told = large.clone().count();
    lines.extend(large.map(|(item, share)| {
        let how = item.why.split([',', ';', ':']).next().unwrap_or_default();
        format!("{:>7}  {}: {how}", percent(*share), item.part)
    }));
    let (others, rest) = (parts.len() - told, parts[told..].iter().map(|(_, share)| share).sum());
    if others > 0 {
        let others = lennard_studies::report::counted(others, "other part");
        lines.push(format!("{:>7}  {others}", percent(rest)));
    }
    let off = plan.items.len() - on().count();
    lines.push(format!("--verbose: every part, and the reason for each of {off} that are off"));
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rates_are_shown_as_they_are_typed() {
        for (bytes, shown) in [(25e9, "25 GB/s"), (1.5e6, "1.5 MB/s"), (0.5, "0.5 B/s")] {
            assert_eq!(rate(bytes), shown);
        }
    }

    #[test]
    fn the_largest_parts_have_a_line_and_the_others_are_counted() {
        let item = |part: &str, why: &str, share| PlanItem {
            part: part.into(),
            on: true,
            why: why.into(),
            share,
        };
        let mut items = vec![
            item("neighbor list", "list radius 2.8 σ: because", Some(0.2)),
            item("pair forces", "every step, `rows` loop", Some(0.7)),
            item("integrator", "velocity-verlet, dt = 0.004 τ", Some(0.09)),
            item("rdf", "every 100 steps", Some(0.006)),
            item("msd", "every 10 steps", Some(0.004)),
            item("stage melt", "1000 steps, bussi at T = 2", None),
            item("stage production", "20000 steps, measured", None),
        ];
        items.push(PlanItem { on: false, ..item("vacf", "not in the scene", None) });
        let plan = Plan {
            threads: 1,
            items,
            seconds_per_step: Some(1.0),
            measured_steps: 3,
            estimated_seconds: Some(1.0),
            ..Plan::default()
        };
        assert_eq!(
            time(&plan),
            "about 1.0 s on 1 thread; a step that nothing looks at took 1.0 s here (median of 3)"
        );
        let slow = Plan { measured_steps: 1, threads: 1, ..Plan::default() };
        assert_eq!(
            time(&slow),
            "too slow to measure: in 10.0 s on 1 thread, 1 step after the first"
        );
        assert_eq!(
            lines(&plan),
            [
                "stages: melt 1000 steps, production 20000 steps",
                " 70.0 %  pair forces: every step",
                " 20.0 %  neighbor list: list radius 2.8 σ",
                "  9.0 %  integrator: velocity-verlet",
                "  1.0 %  2 other parts",
                "--verbose: every part, and the reason for each of 1 that are off",
            ]
        );
        // Remarks take the place of parts, and the largest part keeps its line.
        for (lines_of_remarks, parts) in [(1, 2), (2, 1), (9, 1)] {
            let remarks = vec!["a remark".to_owned(); lines_of_remarks];
            let said = lines(&Plan { remarks, ..plan.clone() });
            assert_eq!(said.len(), 1 + parts + 2, "{said:?}");
            assert_eq!(said[1], " 70.0 %  pair forces: every step");
        }
    }
}
