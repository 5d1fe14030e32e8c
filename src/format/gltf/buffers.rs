//! Where the bytes of buffers come from.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::fs::File;
use std::io::Read;
use std::path::{Component, Path, PathBuf};

use base64::Engine;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};
use gltf::json;

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
    loaded: BTreeMap<usize, Cow<'a, [u8]>>,
}

impl<'a> Buffers<'a> {
    pub fn new(blob: Option<&'a [u8]>, folder: &'a Path) -> Buffers<'a> {
        Buffers { blob, folder, loaded: BTreeMap::new() }
    }

    /// The bytes of a buffer that was loaded.
    pub fn bytes(&self, index: usize) -> Option<&[u8]> {
        self.loaded.get(&index).map(|bytes| &**bytes)
    }

    /// Makes sure that the buffer's bytes are there, as many as it says.
    pub fn load(&mut self, index: usize, buffer: &json::Buffer) -> Result<(), GltfError> {
        if self.loaded.contains_key(&index) {
            return Ok(());
        }
        let claimed = buffer.byte_length.0;
        let at = |problem| GltfError::at(format!("buffers[{index}]"), problem);
        let bytes = match &buffer.uri {
            None if index == 0 => Cow::Borrowed(self.blob.ok_or_else(|| {
                at(GltfProblem::Invalid { what: "buffer without uri in a file without a binary chunk".to_owned() })
            })?),
            None => {
                return Err(at(GltfProblem::Invalid { what: "only the first buffer may go without uri".to_owned() }));
            }
            Some(uri) if uri.starts_with("data:") => Cow::Owned(data_uri(uri).map_err(at)?),
            Some(uri) => Cow::Owned(self.beside(uri, claimed).map_err(at)?),
        };
        if (bytes.len() as u64) < claimed {
            return Err(at(GltfProblem::Truncated { what: "the buffer", claimed, found: bytes.len() as u64 }));
        }
        self.loaded.insert(index, bytes);
        Ok(())
    }

    /// A file in the folder or below it; never more of it than the buffer claims, and only when it has that much.
    fn beside(&self, uri: &str, claimed: u64) -> Result<Vec<u8>, GltfProblem> {
        let refused = |reason: String| GltfProblem::Buffer { uri: shortened(uri), reason };
        let path = self.folder.join(relative_path(uri).map_err(|reason| refused(reason.to_owned()))?);
        let file = File::open(&path).map_err(|error| refused(error.to_string()))?;
        let found = file.metadata().map_err(|error| refused(error.to_string()))?.len();
        if found < claimed {
            return Err(GltfProblem::Truncated { what: "the buffer", claimed, found });
        }
        let mut bytes = Vec::new();
        file.take(claimed).read_to_end(&mut bytes).map_err(|error| refused(error.to_string()))?;
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

fn percent_decoded(uri: &str) -> Option<String> {
    let mut bytes = Vec::with_capacity(uri.len());
    let mut rest = uri.as_bytes();
    while let [first, tail @ ..] = rest {
        let hex = |digit: u8| char::from(digit).to_digit(16);
        match (first, tail) {
            (b'%', [high, low, after @ ..]) if hex(*high).is_some() && hex(*low).is_some() => {
                bytes.push((16 * hex(*high)? + hex(*low)?) as u8);
                rest = after;
            }
            _ => {
                bytes.push(*first);
                rest = tail;
            }
        }
    }
    String::from_utf8(bytes).ok()
}

/// Enough of a URI to know it by.
fn shortened(uri: &str) -> String {
    const SHOWN: usize = 60;
    if uri.chars().count() <= SHOWN { uri.to_owned() } else { uri.chars().take(SHOWN).chain("...".chars()).collect() }
}
