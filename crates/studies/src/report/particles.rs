//! Particles in their box as shaded spheres, seen from outside and above.

mod view;

use std::fmt::Write as _;

use lennard_core::DVec3;

use crate::report::canvas::{FINE, TEXT, TITLE, WIDTH, text_width};
use crate::report::{COLORS, ReportError, escape};
use view::{Scenery, Seen, Spheres};

/// Shades from the front to the back: what is far away is paler.
const SHADES: usize = 5;
/// The share of white in the last shade.
const PALEST: f64 = 0.55;
/// The side of a sample in the legend, design units.
const SAMPLE: f64 = 22.0;

/// A species in a picture.
#[derive(Debug, Clone, PartialEq)]
pub struct Sphere {
    /// Its name in the legend.
    pub name: String,
    /// Its diameter, σ.
    pub diameter: f64,
}

/// Particles in a periodic box.
///
/// Spheres that others hide are left out, which changes nothing that is seen. At most 2,000 spheres are drawn: of a larger
/// system the corner of the box that is nearest.
#[derive(Debug, Clone, PartialEq)]
pub struct ParticleFigure {
    /// File stem.
    pub name: String,
    /// Heading inside the figure.
    pub title: String,
    /// Sides of the box, σ.
    pub sides: DVec3,
    /// The species.
    pub species: Vec<Sphere>,
    /// Places of the particles, σ; they are folded into the box.
    pub places: Vec<DVec3>,
    /// The number of the species of each particle; empty where all are of the first.
    pub of_particle: Vec<usize>,
}

impl ParticleFigure {
    /// The figure as one SVG text that scales to the width it is given.
    ///
    /// # Errors
    /// [`ReportError`] where there is no particle.
    pub fn to_svg(&self) -> Result<String, ReportError> {
        if self.places.is_empty() || self.species.is_empty() {
            return Err(ReportError::NothingToDraw { figure: self.name.clone() });
        }
        let scenery = self.scenery();
        let top = 2.0 * TITLE;
        let below = top + scenery.height + 1.4 * TEXT;
        let legend = match self.species.len() {
            1 => 0.0,
            _ => 1.5 * SAMPLE,
        };
        let height = below + legend + 0.6 * TEXT;
        let mut svg = format!(
            "<svg role=\"img\" width=\"100%\" viewBox=\"0 0 {} {}\" xmlns=\"http://www.w3.org/2000/svg\">\n<title>{}</title>\n\
             <rect width=\"100%\" height=\"100%\" fill=\"#FFFFFF\"/>\n",
            fine(WIDTH),
            fine(height),
            escape(&self.title)
        );
        self.write_spheres(&mut svg, &scenery);
        let width = 1.06 * text_width(&self.title, TITLE);
        let size = TITLE * (0.97 * WIDTH / width).min(1.0);
        write_text(
            &mut svg,
            (0.5 * WIDTH, 1.3 * TITLE),
            size,
            "middle\" font-weight=\"bold",
            &self.title,
        );
        let _ = writeln!(svg, "<g transform=\"translate(0 {})\">", fine(top));
        write_edges(&mut svg, &scenery, false);
        for Seen { at, species, depth } in &scenery.seen {
            let shade = ((depth * SHADES as f64) as usize).min(SHADES - 1);
            let _ = writeln!(
                svg,
                "<use href=\"#{}-{species}-{shade}\" x=\"{}\" y=\"{}\"/>",
                self.name,
                fine(at.0),
                fine(at.1)
            );
        }
        write_edges(&mut svg, &scenery, true);
        for (axis, at) in scenery.axes() {
            write_text(&mut svg, at, TEXT, "middle", axis);
        }
        svg.push_str("</g>\n");
        let words = scenery.sides_in_words();
        write_text(&mut svg, (0.5 * WIDTH, below), 0.88 * TEXT, "middle", &words);
        self.write_legend(&mut svg, below + 1.3 * SAMPLE);
        svg.push_str("</svg>\n");
        Ok(svg)
    }

