//! Texts in Rust sources, with what they stand in.

use proc_macro2::{Delimiter, TokenStream, TokenTree};
use syn::LitStr;

/// A text and where it stands.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Found {
    /// In the code of a test.
    Test(String),
    /// Among the arguments of `name(…)` or `name!(…)`.
    Call {
        /// The last name before the bracket, with the one before it where there is a path (`Failure::new`).
        name: String,
        /// Line in the file, from 1.
        line: usize,
        /// The text.
        text: String,
    },
    /// In `#[error(…)]`.
    ErrorAttribute {
        /// Line in the file, from 1.
        line: usize,
        /// The text.
        text: String,
    },
}

/// All texts of a source file; `test` where the whole file is one.
pub fn in_source(source: &str, test: bool) -> Result<Vec<Found>, String> {
    let stream: TokenStream = source.parse().map_err(|e| format!("{e}"))?;
    let mut found = Vec::new();
    walk(stream, &[], test, &mut found);
    Ok(found)
}

/// `calls`: the calls around these tokens, from outside to inside.
fn walk(stream: TokenStream, calls: &[String], test: bool, found: &mut Vec<Found>) {
    let tokens: Vec<TokenTree> = stream.into_iter().collect();
    let mut next_block_is_test = false;
    for (i, token) in tokens.iter().enumerate() {
        match token {
            TokenTree::Literal(literal) => {
                let Ok(text) = syn::parse_str::<LitStr>(&literal.to_string()) else {
                    continue;
                };
                let (text, line) = (text.value(), literal.span().start().line);
                if test {
                    found.push(Found::Test(text));
                } else {
                    found.extend(calls.iter().map(|name| Found::Call {
                        name: name.clone(),
                        line,
                        text: text.clone(),
                    }));
                }
            }
            TokenTree::Group(group) if is_punct(i.checked_sub(1).map(|b| &tokens[b]), '#') => {
                let mut inside = group.stream().into_iter();
                let (name, rest) = (inside.next().map(|t| t.to_string()), inside.next());
                match (name.as_deref(), rest) {
                    (Some("error"), Some(TokenTree::Group(format))) => {
                        // The format alone: what follows it is code.
                        if let Some(TokenTree::Literal(literal)) =
                            format.stream().into_iter().next()
                            && let Ok(text) = syn::parse_str::<LitStr>(&literal.to_string())
                        {
                            let line = literal.span().start().line;
                            found.push(Found::ErrorAttribute { line, text: text.value() });
                        }
                    }
                    (Some("cfg"), Some(TokenTree::Group(condition)))
                        if condition.stream().to_string() == "test" =>
                    {
                        next_block_is_test = true;
                    }
                    _ => {}
                }
            }
            TokenTree::Group(group) => {
                let block = group.delimiter() == Delimiter::Brace;
                let in_test = test || block && next_block_is_test;
                if block {
                    next_block_is_test = false;
                }
                let mut around = calls.to_vec();
                if group.delimiter() == Delimiter::Parenthesis {
                    around.extend(name_before(&tokens[..i]));
                }
                walk(group.stream(), &around, in_test, found);
            }
            TokenTree::Punct(p) if p.as_char() == ';' => next_block_is_test = false,
            _ => {}
        }
    }
}

fn is_punct(token: Option<&TokenTree>, c: char) -> bool {
    matches!(token, Some(TokenTree::Punct(p)) if p.as_char() == c)
}

/// The name right before a bracket: `new` of a path gets the type before it.
fn name_before(tokens: &[TokenTree]) -> Option<String> {
    let end = match tokens.last()? {
        TokenTree::Punct(p) if p.as_char() == '!' => tokens.len() - 1,
        _ => tokens.len(),
    };
    let TokenTree::Ident(name) = tokens[..end].last()? else {
        return None;
    };
    let name = name.to_string();
    if name == "new"
        && let [.., TokenTree::Ident(of), TokenTree::Punct(_), TokenTree::Punct(_), _] =
            &tokens[..end]
    {
        return Some(format!("{of}::new"));
    }
    Some(name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_are_found_with_the_call_the_attribute_or_the_test_around_them() {
        let source = r##"
            /// A "doc" comment.
            #[error("bad {found}", found = "code".len())]
            struct A;
            fn f() -> Failure { Failure::new("doing", format!("it {}", 1), 2) }
            #[cfg(test)]
            mod tests { fn t() { assert!(x.contains(r#"a "raw" one"#)); } }
            fn g() { misfit("entry", "too long") }
        "##;
        let found = in_source(source, false).unwrap();
        let call = |name: &str, text: &str, line| Found::Call {
            name: name.into(),
            line,
            text: text.into(),
        };
        for wanted in [
            Found::ErrorAttribute { line: 3, text: "bad {found}".into() },
            call("Failure::new", "doing", 5),
            call("Failure::new", "it {}", 5),
            call("format", "it {}", 5),
            call("misfit", "too long", 8),
            Found::Test("a \"raw\" one".into()),
        ] {
            assert!(found.contains(&wanted), "{wanted:?} in {found:?}");
        }
        let words = |f: &Found| format!("{f:?}");
        assert!(!found.iter().any(|f| words(f).contains("code") || words(f).contains("doc")));
        assert_eq!(in_source("fn t() { a(\"b\") }", true).unwrap(), [Found::Test("b".into())]);
    }
}
