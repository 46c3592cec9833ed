//! Particles in their box as shaded spheres, seen from outside and above.

use std::f64::consts::PI;

use lennard_core::DVec3;

use crate::report::sheet::{
    AFTER, BELOW, GREY, INK, Place, Rgb, Sheet, TEXT, TITLE, WIDTH, color, fine, hex, text_width,
};
use crate::report::{Dash, ReportError};

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
    pub(crate) fn to_svg(&self) -> Result<String, ReportError> {
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

/// Direction from which the box is seen: angle in the plane from the first axis, and angle above the plane.
const AZIMUTH: f64 = 27.0 * PI / 180.0;
const ELEVATION: f64 = 19.0 * PI / 180.0;
/// Largest height of the box on the sheet, design units.
const HIGHEST: f64 = 400.0;
/// Room to the left and to the right, design units.
const MARGIN: f64 = 30.0;
/// A side is the longest where it exceeds the others by this factor; it is then drawn from left to right.
const LONGER: f64 = 1.2;
/// The most spheres in a picture.
pub(super) const MOST_SPHERES: usize = 2000;
/// The most particles that are looked at: far more than are seen of a dense fluid with as many spheres as may be drawn.
const MOST_PARTICLES: f64 = 60_000.0;
/// How much smaller the sides get where there are too many spheres.
const SMALLER: f64 = 0.85;

/// A sphere that is seen.
pub(super) struct Seen {
    /// Its middle on the sheet.
    pub at: Place,
    /// The number of its species.
    pub species: usize,
    /// From 0 in front to 1 at the back.
    pub depth: f64,
}

/// What is seen of a box.
pub(super) struct Scenery {
    /// Design units for each σ.
    pub scale: f64,
    /// Height on the sheet, design units.
    pub height: f64,
    /// The spheres that are seen, from the back to the front.
    pub seen: Vec<Seen>,
    /// Sides of what is drawn, in the order of the axes as drawn.
    sides: DVec3,
    /// The axes that are drawn toward the viewer, to the right and upward.
    axes: [usize; 3],
    /// Sides as a share of the sides of the box.
    share: f64,
    /// Upper left corner of the sheet in the plane of view, design units.
    corner: Place,
}

impl Scenery {
    pub(crate) fn of(all: &ParticleFigure) -> Self {
        let whole = (MOST_PARTICLES / all.places.len() as f64).cbrt().min(1.0);
        let mut scenery = Self::of_part(all, whole);
        while scenery.seen.len() > MOST_SPHERES {
            scenery = Self::of_part(all, SMALLER * scenery.share);
        }
        scenery
    }

    /// The corner of the box nearest to the viewer, whose sides are a share of the sides of the box.
    fn of_part(all: &ParticleFigure, share: f64) -> Self {
        let axes = axes(all.sides);
        let turned = |r: DVec3| DVec3::from_array(axes.map(|axis| r[axis]));
        let whole = turned(all.sides);
        let sides = share * whole;
        let largest = all.species.iter().map(|s| s.diameter).fold(0.0, f64::max);
        let corners = corners(sides).map(|r| flat(r).0);
        let [left, right] = ends(corners.map(|c| c.0), 0.5 * largest);
        let [upper, lower] = ends(corners.map(|c| c.1), 0.5 * largest);
        let scale = ((WIDTH - 2.0 * MARGIN) / (right - left)).min(HIGHEST / (lower - upper));
        let mut scenery = Self {
            scale,
            height: scale * (lower - upper) + TEXT,
            seen: Vec::new(),
            sides,
            axes,
            share,
            corner: (scale * left - 0.5 * (WIDTH - scale * (right - left)), scale * upper),
        };
        let in_part = all.places.iter().enumerate().filter_map(|(i, r)| {
            let r = turned(*r);
            let inside = r - whole * (r / whole).floor() - (whole - sides);
            let species = all.of_particle.get(i).copied().unwrap_or(0);
            (inside.cmpge(DVec3::ZERO).all()).then_some((inside, species))
        });
        let spheres = in_part.collect();
        scenery.seen = scenery.unhidden(all, spheres);
        scenery
    }

    /// The spheres that no others hide, from the back to the front.
    fn unhidden(&self, all: &ParticleFigure, spheres: Vec<(DVec3, usize)>) -> Vec<Seen> {
        let farthest = flat(DVec3::ZERO).1;
        let range = flat(self.sides).1 - farthest;
        let mut spheres: Vec<(Seen, f64)> = spheres
            .into_iter()
            .map(|(r, species)| {
                let (_, near) = flat(r);
                let seen =
                    Seen { at: self.place(r), species, depth: 1.0 - (near - farthest) / range };
                let radius = 0.5 * self.scale * all.species[species].diameter;
                (seen, radius)
            })
            .collect();
        spheres.sort_by(|a, b| a.0.depth.total_cmp(&b.0.depth));
        let mut covered = Cover::new(WIDTH, self.height);
        spheres.retain(|(seen, radius)| covered.by(seen.at, *radius));
        spheres.reverse();
        spheres.into_iter().map(|(seen, _)| seen).collect()
    }

    /// Where a place is on the sheet.
    fn place(&self, r: DVec3) -> Place {
        let ((x, y), _) = flat(r);
        (self.scale * x - self.corner.0, self.scale * y - self.corner.1)
    }

    /// The edges that meet at the corner nearest to the viewer, or the nine others.
    pub(crate) fn edges(&self, in_front: bool) -> Vec<(Place, Place)> {
        let mut edges = Vec::new();
        for axis in 0..3 {
            for corner in corners(self.sides) {
                if corner[axis] > 0.0 {
                    continue;
                }
                let mut end = corner;
                end[axis] = self.sides[axis];
                if (end == self.sides) == in_front {
                    edges.push((self.place(corner), self.place(end)));
                }
            }
        }
        edges
    }

    /// The names of the axes beside the edges that are in front below.
    pub(crate) fn axes(&self) -> [(&'static str, Place); 3] {
        let DVec3 { x, y, z } = self.sides;
        let middles = [
            (DVec3::new(0.5 * x, y, 0.0), (10.0, 18.0)),
            (DVec3::new(x, 0.5 * y, 0.0), (-4.0, 20.0)),
            (DVec3::new(x, 0.0, 0.5 * z), (-12.0, 5.0)),
        ];
        std::array::from_fn(|i| {
            let (middle, (dx, dy)) = middles[i];
            let (px, py) = self.place(middle);
            (["x", "y", "z"][self.axes[i]], (px + dx, py + dy))
        })
    }

    /// The sides of what is drawn: "8.55 × 8.55 × 8.55 σ".
    pub(crate) fn sides_in_words(&self) -> String {
        let mut sides = [0.0; 3];
        for (side, axis) in self.sides.to_array().into_iter().zip(self.axes) {
            sides[axis] = side;
        }
        let [x, y, z] = sides;
        let part = if self.share < 1.0 { "a corner of the box: " } else { "" };
        format!("{part}{x:.2} × {y:.2} × {z:.2} σ")
    }
}

/// The axes in the order toward the viewer, to the right, upward: the longest side lies from left to right.
fn axes(sides: DVec3) -> [usize; 3] {
    let longest = |axis: usize| (0..3).all(|b| b == axis || sides[axis] > LONGER * sides[b]);
    match (longest(0), longest(2)) {
        (true, _) => [2, 0, 1],
        (_, true) => [1, 2, 0],
        _ => [0, 1, 2],
    }
}

/// A place seen along the direction of view: to the right, downward, and toward the viewer.
fn flat(r: DVec3) -> (Place, f64) {
    let ((sin_a, cos_a), (sin_e, cos_e)) = (AZIMUTH.sin_cos(), ELEVATION.sin_cos());
    let ahead = cos_a * r.x + sin_a * r.y;
    let right = cos_a * r.y - sin_a * r.x;
    let up = cos_e * r.z - sin_e * ahead;
    ((right, -up), cos_e * ahead + sin_e * r.z)
}

fn corners(sides: DVec3) -> [DVec3; 8] {
    std::array::from_fn(|k| {
        let end = |bit: usize, side: f64| if k >> bit & 1 == 1 { side } else { 0.0 };
        DVec3::new(end(0, sides.x), end(1, sides.y), end(2, sides.z))
    })
}

/// The least and the largest value, with room on both sides.
fn ends(values: [f64; 8], room: f64) -> [f64; 2] {
    let least = values.iter().copied().fold(f64::INFINITY, f64::min);
    let most = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    [least - room, most + room]
}

/// The part of the sheet that spheres in front cover, in squares of one design unit.
struct Cover {
    columns: usize,
    rows: usize,
    covered: Vec<bool>,
}

impl Cover {
    fn new(width: f64, height: f64) -> Self {
        let (columns, rows) = (width.ceil() as usize, height.ceil() as usize);
        Self { columns, rows, covered: vec![false; columns * rows] }
    }

    /// Covers the disc around a place, and tells whether any of it was free.
    fn by(&mut self, at: Place, radius: f64) -> bool {
        let range = |middle: f64, most: usize| {
            let from = (middle - radius).floor().max(0.0) as usize;
            let to = (middle + radius).ceil().max(0.0) as usize;
            from.min(most)..to.min(most)
        };
        let mut is_seen = false;
        for row in range(at.1, self.rows) {
            for column in range(at.0, self.columns) {
                let (dx, dy) = (column as f64 + 0.5 - at.0, row as f64 + 0.5 - at.1);
                if dx * dx + dy * dy <= radius * radius {
                    let square = &mut self.covered[row * self.columns + column];
                    is_seen |= !*square;
                    *square = true;
                }
            }
        }
        is_seen
    }
}

#[cfg(test)]
mod tests;
