//! Text from user files made safe for the places it goes to: HTML text, HTML attributes, JSON in a script.

use std::fmt::Write as _;

/// For HTML text and for attribute values in double or single quotes. Control characters that HTML forbids
/// become U+FFFD; bidirectional overrides, which could make a name read as another, too.
pub fn html(text: &str) -> String {
    let mut out = String::with_capacity(text.len() + 16);
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            '\n' | '\t' => out.push(c),
            c if c.is_control() || is_bidi_control(c) => out.push('\u{fffd}'),
            c => out.push(c),
        }
    }
    out
}

/// A JSON string with its quotes that is also safe inside `<script>`: no `<`, `>`, `&`, U+2028, U+2029.
pub fn json_string(text: &str) -> String {
    let mut out = String::with_capacity(text.len() + 2);
    out.push('"');
    for c in text.chars() {
        match c {
            '"' => out.push_str("\\\""),
            '\\' => out.push_str("\\\\"),
            '\n' => out.push_str("\\n"),
            '<' | '>' | '&' | '\'' | '\u{2028}' | '\u{2029}' => {
                let _ = write!(out, "\\u{:04x}", u32::from(c));
            }
            c if c.is_control() || is_bidi_control(c) => out.push_str("\\ufffd"),
            c => out.push(c),
        }
    }
    out.push('"');
    out
}

/// A JSON number; null where the value is not finite.
pub fn json_number(value: f64) -> String {
    if value.is_finite() { format!("{value}") } else { "null".to_owned() }
}

fn is_bidi_control(c: char) -> bool {
    matches!(c, '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}' | '\u{200e}' | '\u{200f}')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn html_leaves_no_markup() {
        assert_eq!(html(r#"<b a="1" b='2'>&"#), "&lt;b a=&quot;1&quot; b=&#39;2&#39;&gt;&amp;");
        assert_eq!(html("骨盤 1.csv"), "骨盤 1.csv");
        assert_eq!(html("a\u{0}b\u{202e}c"), "a\u{fffd}b\u{fffd}c");
    }

    #[test]
    fn json_cannot_end_its_script() {
        let s = json_string("</script><!--\u{2028}\"\\\n\u{7}");
        assert_eq!(s, r#""\u003c/script\u003e\u003c!--\u2028\"\\\n\ufffd""#);
    }

    #[test]
    fn json_numbers_are_valid_json() {
        assert_eq!(json_number(0.1), "0.1");
        assert_eq!(json_number(1e21), "1000000000000000000000");
        assert_eq!(json_number(f64::NAN), "null");
        assert_eq!(json_number(f64::NEG_INFINITY), "null");
    }
}
