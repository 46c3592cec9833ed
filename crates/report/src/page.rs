//! A self-contained page: one HTML text with its style and its figures inside.

use crate::PageTable;
use crate::escape::{escape, inline_markup};

/// The style of every page.
const STYLE: &str = include_str!("page.css");
/// What lets points be pointed at, with a mouse or a finger; only on pages that have such points.
const SCRIPT: &str = include_str!("page.js");

/// A figure on a page.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct PageFigure {
    /// The SVG text, as [`crate::Figure::to_svg`] gives it.
    pub svg: String,
    /// What it shows, with inline markup.
    pub caption: String,
    /// The command that makes it again.
    pub command: Option<String>,
    /// Name of the file with the numbers.
    pub data: Option<String>,
}

/// A part of a section.
#[derive(Debug, Clone, PartialEq, Eq)]
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
    Figures(Vec<PageFigure>),
    /// A table.
    Table(PageTable),
}

/// A section with a heading.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Section {
    /// Heading.
    pub title: String,
    /// What stands in it.
    pub blocks: Vec<Block>,
}

impl Section {
    /// An empty section.
    #[must_use]
    pub fn new(title: impl Into<String>) -> Self {
        Self {
            title: title.into(),
            blocks: Vec::new(),
        }
    }

    /// Adds a block.
    #[must_use]
    pub fn with(mut self, block: Block) -> Self {
        self.blocks.push(block);
        self
    }

    /// Adds a paragraph.
    #[must_use]
    pub fn text(self, text: impl Into<String>) -> Self {
        self.with(Block::Text(text.into()))
    }
}

/// A page.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Page {
    /// Title of the page and of the browser's tab.
    pub title: String,
    /// What the page says, in a few sentences with inline markup.
    pub lead: String,
    /// Its sections.
    pub sections: Vec<Section>,
    /// What was run, with what and when, as pairs of name and value in the footer.
    pub provenance: Vec<(String, String)>,
}

impl Page {
    /// The page as one HTML text.
    #[must_use]
    pub fn to_html(&self) -> String {
        let title = escape(&self.title);
        let mut html = format!(
            "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
             <title>{title}</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n<header>\n<h1>{title}</h1>\n\
             <p class=\"lead\">{}</p>\n",
            inline_markup(&self.lead)
        );
        if self.sections.len() > 1 {
            html.push_str("<nav><ul>\n");
            for (i, section) in self.sections.iter().enumerate() {
                html.push_str(&format!(
                    "<li><a href=\"#section-{}\">{}</a></li>\n",
                    i + 1,
                    escape(&section.title)
                ));
            }
            html.push_str("</ul></nav>\n");
        }
        html.push_str("</header>\n<main>\n");
        for (i, section) in self.sections.iter().enumerate() {
            html.push_str(&format!(
                "<section id=\"section-{}\">\n<h2>{}</h2>\n",
                i + 1,
                escape(&section.title)
            ));
            for block in &section.blocks {
                html.push_str(&block.to_html());
            }
            html.push_str("</section>\n");
        }
        html.push_str("</main>\n<footer>\n<h2>Provenance</h2>\n<dl>\n");
        for (name, value) in &self.provenance {
            html.push_str(&format!(
                "<dt>{}</dt><dd>{}</dd>\n",
                escape(name),
                inline_markup(value)
            ));
        }
        html.push_str("</dl>\n</footer>\n");
        if html.contains("class=\"hint\"") {
            html.push_str(&format!("<script>\n{SCRIPT}</script>\n"));
        }
        html.push_str("</body>\n</html>\n");
        html
    }
}

