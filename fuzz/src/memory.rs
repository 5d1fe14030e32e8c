//! Counts the memory that is held, and the most that was.

use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

/// The system's allocator, counted. Whoever measures makes it the global one.
pub struct Counting;

static HELD: AtomicUsize = AtomicUsize::new(0);
static MOST: AtomicUsize = AtomicUsize::new(0);

/// Beyond this nothing is given, bytes, so that a reader that fills the memory ends its own process and no other.
const LIMIT: usize = 512 << 20;

/// Bytes held now; the most is counted from here.
pub fn begin() -> usize {
    let held = HELD.load(Relaxed);
    MOST.store(held, Relaxed);
    held
}

/// The most bytes held since [`begin`].
pub fn most() -> usize {
    MOST.load(Relaxed)
}

fn take(bytes: usize) -> bool {
    let held = HELD.fetch_add(bytes, Relaxed) + bytes;
    MOST.fetch_max(held, Relaxed);
    held <= LIMIT
}

fn give_back(bytes: usize) {
    HELD.fetch_sub(bytes, Relaxed);
}

// An allocator cannot be written without `unsafe`; each call goes to the system's with what it came with.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        let given = if take(layout.size()) { unsafe { System.alloc(layout) } } else { std::ptr::null_mut() };
        if given.is_null() {
            give_back(layout.size());
        }
        given
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        let given = if take(layout.size()) { unsafe { System.alloc_zeroed(layout) } } else { std::ptr::null_mut() };
        if given.is_null() {
            give_back(layout.size());
        }
        given
    }

    unsafe fn dealloc(&self, place: *mut u8, layout: Layout) {
        unsafe { System.dealloc(place, layout) };
        give_back(layout.size());
    }

    unsafe fn realloc(&self, place: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        // The old place may be held until the new one is filled: both count while it is done.
        let given = if take(size) { unsafe { System.realloc(place, layout, size) } } else { std::ptr::null_mut() };
        give_back(if given.is_null() { size } else { layout.size() });
        given
    }
}
