//! JSON documents held against the specification's schemas.

use serde_json::Value;

/// Holds a value against as much of JSON Schema as the specification's schemas use; what an object holds beyond what
/// its schema describes is a fault too.
pub(crate) fn validate(value: &Value, schema: &Value, root: &Value, place: &str) {
    if let Err(fault) = fits(value, schema, root, place) {
        panic!("{fault}");
    }
}

fn fits(value: &Value, schema: &Value, root: &Value, place: &str) -> Result<(), String> {
    let check = |sound: bool, what: &str| if sound { Ok(()) } else { Err(format!("{place}: {what}: {value}")) };
    for (word, wanted) in schema.as_object().unwrap() {
        match word.as_str() {
            "$ref" => {
                let pointer = wanted.as_str().unwrap().trim_start_matches('#');
                fits(value, root.pointer(pointer).unwrap(), root, place)?;
            }
            "type" => {
                let names = wanted.as_array().cloned().unwrap_or_else(|| vec![wanted.clone()]);
                check(names.iter().any(|name| is_a(value, name.as_str().unwrap())), &format!("is no {wanted}"))?;
            }
            "const" => check(value == wanted, "is another value")?,
            "enum" => check(wanted.as_array().unwrap().contains(value), "is none of the values")?,
            "minimum" => check(value.as_f64().is_none_or(|v| v >= wanted.as_f64().unwrap()), "is too low")?,
            "maximum" => check(value.as_f64().is_none_or(|v| v <= wanted.as_f64().unwrap()), "is too high")?,
            "exclusiveMinimum" => check(value.as_f64().is_none_or(|v| v > wanted.as_f64().unwrap()), "is too low")?,
            "minItems" => {
                check(value.as_array().is_none_or(|v| v.len() as u64 >= wanted.as_u64().unwrap()), "is too short")?;
            }
            "maxItems" => {
                check(value.as_array().is_none_or(|v| v.len() as u64 <= wanted.as_u64().unwrap()), "is too long")?;
            }
            "minLength" => {
                check(value.as_str().is_none_or(|v| v.len() as u64 >= wanted.as_u64().unwrap()), "is too short")?;
            }
            "maxLength" => {
                check(value.as_str().is_none_or(|v| v.len() as u64 <= wanted.as_u64().unwrap()), "is too long")?;
            }
            "uniqueItems" => {
                let twice = |v: &Vec<Value>| v.iter().enumerate().any(|(i, a)| v[..i].contains(a));
                check(!value.as_array().is_some_and(twice), "holds something twice")?;
            }
            "items" => {
                for (i, item) in value.as_array().into_iter().flatten().enumerate() {
                    fits(item, wanted, root, &format!("{place}[{i}]"))?;
                }
            }
            "required" => {
                for name in wanted.as_array().unwrap() {
                    let name = name.as_str().unwrap();
                    check(value.as_object().is_none_or(|v| v.contains_key(name)), &format!("has no {name}"))?;
                }
            }
            "properties" => {
                // A schema without a type looks at an object from one side only.
                let described = |name: &String| schema.get("type").is_none() || wanted.get(name).is_some();
                let names = value.as_object().into_iter().flat_map(|object| object.keys());
                check(names.clone().all(described), "holds something that the schema does not describe")?;
                for (name, schema) in wanted.as_object().unwrap() {
                    if let Some(value) = value.get(name) {
                        fits(value, schema, root, &format!("{place}.{name}"))?;
                    }
                }
            }
            "anyOf" => {
                let any = wanted.as_array().unwrap().iter().any(|schema| fits(value, schema, root, place).is_ok());
                check(any, "fits none of the shapes")?;
            }
            "if" => {
                let branch = if fits(value, wanted, root, place).is_ok() { "then" } else { "else" };
                schema.get(branch).map_or(Ok(()), |schema| fits(value, schema, root, place))?;
            }
            "then" | "else" | "$schema" | "$id" | "$defs" | "title" | "description" | "default" => {}
            word => panic!("the schema uses {word}, which this test does not know"),
        }
    }
    Ok(())
}

fn is_a(value: &Value, name: &str) -> bool {
    match name {
        "object" => value.is_object(),
        "array" => value.is_array(),
        "string" => value.is_string(),
        "number" => value.is_number(),
        "integer" => value.as_f64().is_some_and(|v| v.fract() == 0.0),
        "boolean" => value.is_boolean(),
        _ => value.is_null(),
    }
}
