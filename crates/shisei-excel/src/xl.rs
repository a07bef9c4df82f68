//! The part of Excel's C interface that an add-in of functions needs, from its published layout (64-bit).

#![allow(dead_code)] // the test host shares this file and needs the rest

#[cfg(windows)]
use std::ffi::c_void;

/// A rectangle of values.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct Array {
    pub cells: *mut Xloper12,
    pub rows: i32,
    pub columns: i32,
}

/// What [`Xloper12::kind`] says is meant. The largest member of Excel's union (a macro's flow) has 24 bytes.
#[repr(C)]
pub union Value {
    pub number: f64,
    /// Counted UTF-16: the first unit is the length.
    pub text: *mut u16,
    pub truth: i32,
    pub error: i32,
    pub integer: i32,
    pub array: Array,
    pub largest: [u64; 3],
}

/// Excel's value.
#[repr(C)]
pub struct Xloper12 {
    pub value: Value,
    pub xltype: u32,
}

const _: () = assert!(size_of::<Xloper12>() == 32);

pub const NUMBER: u32 = 1;
pub const TEXT: u32 = 2;
pub const TRUTH: u32 = 4;
pub const ERROR: u32 = 0x10;
pub const ARRAY: u32 = 0x40;
pub const MISSING: u32 = 0x80;
pub const BLANK: u32 = 0x100;
pub const INTEGER: u32 = 0x800;
/// Excel frees it after the call back.
pub const EXCEL_FREES: u32 = 0x1000;
/// Excel calls xlAutoFree12 for it.
pub const WE_FREE: u32 = 0x4000;

pub const ERROR_VALUE: i32 = 15;
pub const ERROR_NUM: i32 = 36;
pub const ERROR_NA: i32 = 42;

pub const XL_FREE: i32 = 0x4000;
pub const XL_GET_NAME: i32 = 0x4009;
pub const XLF_REGISTER: i32 = 149;

/// Excel's one entry for calls back.
pub type Entry = unsafe extern "system" fn(i32, i32, *const *mut Xloper12, *mut Xloper12) -> i32;

#[cfg(windows)]
unsafe extern "system" {
    fn GetModuleHandleW(name: *const u16) -> *mut c_void;
    fn GetProcAddress(module: *mut c_void, name: *const u8) -> *mut c_void;
    fn GetUserDefaultUILanguage() -> u16;
}

/// Excel's entry in this process; `None` where there is no Excel.
#[cfg(windows)]
pub fn entry() -> Option<Entry> {
    // SAFETY: both take a name that ends with zero; the symbol has the type of Entry by Excel's documentation
    unsafe {
        let found = GetProcAddress(GetModuleHandleW(std::ptr::null()), c"MdCallBack12".as_ptr().cast());
        (!found.is_null()).then(|| std::mem::transmute::<*mut c_void, Entry>(found))
    }
}

#[cfg(not(windows))]
pub fn entry() -> Option<Entry> {
    None
}

/// True when the user's Windows speaks Japanese; `SHISEI_LANG` overrides.
pub fn user_is_japanese() -> bool {
    if let Ok(lang) = std::env::var("SHISEI_LANG") {
        return lang.starts_with("ja");
    }
    #[cfg(windows)]
    // SAFETY: takes nothing
    return unsafe { GetUserDefaultUILanguage() } & 0x3ff == 0x11;
    #[cfg(not(windows))]
    false
}

/// Calls Excel. The result is Excel's own where it is text.
///
/// # Safety
/// `arguments` must be valid for the function `id` of Excel.
pub unsafe fn excel(id: i32, result: *mut Xloper12, arguments: &mut [Xloper12]) -> i32 {
    const FAILED: i32 = 32;
    let pointers: Vec<*mut Xloper12> = arguments.iter_mut().map(std::ptr::from_mut).collect();
    match entry() {
        // SAFETY: as of this function
        Some(entry) => unsafe { entry(id, pointers.len() as i32, pointers.as_ptr(), result) },
        None => FAILED,
    }
}

