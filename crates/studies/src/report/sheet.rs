//! The sheet that figures are drawn on: elements of SVG at places in design units.

use std::fmt::Write as _;

use crate::report::escape::{escape, is_near};
use crate::report::{COLORS, Dash, Symbol};

/// Radius of marks, design units.
pub(crate) const MARK: f64 = 4.2;
/// Width of lines, design units.
pub(crate) const LINE: f64 = 2.0;
/// Drawing units per design unit: files hold whole numbers, and this is their precision.
const FINE: f64 = 8.0;
/// Width of every figure in design units: at the 360 pixels of a phone, text of 17 units is 11 pixels high.
pub(crate) const WIDTH: f64 = 560.0;
/// Height of tick labels, axis labels and legends, design units.
pub(crate) const TEXT: f64 = 17.0;
/// Height of a line of the legend, design units.
pub(crate) const LEGEND_ROW: f64 = 24.0;
/// Height of the title, design units.
pub(crate) const TITLE: f64 = 19.0;
/// Average width of a character of a sans-serif face as a share of its height.
const CHARACTER: f64 = 0.56;

/// Red, green and blue.
pub(crate) type Rgb = (u8, u8, u8);
pub(crate) const INK: Rgb = (40, 40, 40);
pub(crate) const GREY: Rgb = (120, 120, 120);
pub(crate) const GRID: Rgb = (224, 224, 224);
pub(crate) const FAINT_GRID: Rgb = (242, 242, 242);
pub(crate) const TINT: Rgb = (240, 236, 224);

/// A place on the sheet in design units, from the upper left.
pub(crate) type Place = (f64, f64);

/// Where a text stands, seen from its place: its anchor and how far its baseline is below.
pub(crate) type Anchor = (&'static str, &'static str);
/// Below the place, in the middle.
pub(crate) const BELOW: Anchor = ("middle", "0.76em");
/// To the right of the place.
pub(crate) const AFTER: Anchor = ("start", "0.5ex");
/// To the left of the place.
pub(crate) const BEFORE: Anchor = ("end", "0.5ex");
/// To the left of the place and below it.
pub(crate) const BELOW_BEFORE: Anchor = ("end", "0.76em");
/// To the right of the place and below it.
pub(crate) const BELOW_AFTER: Anchor = ("start", "0.76em");

/// The color of the `index`-th series.
pub(crate) fn color(index: usize) -> Rgb {
    COLORS[index % COLORS.len()]
}

/// A color as SVG writes it.
pub(crate) fn hex((r, g, b): Rgb) -> String {
    format!("#{r:02X}{g:02X}{b:02X}")
}

/// A length in drawing units.
pub(crate) fn fine(length: f64) -> i64 {
    (length * FINE).round() as i64
}

/// Width of a text in design units: an estimate, since the reader's font is not known.
pub(crate) fn text_width(text: &str, height: f64) -> f64 {
    text.chars().count() as f64 * CHARACTER * height
}

/// The height at which a text fits a width.
pub(crate) fn fitting(text: &str, height: f64, width: f64) -> f64 {
    height * (width / text_width(text, height)).min(1.0)
}

/// A sheet being drawn on.
pub(crate) struct Sheet {
    svg: String,
    hints: String,
}

impl Sheet {
    /// A white sheet that scales to the width it is given, with a title that screen readers know.
    pub(crate) fn titled(title: &str, height: f64) -> Self {
        let mut sheet = Self::new(WIDTH, height);
        let name = escape(title);
        sheet.write(&format!(
            "<title>{name}</title>\n<rect width=\"100%\" height=\"100%\" fill=\"#FFFFFF\"/>"
        ));
        // A title that is too long for the sheet shrinks rather than being cut off.
        let size = fitting(title, TITLE, 0.97 * WIDTH / 1.06);
        sheet.text(
            title,
            (0.5 * WIDTH, 8.0),
            (size, INK),
            ("middle\" font-weight=\"bold", BELOW.1),
        );
        sheet
    }

    /// A transparent sheet.
    pub(crate) fn new(width: f64, height: f64) -> Self {
        let mut sheet = Self { svg: String::new(), hints: String::new() };
        sheet.write(&format!(
            "<svg role=\"img\" width=\"100%\" viewBox=\"0 0 {} {}\" xmlns=\"http://www.w3.org/2000/svg\">",
            fine(width),
            fine(height)
        ));
        sheet
    }

    /// The finished text. What can be pointed at lies above all else.
    pub(crate) fn finish(self) -> String {
        format!("{}{}</svg>\n", self.svg, self.hints)
    }

    /// Writes elements as they are.
    pub(crate) fn write(&mut self, elements: &str) {
        self.svg.push_str(elements);
        self.svg.push('\n');
    }

    /// Text of a height and a color.
    pub(crate) fn text(
        &mut self,
        text: &str,
        at: Place,
        (height, color): (f64, Rgb),
        (anchor, below): Anchor,
    ) {
        let (x, y) = (fine(at.0), fine(at.1));
        self.write(&format!(
            "<text x=\"{x}\" y=\"{y}\" dy=\"{below}\" font-family=\"sans-serif\" font-size=\"{}\" fill=\"{}\" text-anchor=\"{anchor}\">{}</text>",
            fine(height),
            hex(color),
            escape(text)
        ));
    }

