//! The files of a diagnosis.

use crate::diagnosis::Diagnosis;
use crate::error::Error;
use std::path::Path;

/// All files that a diagnosis may write: an earlier one's next experiment or inputs must not stand beside a new one's.
pub const FILES: [&str; 6] = [
    "diagnosis.json",
    "amended.toml",
    "report.html",
    "next_experiment.toml",
    crate::general::INPUTS,
    crate::general::INPUT_LINES,
];

impl Diagnosis {
    /// `diagnosis.json` as text.
    pub fn to_json(&self) -> String {
        // floats that are not finite become null; nothing else can fail here
        serde_json::to_string_pretty(self).unwrap_or_default()
    }

    /// Writes `diagnosis.json`, `amended.toml`, the next experiment's scenario if there is one, and `report.html`.
    ///
    /// # Errors
    /// The folder or a file can't be written.
    pub fn write(&self, folder: &Path) -> Result<(), Error> {
        let put = |name: &str, text: &str| {
            let path = folder.join(name);
            std::fs::write(&path, text).map_err(|source| Error::Io { path, source })
        };
        std::fs::create_dir_all(folder).map_err(|source| Error::Io { path: folder.to_owned(), source })?;
        put("diagnosis.json", &(self.to_json() + "\n"))?;
        put("amended.toml", &self.amended)?;
        self.attachments.iter().try_for_each(|(name, text)| put(name, text))?;
        if let Some(experiment) = &self.experiment {
            put("next_experiment.toml", experiment)?;
        }
        put("report.html", &crate::report_page::html(self)?)
    }
}
