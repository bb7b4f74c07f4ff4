//! The engine under the verdict, by its name.

use std::borrow::Cow;

use serde::{Deserialize, Serialize};

use crate::backend::BackendKind;

/// What an engine is called in answers, figures and JSON.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct EngineName {
    pub name: Cow<'static, str>,
    /// As the engine states it; left out where it does not.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub version: Option<String>,
}

impl EngineName {
    /// Name, and version if there is one.
    pub fn text(&self) -> String {
        self.version.as_ref().map_or_else(|| self.name.to_string(), |version| format!("{} {version}", self.name))
    }

    /// Names of the two exact backends and of this engine.
    pub fn after_exact(&self) -> [&str; 3] {
        [BackendKind::QuasiStatic.name(), BackendKind::Inertial.name(), &self.name]
    }
}
