//! A self-contained page: one HTML text with its style and its figures inside.

use lennard_observables::Table;

use crate::report::escape::{escape, inline_markup, made_by};
use crate::report::{Picture, ReportError, draw, table};

/// The style of every page.
const STYLE: &str = include_str!("page.css");
/// What lets points be pointed at, with a mouse or a finger; only on pages that have such points.
const SCRIPT: &str = include_str!("page.js");

/// A part of a section.
#[derive(Debug, Clone, PartialEq)]
pub enum Block {
    /// A paragraph with inline markup: `` `code` `` and `**bold**`.
    Text(String),
    /// Points of a list, with inline markup.
    List(Vec<String>),
    /// Lines of a derivation.
    Equations(Vec<String>),
    /// A remark that must not be missed.
    Remark(String),
    /// A heading inside the section.
    Heading(String),
    /// Figures, side by side where there is room.
    Figures(Vec<Picture>),
    /// A table.
    Table(Table),
}

/// A section with a heading.
#[derive(Debug, Clone, PartialEq)]
pub struct Section {
    /// Heading.
    pub title: String,
    /// What stands in it.
    pub blocks: Vec<Block>,
    /// Whether a terminal shows it too, and without which columns of its tables: it has less room.
    pub brief: Option<&'static [&'static str]>,
    /// Whether a page shows its heading alone until a reader opens it.
    pub folded: bool,
}

impl Section {
    /// An empty section.
    #[must_use]
    pub fn new(title: impl Into<String>) -> Self {
        Self { title: title.into(), blocks: Vec::new(), brief: None, folded: false }
    }

    /// Shows the heading alone until a reader opens the section.
    pub(crate) fn folded(self) -> Self {
        Self { folded: true, ..self }
    }

    /// Lets a terminal show the section too, without these columns of its tables.
    pub(crate) fn brief(self, without: &'static [&'static str]) -> Self {
        Self { brief: Some(without), ..self }
    }

    /// Every figure of the section.
    pub(crate) fn pictures(&self) -> impl Iterator<Item = &Picture> {
        let blocks = self.blocks.iter();
        blocks
            .filter_map(|block| match block {
                Block::Figures(pictures) => Some(pictures),
                _ => None,
            })
            .flatten()
    }

    /// Adds a block.
    pub(crate) fn with(mut self, block: Block) -> Self {
        self.blocks.push(block);
        self
    }

    /// Adds blocks, where there are some.
    pub(crate) fn with_all(mut self, blocks: Option<Vec<Block>>) -> Self {
        self.blocks.extend(blocks.into_iter().flatten());
        self
    }

    /// Adds a table.
    #[must_use]
    pub fn table(self, table: Table) -> Self {
        self.with(Block::Table(table))
    }

    /// Adds figures, side by side where there is room; nothing where there are none.
    pub(crate) fn figures(self, figures: Vec<Picture>) -> Self {
        if figures.is_empty() {
            return self;
        }
        self.with(Block::Figures(figures))
    }

    /// Adds a list; nothing where it is empty.
    #[must_use]
    pub fn list(self, points: Vec<String>) -> Self {
        if points.is_empty() {
            return self;
        }
        self.with(Block::List(points))
    }

    /// Adds a heading inside the section.
    #[must_use]
    pub fn heading(self, heading: impl Into<String>) -> Self {
        self.with(Block::Heading(heading.into()))
    }

    /// Adds paragraphs, as many as there are.
    #[must_use]
    pub fn texts(mut self, texts: impl IntoIterator<Item = impl Into<String>>) -> Self {
        self.blocks.extend(texts.into_iter().map(|text| Block::Text(text.into())));
        self
    }

    /// Adds a paragraph.
    #[must_use]
    pub fn text(self, text: impl Into<String>) -> Self {
        self.with(Block::Text(text.into()))
    }

    /// Without a title its blocks stand side by side where there is room.
    fn to_html(&self, command: Option<&str>) -> Result<String, ReportError> {
        let title = escape(&self.title);
        let (begin, end) = match (self.folded, title.as_str()) {
            (true, _) => {
                (format!("<details>\n<summary><h2>{title}</h2></summary>\n"), "</details>\n")
            }
            (false, "") => ("<section class=\"beside\">\n".to_owned(), "</section>\n"),
            (false, _) => (format!("<section>\n<h2>{title}</h2>\n"), "</section>\n"),
        };
        let blocks = self.blocks.iter().map(|block| block.to_html(command));
        Ok(begin + &blocks.collect::<Result<String, _>>()? + end)
    }
}

