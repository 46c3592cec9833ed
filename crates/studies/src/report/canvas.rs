//! The sheet that figures are drawn on: sizes in design units, text, symbols, lines.

use plotters::coord::Shift;
use plotters::element::{Circle, DashedPathElement, PathElement, Polygon, Rectangle, Text};
use plotters::prelude::{DrawingArea, IntoDrawingArea, RGBColor, SVGBackend, ShapeStyle};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{
    Color, FontFamily, FontStyle, FontTransform, IntoTextStyle, TextStyle, WHITE,
};

use crate::report::escape::{escape, is_near};
use crate::report::{COLORS, Dash, ReportError, Symbol};

/// Radius of marks, design units.
pub(crate) const MARK: f64 = 4.2;
/// Width of lines, design units.
pub(crate) const LINE: f64 = 2.0;

/// Drawing units per design unit: the plotting library takes whole numbers, and this is its precision.
pub(crate) const FINE: i32 = 8;
/// Width of every figure in design units: at the 360 pixels of a phone, text of 17 units is 11 pixels high.
pub(crate) const WIDTH: f64 = 560.0;
/// Height of tick labels, axis labels and legends, design units.
pub(crate) const TEXT: f64 = 17.0;
/// Height of the title, design units.
pub(crate) const TITLE: f64 = 19.0;
/// Average width of a character of a sans-serif face as a share of its height.
pub(crate) const CHARACTER: f64 = 0.56;
/// The SVG back end divides every font size by this before writing it.
const BACKEND_FONT_DIVISOR: f64 = 1.24;

pub(crate) const INK: RGBColor = RGBColor(40, 40, 40);
pub(crate) const GREY: RGBColor = RGBColor(120, 120, 120);
pub(crate) const GRID: RGBColor = RGBColor(224, 224, 224);
pub(crate) const TINT: RGBColor = RGBColor(240, 236, 224);
pub(crate) const FAINT_GRID: RGBColor = RGBColor(242, 242, 242);

/// A place on the sheet in design units, from the upper left.
pub(crate) type Place = (f64, f64);

pub(crate) fn fine(place: Place) -> (i32, i32) {
    ((place.0 * f64::from(FINE)).round() as i32, (place.1 * f64::from(FINE)).round() as i32)
}

pub(crate) fn color(index: usize) -> RGBColor {
    let (r, g, b) = COLORS[index % COLORS.len()];
    RGBColor(r, g, b)
}

pub(crate) fn stroke(color: RGBColor, width: f64) -> ShapeStyle {
    color.stroke_width((width * f64::from(FINE)).round() as u32)
}

/// Text of a height in design units.
pub(crate) fn font(height: f64, color: RGBColor) -> TextStyle<'static> {
    let size = height * f64::from(FINE) * BACKEND_FONT_DIVISOR;
    let mut style: TextStyle<'static> = (FontFamily::SansSerif, size).into_text_style(&(0, 0));
    style.color = color.to_backend_color();
    style
}

/// Where a text stands, seen from its place.
pub(crate) type Anchor = (HPos, VPos);
/// Below the place, in the middle.
pub(crate) const BELOW: Anchor = (HPos::Center, VPos::Top);
/// To the right of the place.
pub(crate) const AFTER: Anchor = (HPos::Left, VPos::Center);
/// To the left of the place.
pub(crate) const BEFORE: Anchor = (HPos::Right, VPos::Center);

/// Text in the colour of ink.
pub(crate) fn ink(height: f64) -> TextStyle<'static> {
    font(height, INK)
}

/// Width of a text in design units: an estimate, since the reader's font is not known.
pub(crate) fn text_width(text: &str, height: f64) -> f64 {
    text.chars().count() as f64 * CHARACTER * height
}

/// A sheet being drawn on.
pub(crate) struct Sheet<'a> {
    pub(crate) area: DrawingArea<SVGBackend<'a>, Shift>,
    figure: &'a str,
}

