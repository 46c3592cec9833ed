//! How fast frames of XTC are written, and how many bytes a particle takes, beside the crate `molly`: the numbers of docs/formats.md.
//!
//!     lennard run verlet-1967/triple-point --set system.n_atoms=108000 --set stage.production.steps=200 --out runs/many
//!     cargo run --release -p lennard-io --example xtc_rate -- runs/many/final.xyz
#![allow(clippy::print_stdout)] // printing is what it is for

use std::error::Error;
use std::path::Path;
use std::time::Instant;

use lennard_core::State;
use lennard_io::{Frame, FrameStyle, TrajectoryFormat, TrajectoryWriter, read_configuration};
use molly::{Magic, XTCWriter};

/// Frames of one pass.
const FRAMES: u64 = 20;
/// Passes; the fastest counts, since other work on the machine lengthens the others.
const PASSES: usize = 7;

/// The shortest time of a pass, s, and what the last pass gives.
fn fastest<T>(
    mut pass: impl FnMut() -> Result<T, Box<dyn Error>>,
) -> Result<(f64, T), Box<dyn Error>> {
    let mut best = (f64::INFINITY, pass()?);
    for _ in 0..PASSES {
        let clock = Instant::now();
        let found = pass()?;
        best = (best.0.min(clock.elapsed().as_secs_f64()), found);
    }
    Ok(best)
}

fn main() -> Result<(), Box<dyn Error>> {
    let path = std::env::args().nth(1).ok_or("xtc_rate FILE: a start configuration")?;
    let start = read_configuration(Path::new(&path))?;
    let n = start.positions.len();
    let mut state = State::new(start.cell, start.positions, vec![Default::default(); n]);
    let folder = tempfile::tempdir()?;
    let file = folder.path().join("trajectory.xtc");
    for precision in [1e4, 1e5] {
        let style = FrameStyle { precision, velocities: false, ..FrameStyle::default() };
        let (ours, bytes) = fastest(|| {
            let mut writer = TrajectoryWriter::create(&file, TrajectoryFormat::Xtc, &style)?;
            for step in 0..FRAMES {
                state.step = step;
                writer.write(&Frame { state: &state, extra: &[] })?;
            }
            Ok(writer.mark().bytes)
        })?;
        let singles: Vec<[f32; 3]> =
            state.positions.iter().map(|r| state.cell.wrap(*r).as_vec3().to_array()).collect();
        let (theirs, their_bytes) = fastest(|| {
            let mut written = Vec::new();
            for step in 0..FRAMES as u32 {
                XTCWriter::new_with_magic(&mut written, Magic::Xtc1995).write_frame_parts(
                    step,
                    0.0,
                    [1.0; 9],
                    singles.iter(),
                    precision as f32,
                )?;
            }
            Ok(written.len() as u64)
        })?;
        let all = (n as u64 * FRAMES) as f64;
        for (name, seconds, bytes) in [
            ("whole frames of Lennard to a file", ours, bytes),
            ("molly, singles to memory", theirs, their_bytes),
        ] {
            println!(
                "{n} particles, precision {precision}: {name}: {:.1} million particles per second, {:.2} bytes each",
                1e-6 * all / seconds,
                bytes as f64 / all
            );
        }
    }
    Ok(())
}
