//! Saved states: what `fmi2FMUstate` refers to, and their bytes.
//!
//! A handle is a number, not an address: a stale or foreign one is found out instead of followed. The states
//! lie in one table for the whole library, each owned by the instance that made it, which takes its own along
//! when it is freed.

use crate::error::Error;
use crate::instance::State;
use crate::model::Model;
use sha2::{Digest, Sha256};
use std::any::Any;
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

type Shared = Arc<Mutex<dyn Any + Send>>;

struct Entry {
    owner: usize,
    state: Shared,
}

static STATES: Mutex<BTreeMap<usize, Entry>> = Mutex::new(BTreeMap::new());

/// Handles grow by this much, so that they look like aligned addresses to a master that prints them.
const STRIDE: usize = 16;

/// The table is whole whenever the lock is free, so a panic elsewhere doesn't spoil it.
fn states() -> MutexGuard<'static, BTreeMap<usize, Entry>> {
    STATES.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Keeps a state for `owner`: under `handle` if that is not 0, which must then be known, else under a new one.
pub fn keep<M: Model>(owner: usize, handle: usize, state: State<M>) -> Result<usize, Error> {
    static NEXT: AtomicUsize = AtomicUsize::new(STRIDE);
    let state: Shared = Arc::new(Mutex::new(state));
    let mut states = states();
    if handle == 0 {
        let handle = NEXT.fetch_add(STRIDE, Ordering::Relaxed);
        states.insert(handle, Entry { owner, state });
        return Ok(handle);
    }
    let entry = states.get_mut(&handle).ok_or(Error::UnknownState(handle))?;
    let old = std::mem::replace(&mut entry.state, state);
    drop(states); // before a large state goes
    drop(old);
    Ok(handle)
}

/// Reads a state.
pub fn with<M: Model, T>(handle: usize, read: impl FnOnce(&State<M>) -> T) -> Result<T, Error> {
    let state =
        states().get(&handle).map(|entry| Arc::clone(&entry.state)).ok_or(Error::UnknownState(handle))?;
    let state = state.lock().unwrap_or_else(PoisonError::into_inner);
    state.downcast_ref::<State<M>>().map(read).ok_or(Error::UnknownState(handle))
}

/// Frees a state.
pub fn free(handle: usize) -> Result<(), Error> {
    let mut states = states();
    let entry = states.remove(&handle).ok_or(Error::UnknownState(handle))?;
    give_memory_back(&mut states);
    drop(states);
    drop(entry);
    Ok(())
}

/// Frees all states of an instance.
pub fn free_all(owner: usize) {
    let mut states = states();
    let mine: Vec<Entry> =
        states.extract_if(.., |_, entry| entry.owner == owner).map(|(_, entry)| entry).collect();
    give_memory_back(&mut states);
    drop(states);
    drop(mine);
}

/// An emptied map may keep a node; a library that is unloaded would lose it.
fn give_memory_back(states: &mut BTreeMap<usize, Entry>) {
    if states.is_empty() {
        *states = BTreeMap::new();
    }
}

/// First bytes of a serialised state; the last one counts versions of the layout.
const MAGIC: &[u8; 8] = b"fmi2exp\x01";
pub(crate) const GUID_LENGTH: usize = 38;
const DIGEST_LENGTH: usize = 32;
const HEADER_LENGTH: usize = MAGIC.len() + GUID_LENGTH + DIGEST_LENGTH + size_of::<u64>();

/// The bytes of a state: magic, GUID, SHA-256 of the rest, length of the rest, the rest.
pub fn to_bytes<M: Model>(state: &State<M>, guid: &str) -> Result<Vec<u8>, Error> {
    let content = postcard::to_stdvec(state).map_err(|error| Error::Serialise(error.to_string()))?;
    let mut bytes = Vec::with_capacity(HEADER_LENGTH + content.len());
    bytes.extend_from_slice(MAGIC);
    bytes.extend_from_slice(guid.as_bytes());
    bytes.extend_from_slice(&Sha256::digest(&content));
    bytes.extend_from_slice(&(content.len() as u64).to_le_bytes());
    bytes.extend_from_slice(&content);
    Ok(bytes)
}

/// The state in bytes that [`to_bytes`] made. What follows them is ignored, since a master may hand over its
/// whole buffer.
pub fn from_bytes<M: Model>(bytes: &[u8], guid: &str) -> Result<State<M>, Error> {
    let refused = |why| Err(Error::Bytes(why));
    let Some((magic, rest)) = bytes.split_first_chunk::<{ MAGIC.len() }>() else {
        return refused("too short");
    };
    let Some((of_guid, rest)) = rest.split_first_chunk::<GUID_LENGTH>() else { return refused("too short") };
    let Some((digest, rest)) = rest.split_first_chunk::<DIGEST_LENGTH>() else { return refused("too short") };
    let Some((length, rest)) = rest.split_first_chunk::<8>() else { return refused("too short") };
    if magic != MAGIC {
        return refused("not written by this version of fmi2-export");
    }
    if of_guid != guid.as_bytes() {
        return refused("written by another unit, or by another version of this one");
    }
    let length = usize::try_from(u64::from_le_bytes(*length)).unwrap_or(usize::MAX);
    let Some(content) = rest.get(..length) else { return refused("too short") };
    if Sha256::digest(content).as_slice() != digest {
        return refused("damaged: the checksum does not match");
    }
    postcard::from_bytes(content).or(Err(Error::Bytes("damaged: the content can't be read")))
}