impl Xloper12 {
    pub fn kind(&self) -> u32 {
        self.xltype & 0xFFF
    }

    /// The number, where it is one.
    #[inline]
    pub fn as_number(&self) -> Option<f64> {
        if self.kind() == NUMBER {
            // SAFETY: the kind says that the number is meant
            Some(unsafe { self.value.number })
        } else {
            None
        }
    }

    pub fn blank() -> Self {
        Xloper12 { value: Value { integer: 0 }, xltype: BLANK }
    }

    pub fn missing() -> Self {
        Xloper12 { value: Value { integer: 0 }, xltype: MISSING }
    }

    pub fn error(code: i32) -> Self {
        Xloper12 { value: Value { error: code }, xltype: ERROR }
    }

    /// A number; NaN is #N/A and infinite #NUM!, for a cell can hold neither.
    #[inline]
    pub fn number(x: f64) -> Self {
        if x.is_finite() {
            Xloper12 { value: Value { number: x }, xltype: NUMBER }
        } else {
            Xloper12::error(if x.is_nan() { ERROR_NA } else { ERROR_NUM })
        }
    }

    pub fn truth(truth: bool) -> Self {
        Xloper12 { value: Value { truth: i32::from(truth) }, xltype: TRUTH }
    }

    /// Text of at most 32,767 units; freed by [`Xloper12::free`].
    pub fn text(text: &str) -> Self {
        let mut units: Vec<u16> = vec![0];
        units.extend(text.encode_utf16().take(32_767));
        units[0] = (units.len() - 1) as u16;
        Xloper12 { value: Value { text: Box::leak(units.into_boxed_slice()).as_mut_ptr() }, xltype: TEXT }
    }

    /// A rectangle; freed by [`Xloper12::free`].
    pub fn array(cells: Vec<Xloper12>, rows: usize, columns: usize) -> Self {
        debug_assert_eq!(cells.len(), rows * columns);
        let cells = Box::leak(cells.into_boxed_slice()).as_mut_ptr();
        let array = Array { cells, rows: rows as i32, columns: columns as i32 };
        Xloper12 { value: Value { array }, xltype: ARRAY }
    }

    /// The cells of a rectangle, or the value itself as one cell.
    ///
    /// # Safety
    /// The value must be as Excel or [`Xloper12::array`] made it.
    pub unsafe fn cells(&self) -> (&[Xloper12], usize, usize) {
        if self.kind() != ARRAY {
            return (std::slice::from_ref(self), 1, 1);
        }
        // SAFETY: the kind says that the array is meant
        let array = unsafe { self.value.array };
        let (rows, columns) = (array.rows.max(0) as usize, array.columns.max(0) as usize);
        if array.cells.is_null() {
            return (&[], 0, columns);
        }
        // SAFETY: as of this function
        (unsafe { std::slice::from_raw_parts(array.cells, rows * columns) }, rows, columns)
    }

    /// Frees what [`Xloper12::text`] and [`Xloper12::array`] made. The cells of our arrays hold no text: a million of
    /// them need not be looked at.
    ///
    /// # Safety
    /// The value must be one of ours and not be used again.
    pub unsafe fn free(&mut self) {
        // SAFETY: the kind says which member is meant; the lengths are those they were made with
        unsafe {
            match self.kind() {
                TEXT => {
                    let length = usize::from(*self.value.text) + 1;
                    drop(Box::from_raw(std::ptr::slice_from_raw_parts_mut(self.value.text, length)));
                }
                ARRAY => {
                    let array = self.value.array;
                    let n = (array.rows * array.columns) as usize;
                    drop(Box::from_raw(std::ptr::slice_from_raw_parts_mut(array.cells, n)));
                }
                _ => {}
            }
        }
        self.xltype = BLANK;
    }
}
