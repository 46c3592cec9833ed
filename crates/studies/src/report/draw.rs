//! Draws a [`Figure`].

use crate::report::axis::Span;
use crate::report::escape::escape;
use crate::report::sheet::{
    AFTER, Anchor, BEFORE, BELOW, BELOW_AFTER, BELOW_BEFORE, FAINT_GRID, GREY, GRID, INK,
    LEGEND_ROW, LINE, MARK, Place, Rgb, Sheet, TEXT, TINT, WIDTH, color, fitting, text_width,
};
use crate::report::{COLORS, Dash, Figure, Guide, Look, Point, ReportError, Series, Symbol};

/// Height of the plotting area of every figure, design units.
const PLOT_HEIGHT: f64 = 300.0;
/// Room above the plot for the title, design units.
const TOP: f64 = 38.0;
/// Room at the right, for half a tick label, design units.
const RIGHT: f64 = 22.0;
/// Length of the ticks, design units.
const TICK: f64 = 5.0;
/// Room below the plot for ticks and their labels, design units.
const TICK_ROOM: f64 = TEXT + 14.0;

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

    /// The place of a point, at the edge where it lies outside; `None` where an axis cannot show it.
    fn clamped(&self, x: f64, y: f64) -> Option<Place> {
        let (fx, fy) = self.fractions(x, y)?;
        Some(self.at(fx.clamp(0.0, 1.0), fy.clamp(0.0, 1.0)))
    }
}

/// Whether a fraction of an axis lies inside it.
fn is_inside(fraction: &f64) -> bool {
    (-1e-9..=1.0 + 1e-9).contains(fraction)
}

impl Figure {
    /// The figure as one SVG text that scales to the width it is given.
    ///
    /// # Errors
    /// [`ReportError`] where there is nothing to draw or a fixed range is impossible.
    pub(crate) fn to_svg(&self) -> Result<String, ReportError> {
        self.drawn(Some(Legend::of(self)))
    }

    /// The figure for a page, which has the legend beside it.
    pub(crate) fn to_svg_without_legend(&self) -> Result<String, ReportError> {
        self.drawn(None)
    }

    fn drawn(&self, legend: Option<Legend>) -> Result<String, ReportError> {
        let (x, y) = self.spans()?;
        let bottom = TOP + PLOT_HEIGHT + 2.0 * TEXT + 22.0;
        let left = 12.0 + 1.5 * TEXT + (y.widest_label() as f64 + 1.0) * TEXT * 0.54;
        let frame =
            Frame { left, top: TOP, width: WIDTH - left - RIGHT, height: PLOT_HEIGHT, x, y };
        let height = legend.as_ref().map_or(0.0, |legend| legend.height() + 6.0);
        let mut sheet = Sheet::titled(&self.title, bottom + height);
        self.guides.iter().for_each(|guide| tint(&mut sheet, &frame, guide));
        axes(&mut sheet, self, &frame);
        let mut words = Words::default();
        self.guides.iter().for_each(|guide| draw_guide(&mut sheet, &frame, guide, &mut words));
        self.series.iter().for_each(|series| draw_series(&mut sheet, &frame, series));
        // Words come last: no mark hides them.
        words.labels(&frame, self.series.iter().flat_map(|series| &series.points));
        words.draw(&mut sheet);
        if let Some(legend) = legend {
            legend.draw(&mut sheet, bottom);
        }
        Ok(sheet.finish())
    }

    /// The axes, fitted to points, failures and guides.
    fn spans(&self) -> Result<(Span, Span), ReportError> {
        let (mut x, mut y) = (Vec::new(), Vec::new());
        for point in self.series.iter().flat_map(|s| &s.points) {
            let (low, high) = point.x_range.unwrap_or((point.x, point.x));
            x.extend([point.x, low, high]);
            let error = point.error.unwrap_or(0.0);
            y.extend([point.y, point.y - error, point.y + error]);
        }
        x.extend(self.series.iter().flat_map(|s| &s.failures).map(|f| f.x));
        for guide in &self.guides {
            match guide {
                Guide::Vertical(at, _) | Guide::Before(at, _) => x.push(*at),
                Guide::Horizontal(at, _) | Guide::UpTo(at, _) => y.push(*at),
            }
        }
        Ok((self.x.span(&self.name, x.into_iter())?, self.y.span(&self.name, y.into_iter())?))
    }
}

