//! The list of trajectory formats: one file and one line each.

pub(crate) mod columns;
pub(crate) mod lines;

use std::ops::Range;
use std::path::Path;

use crate::{Frame, FrameStyle, WriteError};

/// Appends a frame, which has all that the style asks for, to bytes; the path is for messages. Returns the precision of the
/// positions, per σ, where the format rounds them.
type Push = fn(
    &mut Vec<u8>,
    &Path,
    &FrameStyle,
    &Frame<'_>,
    Range<usize>,
) -> Result<Option<f64>, WriteError>;

/// What a format that rounds positions can hold.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// The last step.
    pub last_step: u64,
    /// Coordinates are below this number of multiples of the precision.
    pub multiples: f64,
}

impl Limits {
    /// The precision at which coordinates up to `reach` σ can be held, per σ: `wanted`, or a tenth of it as often as needed.
    #[must_use]
    pub fn precision_for(&self, wanted: f64, reach: f64) -> f64 {
        let mut tenths = 1.0;
        while wanted / tenths * reach >= self.multiples {
            tenths *= 10.0;
        }
        wanted / tenths
    }
}

/// What a format declares about itself.
#[derive(Debug, Clone, Copy)]
pub struct FormatSpec {
    /// The file in an output folder.
    pub file: &'static str,
    /// One sentence.
    pub summary: &'static str,
    /// The programs that read it, with what they get.
    pub readers: &'static str,
    /// Whether it can hold velocities and forces.
    pub holds_vectors: bool,
    /// Whether the file says which length σ is written as; otherwise it is written in σ alone, or in units of its own.
    pub names_scale: bool,
    /// Whether it can hold what ASE looks for.
    pub holds_ase: bool,
    /// Whether a frame is the lines of its particles, one after another, so that each rank can write its own.
    pub by_parts: bool,
    /// What a format that rounds positions to a precision can hold; `None` for a format that does not.
    pub limits: Option<&'static Limits>,
    /// The nm that readers take one unit of length for.
    pub nanometers: f64,
    /// Whether every frame ends with a line.
    pub(crate) ends_with_line: bool,
    /// Appends the lines of some particles, behind a header where they are the first ones. Only formats by parts are asked for fewer
    /// than all.
    pub(crate) push: Push,
}

/// Makes the choice and its descriptions from lines `Variant = "name": module,`.
macro_rules! list_of_formats {
    ($($(#[$doc:meta])* $variant:ident = $name:literal: $module:ident,)*) => {
        $(mod $module;)*

        lennard_core::choices! {
            /// The format of a trajectory.
            pub enum TrajectoryFormat {
                $($(#[$doc])* $variant = $name,)*
            }
        }

        impl TrajectoryFormat {
            /// Every format, in the order of the list.
            pub const ALL: &'static [Self] = &[$(Self::$variant,)*];

            /// What the format declares about itself.
            #[must_use]
            pub fn spec(self) -> &'static FormatSpec {
                match self {
                    $(Self::$variant => &$module::SPEC,)*
                }
            }
        }
    };
}

list_of_formats! {
    /// Extended XYZ, as text.
    #[default]
    Xyz = "xyz": xyz,
    /// Extended XYZ, compressed by gzip.
    XyzGz = "xyz.gz": xyz_gz,
    /// The text of LAMMPS' `dump custom`.
    LammpsDump = "lammps-dump": lammps_dump,
    /// The compressed positions of GROMACS.
    Xtc = "xtc": xtc,
}

pub(crate) use xtc::XtcReader;

/// Particles of one piece of a frame by parts.
pub(crate) const PARTICLES_A_PIECE: usize = 16_384;

/// Makes a frame in a buffer, piece by piece, and passes the pieces on; the path is for messages. Rank 0 takes the pieces of all ranks.
/// Returns the precision of the positions, per σ, where the format rounds them.
///
/// # Errors
/// Where a number cannot be written, here or on another rank. Some pieces may have been taken.
pub(crate) fn pass_frame(
    buffer: &mut Vec<u8>,
    path: &Path,
    format: TrajectoryFormat,
    style: &FrameStyle,
    frame: &Frame<'_>,
    take: impl FnMut(&[u8]),
) -> Result<Option<f64>, WriteError> {
    let (spec, n) = (format.spec(), frame.state.len());
    let checked = style.check_frame(path, frame);
    let of_piece = if spec.by_parts { PARTICLES_A_PIECE } else { n };
    let mut precision = None;
    let push = |to: &mut Vec<u8>, particles| {
        precision = (spec.push)(to, path, style, frame, particles)?;
        Ok(())
    };
    style.pass(path, checked, (n, of_piece), buffer, push, take)?;
    Ok(precision)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formats_have_names_and_files_of_their_own() {
        let mut names: Vec<&str> = TrajectoryFormat::names();
        let mut files: Vec<&str> = TrajectoryFormat::ALL.iter().map(|f| f.spec().file).collect();
        for all in [&mut names, &mut files] {
            let count = all.len();
            all.sort_unstable();
            all.dedup();
            assert_eq!(all.len(), count);
        }
        assert_eq!(TrajectoryFormat::default().spec().file, "trajectory.xyz");
    }
}
