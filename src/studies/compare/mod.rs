//! The report of a comparison: its answer, JSON, text, files and page.

pub mod answer;
pub mod beside;
pub mod closed_loop;
pub mod comparison;
pub mod files;
pub mod page;
pub mod text;

use crate::backend::BackendKind;

/// The backends that a comparison runs, in the order of its traces.
const COMPARED: [BackendKind; 3] = [BackendKind::QuasiStatic, BackendKind::Inertial, BackendKind::Rapier];
