//! Whether a value keeps to a JSON schema, for the tests of the published ones.

use serde_json::Value;

/// Whether a value keeps to a schema: the keywords that the schemas of this program use, and a panic at any other.
pub fn keeps(value: &Value, schema: &Value, root: &Value) -> bool {
    schema.as_object().expect("a schema is an object").iter().all(|(keyword, want)| match keyword.as_str() {
        "$schema" | "$defs" | "title" | "description" => true,
        "const" => value == want,
        "$ref" => keeps(value, root.pointer(&want.as_str().unwrap()[1..]).expect("a reference leads somewhere"), root),
        // One name, or several of which one must fit.
        "type" => match want.as_array() {
            Some(names) => names.iter().any(|name| has_type(value, name.as_str().unwrap())),
            None => has_type(value, want.as_str().unwrap()),
        },
        "enum" => want.as_array().unwrap().contains(value),
        "allOf" => want.as_array().unwrap().iter().all(|part| keeps(value, part, root)),
        "anyOf" => want.as_array().unwrap().iter().any(|part| keeps(value, part, root)),
        "required" => want.as_array().unwrap().iter().all(|key| value.get(key.as_str().unwrap()).is_some()),
        "properties" => want
            .as_object()
            .unwrap()
            .iter()
            .all(|(key, part)| value.get(key).is_none_or(|field| keeps(field, part, root))),
        // False, or what the other fields keep to.
        "additionalProperties" => value.as_object().is_none_or(|fields| {
            let mut others = fields.iter().filter(|(key, _)| schema["properties"].get(key).is_none());
            others.all(|(_, field)| want.is_object() && keeps(field, want, root))
        }),
        "items" => value.as_array().is_none_or(|items| items.iter().all(|item| keeps(item, want, root))),
        "minItems" => value.as_array().is_none_or(|items| items.len() as u64 >= want.as_u64().unwrap()),
        "maxItems" => value.as_array().is_none_or(|items| items.len() as u64 <= want.as_u64().unwrap()),
        "minimum" => value.as_f64().is_none_or(|number| number >= want.as_f64().unwrap()),
        "exclusiveMaximum" => value.as_f64().is_none_or(|number| number < want.as_f64().unwrap()),
        "maximum" => value.as_f64().is_none_or(|number| number <= want.as_f64().unwrap()),
        "exclusiveMinimum" => value.as_f64().is_none_or(|number| number > want.as_f64().unwrap()),
        // The one pattern there is: a list of beginnings.
        "pattern" => {
            value.as_str().is_none_or(|text| text.starts_with("degenerate: ") || text.starts_with("ill-formed: "))
        }
        other => panic!("a schema uses {other}, which the tests do not know"),
    })
}

fn has_type(value: &Value, name: &str) -> bool {
    match name {
        "object" => value.is_object(),
        "array" => value.is_array(),
        "string" => value.is_string(),
        "number" => value.is_number(),
        "boolean" => value.is_boolean(),
        "null" => value.is_null(),
        "integer" => value.is_u64() || value.is_i64(),
        other => panic!("a schema uses the type {other}, which the tests do not know"),
    }
}
