//! Which of the project's own JSON files a text is, so that one that is given in another's place is named for what it is.

use serde::Deserialize;
use serde::de::IgnoredAny;

/// The JSON files that the program reads and writes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum JsonKind {
    /// A start file
    Start,
    /// `alignment.json`
    Alignment,
    /// `merge.json`
    Merge,
    /// What `cityweld planes -o` writes
    Planes,
    /// What `cityweld solve` reads
    Problem,
    /// What `cityweld solve` writes
    Answer,
}

/// The keys that tell; their order in the file means nothing.
#[derive(Deserialize)]
struct Keys {
    schema: Option<serde_json::Value>,
    rotation: Option<IgnoredAny>,
    translation: Option<IgnoredAny>,
    // Null counts: an alignment that failed has only nulls.
    #[serde(default, deserialize_with = "present")]
    transform: bool,
    #[serde(default, deserialize_with = "present")]
    best_candidate: bool,
    pairs: Option<IgnoredAny>,
    sensor: Option<IgnoredAny>,
    solutions: Option<IgnoredAny>,
    refused: Option<IgnoredAny>,
}

fn present<'a, D: serde::Deserializer<'a>>(value: D) -> Result<bool, D::Error> {
    IgnoredAny::deserialize(value).map(|_| true)
}

impl JsonKind {
    /// The kind that the file's `schema` names, whatever its version.
    pub fn by_schema(text: &str) -> Option<JsonKind> {
        let keys: Keys = serde_json::from_str(text).ok()?;
        keys.by_schema()
    }

    /// The kind by `schema`, or by its keys where somebody has left the schema out.
    pub fn of(text: &str) -> Option<JsonKind> {
        let keys: Keys = serde_json::from_str(text).ok()?;
        keys.by_schema().or_else(|| keys.by_others())
    }

    /// In words, with its article.
    pub fn words(self) -> &'static str {
        match self {
            JsonKind::Start => "a start",
            JsonKind::Alignment => "an alignment, as `cityweld align` writes it",
            JsonKind::Merge => "the report of a merge, as `cityweld merge` writes it",
            JsonKind::Planes => "the planes of a city, as `cityweld planes` writes them",
            JsonKind::Problem => "a problem of `cityweld solve`",
            JsonKind::Answer => "an answer of `cityweld solve`",
        }
    }
}

impl Keys {
    fn by_schema(&self) -> Option<JsonKind> {
        let (name, _version) = self.schema.as_ref()?.as_str()?.split_once('/')?;
        match name {
            "cityweld.alignment" => Some(JsonKind::Alignment),
            "cityweld.merge" => Some(JsonKind::Merge),
            "cityweld.planes" => Some(JsonKind::Planes),
            _ => None,
        }
    }

    fn by_others(&self) -> Option<JsonKind> {
        if self.transform || self.best_candidate {
            Some(JsonKind::Alignment)
        } else if self.rotation.is_some() && self.translation.is_some() {
            Some(JsonKind::Start)
        } else if self.pairs.is_some() || self.sensor.is_some() {
            Some(JsonKind::Problem)
        } else if self.solutions.is_some() || self.refused.is_some() {
            Some(JsonKind::Answer)
        } else {
            None
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tells_every_json_file_of_the_project() {
        for (text, kind) in [
            (r#"{"scale": 1, "rotation": [], "translation": []}"#, Some(JsonKind::Start)),
            (r#"{"schema": "cityweld.alignment/2"}"#, Some(JsonKind::Alignment)),
            (r#"{"verdict": "failed", "transform": null}"#, Some(JsonKind::Alignment)),
            (r#"{"parts": [], "schema": "cityweld.merge/1"}"#, Some(JsonKind::Merge)),
            (r#"{"schema": "cityweld.planes/1", "planes": []}"#, Some(JsonKind::Planes)),
            (r#"{"kind": "rigid", "points": [], "planes": [], "pairs": []}"#, Some(JsonKind::Problem)),
            (r#"{"solutions": []}"#, Some(JsonKind::Answer)),
            (r#"{"asset": {"version": "2.0"}}"#, None),
            (r#"{"schema": 3}"#, None),
            ("[]", None),
            ("{", None),
        ] {
            assert_eq!(JsonKind::of(text), kind, "{text}");
        }
        assert_eq!(JsonKind::by_schema(r#"{"transform": null}"#), None);
    }
}
