//! Opens and reads the files that somebody names: regular files only, and never more of them than was asked for.
//!
//! A pipe would be waited for, a device read without end. Names come from the user, but also out of files (the buffers of
//! a glTF scene, the photographs of a reconstruction), and archives can hold pipes.

use std::fs::{File, Metadata, OpenOptions};
use std::io::{Error, ErrorKind, Read, Result};
use std::path::Path;

/// The largest city or cloud that is read whole, bytes. Chosen: a country's tiles are sold in files of a few hundred megabytes;
/// what is longer is taken for a file of holes or a device that calls itself regular.
pub const LARGEST_MODEL_BYTES: u64 = 16 << 30;

/// Files from this length on are asked how much of them is on the disk, bytes. Chosen: less than any machine has for one.
const LEAST_WITH_HOLES: u64 = 256 << 20;

/// How many times shorter than its length a file may lie on a disk that compresses. Derived: LZ4, the quickest and commonest,
/// comes to 255; models come to 10.
const BEST_COMPRESSION: u64 = 255;

/// Opens a regular file; a pipe, device, socket or folder is refused without waiting for it, and a file that is all holes.
pub fn open_regular(path: &Path) -> Result<File> {
    // Before opening, which alone makes some devices move; and after, as the name may have changed hands in between.
    refuse_irregular(&std::fs::metadata(path)?)?;
    let file = without_waiting().read(true).open(path)?;
    let found = file.metadata()?;
    refuse_irregular(&found)?;
    refuse_holes(&found)?;
    Ok(file)
}

/// Reads a regular file of at most `limit` bytes.
pub fn read_regular(path: &Path, limit: u64) -> Result<Vec<u8>> {
    let file = open_regular(path)?;
    let length = file.metadata()?.len();
    read_at_most(file, length, limit)
}

/// Reads to the end, which must come within `limit` bytes. `length` is what the system says of it, and is not relied on:
/// for some files it says nothing.
pub fn read_at_most(source: impl Read, length: u64, limit: u64) -> Result<Vec<u8>> {
    let too_long =
        |found: String| Error::new(ErrorKind::FileTooLarge, format!("it has {found} bytes, at most {limit} are read"));
    if length > limit {
        return Err(too_long(length.to_string()));
    }
    let mut bytes = Vec::new();
    // One more, in which the end is met.
    bytes.try_reserve_exact(usize::try_from(length.saturating_add(1)).unwrap_or(usize::MAX))?;
    source.take(limit.saturating_add(1)).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > limit {
        return Err(too_long(format!("more than {limit}")));
    }
    Ok(bytes)
}

/// Whether something stands under this name that is no folder. Pipes count: [`open_regular`] says what they are.
pub fn is_there(path: &Path) -> bool {
    std::fs::metadata(path).is_ok_and(|found| !found.is_dir())
}

fn refuse_irregular(found: &Metadata) -> Result<()> {
    if found.is_file() {
        return Ok(());
    }
    let what = if found.is_dir() { "a folder" } else { special(found.file_type()) };
    Err(Error::new(ErrorKind::InvalidInput, format!("it is {what}, expected a regular file")))
}

/// A length costs nothing to claim: what was set aside for it and never written reads as zeros.
fn refuse_holes(found: &Metadata) -> Result<()> {
    if found.len() < LEAST_WITH_HOLES || bytes_on_disk(found) >= found.len() / BEST_COMPRESSION {
        return Ok(());
    }
    let message = format!("it says {} bytes, of which {} were ever written", found.len(), bytes_on_disk(found));
    Err(Error::new(ErrorKind::InvalidData, message))
}

#[cfg(unix)]
fn bytes_on_disk(found: &Metadata) -> u64 {
    // In units of 512 bytes, whatever the blocks of the disk (POSIX, sys/stat.h).
    512 * std::os::unix::fs::MetadataExt::blocks(found)
}

#[cfg(not(unix))]
fn bytes_on_disk(found: &Metadata) -> u64 {
    found.len()
}

#[cfg(unix)]
fn special(found: std::fs::FileType) -> &'static str {
    use std::os::unix::fs::FileTypeExt;
    if found.is_fifo() {
        "a pipe (save what comes out of it to a file)"
    } else if found.is_socket() {
        "a socket"
    } else {
        "a device"
    }
}

#[cfg(not(unix))]
fn special(_: std::fs::FileType) -> &'static str {
    "a device"
}

/// Opening a pipe waits for who writes into it, unless told not to; a terminal shall not become the program's own.
#[cfg(unix)]
fn without_waiting() -> OpenOptions {
    use rustix::fs::OFlags;
    use std::os::unix::fs::OpenOptionsExt;
    let mut options = OpenOptions::new();
    options.custom_flags((OFlags::NONBLOCK | OFlags::NOCTTY).bits().cast_signed());
    options
}

#[cfg(not(unix))]
fn without_waiting() -> OpenOptions {
    OpenOptions::new()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_regular_file_is_read_up_to_its_limit() {
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(file.path(), b"0123456789").unwrap();
        assert_eq!(read_regular(file.path(), 10).unwrap(), b"0123456789");
        let error = read_regular(file.path(), 9).unwrap_err();
        assert!(error.to_string().contains("10 bytes, at most 9"), "{error}");
        let error = read_at_most(std::io::repeat(7), 0, 1000).unwrap_err();
        assert!(error.to_string().contains("more than 1000"), "{error}");
    }

    #[test]
    fn a_length_that_no_memory_holds_is_an_error() {
        assert!(read_at_most(std::io::empty(), u64::MAX / 4, u64::MAX).is_err());
    }

    #[cfg(unix)]
    #[test]
    fn a_file_of_holes_is_refused_before_it_is_read() {
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(file.path(), b"v 0 0 0\n").unwrap();
        file.as_file().set_len(LARGEST_MODEL_BYTES).unwrap();
        let error = read_regular(file.path(), LARGEST_MODEL_BYTES).unwrap_err();
        assert!(error.to_string().contains("ever written"), "{error}");
        file.as_file().set_len(1 << 20).unwrap();
        assert_eq!(read_regular(file.path(), LARGEST_MODEL_BYTES).unwrap().len(), 1 << 20);
    }

    #[cfg(unix)]
    #[test]
    fn pipes_devices_sockets_and_folders_are_refused_without_waiting() {
        let folder = tempfile::tempdir().unwrap();
        let [pipe, socket, link] = ["pipe", "socket", "link"].map(|name| folder.path().join(name));
        assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
        let _listener = std::os::unix::net::UnixListener::bind(&socket).unwrap();
        std::os::unix::fs::symlink(&pipe, &link).unwrap();
        for (path, what) in [
            (pipe.as_path(), "a pipe"),
            (&link, "a pipe"),
            (&socket, "a socket"),
            (Path::new("/dev/zero"), "a device"),
            (folder.path(), "a folder"),
        ] {
            let error = open_regular(path).unwrap_err();
            assert!(error.to_string().contains(what), "{}: {error}", path.display());
            assert!(read_regular(path, 10).is_err());
        }
        assert!(is_there(&pipe) && !is_there(folder.path()) && !is_there(&folder.path().join("other")));
    }
}
