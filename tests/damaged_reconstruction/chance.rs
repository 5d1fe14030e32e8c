//! Files cut anywhere, and with bytes flipped.

use super::*;

/// Reads what a damaged file became; where it still makes sense, writing and reading it again gives the same points.
fn read_without_panic(path: &Path) -> bool {
    match read_reconstruction(path) {
        Ok(read) => {
            let out = tempfile::tempdir().unwrap();
            let again = if read.colmap.is_some() {
                write_colmap(out.path(), &read).unwrap();
                read_reconstruction(out.path()).unwrap()
            } else {
                let cloud = out.path().join("cloud.ply");
                write_ply(&cloud, &read).unwrap();
                read_reconstruction(&cloud).unwrap()
            };
            assert_eq!(again.points, read.points);
            true
        }
        Err(error) => {
            let message = error.to_string();
            assert!(!message.contains(char::is_control) && message.len() < 2000, "{message}");
            false
        }
    }
}

#[test]
fn binary_files_cut_anywhere_are_refused() {
    for name in ["sound", "sound_framed"] {
        let folder = model("binary", name);
        for path in files_of(folder.path()) {
            let whole = fs::read(&path).unwrap();
            for length in 0..whole.len() {
                fs::write(&path, &whole[..length]).unwrap();
                assert!(!read_without_panic(folder.path()), "{} cut to {length}", path.display());
            }
            fs::write(&path, &whole).unwrap();
        }
    }
    for name in ["sound_little", "sound_big", "sound_mesh"] {
        let whole = fs::read(data().join("ply").join(name).with_extension("ply")).unwrap();
        let file = tempfile::NamedTempFile::new().unwrap();
        for length in 0..whole.len() {
            fs::write(file.path(), &whole[..length]).unwrap();
            assert!(!read_without_panic(file.path()), "{name} cut to {length}");
        }
    }
}

#[test]
fn text_files_cut_anywhere_are_read_or_refused() {
    for name in ["sound", "sound_framed"] {
        let folder = model("text", name);
        for path in files_of(folder.path()) {
            let whole = fs::read(&path).unwrap();
            for length in 0..whole.len() {
                fs::write(&path, &whole[..length]).unwrap();
                read_without_panic(folder.path());
            }
            fs::write(&path, &whole).unwrap();
        }
    }
    let whole = fs::read(data().join("ply/sound_mesh_first.ply")).unwrap();
    let file = tempfile::NamedTempFile::new().unwrap();
    for length in 0..whole.len() {
        fs::write(file.path(), &whole[..length]).unwrap();
        read_without_panic(file.path());
    }
}

/// Damaged copies of each file.
const FLIPS: usize = 250;

fn flip(whole: &[u8], random: &mut ChaCha8Rng) -> Vec<u8> {
    let mut damaged = whole.to_vec();
    for _ in 0..1 + random.next_u32() % 3 {
        let at = random.next_u32() as usize % damaged.len();
        damaged[at] = match random.next_u32() % 3 {
            0 => damaged[at] ^ 1 << (random.next_u32() % 8),
            1 => 0xFF,
            _ => random.next_u32() as u8,
        };
    }
    damaged
}

#[test]
fn flipped_bytes_give_a_reconstruction_or_an_error_and_no_panic() {
    let mut random = ChaCha8Rng::seed_from_u64(7);
    let (mut read, mut refused) = (0, 0);
    for (kind, name) in [("binary", "sound_framed"), ("text", "sound_framed")] {
        let folder = model(kind, name);
        for path in files_of(folder.path()) {
            let whole = fs::read(&path).unwrap();
            for _ in 0..FLIPS {
                fs::write(&path, flip(&whole, &mut random)).unwrap();
                *(if read_without_panic(folder.path()) { &mut read } else { &mut refused }) += 1;
            }
            fs::write(&path, &whole).unwrap();
        }
    }
    let file = tempfile::NamedTempFile::new().unwrap();
    for name in ["sound_ascii", "sound_little", "sound_big", "sound_mesh", "sound_mesh_first"] {
        let whole = fs::read(data().join("ply").join(name).with_extension("ply")).unwrap();
        for _ in 0..FLIPS {
            fs::write(file.path(), flip(&whole, &mut random)).unwrap();
            *(if read_without_panic(file.path()) { &mut read } else { &mut refused }) += 1;
        }
    }
    println!("{read} read, {refused} refused");
    assert!(read > 100 && refused > 100);
}
