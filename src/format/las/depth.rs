//! Unpacking on a stack of its own, which a damaged stream cannot use up unseen.
//!
//! The `laz` crate calls itself for every change between the four clocks of a LAZ file. A sound file changes once a point; a damaged one may
//! say so tens of thousands of times in a byte, and a stack that overflows ends the process. The essence is: whoever asks the source for a
//! byte does so from the depth at which it is, so the source can see it and refuse.
//!
//! Layered chunks are read whole before they are unpacked, so that the source would see nothing of it: their times are not unpacked at all
//! (`pieces.rs`), and nothing else calls itself.

use std::io::{BufRead, BufReader, Error, Read, Result, Seek, SeekFrom};
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Bytes of the stack, taken from the machine only as far as they are used.
const STACK_BYTES: usize = 512 << 20;

/// Bytes of the stack beyond which the source refuses. A byte of the stream leads some 4 MiB deeper at most.
const DEEPEST_BYTES: usize = 64 << 20;

/// Runs `unpack` on a deep stack; `None` where it panics, or there is no such stack.
pub(super) fn on_deep_stack<T: Send>(unpack: impl FnOnce() -> T + Send) -> Option<T> {
    std::thread::scope(|scope| {
        let thread = std::thread::Builder::new().stack_size(STACK_BYTES);
        let unpacked = thread.spawn_scoped(scope, || in_place(unpack));
        unpacked.ok()?.join().ok().flatten()
    })
}

/// Runs `read` where it stands; `None` where it panics. For points that are not packed, which nothing calls itself for.
pub(super) fn in_place<T>(read: impl FnOnce() -> T) -> Option<T> {
    catch_unwind(AssertUnwindSafe(read)).ok()
}

/// A source that refuses to be read from too deep a stack.
pub(super) struct Shallow<R> {
    source: BufReader<R>,
    /// Where the stack was when the source was made.
    top: usize,
}

impl<R: Read> Shallow<R> {
    pub fn new(source: R) -> Shallow<R> {
        Shallow { source: BufReader::new(source), top: here() }
    }

    fn check(&self) -> Result<()> {
        if self.top.abs_diff(here()) <= DEEPEST_BYTES {
            Ok(())
        } else {
            Err(Error::other("the packed points are damaged"))
        }
    }
}

/// Roughly where the stack is.
fn here() -> usize {
    let mark = 0u8;
    std::hint::black_box(&raw const mark).addr()
}

impl<R: Read> Read for Shallow<R> {
    fn read(&mut self, bytes: &mut [u8]) -> Result<usize> {
        self.check()?;
        self.source.read(bytes)
    }

    fn read_exact(&mut self, bytes: &mut [u8]) -> Result<()> {
        self.check()?;
        self.source.read_exact(bytes)
    }
}

impl<R: Read> BufRead for Shallow<R> {
    fn fill_buf(&mut self) -> Result<&[u8]> {
        self.source.fill_buf()
    }

    fn consume(&mut self, count: usize) {
        self.source.consume(count);
    }
}

impl<R: Seek> Seek for Shallow<R> {
    fn seek(&mut self, place: SeekFrom) -> Result<u64> {
        self.source.seek(place)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read_at_depth(source: &mut Shallow<&[u8]>, depth: usize) -> Result<u8> {
        let room = std::hint::black_box([0u8; 1024]);
        if depth > 0 {
            return read_at_depth(source, depth - 1).map(|byte| byte + room[depth % 1024]);
        }
        let mut byte = [0];
        source.read_exact(&mut byte)?;
        Ok(byte[0])
    }

    #[test]
    fn a_source_refuses_whoever_reads_from_too_deep() {
        let at = |depth| on_deep_stack(move || read_at_depth(&mut Shallow::new(&[7u8][..]), depth).ok());
        assert_eq!(at(100), Some(Some(7)));
        assert_eq!(at(100_000), Some(None));
        assert_eq!(on_deep_stack(|| -> u8 { panic!("as the decoder does") }), None);
    }
}