fn axes(sheet: &mut Sheet, figure: &Figure, frame: &Frame) {
    let (x, y) = (&frame.x, &frame.y);
    for (values, paint) in [((x.minor(), y.minor()), FAINT_GRID), ((x.ticks(), y.ticks()), GRID)] {
        for f in values.0.iter().filter_map(|v| x.fraction(*v)) {
            sheet.line(&[frame.at(f, 0.0), frame.at(f, 1.0)], Dash::Solid, paint, 1.0);
        }
        for f in values.1.iter().filter_map(|v| y.fraction(*v)) {
            sheet.line(&[frame.at(0.0, f), frame.at(1.0, f)], Dash::Solid, paint, 1.0);
        }
    }
    for (value, (px, py)) in
        x.ticks().iter().filter_map(|v| Some((*v, frame.at(x.fraction(*v)?, 0.0))))
    {
        sheet.line(&[(px, py), (px, py + TICK)], Dash::Solid, GREY, 1.0);
        sheet.text(&x.label(value), (px, py + TICK + 5.0), (TEXT, INK), BELOW);
    }
    for (value, (px, py)) in
        y.ticks().iter().filter_map(|v| Some((*v, frame.at(0.0, y.fraction(*v)?))))
    {
        sheet.line(&[(px - TICK, py), (px, py)], Dash::Solid, GREY, 1.0);
        sheet.text(&y.label(value), (px - TICK - 5.0, py), (TEXT, INK), BEFORE);
    }
    sheet.outline(frame.at(0.0, 1.0), frame.at(1.0, 0.0), GREY, 1.0);
    let (middle, bottom) = frame.at(0.5, 0.0);
    sheet.text(&figure.x.label, (middle, bottom + TICK_ROOM), (TEXT, INK), BELOW);
    let height = fitting(&figure.y.label, TEXT, 1.1 * frame.height);
    sheet.upright(&figure.y.label, (8.0, frame.at(0.0, 0.5).1), height);
}

/// The strip of a guide that has one.
fn tint(sheet: &mut Sheet, frame: &Frame, guide: &Guide) {
    let corner = match guide {
        Guide::UpTo(y, _) => frame.y.fraction(*y).map(|f| (1.0, f)),
        Guide::Before(x, _) => frame.x.fraction(*x).map(|f| (f, 1.0)),
        Guide::Vertical(..) | Guide::Horizontal(..) => None,
    };
    if let Some((fx, fy)) = corner.filter(|(fx, fy)| *fx > 0.0 && *fy > 0.0) {
        let ((left, bottom), (right, top)) =
            (frame.at(0.0, 0.0), frame.at(fx.min(1.0), fy.min(1.0)));
        sheet.filled_rectangle((left, top), (right, bottom), TINT);
    }
}

/// The words inside a frame. A word that finds no place beside the others is left out; pointing at its mark shows it.
#[derive(Default)]
struct Words {
    placed: Vec<(String, Place, (f64, Rgb), Anchor)>,
}

impl Words {
    /// Left, right, top and bottom of a word.
    fn bounds(text: &str, (x, y): Place, height: f64, (side, below): Anchor) -> [f64; 4] {
        // The reader's font is not known: half a character stays free.
        let width = text_width(text, height) + 0.3 * height;
        let left = if side == "end" { x - width } else { x };
        let top = if below == AFTER.1 { y - 0.5 * height } else { y };
        [left, left + width, top, top + height]
    }

    fn is_free(&self, text: &str, at: Place, height: f64, anchor: Anchor) -> bool {
        let [left, right, top, bottom] = Self::bounds(text, at, height, anchor);
        !self.placed.iter().any(|(text, at, (height, _), anchor)| {
            let [l, r, t, b] = Self::bounds(text, *at, *height, *anchor);
            left < r && l < right && top < b && t < bottom
        })
    }

    /// The words beside points: right or left of their marks, above or below.
    fn labels<'a>(&mut self, frame: &Frame, points: impl Iterator<Item = &'a Point>) {
        let height = 0.82 * TEXT;
        let sides = [(1.6, AFTER), (-1.6, BEFORE)];
        for point in points {
            let (Some(label), Some((x, y))) = (&point.label, frame.clamped(point.x, point.y))
            else {
                continue;
            };
            let places = [-2.2, 2.2, -5.0, 5.0].into_iter().flat_map(|rise| {
                sides.map(|(shift, anchor)| ((x + shift * MARK, y + rise * MARK), anchor))
            });
            let is_inside = |(at, anchor): &(Place, Anchor)| {
                let [left, right, top, bottom] = Self::bounds(label, *at, height, *anchor);
                let (x, y) =
                    (frame.left..=frame.left + frame.width, frame.top..=frame.top + frame.height);
                x.contains(&left) && x.contains(&right) && y.contains(&top) && y.contains(&bottom)
            };
            let mut free = places
                .filter(is_inside)
                .filter(|(at, anchor)| self.is_free(label, *at, height, *anchor));
            if let Some((at, anchor)) = free.next() {
                self.placed.push((label.clone(), at, (height, INK), anchor));
            }
        }
    }

    fn draw(&self, sheet: &mut Sheet) {
        self.placed
            .iter()
            .for_each(|(text, at, look, anchor)| sheet.text(text, *at, *look, *anchor));
    }
}

