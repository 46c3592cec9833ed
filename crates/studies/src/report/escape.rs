//! Text into HTML and SVG.

/// Text as it may stand between tags and inside quoted attributes: `&`, `<`, `>`, `"` and `'` become
/// entities, and control characters that XML forbids are dropped.
#[must_use]
pub fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            '\n' | '\t' => out.push(c),
            c if c.is_control() => {}
            c => out.push(c),
        }
    }
    out
}

/// Whether a link leads to a page beside this one: a relative path of plain letters that ends with `.html`.
pub(crate) fn is_near(link: &str) -> bool {
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_./".contains(c);
    link.ends_with(".html") && !link.starts_with('/') && link.chars().all(plain)
}

/// Escaped text in which `` `code` ``, `**bold**` and `[words](NAME.html)` become tags, and each DOI a link.
///
/// A marker without its twin stays as it is. So does a link that leads elsewhere than to a page beside this one.
#[must_use]
pub fn inline_markup(text: &str) -> String {
    let with_links = with_links(text);
    with_links.unwrap_or_else(|| without_links(text))
}

/// The text with its first link as a tag; `None` where it has none.
fn with_links(text: &str) -> Option<String> {
    let (before, rest) = text.split_once('[')?;
    let (words, rest) = rest.split_once("](")?;
    let (target, after) = rest.split_once(')')?;
    is_near(target).then(|| {
        format!(
            "{}<a href=\"{}\">{}</a>{}",
            without_links(before),
            escape(target),
            escape(words),
            inline_markup(after)
        )
    })
}

fn without_links(text: &str) -> String {
    let coded = wrap_pairs(&escape(text), "`", "code");
    let marked = |text: &str| with_dois(&wrap_pairs(text, "**", "strong"));
    // Stars inside code are code.
    coded
        .split_inclusive("</code>")
        .map(|part| match part.split_once("<code>") {
            Some((before, code)) => format!("{}<code>{code}", marked(before)),
            None => marked(part),
        })
        .collect()
}

/// The text with a link for each DOI: `doi:10.1063/1.4945000` or `DOI 10.1063/1.4945000`.
fn with_dois(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(at) = rest.find("10.") {
        let (before, after) = rest.split_at(at);
        let end = after.find(|c: char| c.is_whitespace() || ";,<\"".contains(c));
        let (found, tail) = after.split_at(end.unwrap_or(after.len()));
        let name = found.trim_end_matches(['.', ')']);
        let is_doi = name.contains('/') && (before.ends_with("doi:") || before.ends_with("DOI "));
        out.push_str(before);
        if is_doi {
            let end = &found[name.len()..];
            out.push_str(&format!("<a href=\"https://doi.org/{name}\">{name}</a>{end}"));
        } else {
            out.push_str(found);
        }
        rest = tail;
    }
    out + rest
}

fn wrap_pairs(text: &str, marker: &str, tag: &str) -> String {
    let mut out = String::with_capacity(text.len());
    let mut rest = text;
    while let Some((before, after)) = rest.split_once(marker) {
        match after.split_once(marker) {
            Some((inside, tail)) if !inside.is_empty() => {
                out.push_str(&format!("{before}<{tag}>{inside}</{tag}>"));
                rest = tail;
            }
            _ => {
                out.push_str(before);
                out.push_str(marker);
                rest = after;
            }
        }
    }
    out + rest
}

/// The small print below figures and tables: where the numbers are and what made them.
pub(crate) fn made_by(command: Option<&str>, data: Option<&str>) -> String {
    let parts: Vec<String> = [
        data.map(|d| format!("numbers: <a href=\"{0}\"><code>{0}</code></a>", escape(d))),
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

    #[test]
    fn everything_that_could_open_a_tag_or_an_attribute_is_escaped() {
        assert_eq!(
            escape("<a href=\"x\" b='y'>&\u{0}\u{1b}</a>"),
            "&lt;a href=&quot;x&quot; b=&#39;y&#39;&gt;&amp;&lt;/a&gt;"
        );
    }

    #[test]
    fn markup_is_made_from_escaped_text() {
        assert_eq!(
            inline_markup("**bold** and `a < b ** c ** d` & **`x`**"),
            "<strong>bold</strong> and <code>a &lt; b ** c ** d</code> &amp; **<code>x</code>**"
        );
        assert_eq!(inline_markup("2 ** 3 and `open"), "2 ** 3 and `open");
        assert!(!inline_markup("`<script>`").contains("<script>"));
        assert_eq!(
            inline_markup("(doi:10.1063/1.4945000), 10.5 and `doi:10.1/x`"),
            "(doi:<a href=\"https://doi.org/10.1063/1.4945000\">10.1063/1.4945000</a>), 10.5 and <code>doi:10.1/x</code>"
        );
    }

    #[test]
    fn links_lead_to_pages_beside_the_page_alone() {
        assert_eq!(
            inline_markup("see [T0.7 <x>](T0.7/report.html) and [b](c.html)"),
            "see <a href=\"T0.7/report.html\">T0.7 &lt;x&gt;</a> and <a href=\"c.html\">b</a>"
        );
        for elsewhere in [
            "[x](javascript:alert(1).html)",
            "[x](https://a.html)",
            "[x](/etc/a.html)",
            "[x](a.svg)",
            "r [σ] (1)",
        ] {
            assert!(!inline_markup(elsewhere).contains("<a"), "{elsewhere}");
        }
    }
}
