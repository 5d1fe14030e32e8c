//! FlatCityBuf: read as the CityJSON sequence that it was made of (cargo feature `flatcitybuf`), or refused by name.

use std::path::{Path, PathBuf};

use cityweld::{CityOptions, read_city};

fn own(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/formats/city").join(name)
}

#[cfg(not(feature = "flatcitybuf"))]
#[test]
fn without_the_feature_the_error_names_the_format_and_both_ways_out() {
    let error = read_city(&own("small.fcb"), &[], &CityOptions::default()).unwrap_err().to_string();
    for words in ["this is FlatCityBuf", "fcb deser IN.fcb OUT.city.jsonl", "--features flatcitybuf", "small.fcb"] {
        assert!(error.contains(words), "{error}");
    }
}

#[cfg(feature = "flatcitybuf")]
mod with_the_feature {
    use super::*;
    use cityweld::types::CityContents;
    use cityweld::{CityModel, read_city_contents};

    /// Of all vertices, millimetres of the city's own coordinates.
    fn extent(city: &CityModel) -> [[i64; 2]; 3] {
        [0, 1, 2].map(|k| {
            let of = |vertex: &cityweld::Point3<f64>| ((vertex[k] + city.origin[k]) * 1e3).round() as i64;
            [city.vertices.iter().map(of).min().unwrap(), city.vertices.iter().map(of).max().unwrap()]
        })
    }

    fn contents(name: &str) -> CityContents {
        read_city_contents(&[own(name)], &CityOptions::default()).unwrap().remove(0).1
    }

    #[test]
    fn the_city_is_that_of_the_sequence_it_was_made_of() {
        let [mut of_buffer, of_text] = ["small.fcb", "small.city.jsonl"].map(contents);
        assert_eq!(of_buffer.format, format!("FlatCityBuf ({})", of_text.format));
        of_buffer.format.clone_from(&of_text.format);
        assert_eq!(of_buffer, of_text);
        let [of_buffer, of_text] =
            ["small.fcb", "small.city.jsonl"].map(|name| read_city(&own(name), &[], &CityOptions::default()).unwrap());
        assert_eq!(of_buffer.crs, of_text.crs);
        assert_eq!(of_buffer.facets.len(), of_text.facets.len());
        assert_eq!(extent(&of_buffer), extent(&of_text));
    }

    #[test]
    fn objects_come_in_the_same_order_every_time() {
        let objects = || read_city(&own("small.fcb"), &[], &CityOptions::default()).unwrap().objects;
        let first = objects();
        (0..20).for_each(|_| assert_eq!(objects(), first));
    }

    #[test]
    fn cut_and_changed_files_are_refused_or_read_and_never_panic() {
        let bytes = std::fs::read(own("small.fcb")).unwrap();
        let room = tempfile::tempdir().unwrap();
        let path = room.path().join("damaged.fcb");
        let read = |bytes: &[u8]| {
            std::fs::write(&path, bytes).unwrap();
            read_city(&path, &[], &CityOptions::default())
        };
        for length in (8..bytes.len()).step_by(61) {
            let error = read(&bytes[..length]).unwrap_err().to_string();
            assert!(error.contains("FlatCityBuf"), "cut at {length}: {error}");
        }
        for at in (8..bytes.len()).step_by(7) {
            for value in [0, 0xFF, bytes[at] ^ 0x10] {
                let mut changed = bytes.clone();
                // Counts have four bytes.
                let end = (at + 4).min(changed.len());
                changed[at..end].fill(value);
                if let Ok(city) = read(&changed) {
                    assert!(city.facets.len() < 1000, "changed at {at}");
                }
            }
        }
    }

    #[test]
    fn boundaries_that_count_what_is_not_there_are_refused() {
        let bytes = std::fs::read(own("small.fcb")).unwrap();
        let room = tempfile::tempdir().unwrap();
        let path = room.path().join("lying.fcb");
        let mut refused = 0;
        for at in (8..bytes.len() - 4).step_by(4) {
            let mut lying = bytes.clone();
            lying[at..at + 4].copy_from_slice(&0xF000_0000u32.to_le_bytes());
            std::fs::write(&path, &lying).unwrap();
            let read = read_city(&path, &[], &CityOptions::default());
            refused += usize::from(read.is_err_and(|error| error.to_string().contains("boundaries count")));
        }
        assert!(refused > 0);
    }
}