fn draw_guide(sheet: &mut Sheet, frame: &Frame, guide: &Guide, words: &mut Words) {
    let (label, ends, at, anchor): (&str, [Place; 2], Place, Anchor) = match guide {
        Guide::Vertical(x, label) | Guide::Before(x, label) => {
            let Some(f) = frame.x.fraction(*x).filter(is_inside) else {
                return;
            };
            let (px, py) = frame.at(f, 0.0);
            // The word stands on the side where there is room.
            let (shift, anchor) = if f > 0.6 { (-5.0, BELOW_BEFORE) } else { (5.0, BELOW_AFTER) };
            (label, [(px, py), frame.at(f, 1.0)], (px + shift, py - 20.0), anchor)
        }
        Guide::Horizontal(y, label) | Guide::UpTo(y, label) => {
            let Some(f) = frame.y.fraction(*y).filter(is_inside) else {
                return;
            };
            let (px, py) = frame.at(1.0, f);
            let shift = if f > 0.9 { 4.0 } else { -18.0 };
            (label, [frame.at(0.0, f), (px, py)], (px - 5.0, py + shift), BELOW_BEFORE)
        }
    };
    sheet.line(&ends, Dash::Dotted, GREY, 1.3);
    let height = 0.88 * TEXT;
    if !label.is_empty() && words.is_free(label, at, height, anchor) {
        words.placed.push((label.to_owned(), at, (height, GREY), anchor));
    }
}

fn draw_series(sheet: &mut Sheet, frame: &Frame, series: &Series) {
    let paint = color(series.color);
    if let Look::Line(dash) | Look::LineAndPoints(dash, _) = series.look {
        let width = if matches!(series.look, Look::Line(_)) { LINE } else { 0.6 * LINE };
        for piece in visible_pieces(frame, &series.points) {
            sheet.line(&piece, dash, paint, width);
        }
    }
    for point in &series.points {
        if let Look::Points(symbol) | Look::LineAndPoints(_, symbol) = series.look {
            draw_point(sheet, frame, point, symbol, series.color);
        }
        if let (Some(note), Some(at)) = (&point.note, frame.clamped(point.x, point.y)) {
            sheet.hint(at, note, point.link.as_deref());
        }
    }
    for failure in &series.failures {
        if let Some(f) = frame.x.fraction(failure.x).filter(is_inside) {
            let (px, py) = frame.at(f, 1.0);
            // Series fail at the same places: each has its own height, so that none hides another.
            let row = 9.0 + 11.0 * (series.color % COLORS.len()) as f64;
            sheet.failure((px, py + row), 0.95 * MARK, paint);
            if let Some(note) = &failure.note {
                sheet.hint((px, py + row), note, None);
            }
        }
    }
}

fn draw_point(sheet: &mut Sheet, frame: &Frame, point: &Point, symbol: Symbol, index: usize) {
    let (paint, symbol) = match point.is_no_result() {
        true => (GREY, symbol.open()),
        false => (color(index), symbol),
    };
    let Some(fx) = frame.x.fraction(point.x).filter(is_inside) else {
        return;
    };
    if point.y.is_nan() {
        return;
    }
    // What a logarithmic axis cannot show, and what lies beyond a fixed end, is an arrow at that edge.
    let fy = frame.y.fraction(point.y).unwrap_or(if point.y > 0.0 { 2.0 } else { -1.0 });
    if !is_inside(&fy) {
        let is_above = fy > 0.5;
        let (x, y) = frame.at(fx, f64::from(u8::from(is_above)));
        return match is_above {
            true => sheet.symbol(Symbol::Triangle, (x, y + 6.0), paint),
            false => sheet.symbol(Symbol::Wedge, (x, y - 6.0), paint),
        };
    }
    if let Some((low, high)) = point.x_range {
        let end = |x: f64| frame.x.fraction(x).unwrap_or(fx).clamp(0.0, 1.0);
        sheet.line(&[frame.at(end(low), fy), frame.at(end(high), fy)], Dash::Solid, paint, 1.0);
    }
    if let Some(error) = point.error.filter(|e| e.is_finite() && *e > 0.0) {
        let end = |y: f64| frame.at(fx, frame.y.fraction(y).unwrap_or(0.0).clamp(0.0, 1.0));
        let ends = [end(point.y - error), end(point.y + error)];
        sheet.line(&ends, Dash::Solid, paint, 1.4);
        for (x, y) in ends {
            sheet.line(&[(x - 3.0, y), (x + 3.0, y)], Dash::Solid, paint, 1.4);
        }
    }
    sheet.symbol(symbol, frame.at(fx, fy), paint);
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

/// Width of the sample in the legend, design units.
const SAMPLE: f64 = 34.0;
/// An entry of a legend.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Entry {
    name: String,
    /// `None` for the cross of failed runs, whatever their color.
    look: Option<Look>,
    color: usize,
}

