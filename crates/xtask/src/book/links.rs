//! Links of a document as links of the book.

use std::path::Path;

use super::page::{Page, plain};

/// The text of a page with links to other pages of the book. A link to a file that is no page becomes the text alone.
pub fn in_book(text: &str, page: &Page, pages: &[Page]) -> String {
    let mut out = String::new();
    let mut is_fenced = false;
    for line in text.split_inclusive('\n') {
        is_fenced ^= line.trim_start().starts_with("```");
        if is_fenced {
            out.push_str(line);
        } else {
            out.push_str(&in_line(line, page, pages));
        }
    }
    out
}

fn in_line(line: &str, page: &Page, pages: &[Page]) -> String {
    let mut out = String::new();
    let mut rest = line;
    while let Some(middle) = rest.find("](") {
        let Some(length) = rest[middle + 2..].find(')') else {
            break;
        };
        let target = &rest[middle + 2..middle + 2 + length];
        let before = &rest[..middle];
        match (book_target(target, page, pages), before.rfind('[')) {
            (Some(target), _) => out.push_str(&format!("{before}]({target})")),
            (None, Some(open)) => {
                out.push_str(&format!("{}{}", &before[..open], &before[open + 1..]))
            }
            (None, None) => out.push_str(&rest[..middle + 3 + length]),
        }
        rest = &rest[middle + 3 + length..];
    }
    out + rest
}

/// Where a link goes in the book; `None` where the book has no such page.
fn book_target(target: &str, page: &Page, pages: &[Page]) -> Option<String> {
    if target.contains("://") || target.starts_with('#') {
        return Some(target.to_owned());
    }
    let (path, anchor) = target
        .split_once('#')
        .map_or((target, String::new()), |(path, anchor)| (path, format!("#{anchor}")));
    let folder = Path::new(&page.source).parent().unwrap_or(Path::new(""));
    let source = plain(&folder.join(path)).to_string_lossy().replace('\\', "/");
    let there = pages.iter().find(|p| p.source == source)?.target.as_str();
    let up = "../".repeat(page.target.matches('/').count());
    Some(format!("{up}{there}{anchor}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn links_lead_to_pages_of_the_book_and_others_become_text() {
        let page =
            |source: &str, target: &str| Page { source: source.into(), target: target.into() };
        let pages = [
            page("docs/speed.md", "speed.md"),
            page("docs/tutorials/first.md", "tutorials/first.md"),
            page("inputs/README.md", "scenes.md"),
            page("README.md", "index.md"),
        ];
        for (at, text, wanted) in [
            (0, "[a](tutorials/first.md#x) b", "[a](tutorials/first.md#x) b"),
            (
                1,
                "[a](../speed.md), [b](../../inputs/README.md)",
                "[a](../speed.md), [b](../scenes.md)",
            ),
            (2, "([s](../docs/speed.md))", "([s](speed.md))"),
            (
                0,
                "the [crate](../crates/core) and [web](https://a.org)",
                "the crate and [web](https://a.org)",
            ),
            (0, "[home](../README.md)", "[home](index.md)"),
            (0, "```\n[a](../crates)\n```\n", "```\n[a](../crates)\n```\n"),
        ] {
            assert_eq!(in_book(text, &pages[at], &pages), wanted);
        }
    }
}
