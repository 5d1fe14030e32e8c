//! What only several files of one city have wrong: tiles without anything in them, objects that lie in two of them.

use std::collections::HashMap;

use super::source::Source;
use super::warning::{CityDefect, CityPlace, CityWarning};
use super::{CityError, CityRole};

/// The files that have faces. A tile may be empty; all of them may not, and neither may the only one.
pub(super) fn keep_filled(sources: Vec<Source>) -> Result<Vec<Source>, CityError> {
    let city = |source: &&Source| source.role == CityRole::City;
    let is_filled = sources.iter().filter(city).any(|source| source.face_count() > 0);
    let of = |defect: CityDefect| -> u64 {
        let warnings = sources.iter().filter(city).flat_map(|source| &source.warnings);
        warnings.filter(|warning| warning.defect == defect).map(|warning| warning.count).sum()
    };
    if let Some(first) = sources.iter().find(city).filter(|_| !is_filled) {
        let path = first.path.clone();
        return Err(match (of(CityDefect::Footprints), of(CityDefect::AboveWantedLevel)) {
            (0, 0) => CityError::NoFaces { path, found: first.nothing_found() },
            (count, 0) => CityError::OnlyFootprints { path, count },
            (_, count) => CityError::AboveWantedLevel { path, count },
        });
    }
    let (filled, empty): (Vec<Source>, Vec<Source>) =
        sources.into_iter().partition(|source| source.face_count() > 0 || source.role == CityRole::Terrain);
    let mut filled = filled;
    if let (Some(first), Some(source)) = (filled.first_mut(), empty.first()) {
        let example = CityPlace { path: source.path.clone(), line: None, object: String::new() };
        first.warnings.push(CityWarning { defect: CityDefect::EmptyTile, count: empty.len() as u64, example });
        first.warnings.extend(empty.iter().flat_map(|source| source.warnings.iter().cloned()));
    }
    Ok(filled)
}

/// Objects with the name of an object in an earlier file of the city.
pub(super) fn shared_names(sources: &[Source]) -> Option<CityWarning> {
    let mut file_of: HashMap<&str, usize> = HashMap::new();
    let mut found: Option<CityWarning> = None;
    for (file, source) in sources.iter().enumerate().filter(|(_, source)| source.role == CityRole::City) {
        for name in &source.objects {
            let is_in_earlier = *file_of.entry(name).or_insert(file) != file;
            if is_in_earlier {
                let example = || CityPlace { path: source.path.clone(), line: None, object: name.clone() };
                let warning = found.get_or_insert_with(|| CityWarning {
                    defect: CityDefect::SameObject,
                    count: 0,
                    example: example(),
                });
                warning.count += 1;
            }
        }
    }
    found
}
