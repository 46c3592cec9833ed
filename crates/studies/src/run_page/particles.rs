//! The picture of the particles at the end of a run.

use crate::report::{ParticleFigure, Picture, Sphere};

use crate::compare::RunFolder;

/// File stem of the picture.
pub(super) const NAME: &str = "particles";

/// The picture, from the last state that the run has written; none where that cannot be read.
pub(super) fn picture(run: &RunFolder) -> Option<Picture> {
    let last = lennard_io::read_configuration(&run.folder.join("final.xyz")).ok()?;
    let found = &last.species;
    let one = [run.scene.output.element.clone()];
    let names = match found.names.is_empty() {
        true => &one[..],
        false => &found.names[..],
    };
    let species = names.iter().map(|element| sphere(run, element)).collect();
    let figure = ParticleFigure {
        name: NAME.to_owned(),
        title: format!("The particles at step {}", run.record.steps),
        sides: last.cell.lengths(),
        species,
        of_particle: (0..last.positions.len()).map(|i| found.of(i)).collect(),
        places: last.positions,
    };
    let caption =
        "Folded into the box. Spheres have the diameter σ; what is farther away is paler.";
    Some(Picture::new(figure, caption, "final.xyz"))
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
