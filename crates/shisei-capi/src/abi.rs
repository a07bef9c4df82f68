//! What every exported symbol does.

use shisei_functions::{Error, FUNCTIONS, Function, Input, Kind, Lang, Output, Range, last_error};
use std::ffi::{CStr, c_char};
use std::panic::{AssertUnwindSafe, catch_unwind};

const SHAPE: i32 = -1;
const DOMAIN: i32 = -2;
const CONDITION: i32 = -3;
const OUT_TOO_SMALL: i32 = -4;
const INTERNAL: i32 = -5;

/// The most arguments a function of the table takes.
const MAX_ARGS: usize = 16;

/// An argument as C passes it.
#[derive(Clone, Copy)]
pub enum Raw {
    Number(f64),
    Range(*const f64, i32, i32),
}

/// Calls function `index` of the table.
///
/// # Safety
/// Each range's pointer must be readable for rows × cols doubles, `out` writable for `out_len`.
pub unsafe fn call(index: usize, raw: &[Raw], out: *mut f64, out_len: i32) -> i32 {
    let Some(function) = FUNCTIONS.get(index) else { return INTERNAL };
    // SAFETY: as of this function
    let result = catch_unwind(AssertUnwindSafe(|| unsafe { run(function, raw, out, out_len) }));
    let error = match result {
        Ok(Ok(written)) => return written,
        Ok(Err(error)) => error,
        Err(_) => Error::Internal,
    };
    // recording takes a lock and formats nothing: it cannot unwind
    last_error::record(function.name, error);
    code(error)
}

fn code(error: Error) -> i32 {
    match error.kind() {
        Some(Kind::Shape) => SHAPE,
        Some(Kind::Domain) => DOMAIN,
        Some(Kind::Condition) => CONDITION,
        None if matches!(error, Error::OutTooSmall { .. }) => OUT_TOO_SMALL,
        None => INTERNAL,
    }
}

unsafe fn run(function: &Function, raw: &[Raw], out: *mut f64, out_len: i32) -> Result<i32, Error> {
    let mut inputs = [Input::Missing; MAX_ARGS];
    let inputs = inputs.get_mut(..raw.len()).ok_or(Error::Internal)?;
    for ((slot, raw), arg) in inputs.iter_mut().zip(raw).zip(function.args) {
        *slot = match *raw {
            Raw::Number(x) if x.is_nan() && arg.default.is_some() => Input::Missing,
            Raw::Number(x) => Input::Number(x),
            // SAFETY: as of this function
            Raw::Range(data, rows, cols) => unsafe { borrow(data, rows, cols) },
        };
    }
    let output = function.call(inputs)?;
    // SAFETY: as of this function
    unsafe { write(&output, out, out_len) }
}

unsafe fn borrow<'a>(data: *const f64, rows: i32, cols: i32) -> Input<'a> {
    let (rows, cols) = (usize::try_from(rows).unwrap_or(0), usize::try_from(cols).unwrap_or(0));
    let n = rows.saturating_mul(cols);
    if n == 0 || n > isize::MAX as usize / size_of::<f64>() {
        return Range::new(&[], 0, cols).map_or(Input::Missing, Input::Range);
    }
    if data.is_null() || !data.is_aligned() {
        return Input::Missing;
    }
    // SAFETY: not null, aligned, readable for n doubles by the caller's word
    let data = unsafe { std::slice::from_raw_parts(data, n) };
    Range::new(data, rows, cols).map_or(Input::Missing, Input::Range)
}

unsafe fn write(output: &Output, out: *mut f64, out_len: i32) -> Result<i32, Error> {
    let numbers = output.numbers()?;
    let given = if out.is_null() { 0 } else { usize::try_from(out_len).unwrap_or(0) };
    if given < numbers.len() {
        return Err(Error::OutTooSmall { needed: numbers.len(), given });
    }
    // SAFETY: `out` is writable for at least that many doubles by the caller's word; copied as bytes, so that
    // its alignment does not matter
    unsafe {
        std::ptr::copy_nonoverlapping(numbers.as_ptr().cast::<u8>(), out.cast::<u8>(), size_of_val(numbers));
    }
    i32::try_from(numbers.len()).map_err(|_| Error::Internal)
}

/// The sentence behind the calling thread's latest error.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn shisei_last_error(utf8: *mut c_char, len: i32, lang: *const c_char) -> i32 {
    let text = catch_unwind(|| {
        // SAFETY: NULL or a C string by the caller's word
        let lang = if lang.is_null() { c"en" } else { unsafe { CStr::from_ptr(lang) } };
        last_error::of_thread(if lang.to_bytes().starts_with(b"ja") { Lang::Ja } else { Lang::En })
    });
    // SAFETY: `utf8` is writable for `len` bytes by the caller's word
    text.map_or(INTERNAL, |text| unsafe { copy_text(&text, utf8, len) })
}

/// The version.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn shisei_version(utf8: *mut c_char, len: i32) -> i32 {
    // SAFETY: `utf8` is writable for `len` bytes by the caller's word
    unsafe { copy_text(shisei_functions::VERSION, utf8, len) }
}

unsafe fn copy_text(text: &str, utf8: *mut c_char, len: i32) -> i32 {
    let room = usize::try_from(len).unwrap_or(0);
    if !utf8.is_null() && room > 0 {
        let mut end = text.len().min(room - 1);
        while !text.is_char_boundary(end) {
            end -= 1;
        }
        // SAFETY: end < room, so the text and its NUL fit
        unsafe {
            std::ptr::copy_nonoverlapping(text.as_ptr(), utf8.cast::<u8>(), end);
            utf8.add(end).write(0);
        }
    }
    i32::try_from(text.len()).unwrap_or(i32::MAX)
}