    /// Text that is read from below, with its middle at a place.
    pub(crate) fn upright(&mut self, text: &str, at: Place, height: f64) {
        self.write(&format!(
            "<g transform=\"translate({} {}) rotate(270)\">",
            fine(at.0),
            fine(at.1)
        ));
        self.text(text, (0.0, 0.0), (height, INK), BELOW);
        self.write("</g>");
    }

    pub(crate) fn filled_rectangle(&mut self, (x, y): Place, opposite: Place, color: Rgb) {
        let (width, height) = (opposite.0 - x, opposite.1 - y);
        let [x, y, width, height] = [x, y, width, height].map(fine);
        let color = hex(color);
        self.write(&format!(
            "<rect x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\" fill=\"{color}\"/>"
        ));
    }

    /// The outline of a rectangle.
    pub(crate) fn outline(&mut self, (x0, y0): Place, (x1, y1): Place, color: Rgb, width: f64) {
        let corners = [(x0, y0), (x1, y0), (x1, y1), (x0, y1), (x0, y0)];
        self.line(&corners, Dash::Solid, color, width);
    }

    pub(crate) fn line(&mut self, places: &[Place], dash: Dash, color: Rgb, width: f64) {
        let mut path: Vec<(i64, i64)> = places.iter().map(|(x, y)| (fine(*x), fine(*y))).collect();
        path.dedup();
        if path.len() < 2 {
            return;
        }
        let dashes = match dash {
            Dash::Solid => "",
            Dash::Dashed => " stroke-dasharray=\"72 40\"",
            Dash::Dotted => " stroke-dasharray=\"24 32\"",
        };
        let points: Vec<String> = path.iter().map(|(x, y)| format!("{x},{y}")).collect();
        self.write(&format!(
            "<polyline fill=\"none\" stroke=\"{}\" stroke-width=\"{}\"{dashes} points=\"{}\"/>",
            hex(color),
            fine(width),
            points.join(" ")
        ));
    }

    /// A mark around a place.
    pub(crate) fn symbol(&mut self, symbol: Symbol, at: Place, color: Rgb) {
        const UPRIGHT: &[Place] = &[(0.0, -1.15), (1.0, 0.7), (-1.0, 0.7)];
        const ON_ITS_TIP: &[Place] = &[(0.0, 1.15), (1.0, -0.7), (-1.0, -0.7)];
        const DIAMOND: &[Place] = &[(0.0, -1.25), (1.0, 0.0), (0.0, 1.25), (-1.0, 0.0)];
        const SQUARE: &[Place] = &[(-0.85, -0.85), (0.85, -0.85), (0.85, 0.85), (-0.85, 0.85)];
        const PLUS: [[Place; 2]; 2] = [[(-1.1, 0.0), (1.1, 0.0)], [(0.0, -1.1), (0.0, 1.1)]];
        let around = |(x, y): &Place| (at.0 + MARK * x, at.1 + MARK * y);
        let corners = match symbol {
            Symbol::Triangle | Symbol::OpenTriangle => UPRIGHT,
            Symbol::Wedge | Symbol::OpenWedge => ON_ITS_TIP,
            Symbol::Diamond | Symbol::OpenDiamond => DIAMOND,
            Symbol::Square | Symbol::Frame => SQUARE,
            Symbol::Disc | Symbol::Ring => return self.circle(at, symbol == Symbol::Disc, color),
            Symbol::Plus => {
                return PLUS.iter().for_each(|ends| {
                    self.line(&[around(&ends[0]), around(&ends[1])], Dash::Solid, color, 2.0);
                });
            }
        };
        let mut corners: Vec<Place> = corners.iter().map(around).collect();
        if symbol.open() == symbol {
            corners.push(corners[0]);
            return self.line(&corners, Dash::Solid, color, 1.6);
        }
        let corners: Vec<String> =
            corners.iter().map(|(x, y)| format!("{},{}", fine(*x), fine(*y))).collect();
        let fill = hex(color);
        self.write(&format!("<polygon fill=\"{fill}\" points=\"{}\"/>", corners.join(" ")));
    }

    fn circle(&mut self, at: Place, is_filled: bool, color: Rgb) {
        let paint = match is_filled {
            true => format!("fill=\"{}\"", hex(color)),
            false => {
                format!("fill=\"none\" stroke=\"{}\" stroke-width=\"{}\"", hex(color), fine(1.6))
            }
        };
        let [x, y, radius] = [at.0, at.1, MARK].map(fine);
        self.write(&format!("<circle cx=\"{x}\" cy=\"{y}\" r=\"{radius}\" {paint}/>"));
    }

    /// The cross of a failed run.
    pub(crate) fn failure(&mut self, (x, y): Place, radius: f64, color: Rgb) {
        for rise in [radius, -radius] {
            let ends = [(x - radius, y - rise), (x + radius, y + rise)];
            self.line(&ends, Dash::Solid, color, 2.6);
        }
    }

    /// A transparent disc over a place, so that pointing at it shows a note; `link` is the page that a click opens.
    pub(crate) fn hint(&mut self, at: Place, note: &str, link: Option<&str>) {
        let [x, y, radius] = [at.0, at.1, 6.0].map(fine);
        let disc = format!(
            "<circle class=\"hint\" cx=\"{x}\" cy=\"{y}\" r=\"{radius}\" fill=\"#000\" fill-opacity=\"0\"><title>{}</title></circle>",
            escape(note)
        );
        let _ = match link.filter(|link| is_near(link)) {
            Some(link) => writeln!(self.hints, "<a href=\"{}\">{disc}\n</a>", escape(link)),
            None => writeln!(self.hints, "{disc}"),
        };
    }
}
