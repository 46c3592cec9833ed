//! The page of the study.

use crate::report::{Block, Page, Picture, Section};

use super::study::MechanicsStudy;
use super::{figures, tables};
use crate::claims;

/// The whole page.
pub(super) fn page(study: &MechanicsStudy) -> Page {
    let (found, options) = (&study.found, &study.options);
    let settings = if options.quick { "quick: shorter runs" } else { "full" };
    let mut provenance = vec![
        ("Command".to_owned(), format!("`{}`", options.command)),
        ("Settings".to_owned(), settings.to_owned()),
    ];
    provenance.extend(options.provenance.iter().cloned());
    let pictures = figures::drawn(found);
    let of = |names: &[&str]| -> Vec<Picture> {
        let named = |name: &&str| pictures.iter().find(|p| p.name() == *name).cloned();
        names.iter().filter_map(named).collect()
    };
    let one = |title: &str, text: &str| Section::new(title).text(text);
    Page {
        title: "Constraints, springs and collisions".into(),
        lead: format!(
            "{} ways to hold a bond, relaxation, SPOOK, walls and contacts, run by the code of the fluid. {}.",
            found.ways.len(),
            claims::tally(&study.claims),
        ),
        command: Some(options.command.clone()),
        sections: vec![
            one(
                "A bond held in each way",
                "Two dumbbells meet and part. A way is judged by its error against rigid dumbbells, by its energy, by its cost, and by the largest step that it bears. \
                 Springs are another model: their error ends at a value that falls as 1/k, while their largest step falls as 1/√k.",
            )
            .figures(of(&["ways-error", "ways-energy", "ways-cost", "ways-limit"]))
            .table(tables::ways(found)),
            direction().figures(of(&["rotor", "drift-density"])),
            one(
                "Relaxation: sweeps and tolerance",
                "A sweep corrects one bond after another. On a straight chain of n bonds it lowers the residual by cos²(π/(n + 1)), so that sweeps grow as n². \
                 A tolerance leaves an error of the velocity of tol·r/h: tolerance and step belong together.",
            )
            .figures(of(&["sweeps", "tolerance-energy", "tolerance-sweeps"])),
            one(
                "Pendulums and chains",
                "Solutions by a Runge–Kutta method of order 8 with a tolerance of 2.3·10⁻¹⁴, with g = 9.81 σ/τ² and beads of unit mass.",
            )
            .table(tables::solved(found)),
            spook().figures(of(&["spook-amplification"])),
            one(
                "Collisions with a wall",
                "A penalty force fails at both ends: too weak, and a particle passes; too strong, and each hit gains energy. Hard walls have four rules.",
            )
            .figures(of(&["penalty-energy", "penalty-depth", "bounces"]))
            .table(tables::damped(found)),
            one(
                "Rows and stacks",
                "A hit of touching balls has no answer without a rule. Impacts in turn give the cradle; Newton's rule for all contacts at once does not; springs lie between.",
            )
            .table(tables::cradles(found)),
            one(
                "Pressure on walls",
                "Between hard walls the virial theorem holds in discrete time, term by term.",
            )
            .figures(of(&["wall-pressure"])),
            one("Fluids of rigid dumbbells", "The same scene under each way, and beside two equations of state.")
                .table(tables::drifts(found))
                .figures(of(&["states-energy", "states-pressure"])),
            claims::section(&study.claims),
        ],
        provenance,
    }
}

fn equations(lines: &[&str]) -> Block {
    Block::Equations(lines.iter().map(|line| (*line).to_owned()).collect())
}

fn direction() -> Section {
    Section::new("Which way a correction points")
        .text(
            "The article moves two particles along the bond between them as it is after the drift. On a free rotor with the angle α per step this gives \
             (lengths in units of the bond)",
        )
        .with(equations(&[
            "d_{n+1} ∥ 2d_n − d_{n−1},   |2d_n − d_{n−1}|² = 5 − 4·cos α",
            "sin α′ = sin α/√(5 − 4·cos α),   so that  1/α′² = 1/α² + 2 + O(α²)",
            "α_n = α₀/√(1 + 2α₀²n),   dK/dt = −2Ω²h·K:  dissipation of first order",
            "",
            "along the old bond (SHAKE, RATTLE):  α = arcsin(Ωh) at every step, K exact",
        ]))
        .with(Block::Remark(
            "**Verdict.** Relaxation and direct solve agree where both correct along the old bond. The relaxation of the article corrects along the new one. It is another \
             method, of first order, and does not agree. In a fluid its drift is −h·⟨T_b·r·Ω²⟩ per bond, with the tension T_b: it cools a gas and heats a dense liquid."
                .into(),
        ))
}

fn spook() -> Section {
    Section::new("SPOOK: compliance and damping")
        .text(
            "One damped spring as the constraint g(x) = x, with s = ωh, ω² = 1/(εm) and γ = 1/(1 + 4τ/h). The scheme follows from an average of the constraint over the \
             step pair:",
        )
        .with(equations(&[
            "ε·λ/h + ¼·(g_{k+1} + 2g_k + g_{k−1}) + τ·G·v_{k+1} = 0,   g_{k±1} ≈ g_k ± h·G·v",
            "⇒  G·v_{k+1} + Σ·λ = −(4/h)·γ·g_k + γ·G·v_k,   Σ = (4/h²)·ε·γ",
            "",
            "on (x, h·v):  M = [[1 − q, p], [−q, p]],   p = γ(s² + 4)/(s² + 4γ),   q = 4γs²/(s² + 4γ)",
            "det M = p < 1 for every τ > 0;  ε = 0:  double root 1/3 at γ = 1/9, that is at τ = 2h",
            "",
            "free rotor, angle α per step:  |d| = r/(1 − (1 − cos α)·[(1 + γ)/(4γ) + 2εμ/h²])",
        ]))
        .with(Block::Remark(
            "**Verdict.** For linear constraints SPOOK does not diverge with any damping. On a pendulum ε = 0 without damping diverges, so that a scene refuses it. τ = 2h is \
             the critical choice and the default. Contacts of SPOOK alone bounce by the phase of the step: they need an impact stage before them."
                .into(),
        ))
}
