//! Lists of a fixed length that are longer than that: serde reads the front of such a list and TOML's
//! reader does not mind the rest, so a fourth coordinate would be lost without a word. Read through
//! [`Strict`], it is an error where it stands.

use serde::de::{
    DeserializeSeed, Deserializer, EnumAccess, Error, IgnoredAny, MapAccess, SeqAccess,
    VariantAccess, Visitor,
};
use std::fmt;

/// A deserializer, a visitor or an access whose lists must be read to their end.
pub(super) struct Strict<T>(pub T);

/// Methods that only pass a visitor on.
macro_rules! pass_on {
    ($($name:ident)*) => {
        $(fn $name<V: Visitor<'de>>(self, v: V) -> Result<V::Value, D::Error> {
            self.0.$name(Strict(v))
        })*
    };
}

impl<'de, D: Deserializer<'de>> Deserializer<'de> for Strict<D> {
    type Error = D::Error;

    pass_on! {
        deserialize_any deserialize_bool deserialize_i8 deserialize_i16 deserialize_i32
        deserialize_i64 deserialize_i128 deserialize_u8 deserialize_u16 deserialize_u32
        deserialize_u64 deserialize_u128 deserialize_f32 deserialize_f64 deserialize_char
        deserialize_str deserialize_string deserialize_bytes deserialize_byte_buf
        deserialize_option deserialize_unit deserialize_seq deserialize_map
        deserialize_identifier deserialize_ignored_any
    }

    fn deserialize_unit_struct<V: Visitor<'de>>(
        self,
        name: &'static str,
        v: V,
    ) -> Result<V::Value, D::Error> {
        self.0.deserialize_unit_struct(name, Strict(v))
    }
    fn deserialize_newtype_struct<V: Visitor<'de>>(
        self,
        name: &'static str,
        v: V,
    ) -> Result<V::Value, D::Error> {
        self.0.deserialize_newtype_struct(name, Strict(v))
    }
    fn deserialize_tuple<V: Visitor<'de>>(self, n: usize, v: V) -> Result<V::Value, D::Error> {
        self.0.deserialize_tuple(n, Strict(v))
    }
    fn deserialize_tuple_struct<V: Visitor<'de>>(
        self,
        name: &'static str,
        n: usize,
        v: V,
    ) -> Result<V::Value, D::Error> {
        self.0.deserialize_tuple_struct(name, n, Strict(v))
    }
    fn deserialize_struct<V: Visitor<'de>>(
        self,
        name: &'static str,
        fields: &'static [&'static str],
        v: V,
    ) -> Result<V::Value, D::Error> {
        self.0.deserialize_struct(name, fields, Strict(v))
    }
    fn deserialize_enum<V: Visitor<'de>>(
        self,
        name: &'static str,
        variants: &'static [&'static str],
        v: V,
    ) -> Result<V::Value, D::Error> {
        self.0.deserialize_enum(name, variants, Strict(v))
    }
    fn is_human_readable(&self) -> bool {
        self.0.is_human_readable()
    }
}

/// Methods that pass a value on as it is.
macro_rules! plain {
    ($($name:ident: $of:ty),*) => {
        $(fn $name<E: Error>(self, x: $of) -> Result<V::Value, E> {
            self.0.$name(x)
        })*
    };
}

impl<'de, V: Visitor<'de>> Visitor<'de> for Strict<V> {
    type Value = V::Value;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.expecting(f)
    }

    plain! {
        visit_bool: bool, visit_i64: i64, visit_i128: i128, visit_u64: u64, visit_u128: u128,
        visit_f64: f64, visit_char: char, visit_str: &str, visit_borrowed_str: &'de str,
        visit_string: String, visit_bytes: &[u8], visit_borrowed_bytes: &'de [u8],
        visit_byte_buf: Vec<u8>
    }

    fn visit_none<E: Error>(self) -> Result<V::Value, E> {
        self.0.visit_none()
    }
    fn visit_unit<E: Error>(self) -> Result<V::Value, E> {
        self.0.visit_unit()
    }
    fn visit_some<D: Deserializer<'de>>(self, d: D) -> Result<V::Value, D::Error> {
        self.0.visit_some(Strict(d))
    }
    fn visit_newtype_struct<D: Deserializer<'de>>(self, d: D) -> Result<V::Value, D::Error> {
        self.0.visit_newtype_struct(Strict(d))
    }
    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<V::Value, A::Error> {
        let mut read = 0;
        let value = self.0.visit_seq(Counted { list: &mut list, read: &mut read })?;
        let mut more = 0;
        while list.next_element::<IgnoredAny>()?.is_some() {
            more += 1;
        }
        if more > 0 {
            let why = format!("got {} values, expected {read}", read + more);
            return Err(A::Error::custom(why));
        }
        Ok(value)
    }
    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<V::Value, A::Error> {
        self.0.visit_map(Strict(map))
    }
    fn visit_enum<A: EnumAccess<'de>>(self, access: A) -> Result<V::Value, A::Error> {
        self.0.visit_enum(Strict(access))
    }
}

