//! The picture of the particles at the end of a run.

use crate::report::{ParticleFigure, Picture, Sphere};

use crate::compare::RunFolder;

pub(super) const PARTICLES: &str =
    "The particles at the end, folded into the box. What is farther away is paler.";

/// The picture, from the last state that the run has written; none where that cannot be read.
pub(super) fn particles(run: &RunFolder) -> Option<ParticleFigure> {
    let last = lennard_io::read_configuration(&run.folder.join("final.xyz")).ok()?;
    let found = &last.species;
    let one = [run.scene.output.element.clone()];
    let names = match found.names.is_empty() {
        true => &one[..],
        false => &found.names[..],
    };
    let species = names.iter().map(|element| sphere(run, element)).collect();
    Some(ParticleFigure {
        name: "particles".to_owned(),
        title: format!("The particles at step {}", run.record.steps),
        sides: last.cell.lengths(),
        species,
        of_particle: (0..last.positions.len()).map(|i| found.of(i)).collect(),
        places: last.positions,
    })
}

/// How a species is drawn that files name by an element: with the name and the σ that the scene gives it.
fn sphere(run: &RunFolder, element: &str) -> Sphere {
    let all = run.scene.mixture.as_ref().map_or(&[][..], |m| &m.species);
    let named = all.iter().find(|s| s.element == element);
    Sphere {
        name: named.map_or(element, |s| &s.name).to_owned(),
        diameter: named.map_or(1.0, |s| s.sigma),
    }
}

/// The picture with its caption.
pub(super) fn pictures(figure: Option<&ParticleFigure>) -> Vec<Picture> {
    let caption = "Spheres have the diameter σ.";
    let picture = figure.map(|figure| Picture::new(figure.clone(), caption, "final.xyz"));
    picture.into_iter().collect()
}
