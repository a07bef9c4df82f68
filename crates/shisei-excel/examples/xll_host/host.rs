//! Excel's side of the interface.

use crate::xl::{
    ARRAY, BLANK, ERROR, EXCEL_FREES, MISSING, NUMBER, TEXT, TRUTH, WE_FREE, XL_FREE, XL_GET_NAME,
    XLF_REGISTER, Xloper12,
};
use std::collections::HashMap;
use std::ffi::{CString, c_void};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

unsafe extern "system" {
    fn LoadLibraryW(name: *const u16) -> *mut c_void;
    fn FreeLibrary(module: *mut c_void) -> i32;
    fn GetProcAddress(module: *mut c_void, name: *const u8) -> *mut c_void;
}

/// One registration, as text; numbers are written out.
pub type Registration = Vec<String>;

static REGISTERED: Mutex<Vec<Registration>> = Mutex::new(Vec::new());
static FILE: Mutex<String> = Mutex::new(String::new());
static FREED_BY_EXCEL: AtomicUsize = AtomicUsize::new(0);

/// Excel's entry for calls back.
#[unsafe(no_mangle)]
pub unsafe extern "system" fn MdCallBack12(
    id: i32,
    n: i32,
    args: *const *mut Xloper12,
    result: *mut Xloper12,
) -> i32 {
    const UNKNOWN: i32 = 2;
    let arguments = (0..n as usize).map(|i| unsafe { *args.add(i) });
    match id {
        XL_GET_NAME => unsafe {
            *result = Xloper12::text(&FILE.lock().unwrap());
            (*result).xltype |= EXCEL_FREES;
        },
        XLF_REGISTER => {
            let texts = arguments.map(|a| unsafe { show(&*a) }).collect();
            let mut all = REGISTERED.lock().unwrap();
            all.push(texts);
            unsafe { *result = Xloper12::number(all.len() as f64) };
        }
        XL_FREE => arguments.for_each(|a| {
            unsafe { (*a).free() };
            FREED_BY_EXCEL.fetch_add(1, Ordering::Relaxed);
        }),
        _ => return UNKNOWN,
    }
    0
}

/// A value in words.
pub fn show(x: &Xloper12) -> String {
    unsafe {
        match x.kind() {
            TEXT => {
                let n = usize::from(*x.value.text);
                String::from_utf16_lossy(std::slice::from_raw_parts(x.value.text.add(1), n))
            }
            NUMBER => x.value.number.to_string(),
            TRUTH => (x.value.truth != 0).to_string(),
            ERROR => format!("#{}", x.value.error),
            ARRAY => format!("{}x{}", x.value.array.rows, x.value.array.columns),
            MISSING => "missing".into(),
            BLANK => "blank".into(),
            other => format!("type {other:x}"),
        }
    }
}

type P = *const Xloper12;
type R = *mut Xloper12;

/// A loaded XLL.
pub struct Xll {
    module: usize,
    functions: HashMap<String, usize>,
    free: unsafe extern "system" fn(R),
    pub registrations: Vec<Registration>,
}

impl Xll {
    pub fn load(path: &str) -> Result<Self, String> {
        path.clone_into(&mut FILE.lock().unwrap());
        let wide: Vec<u16> = path.encode_utf16().chain([0]).collect();
        let module = unsafe { LoadLibraryW(wide.as_ptr()) };
        if module.is_null() {
            return Err(format!("{path} does not load"));
        }
        let find = |name: &str| symbol(module as usize, name).ok_or(format!("{name} is not exported"));
        let open: extern "system" fn() -> i32 = unsafe { std::mem::transmute(find("xlAutoOpen")?) };
        if open() != 1 {
            return Err("xlAutoOpen failed".into());
        }
        let free =
            unsafe { std::mem::transmute::<usize, unsafe extern "system" fn(R)>(find("xlAutoFree12")?) };
        let registrations = std::mem::take(&mut *REGISTERED.lock().unwrap());
        let mut functions = HashMap::new();
        for r in &registrations {
            functions.insert(r[3].clone(), find(&r[1])?);
        }
        if FREED_BY_EXCEL.load(Ordering::Relaxed) != 1 {
            return Err("the name of the file was not freed".into());
        }
        Ok(Xll { module: module as usize, functions, free, registrations })
    }

    pub fn exports(&self, name: &str) -> bool {
        symbol(self.module, name).is_some()
    }

    /// Calls a registered function with all its arguments and reads the result while it lives.
    pub fn call<T>(&self, name: &str, a: &[&Xloper12], read: impl FnOnce(&Xloper12) -> T) -> T {
        let p: Vec<P> = a.iter().map(|x| std::ptr::from_ref(*x)).collect();
        let result = unsafe { invoke(self.functions[name], &p) };
        assert!(!result.is_null(), "{name} returned nothing");
        assert!(unsafe { (*result).xltype } & WE_FREE != 0, "{name}: xlAutoFree12 would not be called");
        let value = read(unsafe { &*result });
        unsafe { (self.free)(result) };
        value
    }

    pub fn unload(self) -> bool {
        let close = symbol(self.module, "xlAutoClose");
        let closed = close.is_some_and(|f| {
            let close: extern "system" fn() -> i32 = unsafe { std::mem::transmute(f) };
            close() == 1
        });
        closed && unsafe { FreeLibrary(self.module as *mut c_void) } != 0
    }
}

fn symbol(module: usize, name: &str) -> Option<usize> {
    let name = CString::new(name).ok()?;
    let found = unsafe { GetProcAddress(module as *mut c_void, name.as_ptr().cast()) };
    (!found.is_null()).then_some(found as usize)
}

/// On 64-bit Windows the caller clears the arguments, so more pointers than the function takes do no harm.
unsafe fn invoke(function: usize, p: &[P]) -> R {
    type Most = unsafe extern "system" fn(P, P, P, P, P, P, P, P, P, P, P, P, P, P) -> R;
    let at = |i: usize| p.get(i).copied().unwrap_or(std::ptr::null());
    unsafe {
        let f = std::mem::transmute::<usize, Most>(function);
        f(
            at(0),
            at(1),
            at(2),
            at(3),
            at(4),
            at(5),
            at(6),
            at(7),
            at(8),
            at(9),
            at(10),
            at(11),
            at(12),
            at(13),
        )
    }
}
