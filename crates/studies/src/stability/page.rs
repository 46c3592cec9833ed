//! The page of the study.

use crate::report::{Block, Page, Section, significant};

use super::displacement::STEP;
use super::study::StabilityStudy;
use super::{convergence_figures, figures, fluid, tables};
use crate::claims;

/// The whole page.
pub(crate) fn page(study: &StabilityStudy) -> Page {
    let command = study.options.command.as_str();
    let differing = study.claims.iter().filter(|c| !c.theory_agrees).count();
    let settings = if study.options.quick { "quick: shorter runs" } else { "full" };
    let mut provenance = vec![
        ("Command".to_owned(), format!("`{command}`")),
        ("Settings".to_owned(), settings.to_owned()),
    ];
    provenance.extend(study.options.provenance.iter().cloned());
    let mut sections =
        vec![amplification(study), cases(study), infinite(study), convergence(study)];
    sections.extend(fluid::sections(&study.fluid));
    sections.push(claims::section(&study.claims));
    Page {
        title: "Where each integrator fails".into(),
        lead: format!(
            "{} methods on an oscillator and on the Lennard-Jones fluid, run by the same code. {}; \
             theory and measurement differ in {differing}.",
            study.oscillator.methods.len(),
            claims::tally(&study.claims),
        ),
        command: Some(command.to_owned()),
        sections,
        provenance,
    }
}

fn amplification(study: &StabilityStudy) -> Section {
    let shared = study.oscillator.groups.iter().filter(|g| g.members.len() > 1);
    let groups = shared.map(|group| {
        let names = group.members.iter().map(|m| format!("`{}`", m.spec.name));
        format!("One map, one line: {}.", names.collect::<Vec<_>>().join(", "))
    });
    Section::new("Amplification and stability limits")
        .text(
            "On ẍ = −ω²x every method is a 2×2 matrix on (x, v), the one-step map. Its spectral radius says \
             by what factor a step makes a motion grow, the angle of its eigenvalues how far a step turns \
             it. Both are functions of ωh alone.",
        )
        .figures(vec![
            figures::amplification(&study.oscillator),
            figures::phase(&study.oscillator),
        ])
        .list(groups.collect())
        .table(tables::limits_on_page(&study.oscillator))
}

fn cases(study: &StabilityStudy) -> Section {
    let mut section = Section::new("Displacement and energy at each stiffness").text(format!(
        "One oscillator, m = 1, from x = 1 σ at rest, with the step h = {STEP} τ throughout; only the \
         stiffness changes. The manual has these numbers in kg, m and s. A cross at the upper edge marks \
         where a method stopped by itself, because its numbers left the range it can represent."
    ));
    for case in &study.oscillator.cases {
        section = section
            .heading(case.title)
            .text(case_in_words(case.name))
            .figures(figures::case(case, &study.oscillator.groups))
            .table(tables::case_on_page(case));
    }
    section
}

fn case_in_words(name: &str) -> &'static str {
    match name {
        "k-100" => {
            "A soft spring. Explicit Euler multiplies its amplitude by √(1 + ω²h²) in every step, implicit \
             Euler divides by it; all others keep within a bound."
        }
        "k-inside" => {
            "Just inside the limit ωh = 2. Symplectic Euler starts with its velocity half a step off, and its \
             amplitude is 1/√(1 − ω²h²/4) = 2/h: about 120 σ from a start at 1 σ. The Verlet family has the \
             same limit and the same angle a step, but its whole-step velocities keep x within 1 σ; the price \
             is in its energy."
        }
        "k-outside" => {
            "Just outside. Symplectic Euler and the Verlet family now have a real eigenvalue beyond −1 and \
             diverge. SPOOK turns by θ = 2·arctan(ωh/2) in a step, which never reaches π: it stays bounded, \
             with amplitude √(1 + ω²h²/4), and its period is too long by ωh/θ."
        }
        _ => {
            "The period equals the step. The analytic solution is back at 1 σ after every step, so that its \
             samples stand still (aliasing); SPOOK swings with amplitude √(1 + π²) ≈ 3.3 σ."
        }
    }
}

