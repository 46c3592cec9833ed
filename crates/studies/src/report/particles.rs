//! Particles in their box as shaded spheres, seen from outside and above.

mod view;

use crate::report::sheet::{
    AFTER, BELOW, GREY, INK, Rgb, Sheet, TEXT, TITLE, WIDTH, color, fine, hex, text_width,
};
use crate::report::{Dash, ReportError};
pub use view::{ParticleFigure, Sphere};
use view::{Scenery, Seen};

/// Shades from the front to the back: what is far away is paler.
const SHADES: usize = 5;
/// The share of white in the last shade.
const PALEST: f64 = 0.55;
/// The side of a sample in the legend, design units.
const SAMPLE: f64 = 22.0;

impl ParticleFigure {
    /// The figure as one SVG text that scales to the width it is given.
    ///
    /// # Errors
    /// [`ReportError`] where there is no particle.
    pub fn to_svg(&self) -> Result<String, ReportError> {
        if self.places.is_empty() || self.species.is_empty() {
            return Err(ReportError::NothingToDraw { figure: self.name.clone() });
        }
        let scenery = Scenery::of(self);
        let top = 2.0 * TITLE;
        let below = top + scenery.height + 1.4 * TEXT;
        let legend = if self.species.len() == 1 { 0.0 } else { 1.5 * SAMPLE };
        let mut sheet = Sheet::titled(&self.title, below + legend + 0.6 * TEXT);
        self.write_spheres(&mut sheet, &scenery);
        sheet.write(&format!("<g transform=\"translate(0 {})\">", fine(top)));
        write_edges(&mut sheet, &scenery, false);
        for Seen { at, species, depth } in &scenery.seen {
            let shade = ((depth * SHADES as f64) as usize).min(SHADES - 1);
            let (x, y, name) = (fine(at.0), fine(at.1), &self.name);
            sheet.write(&format!("<use href=\"#{name}-{species}-{shade}\" x=\"{x}\" y=\"{y}\"/>"));
        }
        write_edges(&mut sheet, &scenery, true);
        for (axis, at) in scenery.axes() {
            sheet.text(axis, at, (TEXT, INK), ("middle", "0"));
        }
        sheet.write("</g>");
        let words = scenery.sides_in_words();
        sheet.text(&words, (0.5 * WIDTH, below - 0.7 * TEXT), (0.88 * TEXT, INK), BELOW);
        self.write_legend(&mut sheet, below + SAMPLE);
        Ok(sheet.finish())
    }

    /// One sphere for each species and shade, which the particles then use.
    fn write_spheres(&self, sheet: &mut Sheet, scenery: &Scenery) {
        sheet.write("<defs>");
        for (a, sphere) in self.species.iter().enumerate() {
            for shade in 0..SHADES {
                let id = format!("{}-{a}-{shade}", self.name);
                let white = PALEST * shade as f64 / (SHADES - 1) as f64;
                let base = toward(color(a), (255, 255, 255), white);
                let light = toward(base, (255, 255, 255), 0.55);
                let dark = toward(base, (0, 0, 0), 0.45 * (1.0 - white));
                sheet.write(&format!(
                    "<radialGradient id=\"{id}-g\" cx=\"0.36\" cy=\"0.32\" r=\"0.7\"><stop offset=\"0\" stop-color=\"{}\"/>\
                     <stop offset=\"0.5\" stop-color=\"{}\"/><stop offset=\"1\" stop-color=\"{}\"/></radialGradient>\n\
                     <circle id=\"{id}\" r=\"{}\" fill=\"url(#{id}-g)\"/>",
                    hex(light),
                    hex(base),
                    hex(dark),
                    fine(0.5 * scenery.scale * sphere.diameter)
                ));
            }
        }
        sheet.write("</defs>");
    }

    fn write_legend(&self, sheet: &mut Sheet, y: f64) {
        if self.species.len() == 1 {
            return;
        }
        let widths = self.species.iter().map(|s| 2.2 * SAMPLE + text_width(&s.name, TEXT));
        let mut x = 0.5 * (WIDTH - widths.clone().sum::<f64>());
        for ((a, sphere), width) in self.species.iter().enumerate().zip(widths) {
            let [cx, cy, radius] = [x + 0.5 * SAMPLE, y, 0.4 * SAMPLE].map(fine);
            let name = &self.name;
            sheet.write(&format!(
                "<circle cx=\"{cx}\" cy=\"{cy}\" r=\"{radius}\" fill=\"url(#{name}-{a}-0-g)\"/>"
            ));
            sheet.text(&sphere.name, (x + 1.2 * SAMPLE, y), (TEXT, INK), AFTER);
            x += width;
        }
    }
}

/// The edges of the box: those in front of all particles, or those behind.
fn write_edges(sheet: &mut Sheet, scenery: &Scenery, in_front: bool) {
    for (from, to) in scenery.edges(in_front) {
        sheet.line(&[from, to], Dash::Solid, GREY, 1.0);
    }
}

/// A color with a share of another.
fn toward(one: Rgb, other: Rgb, share: f64) -> Rgb {
    let mix = |a: u8, b: u8| (f64::from(a) + share * (f64::from(b) - f64::from(a))).round() as u8;
    (mix(one.0, other.0), mix(one.1, other.1), mix(one.2, other.2))
}

#[cfg(test)]
mod tests;
