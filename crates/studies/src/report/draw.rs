//! Draws a [`Figure`] with the plotting library.

use plotters::prelude::ChartBuilder;
use plotters::style::text_anchor::{HPos, VPos};

use crate::report::axis::Span;
use crate::report::canvas::{
    AFTER, BEFORE, BELOW, FAINT_GRID, FINE, GREY, GRID, Hint, LINE, MARK, Place, Sheet, TEXT, TINT,
    WIDTH, color, drawing, fine, font, ink, stroke, text_width,
};
use crate::report::legend::Legend;
use crate::report::{Figure, Guide, Look, Point, ReportError, Series, Symbol};

/// Height of the plotting area of every figure, design units.
const PLOT_HEIGHT: f64 = 300.0;
/// Room above the plot for the title, design units.
const TOP: f64 = 38.0;
/// Room at the right, for half a tick label, design units.
const RIGHT: f64 = 22.0;

/// The plotting area on the sheet and the two axes: from values to places.
struct Frame {
    left: f64,
    top: f64,
    width: f64,
    height: f64,
    x: Span,
    y: Span,
}

impl Frame {
    fn at(&self, fx: f64, fy: f64) -> Place {
        (self.left + fx * self.width, self.top + (1.0 - fy) * self.height)
    }

    fn fractions(&self, x: f64, y: f64) -> Option<(f64, f64)> {
        Some((self.x.fraction(x)?, self.y.fraction(y)?))
    }
}

impl Figure {
    /// The figure as one SVG text that scales to the width it is given.
    ///
    /// # Errors
    /// [`ReportError`] where there is nothing to draw or a fixed range is impossible.
    pub fn to_svg(&self) -> Result<String, ReportError> {
        svg(self)
    }
}

fn svg(figure: &Figure) -> Result<String, ReportError> {
    let points = || figure.series.iter().flat_map(|s| &s.points);
    let failures = || figure.series.iter().flat_map(|s| &s.failures).map(|f| f.x);
    let guides = |vertical: bool| {
        figure.guides.iter().filter_map(move |g| match g {
            Guide::Vertical(v, _) if vertical => Some(*v),
            Guide::Horizontal(v, _) | Guide::UpTo(v, _) if !vertical => Some(*v),
            _ => None,
        })
    };
    let x_values = points()
        .flat_map(|p| {
            let (low, high) = p.x_range.unwrap_or((p.x, p.x));
            [p.x, low, high]
        })
        .chain(failures())
        .chain(guides(true));
    let x = figure.x.span(&figure.name, x_values)?;
    let y_values = points()
        .flat_map(|p| {
            let e = p.error.unwrap_or(0.0);
            [p.y, p.y - e, p.y + e]
        })
        .chain(guides(false));
    let y = figure.y.span(&figure.name, y_values)?;

    let legend = Legend::of(figure);
    let bottom = 2.0 * TEXT + 22.0;
    let plot_bottom = TOP + PLOT_HEIGHT;
    let height = plot_bottom + bottom + legend.height() + 6.0;
    let left = 12.0 + 1.5 * TEXT + (y.widest_label() as f64 + 1.0) * TEXT * 0.54;
    let frame = Frame { left, top: TOP, width: WIDTH - left - RIGHT, height: PLOT_HEIGHT, x, y };

    drawing(&figure.name, &figure.title, height, |sheet, hints| {
        for guide in &figure.guides {
            tint(sheet, &frame, guide)?;
        }
        axes(sheet, figure, &frame)?;
        for guide in &figure.guides {
            draw_guide(sheet, &frame, guide)?;
        }
        for series in &figure.series {
            draw_series(sheet, &frame, series, hints)?;
        }
        // Words come last: no mark hides them.
        for series in &figure.series {
            draw_labels(sheet, &frame, series)?;
        }
        legend.draw(sheet, plot_bottom + bottom)
    })
}