/// A page.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Page {
    /// Title of the page and of the browser's tab.
    pub title: String,
    /// What the page says, in a few sentences with inline markup.
    pub lead: String,
    /// The command that makes its figures and tables again.
    pub command: Option<String>,
    /// Its sections.
    pub sections: Vec<Section>,
    /// What was run, with what and when, as pairs of name and value in the footer.
    pub provenance: Vec<(String, String)>,
}

impl Page {
    /// Every figure of the page.
    pub(crate) fn pictures(&self) -> impl Iterator<Item = &Picture> {
        self.sections.iter().flat_map(Section::pictures)
    }

    /// The page as one HTML text.
    ///
    /// # Errors
    /// [`ReportError`] where a figure cannot be drawn.
    pub(crate) fn to_html(&self) -> Result<String, ReportError> {
        let command = self.command.as_deref();
        let title = escape(&self.title);
        let mut html = format!(
            "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
             <title>{title}</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n<header>\n<h1>{title}</h1>\n\
             <p class=\"lead\">{}</p>\n",
            inline_markup(&self.lead)
        );
        html.push_str("</header>\n<main>\n");
        for section in &self.sections {
            html.push_str(&section.to_html(command)?);
        }
        html.push_str(
            "</main>\n<footer>\n<details>\n<summary><h2>Provenance</h2></summary>\n<dl>\n",
        );
        for (name, value) in &self.provenance {
            html.push_str(&format!("<dt>{}</dt><dd>{}</dd>\n", escape(name), inline_markup(value)));
        }
        html.push_str("</dl>\n</details>\n</footer>\n");
        if html.contains("class=\"hint\"") {
            html.push_str(&format!("<script>\n{SCRIPT}</script>\n"));
        }
        html.push_str("</body>\n</html>\n");
        Ok(html)
    }
}

