//! JSON values that know where they stand.

use crate::error::{Error, ErrorKind, Result};

/// A value with its path in the document.
#[derive(Clone, Debug)]
pub(super) struct Value<'a> {
    json: &'a serde_json::Value,
    path: String,
}

/// An object all of whose members are known.
#[derive(Clone, Debug)]
pub(super) struct Object<'a> {
    members: &'a serde_json::Map<String, serde_json::Value>,
    path: String,
}

impl<'a> Value<'a> {
    pub(super) fn root(json: &'a serde_json::Value) -> Self {
        Self { json, path: "$".into() }
    }

    /// An error at this place.
    pub(super) fn fault(&self, message: impl Into<String>) -> Error {
        Error::new(ErrorKind::Input, message).at_place(self.path.clone())
    }

    /// An error of something made from this value, at this place, as an input error.
    pub(super) fn blame(&self, error: &Error) -> Error {
        let place = error.place().map_or_else(|| self.path.clone(), |inner| format!("{}, {inner}", self.path));
        let kind = if error.kind() == ErrorKind::Usage { ErrorKind::Input } else { error.kind() };
        let named = error.path().map(|path| format!("{}: ", path.display())).unwrap_or_default();
        Error::new(kind, format!("{named}{}", error.message())).at_place(place)
    }

    /// The path in the document.
    pub(super) fn place(&self) -> String {
        self.path.clone()
    }

    fn expected(&self, what: &str) -> Error {
        let mut found = self.json.to_string();
        if found.chars().count() > 60 {
            found = found.chars().take(57).chain("...".chars()).collect();
        }
        self.fault(format!("expected {what}, found {found}"))
    }

    pub(super) fn text(&self) -> Result<&'a str> {
        self.json.as_str().ok_or_else(|| self.expected("text"))
    }

    pub(super) fn flag(&self) -> Result<bool> {
        self.json.as_bool().ok_or_else(|| self.expected("true or false"))
    }

    pub(super) fn number(&self) -> Result<f64> {
        self.json.as_f64().filter(|v| v.is_finite()).ok_or_else(|| self.expected("a finite number"))
    }

    /// The number, if it is one and not text.
    pub(super) fn is_text(&self) -> bool {
        self.json.is_string()
    }

    pub(super) fn is_array(&self) -> bool {
        self.json.is_array()
    }

    pub(super) fn number_within(&self, least: f64, most: f64) -> Result<f64> {
        let number = self.number()?;
        if number < least || number > most {
            let range = if most == f64::MAX { format!("at least {least}") } else { format!("from {least} to {most}") };
            return Err(self.fault(format!("expected a number {range}, found {number}")));
        }
        Ok(number)
    }

    pub(super) fn count(&self, least: u64, most: u64) -> Result<u64> {
        let found = self.json.as_u64().filter(|n| (least..=most).contains(n));
        found.ok_or_else(|| self.expected(&format!("a whole number from {least} to {most}")))
    }

    /// Exactly so many numbers.
    pub(super) fn numbers<const N: usize>(&self) -> Result<[f64; N]> {
        let items = self.items()?;
        if items.len() != N {
            return Err(self.expected(&format!("{N} numbers")));
        }
        let mut found = [0.0; N];
        for (slot, item) in found.iter_mut().zip(&items) {
            *slot = item.number()?;
        }
        Ok(found)
    }

    pub(super) fn items(&self) -> Result<Vec<Value<'a>>> {
        let items = self.json.as_array().ok_or_else(|| self.expected("a list"))?;
        let item = |(i, json)| Value { json, path: format!("{}[{i}]", self.path) };
        Ok(items.iter().enumerate().map(item).collect())
    }

    /// Names and values, in the file's order.
    pub(super) fn members(&self) -> Result<Vec<(String, Value<'a>)>> {
        let members = self.json.as_object().ok_or_else(|| self.expected("an object"))?;
        let member = |(name, json): (&String, &'a serde_json::Value)| {
            (name.clone(), Value { json, path: format!("{}.{name}", self.path) })
        };
        Ok(members.iter().map(member).collect())
    }

    /// The object, which may have these members only.
    pub(super) fn object(&self, known: &[&str]) -> Result<Object<'a>> {
        let members = self.json.as_object().ok_or_else(|| self.expected("an object"))?;
        if let Some(unknown) = members.keys().find(|name| !known.contains(&name.as_str())) {
            let message = format!("unknown member '{unknown}'; known are {}", known.join(", "));
            return Err(self.fault(message));
        }
        Ok(Object { members, path: self.path.clone() })
    }
}

impl<'a> Object<'a> {
    pub(super) fn get(&self, name: &str) -> Option<Value<'a>> {
        self.members.get(name).map(|json| Value { json, path: format!("{}.{name}", self.path) })
    }

    pub(super) fn need(&self, name: &str) -> Result<Value<'a>> {
        let missing = || Error::new(ErrorKind::Input, format!("'{name}' is missing")).at_place(self.path.clone());
        self.get(name).ok_or_else(missing)
    }

    pub(super) fn number_or(&self, name: &str, usual: f64) -> Result<f64> {
        self.get(name).map_or(Ok(usual), |value| value.number())
    }
}