fn axes(sheet: &Sheet<'_>, figure: &Figure, frame: &Frame) -> Result<(), ReportError> {
    let (x0, y0) = fine((frame.left, frame.top));
    let (x1, y1) = fine((frame.left + frame.width, frame.top + frame.height));
    let tick_room = TEXT + 12.0;
    let area = sheet
        .area
        .clone()
        .shrink((0, y0), (x1 as u32, (y1 - y0) as u32 + (tick_room * f64::from(FINE)) as u32));
    let mut chart = ChartBuilder::on(&area)
        .set_label_area_size(plotters::prelude::LabelAreaPosition::Left, x0)
        .set_label_area_size(
            plotters::prelude::LabelAreaPosition::Bottom,
            (tick_room * f64::from(FINE)) as i32,
        )
        .build_cartesian_2d(frame.x.clone(), frame.y.clone())
        .map_err(|e| sheet.failed(e))?;
    chart
        .configure_mesh()
        .bold_line_style(stroke(GRID, 1.0))
        .light_line_style(stroke(FAINT_GRID, 1.0))
        .axis_style(stroke(GREY, 1.0))
        .label_style(ink(TEXT))
        .set_all_tick_mark_size(5 * FINE)
        .draw()
        .map_err(|e| sheet.failed(e))?;
    sheet.outline(
        (frame.left, frame.top),
        (frame.left + frame.width, frame.top + frame.height),
        GREY,
        1.0,
    )?;
    let middle = frame.left + 0.5 * frame.width;
    let below = frame.top + frame.height + tick_room + 2.0;
    sheet.text(&figure.x.label, (middle, below), ink(TEXT), BELOW)?;
    let width = text_width(&figure.y.label, TEXT);
    let height = TEXT * (frame.height * 1.1 / width).min(1.0);
    sheet.upright(&figure.y.label, (8.0, frame.top + 0.5 * frame.height), height)
}

/// The strip below a [`Guide::UpTo`].
fn tint(sheet: &Sheet<'_>, frame: &Frame, guide: &Guide) -> Result<(), ReportError> {
    let Guide::UpTo(y, _) = guide else {
        return Ok(());
    };
    match frame.y.fraction(*y) {
        Some(f) if f > 0.0 => {
            sheet.filled_rectangle(frame.at(0.0, f.min(1.0)), frame.at(1.0, 0.0), TINT)
        }
        _ => Ok(()),
    }
}

/// The words beside points, each to the right of its mark, or to the left where the frame ends.
fn draw_labels(sheet: &Sheet<'_>, frame: &Frame, series: &Series) -> Result<(), ReportError> {
    for point in &series.points {
        let (Some(label), Some((fx, fy))) = (&point.label, frame.fractions(point.x, point.y))
        else {
            continue;
        };
        let (x, y) = frame.at(fx.clamp(0.0, 1.0), fy.clamp(0.0, 1.0));
        let (shift, anchor) = if fx > 0.92 { (-1.6 * MARK, BEFORE) } else { (1.6 * MARK, AFTER) };
        let at = (x + shift, y - 2.2 * MARK);
        sheet.text(label, at, ink(0.82 * TEXT), anchor)?;
    }
    Ok(())
}

fn draw_guide(sheet: &Sheet<'_>, frame: &Frame, guide: &Guide) -> Result<(), ReportError> {
    let (label, ends, at, horizontal) = match guide {
        Guide::Vertical(x, label) => {
            let Some(f) = frame.x.fraction(*x).filter(|f| (0.0..=1.0).contains(f)) else {
                return Ok(());
            };
            let ends = [frame.at(f, 0.0), frame.at(f, 1.0)];
            // The word stands on the side where there is room.
            let (shift, anchor) = if f > 0.6 { (-5.0, HPos::Right) } else { (5.0, HPos::Left) };
            (label, ends, (ends[0].0 + shift, ends[0].1 - 20.0), anchor)
        }
        Guide::Horizontal(y, label) | Guide::UpTo(y, label) => {
            let Some(f) = frame.y.fraction(*y).filter(|f| (0.0..=1.0).contains(f)) else {
                return Ok(());
            };
            let ends = [frame.at(0.0, f), frame.at(1.0, f)];
            let below = f > 0.9;
            let at = (ends[1].0 - 5.0, ends[1].1 + if below { 4.0 } else { -18.0 });
            (label, ends, at, HPos::Right)
        }
    };
    sheet.line(&ends, crate::report::Dash::Dotted, GREY, 1.3)?;
    sheet.text(label, at, font(0.88 * TEXT, GREY), (horizontal, VPos::Top))
}

fn draw_series(
    sheet: &Sheet<'_>,
    frame: &Frame,
    series: &Series,
    hints: &mut Vec<Hint>,
) -> Result<(), ReportError> {
    let paint = color(series.color);
    if let Look::Line(dash) | Look::LineAndPoints(dash, _) = series.look {
        let width = if matches!(series.look, Look::Line(_)) { LINE } else { 0.6 * LINE };
        for piece in visible_pieces(frame, &series.points) {
            sheet.line(&piece, dash, paint, width)?;
        }
    }
    for point in &series.points {
        if let Look::Points(symbol) | Look::LineAndPoints(_, symbol) = series.look {
            draw_point(sheet, frame, point, symbol, series.color)?;
        }
        if let (Some(note), Some((fx, fy))) = (&point.note, frame.fractions(point.x, point.y)) {
            hints.push(Hint {
                at: frame.at(fx.clamp(0.0, 1.0), fy.clamp(0.0, 1.0)),
                note: note.clone(),
                link: point.link.clone(),
            });
        }
    }
    for failure in &series.failures {
        if let Some(f) = frame.x.fraction(failure.x).filter(|f| (0.0..=1.0).contains(f)) {
            let (px, py) = frame.at(f, 1.0);
            // Series fail at the same places: each has its own height, so that none hides another.
            let row = 9.0 + 11.0 * (series.color % crate::report::COLORS.len()) as f64;
            let at = (px, py + row);
            sheet.failure(at, 0.95 * MARK, paint)?;
            hints.extend(failure.note.clone().map(|note| Hint { at, note, link: None }));
        }
    }
    Ok(())
}