/// A list whose elements are counted as they are read.
struct Counted<'a, A> {
    list: &'a mut A,
    read: &'a mut usize,
}

impl<'de, A: SeqAccess<'de>> SeqAccess<'de> for Counted<'_, A> {
    type Error = A::Error;

    fn next_element_seed<S: DeserializeSeed<'de>>(
        &mut self,
        seed: S,
    ) -> Result<Option<S::Value>, A::Error> {
        let next = self.list.next_element_seed(Strict(seed))?;
        *self.read += usize::from(next.is_some());
        Ok(next)
    }
    fn size_hint(&self) -> Option<usize> {
        self.list.size_hint()
    }
}

impl<'de, S: DeserializeSeed<'de>> DeserializeSeed<'de> for Strict<S> {
    type Value = S::Value;

    fn deserialize<D: Deserializer<'de>>(self, d: D) -> Result<S::Value, D::Error> {
        self.0.deserialize(Strict(d))
    }
}

impl<'de, A: MapAccess<'de>> MapAccess<'de> for Strict<A> {
    type Error = A::Error;

    fn next_key_seed<S: DeserializeSeed<'de>>(
        &mut self,
        seed: S,
    ) -> Result<Option<S::Value>, A::Error> {
        self.0.next_key_seed(seed)
    }
    fn next_value_seed<S: DeserializeSeed<'de>>(&mut self, seed: S) -> Result<S::Value, A::Error> {
        self.0.next_value_seed(Strict(seed))
    }
    fn size_hint(&self) -> Option<usize> {
        self.0.size_hint()
    }
}

impl<'de, A: EnumAccess<'de>> EnumAccess<'de> for Strict<A> {
    type Error = A::Error;
    type Variant = Strict<A::Variant>;

    fn variant_seed<S: DeserializeSeed<'de>>(
        self,
        seed: S,
    ) -> Result<(S::Value, Self::Variant), A::Error> {
        self.0.variant_seed(seed).map(|(value, variant)| (value, Strict(variant)))
    }
}

impl<'de, A: VariantAccess<'de>> VariantAccess<'de> for Strict<A> {
    type Error = A::Error;

    fn unit_variant(self) -> Result<(), A::Error> {
        self.0.unit_variant()
    }
    fn newtype_variant_seed<S: DeserializeSeed<'de>>(self, seed: S) -> Result<S::Value, A::Error> {
        self.0.newtype_variant_seed(Strict(seed))
    }
    fn tuple_variant<V: Visitor<'de>>(self, n: usize, v: V) -> Result<V::Value, A::Error> {
        self.0.tuple_variant(n, Strict(v))
    }
    fn struct_variant<V: Visitor<'de>>(
        self,
        fields: &'static [&'static str],
        v: V,
    ) -> Result<V::Value, A::Error> {
        self.0.struct_variant(fields, Strict(v))
    }
}

#[cfg(test)]
mod tests {
    use crate::recipe::{Recipe, parse_solid, parse_surface};
    use std::path::Path;

    #[test]
    fn a_value_too_many_is_told_with_its_line() {
        let solid = "kind = \"solid\"\nparts = [\n  { box = { center = [0, 0, 5], size = [1, 2, 3, 4] } },\n]\n";
        let e = parse_solid(solid, Path::new("s.toml")).unwrap_err().to_string();
        assert_eq!(e, "s.toml:3: parts[0].box.size: got 4 values, expected 3");
        let recipe = "version = 1\n[shapes.a]\nmesh = \"a.stl\"\nmove = [1, 2, 3, 4, 5]\n";
        let e = Recipe::parse(recipe, Path::new("r.toml")).unwrap_err().to_string();
        assert_eq!(e, "r.toml:4: shapes.a.move: got 5 values, expected 3");
        let recipe =
            "version = 1\n[shapes.a]\nmesh = \"a.stl\"\n[morph]\nbetween = [\"a\", \"b\", \"c\"]\n";
        let e = Recipe::parse(recipe, Path::new("r.toml")).unwrap_err().to_string();
        assert!(e.starts_with("r.toml:5: morph.between: got 3 values"), "{e}");
    }

    #[test]
    fn also_in_surface_files_and_json() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/surfaces");
        let text = std::fs::read_to_string(root.join("dynamic-plate.toml")).unwrap();
        let file = Path::new("s.toml");
        assert!(parse_surface(&text, file).is_ok());
        let mut table: toml::Table = text.parse().unwrap();
        table.insert("grid".into(), toml::Value::try_from([11, 11, 11]).unwrap());
        let e = parse_surface(&table.to_string(), file).unwrap_err().to_string();
        assert!(e.contains("grid: got 3 values, expected 2"), "{e}");
        let json = r#"{"version": 1, "shapes": {"a": {"mesh": "a.stl", "move": [1, 2, 3, 4]}}}"#;
        let e = Recipe::parse(json, Path::new("r.json")).unwrap_err().to_string();
        assert!(e.contains("shapes.a.move"), "{e}");
    }
}
