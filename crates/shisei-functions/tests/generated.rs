//! Files made from the table. Each test repairs a stale file and then fails, so that a checkout that was not
//! regenerated does not pass, and running the tests once mends it.

#[path = "generated/c.rs"]
mod c;
#[path = "generated/calc.rs"]
mod calc;
#[path = "generated/docs.rs"]
mod docs;
#[path = "generated/examples.rs"]
mod examples;
#[path = "generated/excel.rs"]
mod excel;
#[path = "generated/javascript.rs"]
mod javascript;
#[path = "generated/python.rs"]
mod python;
#[path = "generated/vba.rs"]
mod vba;

use std::path::PathBuf;

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// Rewrites the file when it differs, and then fails.
fn ensure(path: &str, contents: &str) {
    let path = root().join(path);
    if std::fs::read_to_string(&path).unwrap_or_default() == contents {
        return;
    }
    if let Some(dir) = path.parent() {
        std::fs::create_dir_all(dir).unwrap();
    }
    std::fs::write(&path, contents).unwrap();
    panic!("{} was stale and is rewritten; commit it", path.display());
}

#[test]
fn c_header() {
    ensure("crates/shisei-capi/include/shisei.h", &c::header());
}

#[test]
fn c_exports() {
    ensure("crates/shisei-capi/src/exports.rs", &c::exports());
}

#[test]
fn vba_module() {
    ensure("crates/shisei-capi/vba/shisei.bas", &vba::module());
}

#[test]
fn examples_for_the_doors_that_are_not_rust() {
    ensure("fixtures/functions/examples.json", &examples::json());
}

#[test]
fn calc_interface() {
    ensure("apps/calc/idl/XShisei.idl", &calc::idl());
}

#[test]
fn calc_wizard_texts() {
    ensure("apps/calc/extension/CalcAddIn.xcu", &calc::xcu());
}

#[test]
fn calc_table() {
    ensure("apps/calc/extension/table.json", &calc::table());
}

#[test]
fn calc_description() {
    ensure("apps/calc/extension/description.xml", &calc::description());
}

#[test]
fn python_stubs() {
    ensure("crates/shisei-python/python/shisei/sheet.pyi", &python::stubs());
}

#[test]
fn javascript_types() {
    ensure("crates/shisei-wasm/npm/sheet.d.ts", &javascript::types());
}

#[test]
fn excel_exports() {
    ensure("crates/shisei-excel/src/exports.rs", &excel::exports());
}

#[test]
fn manual_in_english() {
    ensure("docs/en/functions.md", &docs::manual(shisei_functions::Lang::En));
}

#[test]
fn manual_in_japanese() {
    ensure("docs/ja/functions.md", &docs::manual(shisei_functions::Lang::Ja));
}
