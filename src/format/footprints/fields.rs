//! Which attributes are heights.

use crate::format::surface_error::SurfaceError;

/// Names of the attributes that make prisms of footprints.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct FootprintFields {
    /// Height of the building above its base, in the units of the coordinates.
    pub height: Option<String>,
    /// Height of the base; 0 where none is named.
    pub base: Option<String>,
}

/// Where those attributes are among a file's.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Columns {
    pub height: usize,
    pub base: Option<usize>,
}

impl FootprintFields {
    /// Finds the fields among those that hold numbers. The error lists them.
    pub(super) fn among(&self, numeric: &[String]) -> Result<Columns, SurfaceError> {
        let listed = match numeric {
            [] => "it has no fields with numbers".to_owned(),
            names => format!("fields with numbers are {}", names.join(", ")),
        };
        let find = |name: &str| {
            let exact = numeric.iter().position(|field| field == name);
            let found = exact.or_else(|| numeric.iter().position(|field| field.eq_ignore_ascii_case(name)));
            found.ok_or_else(|| SurfaceError::whole(format!("the file has no field `{name}` with numbers: {listed}")))
        };
        let Some(height) = &self.height else {
            let problem =
                format!("footprints need the field with the buildings' heights (--height-field NAME): {listed}");
            return Err(SurfaceError::whole(problem));
        };
        Ok(Columns { height: find(height)?, base: self.base.as_deref().map(find).transpose()? })
    }
}
