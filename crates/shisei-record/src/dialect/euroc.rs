//! EuRoC (ASL): `#timestamp [ns],w_RS_S_x [rad s^-1],…,a_RS_S_x [m s^-2],…`.

use super::{Dialect, names_with};

/// The dialect.
pub const DIALECT: Dialect = Dialect {
    id: "euroc",
    name: "EuRoC / ASL",
    recognises: |s| names_with(s, "w_RS_S_x") && names_with(s, "a_RS_S_x"),
    mend: |_, _| {},
};
