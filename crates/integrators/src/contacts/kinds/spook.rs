//! Bodies whose contacts are the unilateral constraints of SPOOK.

use crate::spook::Damping;
use crate::spook::Solver;
use lennard_core::options::OptionError;

use super::{ContactKind, ContactSpec, Response, UnilateralLaw};

lennard_core::options! {
    /// Unilateral constraints g ≥ 0 of SPOOK, solved in each step for all bodies that touch. They push and never pull.
    ///
    /// Before the solve an impact stage gives bodies that meet their restitution, at any phase of the step. A body at rest sinks
    /// in by the compliance times the force on it.
    #[derive(Copy)]
    pub struct Options {
        /// Restitution e of an impact: the share of the relative normal speed that two bodies keep. What impacts take counts as heat.
        restitution: f64 = 0.0, Between(0.0, 1.0);
        /// Compliance ε, the inverse of a stiffness; 0 is rigid.
        compliance: f64 = 0.0, Between(0.0, 1e9), in "σ²/ε";
        /// Damping time τ over the time step; 2 is critical damping for rigid contacts.
        damping_steps: f64 = 2.0, Between(0.0, 1e9);
        /// Damping time τ, in place of a number of steps.
        damping_time: Option<f64> = None, else "`damping_steps`·`dt`", Between(0.0, 1e9), in "τ";
        /// Sweeps of projected Gauss–Seidel over each group of bodies that touch; 0 solves to rounding, small groups directly.
        sweeps: u32 = 0, Whole(0, 100_000);
    }
}

impl Options {
    fn damping(&self) -> Damping {
        Damping::new(self.damping_steps, self.damping_time)
    }
}

/// What this kind declares about itself.
pub const SPEC: ContactSpec = ContactSpec {
    name: "spook",
    summary: "Unilateral constraints of SPOOK after an impact stage; with the integrator `spook` alone.",
    equation: "0 <= L, S L - b >= 0, L.(S L - b) = 0; S = G M^-1 G^T + (4/h^2) eps y, b = -(4/h) y g + y G v - G (v + h f/m), y = 1/(1 + 4 tau/h)",
    source: "Lacoursière, \"Ghosts and Machines: Regularized Variational Methods for Interactive Simulations of Multibodies with Dry Frictional Contacts\", PhD thesis, Umeå University (2007), the SPOOK stepper; the rule for rest is derived here (docs/walls.md)",
};

impl ContactKind for Options {
    fn response(&self) -> Response {
        Response::Unilateral(UnilateralLaw {
            restitution: self.restitution,
            compliance: self.compliance,
            damping: self.damping(),
            solver: match self.sweeps {
                0 => Solver::Exact,
                sweeps => Solver::Sweeps(sweeps),
            },
        })
    }

    fn in_words(&self) -> String {
        let damping = match self.damping() {
            Damping::Time(time) => format!("damping time {time} τ"),
            Damping::Steps(steps) => format!("damping over {steps} steps"),
        };
        let solved = match self.sweeps {
            0 => String::new(),
            sweeps => format!(", {sweeps} sweeps"),
        };
        format!(
            "contacts of SPOOK, restitution {}, compliance {} σ²/ε, {damping}{solved}",
            self.restitution, self.compliance
        )
    }

    fn check_together(&self) -> Result<(), OptionError> {
        self.damping().suits(self.compliance)
    }
}