    fn scenery(&self) -> Scenery {
        let diameters: Vec<f64> = self.species.iter().map(|s| s.diameter).collect();
        Scenery::of(Spheres {
            sides: self.sides,
            places: &self.places,
            of_particle: &self.of_particle,
            diameters: &diameters,
        })
    }

    /// One sphere for each species and shade, which the particles then use.
    fn write_spheres(&self, svg: &mut String, scenery: &Scenery) {
        svg.push_str("<defs>\n");
        for (a, sphere) in self.species.iter().enumerate() {
            for shade in 0..SHADES {
                let id = format!("{}-{a}-{shade}", self.name);
                let white = PALEST * shade as f64 / (SHADES - 1) as f64;
                let base = toward(COLORS[a % COLORS.len()], (255, 255, 255), white);
                let [light, dark] = [
                    toward(base, (255, 255, 255), 0.55),
                    toward(base, (0, 0, 0), 0.45 * (1.0 - white)),
                ];
                let _ = writeln!(
                    svg,
                    "<radialGradient id=\"{id}-g\" cx=\"0.36\" cy=\"0.32\" r=\"0.7\"><stop offset=\"0\" stop-color=\"{}\"/>\
                     <stop offset=\"0.5\" stop-color=\"{}\"/><stop offset=\"1\" stop-color=\"{}\"/></radialGradient>\n\
                     <circle id=\"{id}\" r=\"{}\" fill=\"url(#{id}-g)\"/>",
                    hex(light),
                    hex(base),
                    hex(dark),
                    fine(0.5 * scenery.scale * sphere.diameter)
                );
            }
        }
        svg.push_str("</defs>\n");
    }

    fn write_legend(&self, svg: &mut String, y: f64) {
        if self.species.len() == 1 {
            return;
        }
        let widths = self.species.iter().map(|s| 2.2 * SAMPLE + text_width(&s.name, TEXT));
        let mut x = 0.5 * (WIDTH - widths.clone().sum::<f64>());
        for ((a, sphere), width) in self.species.iter().enumerate().zip(widths) {
            let _ = writeln!(
                svg,
                "<circle cx=\"{}\" cy=\"{}\" r=\"{}\" fill=\"url(#{}-{a}-0-g)\"/>",
                fine(x + 0.5 * SAMPLE),
                fine(y - 0.33 * TEXT),
                fine(0.4 * SAMPLE),
                self.name
            );
            write_text(svg, (x + 1.2 * SAMPLE, y), TEXT, "start", &sphere.name);
            x += width;
        }
    }
}

/// The edges of the box: those in front of all particles, or those behind.
fn write_edges(svg: &mut String, scenery: &Scenery, in_front: bool) {
    for (from, to) in scenery.edges(in_front) {
        let _ = writeln!(
            svg,
            "<path d=\"M{} {}L{} {}\" stroke=\"#787878\" stroke-width=\"{FINE}\"/>",
            fine(from.0),
            fine(from.1),
            fine(to.0),
            fine(to.1)
        );
    }
}

fn write_text(svg: &mut String, (x, y): (f64, f64), size: f64, anchor: &str, text: &str) {
    let _ = writeln!(
        svg,
        "<text x=\"{}\" y=\"{}\" font-family=\"sans-serif\" font-size=\"{}\" fill=\"#282828\" text-anchor=\"{anchor}\">{}</text>",
        fine(x),
        fine(y),
        fine(size),
        escape(text)
    );
}

/// A length in drawing units.
fn fine(length: f64) -> i64 {
    (length * f64::from(FINE)).round() as i64
}

type Rgb = (u8, u8, u8);

/// A color with a share of another.
fn toward(one: Rgb, other: Rgb, share: f64) -> Rgb {
    let mix = |a: u8, b: u8| (f64::from(a) + share * (f64::from(b) - f64::from(a))).round() as u8;
    (mix(one.0, other.0), mix(one.1, other.1), mix(one.2, other.2))
}

fn hex((r, g, b): Rgb) -> String {
    format!("#{r:02X}{g:02X}{b:02X}")
}

#[cfg(test)]
mod tests;
