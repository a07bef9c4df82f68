//! What targets share.

use std::sync::Once;

/// Panics inside a decoder that is not ours are caught by the reader and are no finding; ours end the program.
pub fn only_ours_count() {
    static HOOK: Once = Once::new();
    HOOK.call_once(|| {
        std::panic::set_hook(Box::new(|info| {
            let ours = |file: &str| file.contains("shisei") || file.contains("fuzz_targets");
            if info.location().is_some_and(|location| ours(location.file())) {
                eprintln!("{info}");
                std::process::abort();
            }
        }));
    });
}
