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

/// Escaped text in which `` `code` `` and `**bold**` become tags; a marker without its twin stays as it is.
#[must_use]
pub fn inline_markup(text: &str) -> String {
    let coded = wrap_pairs(&escape(text), "`", "code");
    // Stars inside code are code.
    coded
        .split_inclusive("</code>")
        .map(|part| match part.split_once("<code>") {
            Some((before, code)) => format!("{}<code>{code}", wrap_pairs(before, "**", "strong")),
            None => wrap_pairs(part, "**", "strong"),
        })
        .collect()
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
    }
}
