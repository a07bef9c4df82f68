//! The user's language: `--lang`, else the locale, else English.

use shisei_core::Lang;

/// Reads `--lang` straight from the arguments: help and usage errors need it before they are parsed.
pub fn choose(args: &[std::ffi::OsString]) -> Lang {
    let mut named = None;
    let mut args = args.iter().map(|a| a.to_string_lossy());
    while let Some(arg) = args.next() {
        if arg == "--" {
            break;
        }
        if arg == "--lang" {
            named = args.next().map(std::borrow::Cow::into_owned);
        } else if let Some(value) = arg.strip_prefix("--lang=") {
            named = Some(value.to_owned());
        }
    }
    from_name(&named.or_else(locale).unwrap_or_default())
}

/// The locale that decides about messages: POSIX's order of variables, else the system's own setting.
fn locale() -> Option<String> {
    ["LC_ALL", "LC_MESSAGES", "LANG"]
        .iter()
        .find_map(|name| std::env::var(name).ok().filter(|value| !value.is_empty()))
        .or_else(sys_locale::get_locale)
}

fn from_name(name: &str) -> Lang {
    let language = name.split(['_', '-', '.']).next().unwrap_or_default();
    if language.eq_ignore_ascii_case("ja") { Lang::Ja } else { Lang::En }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chosen(args: &[&str]) -> Lang {
        choose(&args.iter().map(std::ffi::OsString::from).collect::<Vec<_>>())
    }

    #[test]
    fn option_wins_in_both_spellings() {
        assert_eq!(chosen(&["shisei", "info", "--lang", "ja"]), Lang::Ja);
        assert_eq!(chosen(&["shisei", "--lang=ja", "info"]), Lang::Ja);
        assert_eq!(chosen(&["shisei", "--lang=en", "info"]), Lang::En);
    }

    #[test]
    fn locale_names_are_understood() {
        for (name, lang) in [
            ("ja_JP.UTF-8", Lang::Ja),
            ("ja", Lang::Ja),
            ("ja-JP", Lang::Ja),
            ("C", Lang::En),
            ("jam_JM", Lang::En),
            ("de_DE.UTF-8", Lang::En),
        ] {
            assert_eq!(from_name(name), lang, "{name}");
        }
    }
}
