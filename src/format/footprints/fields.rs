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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_are_found_by_their_very_name_first() {
        let numeric = ["HEIGHT", "height", "Base"].map(str::to_owned);
        let among = |height: &str, base: Option<&str>| {
            let fields = FootprintFields { height: Some(height.to_owned()), base: base.map(str::to_owned) };
            fields.among(&numeric)
        };
        assert_eq!(among("height", None).unwrap(), Columns { height: 1, base: None });
        assert_eq!(among("Height", Some("BASE")).unwrap(), Columns { height: 0, base: Some(2) });
        let error = among("height", Some("floor")).unwrap_err().to_string();
        assert!(error.contains("`floor`") && error.contains("HEIGHT, height, Base"), "{error}");
    }
}