impl Entry {
    fn of(series: &Series) -> Self {
        Self { name: series.name.clone(), look: Some(series.look), color: series.color }
    }

    fn of_failures() -> Self {
        Self { name: "failed: no value".to_owned(), look: None, color: 0 }
    }

    /// Whether two entries say the same, be the marks joined by a line or not.
    fn is_like(&self, other: &Self) -> bool {
        let mark = |look: Option<Look>| match look {
            None | Some(Look::Line(_)) => None,
            Some(Look::Points(symbol) | Look::LineAndPoints(_, symbol)) => Some(symbol),
        };
        let [own, others] = [self, other].map(|e| (&e.name, e.color, mark(e.look)));
        own == others
    }

    fn sample(&self, sheet: &mut Sheet, (x, y): Place) {
        let (paint, middle) = (color(self.color), (x + 0.5 * SAMPLE - 3.0, y));
        let Some(look) = self.look else {
            return sheet.failure(middle, MARK, INK);
        };
        if let Look::Line(dash) | Look::LineAndPoints(dash, _) = look {
            sheet.line(&[(x, y), (x + SAMPLE - 6.0, y)], dash, paint, LINE);
        }
        if let Look::Points(symbol) | Look::LineAndPoints(_, symbol) = look {
            sheet.symbol(symbol, middle, paint);
        }
    }
}

/// The entries of a figure, each once.
fn entries(figure: &Figure) -> Vec<Entry> {
    let mut found: Vec<Entry> = Vec::new();
    let failures = figure.series.iter().any(|series| !series.failures.is_empty());
    let named = figure.series.iter().filter(|series| !series.name.is_empty()).map(Entry::of);
    for entry in named.chain(failures.then(Entry::of_failures)) {
        if !is_in(&entry, &found) {
            found.push(entry);
        }
    }
    found
}

fn is_in(entry: &Entry, entries: &[Entry]) -> bool {
    entries.iter().any(|known| known.is_like(entry))
}

/// The entries that several figures of a row have: they stand once, above the row.
pub(crate) fn shared_entries<'a>(figures: impl Iterator<Item = &'a Figure>) -> Vec<Entry> {
    let (mut seen, mut shared) = (Vec::new(), Vec::new());
    for entry in figures.flat_map(entries) {
        if !is_in(&entry, &seen) {
            seen.push(entry);
        } else if !is_in(&entry, &shared) {
            shared.push(entry);
        }
    }
    shared
}

/// The entries of a figure that do not stand above its row.
pub(crate) fn own_entries(figure: &Figure, shared: &[Entry]) -> Vec<Entry> {
    entries(figure).into_iter().filter(|entry| !is_in(entry, shared)).collect()
}

/// A legend of a page; nothing without entries.
pub(crate) fn legend_to_html(entries: &[Entry]) -> String {
    if entries.is_empty() {
        return String::new();
    }
    let items: String = entries
        .iter()
        .map(|entry| {
            let mut sheet = Sheet::new(SAMPLE, LEGEND_ROW);
            entry.sample(&mut sheet, (3.0, 0.5 * LEGEND_ROW));
            format!("<li>{}{}</li>\n", sheet.finish().trim_end(), escape(&entry.name))
        })
        .collect();
    format!("<ul class=\"legend\">\n{items}</ul>\n")
}

/// The legend below the plot of a figure that is a file, in as many columns as the names allow.
pub(crate) struct Legend {
    entries: Vec<Entry>,
    columns: usize,
}

impl Legend {
    pub(crate) fn of(figure: &Figure) -> Self {
        let entries = entries(figure);
        let widest = entries.iter().map(|e| text_width(&e.name, TEXT)).fold(0.0, f64::max);
        let columns = ((WIDTH - 16.0) / (widest + SAMPLE + 8.0)).floor() as usize;
        Self { columns: columns.clamp(1, entries.len().max(1)), entries }
    }

    fn rows(&self) -> usize {
        self.entries.len().div_ceil(self.columns)
    }

    pub(crate) fn height(&self) -> f64 {
        self.rows() as f64 * LEGEND_ROW
    }

    pub(crate) fn draw(&self, sheet: &mut Sheet, top: f64) {
        let column_width = (WIDTH - 16.0) / self.columns as f64;
        for (i, entry) in self.entries.iter().enumerate() {
            let (column, row) = (i / self.rows(), i % self.rows());
            let x = 8.0 + column as f64 * column_width;
            let y = top + (row as f64 + 0.5) * LEGEND_ROW;
            entry.sample(sheet, (x, y));
            let height = fitting(&entry.name, TEXT, column_width - SAMPLE - 4.0);
            sheet.text(&entry.name, (x + SAMPLE, y), (height, INK), AFTER);
        }
    }
}

#[cfg(test)]
mod tests;
