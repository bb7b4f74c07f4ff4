//! Styles of the figures of `paper`.

use cohaul_report::chart::panel::Style;

pub const OURS: Style = Style { color: "#0072B2", dash: "", width: 1.6 };
pub const OTHER: Style = Style { color: "#E69F00", dash: "", width: 1.6 };
pub const PRINTED: Style = Style { color: "#D55E00", dash: "7 3", width: 1.6 };