fn draw_point(
    sheet: &Sheet<'_>,
    frame: &Frame,
    point: &Point,
    symbol: Symbol,
    color_index: usize,
) -> Result<(), ReportError> {
    let (paint, symbol) = match point.is_no_result() {
        true => (GREY, symbol.open()),
        false => (color(color_index), symbol),
    };
    let Some(fx) = frame.x.fraction(point.x).filter(|f| (-1e-9..=1.0 + 1e-9).contains(f)) else {
        return Ok(());
    };
    if point.y.is_nan() {
        return Ok(());
    }
    // What a logarithmic axis cannot show, and what lies beyond a fixed end, is an arrow at that edge.
    let fy = frame.y.fraction(point.y).unwrap_or(if point.y > 0.0 { 2.0 } else { -1.0 });
    if fy > 1.0 + 1e-9 {
        let (x, y) = frame.at(fx, 1.0);
        return sheet.symbol(Symbol::Triangle, (x, y + 6.0), MARK, paint);
    }
    if fy < -1e-9 {
        let (x, y) = frame.at(fx, 0.0);
        return sheet.symbol(Symbol::Wedge, (x, y - 6.0), MARK, paint);
    }
    if let Some((low, high)) = point.x_range {
        let end = |x: f64| frame.x.fraction(x).unwrap_or(fx).clamp(0.0, 1.0);
        let ends = [frame.at(end(low), fy), frame.at(end(high), fy)];
        sheet.line(&ends, crate::report::Dash::Solid, paint, 1.0)?;
    }
    if let Some(error) = point.error.filter(|e| e.is_finite() && *e > 0.0) {
        let end = |y: f64| frame.y.fraction(y).unwrap_or(0.0).clamp(0.0, 1.0);
        let ends = [point.y - error, point.y + error].map(|y| frame.at(fx, end(y)));
        sheet.line(&ends, crate::report::Dash::Solid, paint, 1.4)?;
        for (x, y) in ends {
            let end = [(x - 3.0, y), (x + 3.0, y)];
            sheet.line(&end, crate::report::Dash::Solid, paint, 1.4)?;
        }
    }
    sheet.symbol(symbol, frame.at(fx, fy), MARK, paint)
}

/// The parts of a line that lie inside the frame, as unbroken runs of places.
fn visible_pieces(frame: &Frame, points: &[Point]) -> Vec<Vec<Place>> {
    let mut pieces: Vec<Vec<Place>> = Vec::new();
    let mut open = false;
    for pair in points.windows(2) {
        let clipped = frame
            .fractions(pair[0].x, pair[0].y)
            .zip(frame.fractions(pair[1].x, pair[1].y))
            .and_then(|(a, b)| clip(a, b));
        let Some((a, b, whole_start, whole_end)) = clipped else {
            open = false;
            continue;
        };
        let (from, to) = (frame.at(a.0, a.1), frame.at(b.0, b.1));
        match pieces.last_mut() {
            Some(piece) if open && whole_start => piece.push(to),
            _ => pieces.push(vec![from, to]),
        }
        open = whole_end;
    }
    pieces
}

type Fractions = (f64, f64);

/// The part of a segment inside the unit square (Liang and Barsky, "A new concept and method for line
/// clipping", ACM Trans. Graph. 3, 1, 1984), and whether its start and its end are the segment's own.
fn clip(a: Fractions, b: Fractions) -> Option<(Fractions, Fractions, bool, bool)> {
    let (dx, dy) = (b.0 - a.0, b.1 - a.1);
    let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
    for (direction, distance) in [(-dx, a.0), (dx, 1.0 - a.0), (-dy, a.1), (dy, 1.0 - a.1)] {
        if direction == 0.0 {
            if distance < 0.0 {
                return None;
            }
        } else if direction < 0.0 {
            enter = enter.max(distance / direction);
        } else {
            leave = leave.min(distance / direction);
        }
    }
    if enter > leave || !(dx.is_finite() && dy.is_finite()) {
        return None;
    }
    let at = |t: f64| (a.0 + t * dx, a.1 + t * dy);
    Some((at(enter), at(leave), enter == 0.0, leave == 1.0))
}

#[cfg(test)]
mod tests;
