//! The engine under the verdict, by its name.

use std::borrow::Cow;

use serde::Serialize;

use crate::backend::BackendKind;

/// What an engine is called in answers, figures and JSON.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct EngineName {
    pub name: Cow<'static, str>,
    /// As the engine states it; left out where it does not.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub version: Option<String>,
}

impl EngineName {
    /// Names of the two exact backends and of this engine.
    pub fn after_exact(&self) -> [&str; 3] {
        [BackendKind::QuasiStatic.name(), BackendKind::Inertial.name(), &self.name]
    }
}