impl Block {
    fn to_html(&self) -> String {
        match self {
            Self::Text(text) => format!("<p>{}</p>\n", inline_markup(text)),
            Self::Heading(text) => format!("<h3>{}</h3>\n", inline_markup(text)),
            Self::Remark(text) => format!("<p class=\"remark\">{}</p>\n", inline_markup(text)),
            Self::List(points) => {
                let items: String = points
                    .iter()
                    .map(|p| format!("<li>{}</li>\n", inline_markup(p)))
                    .collect();
                format!("<ul>\n{items}</ul>\n")
            }
            Self::Equations(lines) => {
                let lines: Vec<String> = lines.iter().map(|l| escape(l)).collect();
                format!("<pre class=\"equations\">{}</pre>\n", lines.join("\n"))
            }
            Self::Figures(figures) => {
                let mut html = String::from("<div class=\"figures\">\n");
                for figure in figures {
                    html.push_str("<figure>\n");
                    html.push_str(&figure.svg);
                    html.push_str("<figcaption>");
                    html.push_str(&inline_markup(&figure.caption));
                    html.push_str(&made_by(figure.command.as_deref(), figure.data.as_deref()));
                    html.push_str("</figcaption>\n</figure>\n");
                }
                html + "</div>\n"
            }
            Self::Table(table) => table.to_html(),
        }
    }
}

/// The small print below figures and tables: where the numbers are and what made them.
pub(crate) fn made_by(command: Option<&str>, data: Option<&str>) -> String {
    let parts: Vec<String> = [
        data.map(|d| format!("numbers: <code>{}</code>", escape(d))),
        command.map(|c| format!("made by <code>{}</code>", escape(c))),
    ]
    .into_iter()
    .flatten()
    .collect();
    if parts.is_empty() {
        String::new()
    } else {
        format!(" <span class=\"made\">{}</span>", parts.join("; "))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Cell, Tone};

    fn page() -> Page {
        Page {
            title: "A <b>title</b> & more".into(),
            lead: "x < y, **strongly**".into(),
            sections: vec![
                Section::new("One \"quoted\"")
                    .text("<script>alert(1)</script>")
                    .with(Block::Equations(vec!["x < 1".into()]))
                    .with(Block::Table(PageTable {
                        caption: "Cap <i>tion</i>".into(),
                        command: Some("lennard stability --out \"<dir>\"".into()),
                        header: vec!["a<b".into()],
                        rows: vec![vec![Cell::toned("<img src=x onerror=y>", Tone::Bad)]],
                    })),
                Section::new("Two").with(Block::Figures(vec![PageFigure {
                    svg: "<svg></svg>\n".into(),
                    caption: "c & d".into(),
                    command: None,
                    data: Some("numbers.csv".into()),
                }])),
            ],
            provenance: vec![("version<".into(), "`0.1`".into())],
        }
    }

    #[test]
    fn nothing_that_a_user_names_becomes_markup() {
        let html = page().to_html();
        for evil in ["<script>", "<img", "<b>", "<i>", "<dir>", "version<"] {
            assert!(!html.contains(evil), "{evil}");
        }
        for text in [
            "&lt;script&gt;alert(1)&lt;/script&gt;",
            "A &lt;b&gt;title&lt;/b&gt; &amp; more",
            "<strong>strongly</strong>",
            "<td class=\"bad\">&lt;img src=x onerror=y&gt;</td>",
            "made by <code>lennard stability --out &quot;&lt;dir&gt;&quot;</code>",
            "numbers: <code>numbers.csv</code>",
        ] {
            assert!(html.contains(text), "{text}");
        }
    }

    #[test]
    fn a_page_stands_alone_and_is_the_same_each_time() {
        let html = page().to_html();
        assert_eq!(html, page().to_html());
        for outside in ["src=\"", "href=\"http", "@import", "url("] {
            assert!(!html.contains(outside), "{outside}");
        }
        // The script is there where a point can be pointed at, and only there.
        let mut pointed = page();
        let hint = r#"<svg><circle class="hint"><title>x</title></circle></svg>"#;
        pointed
            .sections
            .push(Section::new("S").with(Block::Figures(vec![PageFigure {
                svg: hint.into(),
                ..PageFigure::default()
            }])));
        assert_eq!(pointed.to_html().matches("<script>").count(), 1);
        // Every tag that opens is closed.
        for tag in [
            "section",
            "figure",
            "table",
            "div",
            "main",
            "ul",
            "tr",
            "td",
            "figcaption",
        ] {
            assert_eq!(
                html.matches(&format!("<{tag}>")).count()
                    + html.matches(&format!("<{tag} ")).count(),
                html.matches(&format!("</{tag}>")).count(),
                "{tag}"
            );
        }
    }
}
