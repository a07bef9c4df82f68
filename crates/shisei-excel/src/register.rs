//! What Excel asks of an add-in: to register its functions, to free results, to name itself.

use crate::xl::{NUMBER, TEXT, Value, XL_FREE, XL_GET_NAME, XLF_REGISTER, Xloper12, excel, user_is_japanese};
use shisei_functions::{FUNCTIONS, Function, Lang, ReturnShape, last_error};
use std::panic::{AssertUnwindSafe, catch_unwind};

const CATEGORY: &str = "shisei";
/// Excel's limit for a text of a registration.
const MOST_UNITS: usize = 255;

/// Excel loads the add-in.
#[unsafe(no_mangle)]
pub extern "system" fn xlAutoOpen() -> i32 {
    let opened = catch_unwind(|| {
        let lang = if user_is_japanese() { Lang::Ja } else { Lang::En };
        last_error::set_user_lang(lang);
        let mut file = Xloper12::blank();
        // SAFETY: xlGetName takes no argument
        if unsafe { excel(XL_GET_NAME, &raw mut file, &mut []) } != 0 {
            return 0;
        }
        for function in &FUNCTIONS {
            register(&file, function, lang);
        }
        // SAFETY: Excel made the name and frees it
        unsafe { excel(XL_FREE, std::ptr::null_mut(), &mut [file]) };
        1
    });
    opened.unwrap_or(0)
}

fn register(file: &Xloper12, function: &Function, lang: Lang) {
    // SAFETY: the kind of a file's name is text; Excel reads it only
    let name_of_file = Xloper12 { value: Value { text: unsafe { file.value.text } }, xltype: TEXT };
    let mut given = vec![
        name_of_file,
        Xloper12::text(&format!("xl_{}", function.name)),
        Xloper12::text(&type_text(function)),
        Xloper12::text(function.name),
        Xloper12::text(&argument_names(function)),
        Xloper12 { value: Value { number: 1.0 }, xltype: NUMBER }, // a function, not a command
        Xloper12::text(CATEGORY),
        Xloper12::missing(), // shortcut
        Xloper12::missing(), // help topic
        Xloper12::text(&cut(function.doc.get(lang))),
    ];
    for (i, arg) in function.args.iter().enumerate() {
        given.push(Xloper12::text(&cut(&argument_help(arg, lang, i + 1 == function.args.len()))));
    }
    let mut id = Xloper12::blank();
    // SAFETY: the arguments are those of xlfRegister
    unsafe { excel(XLF_REGISTER, &raw mut id, &mut given) };
    for value in given.iter_mut().skip(1) {
        // SAFETY: ours, and Excel keeps no pointer
        unsafe { value.free() };
    }
}

/// XLOPER12 in and out, thread-safe; the latest error changes without its arguments: volatile.
fn type_text(function: &Function) -> String {
    let arguments = "Q".repeat(function.args.len());
    let latest_error = function.returns.shape == ReturnShape::Sentence && function.name == "ShiseiLastError";
    format!("Q{arguments}{}", if latest_error { "!" } else { "$" })
}

fn argument_names(function: &Function) -> String {
    let name =
        |a: &shisei_functions::Arg| if a.default.is_some() { format!("[{}]", a.name) } else { a.name.into() };
    function.args.iter().map(name).collect::<Vec<String>>().join(",")
}

fn argument_help(arg: &shisei_functions::Arg, lang: Lang, last: bool) -> String {
    let unit = if arg.unit.is_empty() { String::new() } else { format!(" [{}]", arg.unit) };
    let default = match (arg.default, lang) {
        (None, _) => String::new(),
        (Some(d), Lang::En) => format!("; {d} when left out"),
        (Some(d), Lang::Ja) => format!("。省略時 {d}"),
    };
    // Excel cuts the last help text by a character or two
    let padding = if last { ". " } else { "" };
    format!("{}: {}{unit}{default}{padding}", arg.label.get(lang), arg.doc.get(lang))
}

fn cut(text: &str) -> String {
    let units: Vec<u16> = text.encode_utf16().take(MOST_UNITS).collect();
    String::from_utf16_lossy(&units)
}

/// Excel unloads the add-in; it forgets the functions by itself.
#[unsafe(no_mangle)]
pub extern "system" fn xlAutoClose() -> i32 {
    1
}

/// The add-in manager adds the file.
#[unsafe(no_mangle)]
pub extern "system" fn xlAutoAdd() -> i32 {
    1
}

/// The add-in manager removes the file.
#[unsafe(no_mangle)]
pub extern "system" fn xlAutoRemove() -> i32 {
    1
}

/// Excel has read a result.
#[unsafe(no_mangle)]
pub unsafe extern "system" fn xlAutoFree12(result: *mut Xloper12) {
    let _ = catch_unwind(AssertUnwindSafe(|| {
        if !result.is_null() {
            // SAFETY: Excel hands back what `call` handed over, once
            unsafe { Box::from_raw(result).free() };
        }
    }));
}

/// The add-in manager asks for the name.
#[unsafe(no_mangle)]
pub unsafe extern "system" fn xlAddInManagerInfo12(_action: *const Xloper12) -> *mut Xloper12 {
    let mut name = Xloper12::text(&format!("shisei {}", shisei_functions::VERSION));
    name.xltype |= crate::xl::WE_FREE;
    Box::into_raw(Box::new(name))
}
