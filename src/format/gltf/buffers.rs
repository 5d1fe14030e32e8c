//! Where the bytes of buffers come from.

use std::collections::BTreeMap;
use std::io::Read;
use std::path::{Component, Path, PathBuf};
use std::rc::Rc;

use base64::Engine;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};
use gltf::json;

use super::super::file::{LARGEST_MODEL_BYTES, open_regular, read_at_most};
use super::super::uri::{percent_decoded, shortened};
use super::extensions::Extensions;
use super::{GltfError, GltfProblem};

/// Writers differ on whether the last group is filled up.
const BASE64: GeneralPurpose = GeneralPurpose::new(
    &base64::alphabet::STANDARD,
    GeneralPurposeConfig::new().with_decode_padding_mode(DecodePaddingMode::Indifferent),
);

/// Buffers that were asked for; the others (images, animations) are never opened.
pub(super) struct Buffers<'a> {
    blob: Option<&'a [u8]>,
    folder: &'a Path,
    extensions: &'a Extensions,
    loaded: BTreeMap<usize, Loaded<'a>>,
    /// Files beside this one, by their real path and how much was asked for: many buffers may name one file.
    files: BTreeMap<(PathBuf, u64), Rc<Vec<u8>>>,
    bytes_beside: usize,
}

/// The bytes of one buffer.
enum Loaded<'a> {
    Chunk(&'a [u8]),
    Data(Vec<u8>),
    Beside(Rc<Vec<u8>>),
}

impl Loaded<'_> {
    fn bytes(&self) -> &[u8] {
        match self {
            Loaded::Chunk(bytes) => bytes,
            Loaded::Data(bytes) => bytes,
            Loaded::Beside(bytes) => bytes,
        }
    }
}

impl<'a> Buffers<'a> {
    pub fn new(blob: Option<&'a [u8]>, folder: &'a Path, extensions: &'a Extensions) -> Buffers<'a> {
        Buffers { blob, folder, extensions, loaded: BTreeMap::new(), files: BTreeMap::new(), bytes_beside: 0 }
    }

    /// The bytes of a buffer that was loaded.
    pub fn bytes(&self, index: usize) -> Option<&[u8]> {
        self.loaded.get(&index).map(Loaded::bytes)
    }

    /// What the file says of its extensions.
    pub fn extensions(&self) -> &Extensions {
        self.extensions
    }

    /// Bytes that were read from files beside.
    pub fn bytes_beside(&self) -> usize {
        self.bytes_beside
    }

    /// Makes sure that the buffer's bytes are there, as many as it says.
    pub fn load(&mut self, index: usize, buffer: &json::Buffer) -> Result<(), GltfError> {
        if self.loaded.contains_key(&index) {
            return Ok(());
        }
        self.extensions.check_buffer(index)?;
        let claimed = buffer.byte_length.0;
        let at = |problem| GltfError::at(format!("buffers[{index}]"), problem);
        let bytes = match &buffer.uri {
            None if index == 0 => Loaded::Chunk(self.blob.ok_or_else(|| {
                at(GltfProblem::Invalid { what: "buffer without uri in a file without a binary chunk".to_owned() })
            })?),
            None => {
                return Err(at(GltfProblem::Invalid { what: "only the first buffer may go without uri".to_owned() }));
            }
            Some(uri) if uri.starts_with("data:") => Loaded::Data(data_uri(uri).map_err(at)?),
            Some(uri) => Loaded::Beside(self.beside(uri, claimed).map_err(at)?),
        };
        let found = bytes.bytes().len() as u64;
        if found < claimed {
            return Err(at(GltfProblem::Truncated { what: "the buffer", claimed, found }));
        }
        self.loaded.insert(index, bytes);
        Ok(())
    }

    /// A file in the folder or below it, when it has as much as the buffer claims. Not much more of it is read: claims are
    /// rounded up to a power of two, so that of a file that many buffers name no more than twice its bytes are held.
    fn beside(&mut self, uri: &str, claimed: u64) -> Result<Rc<Vec<u8>>, GltfProblem> {
        let refused = |reason: String| GltfProblem::Buffer { uri: shortened(uri), reason };
        let path = self.folder.join(relative_path(uri).map_err(|reason| refused(reason.to_owned()))?);
        let file = open_regular(&path).map_err(|error| refused(error.to_string()))?;
        let found = file.metadata().map_err(|error| refused(error.to_string()))?.len();
        if found < claimed {
            return Err(GltfProblem::Truncated { what: "the buffer", claimed, found });
        }
        let wanted = claimed.checked_next_power_of_two().map_or(found, |wanted| wanted.min(found));
        let real_path = path.canonicalize().map_err(|error| refused(error.to_string()))?;
        if let Some(bytes) = self.files.get(&(real_path.clone(), wanted)) {
            return Ok(Rc::clone(bytes));
        }
        let bytes = read_at_most(file.take(wanted), wanted, LARGEST_MODEL_BYTES);
        let bytes = Rc::new(bytes.map_err(|error| refused(error.to_string()))?);
        self.bytes_beside += bytes.len();
        self.files.insert((real_path, wanted), Rc::clone(&bytes));
        Ok(bytes)
    }
}

fn data_uri(uri: &str) -> Result<Vec<u8>, GltfProblem> {
    let refused = |reason: String| GltfProblem::Buffer { uri: shortened(uri), reason };
    let Some((_, text)) = uri.split_once(";base64,") else {
        return Err(refused("expected base64 data".to_owned()));
    };
    BASE64.decode(text.trim()).map_err(|error| refused(format!("base64: {error}")))
}

/// The path that a relative URI means. Whoever made the file shall not choose which other files are read.
fn relative_path(uri: &str) -> Result<PathBuf, &'static str> {
    let decoded = percent_decoded(uri).ok_or("its name is not UTF-8")?;
    let path = Path::new(&decoded);
    let is_below = path.components().all(|part| matches!(part, Component::Normal(_) | Component::CurDir));
    // A colon is a scheme or a drive, a backslash a separator elsewhere.
    if decoded.is_empty() || !is_below || decoded.contains([':', '\\', '\0']) {
        return Err(
            "only files in the same folder or below it are read; put it there and name it without folders above",
        );
    }
    Ok(path.to_owned())
}
