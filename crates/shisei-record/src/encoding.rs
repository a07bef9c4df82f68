//! From bytes to text: byte-order marks, UTF-16, Shift_JIS (CP932), Windows-1252.
//!
//! The table's body is never decoded: digits and separators are ASCII in every encoding here, so only
//! UTF-16 is converted whole; header cells are decoded one by one.

use std::borrow::Cow;

/// How text cells are decoded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Encoding {
    /// UTF-8 (or plain ASCII).
    Utf8,
    /// UTF-8 with a byte-order mark.
    Utf8Bom,
    /// UTF-16 with a byte-order mark or with every other byte zero.
    Utf16,
    /// Shift_JIS as Windows writes it (CP932).
    ShiftJis,
    /// Windows-1252 (Latin-1).
    Windows1252,
}

impl Encoding {
    /// The encoding's name.
    pub fn name(self) -> &'static str {
        match self {
            Encoding::Utf8 => "UTF-8",
            Encoding::Utf8Bom => "UTF-8 with BOM",
            Encoding::Utf16 => "UTF-16",
            Encoding::ShiftJis => "Shift_JIS (CP932)",
            Encoding::Windows1252 => "Windows-1252",
        }
    }

    /// Decodes a piece of the text.
    pub(crate) fn decode(self, bytes: &[u8]) -> Cow<'_, str> {
        match self {
            Encoding::ShiftJis => encoding_rs::SHIFT_JIS.decode_without_bom_handling(bytes).0,
            Encoding::Windows1252 => encoding_rs::WINDOWS_1252.decode_without_bom_handling(bytes).0,
            _ => String::from_utf8_lossy(bytes),
        }
    }
}

/// Finds the encoding; gives the text without its byte-order mark (converted where it was UTF-16).
pub(crate) fn detect(bytes: &[u8]) -> (Encoding, Cow<'_, [u8]>) {
    if let Some(rest) = bytes.strip_prefix(b"\xEF\xBB\xBF") {
        return (Encoding::Utf8Bom, Cow::Borrowed(rest));
    }
    let head = bytes.get(..bytes.len().min(64)).unwrap_or(bytes);
    let zeros = |odd: usize| head.iter().skip(odd).step_by(2).filter(|b| **b == 0).count();
    let many = head.len() / 2;
    let utf16 = if bytes.starts_with(b"\xFF\xFE") || (head.len() >= 8 && zeros(1) == many && zeros(0) == 0) {
        Some(encoding_rs::UTF_16LE)
    } else if bytes.starts_with(b"\xFE\xFF") || (head.len() >= 8 && zeros(0) >= many && zeros(1) == 0) {
        Some(encoding_rs::UTF_16BE)
    } else {
        None
    };
    if let Some(encoding) = utf16 {
        let (text, _) = encoding.decode_with_bom_removal(bytes);
        return (Encoding::Utf16, Cow::Owned(text.into_owned().into_bytes()));
    }
    if ends_lines_with_cr(bytes) {
        let lines: Vec<u8> = bytes.iter().map(|b| if *b == b'\r' { b'\n' } else { *b }).collect();
        return (kind(&lines), Cow::Owned(lines));
    }
    let mut head = bytes.get(..bytes.len().min(1 << 16)).unwrap_or(bytes);
    if head.len() < bytes.len() {
        // Cut at a line end, so that no character is cut in two.
        head = memchr::memrchr(b'\n', head).and_then(|end| head.get(..end)).unwrap_or(head);
    }
    (kind(head), Cow::Borrowed(bytes))
}

/// True for a text whose lines end as on an old Macintosh ("CSV (Macintosh)" of Excel).
pub(crate) fn ends_lines_with_cr(bytes: &[u8]) -> bool {
    let head = bytes.get(..bytes.len().min(1 << 16)).unwrap_or(bytes);
    memchr::memchr(b'\n', head).is_none() && memchr::memchr(b'\r', head).is_some()
}

fn kind(head: &[u8]) -> Encoding {
    match std::str::from_utf8(head) {
        Ok(_) => return Encoding::Utf8,
        Err(error) if error.error_len().is_none() => return Encoding::Utf8,
        Err(_) => {}
    }
    // Signs that stand alone in Latin-1 (degree, superscripts, micro) are half-width kana in Shift_JIS.
    let mut lone = true;
    let mut previous_high = false;
    for byte in head {
        let high = *byte >= 0x80;
        if high
            && (previous_high
                || !matches!(
                    byte,
                    0xA0 | 0xA9 | 0xAE | 0xB0 | 0xB1 | 0xB2 | 0xB3 | 0xB5 | 0xB7 | 0xB9 | 0xBA | 0xD7
                ))
        {
            lone = false;
            break;
        }
        previous_high = high;
    }
    if lone {
        return Encoding::Windows1252;
    }
    if encoding_rs::SHIFT_JIS.decode_without_bom_handling_and_without_replacement(head).is_some() {
        Encoding::ShiftJis
    } else {
        Encoding::Windows1252
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(bytes: &[u8], encoding: Encoding, text: &str) {
        let (found, body) = detect(bytes);
        assert_eq!(found, encoding);
        assert_eq!(found.decode(&body), text);
    }

    #[test]
    fn encodings() {
        check(b"Ax[m/s2]", Encoding::Utf8, "Ax[m/s2]");
        check("\u{feff}Ax[m/s²]".as_bytes(), Encoding::Utf8Bom, "Ax[m/s²]");
        check(b"\x8e\x9e\x8d\x8f,Ax", Encoding::ShiftJis, "時刻,Ax");
        check(b"X (m/s\xb2),w (\xb0/s)", Encoding::Windows1252, "X (m/s²),w (°/s)");
        check(b"\xff\xfeA\0x\0,\0", Encoding::Utf16, "Ax,");
        check(b"A\0x\0,\0b\0c\0", Encoding::Utf16, "Ax,bc");
        check(b"Ax,Ay\r1,2\r", Encoding::Utf8, "Ax,Ay\n1,2\n");
    }
}
