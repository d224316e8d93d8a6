//! What `gltf-json` 1.4.1 refuses, or takes for something else, although the file means it well.

use serde_json::{Map, Number, Value};

/// Whether the text has an integer beyond 32 bits. False alarms (in strings) only cost time.
pub(super) fn has_large_integer(json: &[u8]) -> bool {
    json.split(|b| !b.is_ascii_digit())
        .filter(|digits| digits.len() >= 10)
        .filter_map(|digits| std::str::from_utf8(digits).ok())
        .any(|digits| digits.parse::<u64>().is_ok_and(|n| n > u64::from(u32::MAX)))
}

/// The document without what `gltf-json` would refuse although it is legal (or harmless), and without its animations.
pub(super) fn mended(json: &[u8]) -> Result<Value, String> {
    let mut value: Value = serde_json::from_slice(json).map_err(|e| e.to_string())?;
    mend(&mut value)?;
    if let Some(root) = value.as_object_mut() {
        root.remove("animations");
        let scenes = root.get_mut("scenes").and_then(Value::as_array_mut);
        for scene in scenes
            .into_iter()
            .flatten()
            .filter_map(Value::as_object_mut)
        {
            scene
                .entry("nodes")
                .or_insert_with(|| Value::Array(Vec::new()));
        }
    }
    Ok(value)
}

/// Properties that are indices into the document's arrays.
const INDEX_KEYS: [&str; 18] = [
    "buffer",
    "bufferView",
    "camera",
    "children",
    "index",
    "indices",
    "input",
    "inverseBindMatrices",
    "joints",
    "light",
    "material",
    "mesh",
    "nodes",
    "output",
    "sampler",
    "scene",
    "skin",
    "source",
];

/// Drops extras and nulls, and writes `3.0` as `3`. Deep nesting was refused by the parser (128 levels).
pub(super) fn mend(value: &mut Value) -> Result<(), String> {
    match value {
        Value::Object(map) => mend_object(map),
        Value::Array(items) => items.iter_mut().try_for_each(mend),
        Value::Number(number) => {
            let whole = number.as_f64().filter(|f| {
                // Beyond 2^53 not every integer is a double.
                number.is_f64() && f.fract() == 0.0 && f.abs() <= 9_007_199_254_740_992.0
            });
            if let Some(f) = whole {
                *number = Number::from(f as i64);
            }
            Ok(())
        }
        _ => Ok(()),
    }
}

fn mend_object(map: &mut Map<String, Value>) -> Result<(), String> {
    map.remove("extras");
    map.retain(|_, v| !v.is_null());
    for (key, value) in map.iter_mut() {
        mend(value)?;
        let too_large = |v: &Value| v.as_u64().filter(|&n| n > u64::from(u32::MAX));
        let is_index = INDEX_KEYS.contains(&key.as_str());
        let found = match value {
            Value::Number(_) if is_index => too_large(value),
            Value::Array(items) if is_index => items.iter().find_map(too_large),
            Value::Object(attributes) if key == "attributes" => {
                attributes.values().find_map(too_large)
            }
            Value::Array(targets) if key == "targets" => {
                let targets = targets.iter().filter_map(Value::as_object);
                targets.flat_map(Map::values).find_map(too_large)
            }
            _ => None,
        };
        if let Some(n) = found {
            return Err(format!("{key:?}: index {n} is beyond every array"));
        }
    }
    Ok(())
}
