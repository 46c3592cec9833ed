//! The lists behind `lennard list potentials` and `lennard list truncations`.

use serde::Serialize;

/// What a potential declares about itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct PotentialSpec {
    /// Name in scene files.
    pub name: &'static str,
    /// One sentence.
    pub summary: &'static str,
    /// The formula, in plain text.
    pub equation: &'static str,
    /// Author, title, equation.
    pub source: &'static str,
}

/// What a truncation declares about itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct TruncationSpec {
    /// Name in scene files.
    pub name: &'static str,
    /// One sentence.
    pub summary: &'static str,
    /// The formula, in plain text.
    pub equation: &'static str,
    /// Author, title, equation.
    pub source: &'static str,
}

/// Every potential that a scene may name.
#[must_use]
pub fn potentials() -> &'static [PotentialSpec] {
    &[
        PotentialSpec {
            name: "lennard-jones",
            summary: "The 12-6 potential of a simple liquid.",
            equation: "U = 4 (r^-12 - r^-6)",
            source: "J. E. Lennard-Jones, On the determination of molecular fields. II, Proc. R. Soc. A 106 (1924) 463",
        },
        PotentialSpec {
            name: "wca",
            summary: "The repulsive part of Lennard-Jones, ending smoothly at its minimum.",
            equation: "U = 4 (r^-12 - r^-6) + 1 for r <= 2^(1/6), else 0",
            source: "J. D. Weeks, D. Chandler and H. C. Andersen, Role of repulsive forces in determining the equilibrium structure of simple liquids, J. Chem. Phys. 54 (1971) 5237, eq. 4",
        },
        PotentialSpec {
            name: "soft-sphere",
            summary: "An inverse power, purely repulsive.",
            equation: "U = r^-n",
            source: "W. G. Hoover et al., Soft-sphere equation of state, J. Chem. Phys. 52 (1970) 4931, eq. 1",
        },
    ]
}

/// Every truncation that a scene may name.
#[must_use]
pub fn truncations() -> &'static [TruncationSpec] {
    &[
        TruncationSpec {
            name: "cut",
            summary: "The potential as it is up to r_cut; the energy jumps there, and a tail correction may be added to means.",
            equation: "U(r) for r <= r_cut, else 0",
            source: "M. P. Allen and D. J. Tildesley, Computer Simulation of Liquids, section 5.2",
        },
        TruncationSpec {
            name: "shift",
            summary: "Cut and shifted: the same forces, and a continuous energy.",
            equation: "U(r) - U(r_cut)",
            source: "M. P. Allen and D. J. Tildesley, Computer Simulation of Liquids, eq. 5.8",
        },
        TruncationSpec {
            name: "force-shift",
            summary: "Energy and force are continuous.",
            equation: "U(r) - U(r_cut) - U'(r_cut) (r - r_cut)",
            source: "S. D. Stoddard and J. Ford, Numerical experiments on the stochastic behavior of a Lennard-Jones gas system, Phys. Rev. A 8 (1973) 1504",
        },
        TruncationSpec {
            name: "switch",
            summary: "Energy, force and curvature are continuous: for energy conservation and the configurational temperature.",
            equation: "U(r) S(x), S = 1 - x^3 (10 - 15 x + 6 x^2), x = (r^2 - r_s^2)/(r_cut^2 - r_s^2) held to [0, 1]",
            source: "quintic smoothstep in r^2; switches in M. P. Allen and D. J. Tildesley, Computer Simulation of Liquids, section 5.2",
        },
    ]
}
