//! Why several ranks cannot run together.

use lennard_core::TooManyRanks;

/// Why several ranks cannot run a scene together, or not any longer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum RanksError {
    /// A rank would have nothing to do.
    #[error(transparent)]
    TooMany(#[from] TooManyRanks),
    /// A rank was started with something else.
    #[error(
        "rank {rank} has another {what} than rank 0: all ranks need the same program, input and kind of processor{advice}"
    )]
    Differs {
        /// The rank.
        rank: usize,
        /// What it has.
        what: &'static str,
        /// What to do.
        advice: &'static str,
    },
    /// The bits of a rank differ from the others.
    #[error(
        "after step {step} the state of rank {rank} is no longer the state of rank 0: its machine or its libraries compute other bits\n  the checkpoints before are whole; go on with machines of one kind"
    )]
    Diverged {
        /// The rank.
        rank: usize,
        /// The step.
        step: u64,
    },
}

impl RanksError {
    /// The exit code of the command line.
    pub(crate) fn exit_code(&self) -> u8 {
        match self {
            Self::TooMany(_) | Self::Differs { .. } => 2,
            Self::Diverged { .. } => 1,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_name_the_rank_and_the_step() {
        let differs = RanksError::Differs { rank: 3, what: "instruction set", advice: "" };
        assert!(
            differs
                .to_string()
                .starts_with("rank 3 has another instruction set than rank 0: all ranks need the same program, input and kind of processor")
        );
        assert_eq!(differs.exit_code(), 2);
        let diverged = RanksError::Diverged { rank: 1, step: 700 };
        assert!(
            diverged.to_string().starts_with(
                "after step 700 the state of rank 1 is no longer the state of rank 0: its machine or its libraries compute other bits"
            )
        );
        assert_eq!(diverged.exit_code(), 1);
    }
}
