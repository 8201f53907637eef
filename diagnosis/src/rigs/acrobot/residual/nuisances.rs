//! Nuisances: start states, slack torques and poses, which belong to the logs and not to the machine. A value, which whoever searches
//! or fits keeps, hands in, and goes back to.

use super::image::ImageState;
use super::plant::WindowState;
use std::sync::Arc;

/// Where the nuisances of a cut are. Cheap to copy.
#[derive(Debug, Clone, Default)]
pub struct Nuisances {
    /// Start state and slack torques of each window; `None` where windows begin from the data.
    pub(super) windows: Option<Arc<Vec<WindowState>>>,
    /// Poses of all frames; `None` where poses are those of a log.
    pub(super) frames: Option<Arc<ImageState>>,
    /// Doubted windows were settled anew, and none got a better start: not worth another try on these logs.
    pub in_vain: bool,
}

impl Nuisances {
    /// Where the last linearisation had them, without the chord steps since.
    pub(super) fn linearised(&self) -> Self {
        let windows = self.windows.as_ref().map(|windows| {
            let back = windows.iter().map(WindowState::linearised).collect();
            Arc::new(back)
        });
        let frames = self.frames.as_ref().map(|frames| Arc::new(frames.linearised()));
        Self { windows, frames, in_vain: self.in_vain }
    }

    /// Windows begin from the data again; poses stay.
    pub(super) fn reset(&self) -> Self {
        Self { windows: None, ..self.clone() }
    }
}
