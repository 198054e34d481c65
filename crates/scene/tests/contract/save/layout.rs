//! The layout of saved states as text, by a serializer that records names and types.
//!
//! A line is the path of a value and its type. Fields have numbers, since their order is part of
//! the layout; `[]` is a list, `[3]` an array, `?` an option and `::1 Name` a variant.

use serde::de::value::Error;
use serde::ser::{self, Serialize, Serializer};
use std::collections::BTreeSet;

pub(super) type Lines = BTreeSet<String>;

/// Returns the layout of a value.
pub(super) fn layout(value: &impl Serialize) -> Lines {
    value.serialize(Recorder).unwrap()
}

/// Returns lines after a common start of their paths.
fn under(path: &str, lines: &Lines) -> impl Iterator<Item = String> {
    lines.iter().map(move |line| format!("{path}{line}"))
}

struct Recorder;

/// The values of a list, an array or a struct.
struct Parts {
    path: String,
    is_list: bool,
    names: Vec<&'static str>,
    parts: Vec<Lines>,
}

impl Parts {
    fn new(path: String) -> Self {
        Self {
            path,
            is_list: false,
            names: Vec::new(),
            parts: Vec::new(),
        }
    }

    fn push(&mut self, value: &(impl Serialize + ?Sized)) -> Result<(), Error> {
        let lines = value.serialize(Recorder)?;
        if self.is_list && self.parts.contains(&lines) {
            return Ok(());
        }
        self.parts.push(lines);
        Ok(())
    }

    fn join(self) -> Lines {
        let Self {
            path,
            is_list,
            names,
            parts,
        } = self;
        let is_array = names.is_empty() && parts.windows(2).all(|pair| pair[0] == pair[1]);
        if is_list {
            let values = parts.iter().flat_map(|lines| under("[]", lines));
            values.chain(["[]".to_owned()]).collect()
        } else if is_array {
            let array = format!("{path}[{}]", parts.len());
            parts
                .iter()
                .flat_map(|lines| under(&array, lines))
                .collect()
        } else {
            let name = |i: usize| names.get(i).copied().unwrap_or_default();
            let fields = parts.iter().enumerate().map(|(i, lines)| {
                let field = format!("{path}/{i:02} {}", name(i));
                under(&field, lines).collect::<Lines>()
            });
            fields.flatten().collect()
        }
    }
}

macro_rules! leaves {
    ($($method:ident: $type:ty = $name:literal)+) => {$(
        fn $method(self, _: $type) -> Result<Lines, Error> {
            Ok(Lines::from([format!(": {}", $name)]))
        }
    )+};
}

macro_rules! parts {
    ($($trait:ident: $method:ident)+) => {$(
        impl ser::$trait for Parts {
            type Ok = Lines;
            type Error = Error;

            fn $method<T: Serialize + ?Sized>(&mut self, value: &T) -> Result<(), Error> {
                self.push(value)
            }

            fn end(self) -> Result<Lines, Error> {
                Ok(self.join())
            }
        }
    )+};
}

macro_rules! structs {
    ($($trait:ident)+) => {$(
        impl ser::$trait for Parts {
            type Ok = Lines;
            type Error = Error;

            fn serialize_field<T: Serialize + ?Sized>(
                &mut self,
                name: &'static str,
                value: &T,
            ) -> Result<(), Error> {
                self.names.push(name);
                self.push(value)
            }

            fn end(self) -> Result<Lines, Error> {
                Ok(self.join())
            }
        }
    )+};
}

parts!(SerializeSeq: serialize_element SerializeTuple: serialize_element);
parts!(SerializeTupleStruct: serialize_field SerializeTupleVariant: serialize_field);
structs!(SerializeStruct SerializeStructVariant);

impl Serializer for Recorder {
    type Ok = Lines;
    type Error = Error;
    type SerializeSeq = Parts;
    type SerializeTuple = Parts;
    type SerializeTupleStruct = Parts;
    type SerializeTupleVariant = Parts;
    type SerializeMap = ser::Impossible<Lines, Error>;
    type SerializeStruct = Parts;
    type SerializeStructVariant = Parts;

    leaves! {
        serialize_bool: bool = "bool"
        serialize_i8: i8 = "i8"
        serialize_i16: i16 = "i16"
        serialize_i32: i32 = "i32"
        serialize_i64: i64 = "i64"
        serialize_u8: u8 = "u8"
        serialize_u16: u16 = "u16"
        serialize_u32: u32 = "u32"
        serialize_u64: u64 = "u64"
        serialize_f32: f32 = "f32"
        serialize_f64: f64 = "f64"
        serialize_char: char = "char"
        serialize_str: &str = "str"
        serialize_bytes: &[u8] = "bytes"
        serialize_unit_struct: &'static str = "()"
    }

    fn is_human_readable(&self) -> bool {
        false
    }

    fn serialize_unit(self) -> Result<Lines, Error> {
        self.serialize_unit_struct("")
    }

    fn serialize_none(self) -> Result<Lines, Error> {
        Ok(Lines::from(["?".to_owned()]))
    }

    fn serialize_some<T: Serialize + ?Sized>(self, value: &T) -> Result<Lines, Error> {
        let value = under("?", &value.serialize(self)?).collect::<Lines>();
        Ok(value.into_iter().chain(["?".to_owned()]).collect())
    }

    fn serialize_unit_variant(
        self,
        _: &'static str,
        number: u32,
        name: &'static str,
    ) -> Result<Lines, Error> {
        Ok(Lines::from([format!("::{number} {name}")]))
    }

    fn serialize_newtype_struct<T: Serialize + ?Sized>(
        self,
        _: &'static str,
        value: &T,
    ) -> Result<Lines, Error> {
        value.serialize(self)
    }

    fn serialize_newtype_variant<T: Serialize + ?Sized>(
        self,
        _: &'static str,
        number: u32,
        name: &'static str,
        value: &T,
    ) -> Result<Lines, Error> {
        Ok(under(&format!("::{number} {name}"), &value.serialize(self)?).collect())
    }

    fn serialize_seq(self, _: Option<usize>) -> Result<Parts, Error> {
        Ok(Parts {
            is_list: true,
            ..Parts::new(String::new())
        })
    }

    fn serialize_tuple(self, _: usize) -> Result<Parts, Error> {
        Ok(Parts::new(String::new()))
    }

    fn serialize_tuple_struct(self, _: &'static str, _: usize) -> Result<Parts, Error> {
        Ok(Parts::new(String::new()))
    }

    fn serialize_tuple_variant(
        self,
        _: &'static str,
        number: u32,
        name: &'static str,
        _: usize,
    ) -> Result<Parts, Error> {
        Ok(Parts::new(format!("::{number} {name}")))
    }

    fn serialize_map(self, _: Option<usize>) -> Result<Self::SerializeMap, Error> {
        Err(ser::Error::custom("no state has a map"))
    }

    fn serialize_struct(self, _: &'static str, _: usize) -> Result<Parts, Error> {
        Ok(Parts::new(String::new()))
    }

    fn serialize_struct_variant(
        self,
        _: &'static str,
        number: u32,
        name: &'static str,
        _: usize,
    ) -> Result<Parts, Error> {
        Ok(Parts::new(format!("::{number} {name}")))
    }
}
