//! Saved states of an instance, and their bytes.

use crate::error::Error;
use crate::instance::Mode;
use orchestrator::{Checkpoint, Value};
use serde::{Deserialize, Serialize};
use sha2::{Digest as _, Sha256};
use std::collections::BTreeMap;

/// All that decides how an instance goes on.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct State {
    pub(crate) mode: Mode,
    pub(crate) time: f64,
    pub(crate) experiment: Option<(f64, Option<f64>)>,
    /// Set before the first step, by value reference.
    pub(crate) starts: BTreeMap<u32, Value>,
    /// The units, if they run.
    pub(crate) inside: Option<Checkpoint>,
}

/// Begins every state; the last byte counts versions of the layout.
const MAGIC: &[u8; 8] = b"acrocon\x01";
const DIGEST: usize = 32;

impl State {
    /// Magic, checksum of the rest, the rest: the GUID and the state.
    pub(crate) fn to_bytes(&self, guid: &str) -> Result<Vec<u8>, Error> {
        let content = postcard::to_stdvec(&(guid, self)).map_err(|error| Error::Bytes(error.to_string()))?;
        let mut bytes = MAGIC.to_vec();
        bytes.extend_from_slice(&Sha256::digest(&content));
        bytes.extend_from_slice(&(content.len() as u64).to_le_bytes());
        bytes.extend_from_slice(&content);
        Ok(bytes)
    }

    /// The state in bytes that [`State::to_bytes`] made. What follows is passed over: a master may hand over its whole
    /// buffer.
    pub(crate) fn from_bytes(bytes: &[u8], guid: &str) -> Result<Self, Error> {
        let wrong = |why: &str| Error::Bytes(why.to_owned());
        let rest = bytes.strip_prefix(MAGIC).ok_or_else(|| wrong("it was not written by a container"))?;
        let (sum, rest) = rest.split_at_checked(DIGEST).ok_or_else(|| wrong("it is cut off"))?;
        let (length, rest) = rest.split_first_chunk::<8>().ok_or_else(|| wrong("it is cut off"))?;
        let length = usize::try_from(u64::from_le_bytes(*length)).unwrap_or(usize::MAX);
        let content = rest.get(..length).ok_or_else(|| wrong("it is cut off"))?;
        if Sha256::digest(content).as_slice() != sum {
            return Err(wrong("its checksum does not match: it is damaged"));
        }
        let (of, state): (String, Self) =
            postcard::from_bytes(content).map_err(|error| Error::Bytes(error.to_string()))?;
        if of != guid {
            return Err(wrong("it belongs to another container"));
        }
        Ok(state)
    }
}