fn infinite(study: &StabilityStudy) -> Section {
    let found = &study.oscillator.infinite;
    let rigid = found.rigid.iter().find(|r| r.damping_steps == 0.0);
    let last = rigid.map_or(f64::NAN, |r| r.last_displacement);
    Section::new("Infinite stiffness: what is true")
        .text(
            "The manual says that SPOOK does not diverge at k = ∞, that is at ε = 0. With g(x) = x and \
             γ = 1/(1 + 4τ/h) the scheme reads, for ε = 0 (Σ = 0):",
        )
        .with(Block::Equations(
            [
                "v′ = γ·v − (4γ/h)·x          from  G·v′ = −(4/h)·γ·g + γ·G·v",
                "x′ = x + h·v′ = (1 − 4γ)·x + hγ·v",
                "",
                "on (x, h·v):   M = [ 1 − 4γ   γ ]      trace 1 − 3γ,  determinant γ",
                "                   [  −4γ     γ ]      λ² − (1 − 3γ)·λ + γ = 0",
                "",
                "τ = 0, γ = 1:   λ = −1 twice, M + 1 ≠ 0, (M + 1)² = 0",
                "                Mⁿ = (−1)ⁿ·(1 − n·(M + 1)),  so  xₙ = (−1)ⁿ·(x₀ + n·(2x₀ − h·v₀))",
                "                |xₙ| = 2n + 1 from x₀ = 1, v₀ = 0:  linear growth without bound",
                "",
                "τ > 0, γ < 1:   discriminant (1 − 3γ)² − 4γ = (1 − γ)(1 − 9γ)",
                "                1/9 < γ < 1:  complex pair, |λ| = √γ < 1",
                "                γ ≤ 1/9:      two real roots in (0, 1)",
                "                the motion dies away for every τ > 0",
            ]
            .map(str::to_owned)
            .to_vec(),
        ))
        .text(format!(
            "Measured with τ = 0 over {} steps: |x| = {} σ at the end, within {} of 2n + 1 all along; the \
             spectral radius is 1, so nothing grows exponentially, and yet nothing bounds it. Only a start \
             that already meets 2x₀ = h·v₀ (at rest on the constraint, above all) stays where it is.",
            found.steps,
            significant(last, 7),
            significant(found.deviation_from_linear, 1),
        ))
        .with(Block::Remark(
            "**Verdict.** For every finite k the claim is true: the map is a rotation by 2·arctan(ωh/2), \
             bounded by √(1 + ω²h²/4), which itself grows with √k. At k = ∞ **without damping it is not \
             true**: a start off the constraint grows linearly, as 2n + 1. With any damping τ > 0 it is \
             true, and the error shrinks by √γ or faster a step."
                .into(),
        ))
        .figures(vec![figures::infinite(&study.oscillator)])
        .heading("The limit of symplectic Euler")
        .text(format!(
            "The manual says that symplectic Euler is stable for k ≤ 4m/h². At k = 4m/h² its map on (x, h·v) is \
             [ −3 1; −4 1 ], the one of SPOOK at ε = 0 and τ = 0. Measured over {} steps, |x| stays within {} of \
             2n + 1. It is stable for k < 4m/h² alone.",
            found.steps,
            significant(found.at_limit.deviation_from_linear, 1),
        ))
}

fn convergence(study: &StabilityStudy) -> Section {
    let o = &study.oscillator;
    Section::new("Order of convergence")
        .text(
            "Errors against the step, each with the line that its theory gives; the orders in the legends \
             are measured at the smallest steps above rounding.",
        )
        .figures(convergence_figures::orders(o))
        .heading("The discretisation error of Störmer–Verlet")
        .text(
            "On ẍ = w²x the recurrence is solved by powers of q₊ = exp(wh)·(1 − (wh)³/24 + …), so that xₙ = \
             exp(wt)·(1 − (wh)²/24·wt + …). The error is of second order, and its constant grows with time.",
        )
        .figures(vec![convergence_figures::discretisation(o)])
        .heading("A step that changes")
        .text(
            "The plain rule x₊ = 2x − x₋ + a·h² contains the last step. When h changes it takes the \
             difference for a change of velocity, and smaller steps do not help (order 0). The \
             time-corrected rule scales the difference and is of order 1; with ½(h + h₋)·h in place of h² it \
             is of order 2. Velocity Verlet takes any step.",
        )
        .figures(convergence_figures::variable_step(o))
}