/// Draws on a white sheet with a title, and gives its SVG text.
pub(crate) fn drawing(
    figure: &str,
    title: &str,
    height: f64,
    draw: impl FnOnce(&Sheet<'_>, &mut Vec<Hint>) -> Result<(), ReportError>,
) -> Result<String, ReportError> {
    let (mut svg, mut hints) = (String::new(), Vec::new());
    {
        let sheet = Sheet::new(figure, &mut svg, height);
        sheet.area.fill(&WHITE).map_err(|e| sheet.failed(e))?;
        sheet.title(title)?;
        draw(&sheet, &mut hints)?;
        sheet.area.present().map_err(|e| sheet.failed(e))?;
    }
    Ok(dress(&svg, title, &hints))
}

impl<'a> Sheet<'a> {
    fn new(figure: &'a str, svg: &'a mut String, height: f64) -> Self {
        let (w, h) = fine((WIDTH, height));
        let area = SVGBackend::with_string(svg, (w as u32, h as u32)).into_drawing_area();
        Self { area, figure }
    }

    pub(crate) fn failed(&self, reason: impl std::fmt::Display) -> ReportError {
        ReportError::Drawing { figure: self.figure.into(), reason: reason.to_string() }
    }

    pub(crate) fn text(
        &self,
        text: &str,
        at: Place,
        style: TextStyle<'static>,
        (horizontal, vertical): Anchor,
    ) -> Result<(), ReportError> {
        let style = style.pos(Pos::new(horizontal, vertical));
        self.area.draw(&Text::new(text.to_owned(), fine(at), style)).map_err(|e| self.failed(e))
    }

    fn title(&self, title: &str) -> Result<(), ReportError> {
        // A title that is too long for the sheet shrinks rather than being cut off.
        let width = text_width(title, TITLE) * 1.06;
        let height = TITLE * (0.97 * WIDTH / width).min(1.0);
        let size = height * f64::from(FINE) * BACKEND_FONT_DIVISOR;
        let face = (FontFamily::SansSerif, size, FontStyle::Bold);
        let mut style: TextStyle<'static> = face.into_text_style(&(0, 0));
        style.color = INK.to_backend_color();
        self.text(title, (0.5 * WIDTH, 8.0), style, BELOW)
    }

    pub(crate) fn upright(&self, text: &str, at: Place, height: f64) -> Result<(), ReportError> {
        let style = font(height, INK).transform(FontTransform::Rotate270);
        self.text(text, at, style, BELOW)
    }

    pub(crate) fn filled_rectangle(
        &self,
        corner: Place,
        opposite: Place,
        color: RGBColor,
    ) -> Result<(), ReportError> {
        self.area
            .draw(&Rectangle::new([fine(corner), fine(opposite)], color.filled()))
            .map_err(|e| self.failed(e))
    }

    /// The outline of a rectangle, as a closed line: the SVG back end gives rectangles no line width.
    pub(crate) fn outline(
        &self,
        (x0, y0): Place,
        (x1, y1): Place,
        color: RGBColor,
        width: f64,
    ) -> Result<(), ReportError> {
        let corners = [(x0, y0), (x1, y0), (x1, y1), (x0, y1), (x0, y0)];
        self.line(&corners, Dash::Solid, color, width)
    }

    pub(crate) fn line(
        &self,
        places: &[Place],
        dash: Dash,
        color: RGBColor,
        width: f64,
    ) -> Result<(), ReportError> {
        let mut path: Vec<(i32, i32)> = places.iter().map(|p| fine(*p)).collect();
        path.dedup();
        if path.len() < 2 {
            return Ok(());
        }
        let style = stroke(color, width);
        let done = match dash {
            Dash::Solid => self.area.draw(&PathElement::new(path, style)),
            Dash::Dashed => {
                self.area.draw(&DashedPathElement::new(path, 9 * FINE, 5 * FINE, style))
            }
            Dash::Dotted => {
                self.area.draw(&DashedPathElement::new(path, 3 * FINE, 4 * FINE, style))
            }
        };
        done.map_err(|e| self.failed(e))
    }

    /// A mark of about `radius` design units around a place.
    pub(crate) fn symbol(
        &self,
        symbol: Symbol,
        at: Place,
        radius: f64,
        color: RGBColor,
    ) -> Result<(), ReportError> {
        let around = |corners: &[(f64, f64)]| -> Vec<Place> {
            corners.iter().map(|(x, y)| (at.0 + radius * x, at.1 + radius * y)).collect()
        };
        let fill = |corners: &[(f64, f64)]| {
            let corners: Vec<(i32, i32)> = around(corners).into_iter().map(fine).collect();
            self.area.draw(&Polygon::new(corners, color.filled())).map_err(|e| self.failed(e))
        };
        let circle = |style: ShapeStyle| {
            let size = (radius * f64::from(FINE)).round() as i32;
            self.area.draw(&Circle::new(fine(at), size, style)).map_err(|e| self.failed(e))
        };
        const UPRIGHT: [(f64, f64); 3] = [(0.0, -1.15), (1.0, 0.7), (-1.0, 0.7)];
        const ON_ITS_TIP: [(f64, f64); 3] = [(0.0, 1.15), (1.0, -0.7), (-1.0, -0.7)];
        const DIAMOND: [(f64, f64); 4] = [(0.0, -1.25), (1.0, 0.0), (0.0, 1.25), (-1.0, 0.0)];
        let ring = |corners: &[(f64, f64)]| {
            let mut corners = around(corners);
            corners.extend(corners.first().copied());
            self.line(&corners, Dash::Solid, color, 1.6)
        };
        match symbol {
            Symbol::Disc => circle(color.filled()),
            Symbol::Ring => circle(stroke(color, 1.6)),
            Symbol::Square => fill(&[(-0.85, -0.85), (0.85, -0.85), (0.85, 0.85), (-0.85, 0.85)]),
            Symbol::Frame => {
                let corners = around(&[(-0.9, -0.9), (0.9, 0.9)]);
                self.outline(corners[0], corners[1], color, 1.6)
            }
            Symbol::Triangle => fill(&UPRIGHT),
            Symbol::Wedge => fill(&ON_ITS_TIP),
            Symbol::Diamond => fill(&DIAMOND),
            Symbol::OpenTriangle => ring(&UPRIGHT),
            Symbol::OpenWedge => ring(&ON_ITS_TIP),
            Symbol::OpenDiamond => ring(&DIAMOND),
            Symbol::Plus => {
                for ends in [[(-1.1, 0.0), (1.1, 0.0)], [(0.0, -1.1), (0.0, 1.1)]] {
                    self.line(&around(&ends), Dash::Solid, color, 2.0)?;
                }
                Ok(())
            }
        }
    }

    /// The cross of a failed run.
    pub(crate) fn failure(
        &self,
        at: Place,
        radius: f64,
        color: RGBColor,
    ) -> Result<(), ReportError> {
        for (x, y) in [(1.0, 1.0), (1.0, -1.0)] {
            let (dx, dy) = (radius * x, radius * y);
            let ends = [(at.0 - dx, at.1 - dy), (at.0 + dx, at.1 + dy)];
            self.line(&ends, Dash::Solid, color, 2.6)?;
        }
        Ok(())
    }
}

/// A transparent disc over a point with a note, so that pointing at it tells what it is.
pub(crate) struct Hint {
    pub(crate) at: Place,
    pub(crate) note: String,
    /// The page that a click opens.
    pub(crate) link: Option<String>,
}

/// Makes the drawn text scale with its surroundings, names it for screen readers, adds the hints.
fn dress(svg: &str, title: &str, hints: &[Hint]) -> String {
    let title = escape(title);
    let mut out = String::with_capacity(svg.len() + 200);
    // The opening tag names its size in drawing units; the view box alone should decide the shape.
    match (svg.find(" viewBox"), svg.find('>')) {
        (Some(view_box), Some(end)) if view_box < end => {
            out.push_str("<svg role=\"img\" width=\"100%\"");
            out.push_str(&svg[view_box..=end]);
            out.push_str(&format!("\n<title>{title}</title>"));
            out.push_str(svg[end + 1..].trim_end());
        }
        _ => out.push_str(svg.trim_end()),
    }
    if let Some(body) = out.strip_suffix("</svg>") {
        let mut body = body.to_owned();
        for hint in hints {
            let (x, y) = fine(hint.at);
            let link = hint.link.as_deref().filter(|link| is_near(link));
            if let Some(link) = link {
                body.push_str(&format!("<a href=\"{}\">", escape(link)));
            }
            body.push_str(&format!(
                "<circle class=\"hint\" cx=\"{x}\" cy=\"{y}\" r=\"{}\" fill=\"#000\" fill-opacity=\"0\"><title>{}</title></circle>\n",
                6 * FINE,
                escape(&hint.note)
            ));
            if link.is_some() {
                body.push_str("</a>\n");
            }
        }
        out = body + "</svg>";
    }
    out.push('\n');
    out
}
