//! COLLADA is recognised, so that it can be named: of the two crates that read it, one leaves out where its nodes stand, the
//! other refuses what common programs write beside the standard.

/// Bytes within which a file says that it is COLLADA.
const LOOKED_AT: usize = 1 << 12;

/// Whether a file begins like COLLADA (.dae). What to do then: export OBJ or glTF, or `assimp export IN.dae OUT.glb`.
pub fn is_collada(start: &[u8]) -> bool {
    let start = &start[..start.len().min(LOOKED_AT)];
    let text = start.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(start).trim_ascii_start();
    text.starts_with(b"<") && memchr::memmem::find(text, b"<COLLADA").is_some()
}