impl Block {
    fn to_html(&self, command: Option<&str>) -> Result<String, ReportError> {
        Ok(match self {
            Self::Text(text) => format!("<p>{}</p>\n", inline_markup(text)),
            Self::Heading(text) => format!("<h3>{}</h3>\n", inline_markup(text)),
            Self::Remark(text) => format!("<p class=\"remark\">{}</p>\n", inline_markup(text)),
            Self::List(points) => {
                let items: String =
                    points.iter().map(|p| format!("<li>{}</li>\n", inline_markup(p))).collect();
                format!("<ul>\n{items}</ul>\n")
            }
            Self::Equations(lines) => {
                let lines: Vec<String> = lines.iter().map(|l| escape(l)).collect();
                format!("<pre class=\"equations\">{}</pre>\n", lines.join("\n"))
            }
            Self::Figures(pictures) => {
                let shared = draw::shared_entries(pictures.iter().filter_map(Picture::plot));
                let n = pictures.len();
                let mut html =
                    format!("<div class=\"figures of-{n}\">\n{}", draw::legend_to_html(&shared));
                for picture in pictures {
                    let own = picture.plot().map(|figure| draw::own_entries(figure, &shared));
                    html.push_str(&format!(
                        "<figure>\n{}<figcaption>{}{}{}</figcaption>\n</figure>\n",
                        picture.to_svg_without_legend()?,
                        draw::legend_to_html(&own.unwrap_or_default()),
                        inline_markup(&picture.caption),
                        made_by(command, Some(&picture.data))
                    ));
                }
                html + "</div>\n"
            }
            Self::Table(table) => table::to_html(table, command),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::{Axis, Dash, Figure, Look, Point, Series};
    use lennard_observables::{Cell, Tone};

    fn figure(note: Option<&str>) -> Picture {
        let point = Point { x: 1.0, y: 2.0, note: note.map(str::to_owned), ..Point::default() };
        let look = Look::LineAndPoints(Dash::Solid, crate::report::Symbol::Disc);
        let figure = Figure::new("f", "F", Axis::linear("x"), Axis::linear("y")).with(Series::new(
            "s",
            look,
            0,
            vec![point],
        ));
        Picture::new(figure, "c & d", "numbers.csv")
    }

    fn page() -> Page {
        Page {
            title: "A <b>title</b> & more".into(),
            lead: "x < y, **strongly**".into(),
            sections: vec![
                Section::new("One \"quoted\"")
                    .text("<script>alert(1)</script>")
                    .with(Block::Equations(vec!["x < 1".into()]))
                    .table(
                        Table::rows_of("t", &["<img src=x onerror=y>"])
                            .caption("Cap <i>tion</i>")
                            .column("a<b", |text| Cell::words(*text).toned(Tone::Bad))
                            .table(),
                    ),
                Section::new("Two").figures(vec![figure(None)]),
            ],
            command: Some("lennard study stability --out \"<dir>\"".into()),
            provenance: vec![("version<".into(), "`0.1`".into())],
        }
    }

    #[test]
    fn nothing_that_a_user_names_becomes_markup() {
        let html = page().to_html().unwrap();
        for evil in ["<script>", "<img", "<b>", "<i>", "<dir>", "version<"] {
            assert!(!html.contains(evil), "{evil}");
        }
        for text in [
            "&lt;script&gt;alert(1)&lt;/script&gt;",
            "A &lt;b&gt;title&lt;/b&gt; &amp; more",
            "<strong>strongly</strong>",
            "<td class=\"bad\">&lt;img src=x onerror=y&gt;</td>",
            "made by <code>lennard study stability --out &quot;&lt;dir&gt;&quot;</code>",
            "numbers: <a href=\"numbers.csv\"><code>numbers.csv</code></a>",
        ] {
            assert!(html.contains(text), "{text}");
        }
    }

    #[test]
    fn a_page_stands_alone_and_is_the_same_each_time() {
        let html = page().to_html().unwrap();
        assert_eq!(html, page().to_html().unwrap());
        for outside in ["src=\"", "href=\"http", "@import", "url("] {
            assert!(!html.contains(outside), "{outside}");
        }
        // The script is there where a point can be pointed at, and only there.
        let mut pointed = page();
        pointed.sections.push(Section::new("S").figures(vec![figure(Some("x"))]));
        assert_eq!(pointed.to_html().unwrap().matches("<script>").count(), 1);
        // Every tag that opens is closed.
        let tags = "section details summary figure table div main ul tr td figcaption";
        for tag in tags.split(' ') {
            assert_eq!(
                html.matches(&format!("<{tag}>")).count()
                    + html.matches(&format!("<{tag} ")).count(),
                html.matches(&format!("</{tag}>")).count(),
                "{tag}"
            );
        }
    }

    #[test]
    fn a_legend_stands_once_for_a_row_of_figures_and_a_folded_section_shows_its_heading_alone() {
        let line = |name: &str, color| {
            Series::new(name, Look::Line(Dash::Solid), color, [(1.0, 2.0), (2.0, 3.0)])
        };
        let of = |own: &str| {
            let figure = Figure::new("f", "F", Axis::linear("x"), Axis::linear("y"));
            let failing = line("both", 0).with_failures([(1.5, f64::NAN)]);
            Picture::new(figure.with(failing).with(line(own, 1)), "Caption.", "f.csv")
        };
        let section = Section::new("Row").figures(vec![of("left"), of("right")]);
        let html = Page { sections: vec![section.folded()], ..page() }.to_html().unwrap();
        for name in ["both", "left", "right", "failed: no value"] {
            assert_eq!(html.matches(&format!("</svg>{name}</li>")).count(), 1, "{name}");
        }
        let row = html.split("<div class=\"figures of-2\">").nth(1).unwrap();
        let (above, below) = row.split_once("<figure>").unwrap();
        assert!(above.contains("both") && above.contains("failed") && !above.contains("left"));
        assert!(below.contains("</svg>left") && !below.contains("</svg>both"));
        // A figure that is a file has its whole legend inside.
        assert!(of("left").to_svg().unwrap().contains(">both</text>"));
        assert!(html.contains("<details>\n<summary><h2>Row</h2></summary>\n<div class=\"figures"));
    }

    #[test]
    fn the_dark_page_has_each_shade_of_a_figure() {
        use crate::report::sheet::{FAINT_GRID, GREY, GRID, INK, TINT, hex};
        let (_, dark) = STYLE.split_once("prefers-color-scheme: dark").unwrap();
        for shade in
            [INK, GREY, GRID, FAINT_GRID, TINT, crate::report::COLORS[0], crate::report::COLORS[6]]
        {
            assert!(dark.contains(&hex(shade)), "{}", hex(shade));
        }
    }
}
