//! JSON laid out for people: one field a line, lists of numbers on one line.

use serde::Serialize;
use serde_json::ser::{Formatter, PrettyFormatter, Serializer};
use std::io::{self, Write};

/// A formatter that indents objects and keeps arrays on one line.
pub(super) struct Layout(PrettyFormatter<'static>);

impl Layout {
    /// The text of a value, with a line break at its end; numbers that are not finite become `null`.
    ///
    /// # Panics
    /// When a map of the value has keys that are no strings; no type of this folder has any.
    pub(super) fn write(value: &impl Serialize) -> String {
        let mut bytes = vec![];
        let mut serializer = Serializer::with_formatter(&mut bytes, Self(PrettyFormatter::new()));
        value.serialize(&mut serializer).expect("maps by name, written to memory");
        bytes.push(b'\n');
        String::from_utf8(bytes).expect("JSON is UTF-8")
    }
}

impl Formatter for Layout {
    fn begin_array_value<W: ?Sized + Write>(&mut self, writer: &mut W, first: bool) -> io::Result<()> {
        if first { Ok(()) } else { writer.write_all(b", ") }
    }

    fn begin_object<W: ?Sized + Write>(&mut self, writer: &mut W) -> io::Result<()> {
        self.0.begin_object(writer)
    }

    fn end_object<W: ?Sized + Write>(&mut self, writer: &mut W) -> io::Result<()> {
        self.0.end_object(writer)
    }

    fn begin_object_key<W: ?Sized + Write>(&mut self, writer: &mut W, first: bool) -> io::Result<()> {
        self.0.begin_object_key(writer, first)
    }

    fn begin_object_value<W: ?Sized + Write>(&mut self, writer: &mut W) -> io::Result<()> {
        self.0.begin_object_value(writer)
    }

    fn end_object_value<W: ?Sized + Write>(&mut self, writer: &mut W) -> io::Result<()> {
        self.0.end_object_value(writer)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn lines() {
        let value = json!({"a": [1, 2.5], "b": [{"c": null}, {"c": []}], "d": {}});
        let text = Layout::write(&value);
        let expected = r#"{
  "a": [1, 2.5],
  "b": [{
    "c": null
  }, {
    "c": []
  }],
  "d": {}
}
"#;
        assert_eq!(text, expected);
        assert_eq!(serde_json::from_str::<serde_json::Value>(&text).unwrap(), value);
    }
}
