//! APDM Mobility Lab: `Test Name:,…`, `Sample Rate:,128,Hz`, a header, a units row; many sensors a row.
//!
//! The rate makes the time where there is no time column; `--sensor` chooses the body part.

use super::{Dialect, preamble_with};

/// The dialect.
pub const DIALECT: Dialect = Dialect {
    id: "apdm",
    name: "APDM Mobility Lab",
    recognises: |s| preamble_with(s, "Test Name") && preamble_with(s, "Sample Rate"),
    mend: |_, _| {},
};
