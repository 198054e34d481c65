//! Handles: numbers of live objects in the form of pointers, which are never dereferenced.
//!
//! A handle is a key of one table and is never given twice. So a handle of a freed object, of
//! another kind, or of another library is found in every build, without undefined behavior.
//! Each object has a lock, so calls on one object from several threads run one after another.

use crate::status::{Error, Status};
use std::any::Any;
use std::collections::BTreeMap;
use std::ptr::without_provenance_mut;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError, RwLock};

/// An object behind a handle.
pub(crate) trait Object: Any + Send {
    /// The opaque type of the handle in the header.
    type Handle;
    /// Name in error texts.
    const NAME: &'static str;
}

/// A live object and its name.
struct Entry {
    name: &'static str,
    object: Arc<Mutex<dyn Any + Send>>,
}

static LIVE: RwLock<BTreeMap<usize, Entry>> = RwLock::new(BTreeMap::new());
static NEXT: AtomicUsize = AtomicUsize::new(1);

/// Stores an object and returns its handle.
pub(crate) fn insert<T: Object>(object: T) -> *mut T::Handle {
    let number = NEXT.fetch_add(1, Ordering::Relaxed);
    let object = Arc::new(Mutex::new(object));
    let entry = Entry {
        name: T::NAME,
        object,
    };
    let mut live = LIVE.write().unwrap_or_else(PoisonError::into_inner);
    live.insert(number, entry);
    without_provenance_mut(number)
}

/// Removes an object; NULL is nothing to remove.
///
/// A call on it that is running in another thread finishes first and keeps its memory until then.
pub(crate) fn remove<T: Object>(handle: *mut T::Handle) -> Result<(), Error> {
    if handle.is_null() {
        return Ok(());
    }
    find::<T>(handle)?;
    let mut live = LIVE.write().unwrap_or_else(PoisonError::into_inner);
    let entry = live.remove(&handle.addr());
    drop(live);
    entry.map(drop).ok_or_else(|| unknown::<T>(handle))
}

/// Runs `body` on an object.
pub(crate) fn with<T: Object, R>(
    handle: *mut T::Handle,
    body: impl FnOnce(&mut T) -> Result<R, Error>,
) -> Result<R, Error> {
    let object = find::<T>(handle)?;
    let mut object = object.lock().map_err(|_| {
        let text = format_args!("an earlier call on this {} failed inside; free it", T::NAME);
        Error::new(Status::Panic, text)
    })?;
    match object.downcast_mut::<T>() {
        Some(object) => body(object),
        None => Err(unknown::<T>(handle)),
    }
}

fn find<T: Object>(handle: *mut T::Handle) -> Result<Arc<Mutex<dyn Any + Send>>, Error> {
    if handle.is_null() {
        return Err(Error::null(&format!("the {}", T::NAME)));
    }
    let live = LIVE.read().unwrap_or_else(PoisonError::into_inner);
    match live.get(&handle.addr()) {
        Some(entry) if entry.name == T::NAME => Ok(entry.object.clone()),
        Some(entry) => Err(Error::new(
            Status::InvalidHandle,
            format_args!(
                "the handle is one of a {}, not of a {}",
                entry.name,
                T::NAME
            ),
        )),
        None => Err(unknown::<T>(handle)),
    }
}

fn unknown<T: Object>(handle: *mut T::Handle) -> Error {
    let number = handle.addr();
    let name = T::NAME;
    let text = format_args!("no {name} has the handle {number:#x}: it was freed or never made");
    Error::new(Status::InvalidHandle, text)
}

/// Returns the number of objects that are not freed yet, for tests of leaks.
#[unsafe(no_mangle)]
pub extern "C" fn incise_live_handles() -> usize {
    LIVE.read().unwrap_or_else(PoisonError::into_inner).len()
}

#[cfg(test)]
mod tests {
    use super::*;

    impl Object for u8 {
        type Handle = ();
        const NAME: &'static str = "byte";
    }

    impl Object for u16 {
        type Handle = ();
        const NAME: &'static str = "word";
    }

    #[test]
    fn freed_and_foreign_handles_are_found() {
        let byte = insert(7_u8);
        assert_eq!(with(byte, |value: &mut u8| Ok(*value)), Ok(7));
        let word = with(byte, |_: &mut u16| Ok(())).unwrap_err();
        assert_eq!(word.status, Status::InvalidHandle, "another kind");
        assert_eq!(
            remove::<u16>(byte).unwrap_err().status,
            Status::InvalidHandle
        );
        assert_eq!(remove::<u8>(byte), Ok(()));
        let freed = with(byte, |_: &mut u8| Ok(())).unwrap_err();
        assert_eq!(freed.status, Status::InvalidHandle, "freed");
        assert_eq!(
            remove::<u8>(byte).unwrap_err().status,
            Status::InvalidHandle
        );
        assert_ne!(insert(8_u8), byte, "no number is given twice");
    }

    #[test]
    fn an_object_whose_call_panicked_is_only_freed() {
        let byte = insert(7_u8);
        let status = crate::status::call(|| with(byte, |_: &mut u8| panic!("inside")));
        assert_eq!(status, Status::Panic);
        let later = with(byte, |_: &mut u8| Ok(())).unwrap_err();
        assert_eq!(later.status, Status::Panic);
        assert_eq!(remove::<u8>(byte), Ok(()));
    }
}
