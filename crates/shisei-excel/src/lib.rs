//! shisei.xll: Excel's cells to arrays, the table, and back. No formula lives here.
//!
//! The file also exports the C names of `include/shisei.h`, from the same source as `shisei.dll`; what Excel
//! calls is `xl_` + name. On other systems than Windows this compiles and finds no Excel.
#![allow(unsafe_code)] // Excel's interface is C

#[path = "../../shisei-capi/src/abi.rs"]
mod abi;
#[path = "../../shisei-capi/src/exports.rs"]
#[rustfmt::skip]
mod c_exports;
mod call;
#[rustfmt::skip]
mod exports;
mod register;
mod xl;
