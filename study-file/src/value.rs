//! Values as written, with their positions in the file.

use serde::de::value::{MapAccessDeserializer, SeqAccessDeserializer};
use serde::de::{Error, MapAccess, SeqAccess, Unexpected, Visitor};
use serde::{Deserialize, Deserializer};
use std::fmt;
use std::marker::PhantomData;
use std::ops::Range as Span;
use toml::Spanned;

/// A text with its position in the file.
pub type Text = Spanned<String>;

/// An integer with its position in the file. The resolver checks its limits.
pub type Whole = Spanned<i64>;

/// A finite number.
#[derive(Clone, Debug, PartialEq)]
pub struct Number {
    /// Value of the number. Its magnitude is at most [`Number::MOST`].
    pub value: f64,
    /// Byte range of the number in the file.
    pub span: Span<usize>,
}

impl Number {
    /// Largest permitted magnitude of a number. It is far above any dimension, and far below the limit at which products overflow.
    pub const MOST: f64 = 1e12;

    /// Checks a value. Returns it, or a description of the expected value.
    pub fn checked(value: f64) -> Result<f64, String> {
        let most = Number::MOST;
        if value.abs() <= most {
            Ok(value)
        } else if value.is_finite() {
            Err(format!("a number with a magnitude of at most {most:e}"))
        } else {
            Err("a finite number".to_owned())
        }
    }

    /// Parses a text. Returns the value of the number, or a description of the expected value.
    pub fn parsed(text: &str) -> Result<f64, String> {
        Number::checked(text.parse().unwrap_or(f64::NAN))
    }
}

impl<'de> Deserialize<'de> for Number {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let finite = Spanned::<Finite>::deserialize(deserializer)?;
        Ok(Number {
            span: finite.span(),
            value: finite.into_inner().0,
        })
    }
}

struct Finite(f64);

/// Serde visitor for a type that the macro `written!` makes readable.
struct Written<T>(PhantomData<T>);

/// Makes a type readable from each kind of value that may represent it.
macro_rules! written {
    ([$($generics:tt)*] $type:ty, $expected:expr, $($kind:ident $make:expr),+) => {
        impl<'de, $($generics)*> Deserialize<'de> for $type {
            fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                deserializer.deserialize_any(Written::<Self>(PhantomData))
            }
        }

        impl<'de, $($generics)*> Visitor<'de> for Written<$type> {
            type Value = $type;

            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str($expected)
            }

            $(written!($kind $make);)+
        }
    };
    (number $make:expr) => {
        fn visit_f64<E: Error>(self, value: f64) -> Result<Self::Value, E> {
            match Number::checked(value) {
                Ok(value) => Ok($make(value)),
                Err(wanted) => Err(E::invalid_value(Unexpected::Float(value), &&*wanted)),
            }
        }

        fn visit_i64<E: Error>(self, value: i64) -> Result<Self::Value, E> {
            self.visit_f64(value as f64)
        }
    };
    (beyond_i64 $make:expr) => {
        fn visit_u64<E: Error>(self, value: u64) -> Result<Self::Value, E> {
            self.visit_f64(value as f64)
        }
    };
    (truth $make:expr) => {
        fn visit_bool<E: Error>(self, value: bool) -> Result<Self::Value, E> {
            Ok($make(value))
        }
    };
    (word $make:expr) => {
        fn visit_str<E: Error>(self, value: &str) -> Result<Self::Value, E> {
            Ok($make(value.to_owned()))
        }
    };
    (list $make:expr) => {
        fn visit_seq<A: SeqAccess<'de>>(self, seq: A) -> Result<Self::Value, A::Error> {
            Deserialize::deserialize(SeqAccessDeserializer::new(seq)).map($make)
        }
    };
    (table $make:expr) => {
        fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Self::Value, A::Error> {
            Deserialize::deserialize(MapAccessDeserializer::new(map)).map($make)
        }
    };
}

written!([] Finite, "a number", number Finite, beyond_i64 Finite);

/// One value, a list of values, or a range.
#[derive(Clone, Debug)]
pub enum Values {
    /// One value.
    One(f64),
    /// List of values.
    List(Vec<Number>),
    /// Evenly spaced values.
    Range(Range),
}

/// Evenly spaced values, including both ends.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Range {
    /// First value.
    pub from: Number,
    /// Last value.
    pub to: Number,
    /// Number of values.
    pub steps: Whole,
}

written!(
    [] Values, "a number, a list of numbers or { from, to, steps }",
    number Values::One, list Values::List, table Values::Range
);

/// Value of `right` in `[axle]`.
#[derive(Debug)]
pub enum RightWheel {
    /// A word such as `mirrored`.
    Word(String),
    /// `[axle.right]`
    Own(Box<crate::file::OwnRight>),
}

written!(
    [] RightWheel, "\"mirrored\" or a table [axle.right]",
    word RightWheel::Word, table RightWheel::Own
);

/// Selection of all items, of no item, or of named items.
#[derive(Clone, Debug)]
pub enum Selection {
    /// All items if true, none if false.
    All(bool),
    /// Names of the items.
    Named(Vec<Text>),
}

written!(
    [] Selection, "true, false or a list of hardpoint names",
    truth Selection::All, list Selection::Named
);

/// A member, given by its name or by its two ends.
#[derive(Clone, Debug)]
pub enum MemberName {
    /// Name of a member, as in the columns of loads.
    Name(String),
    /// Names of both ends.
    Ends(Vec<Text>),
}

written!(
    [] MemberName, "the name of a member, or a list of the two ends of the member",
    word MemberName::Name, list MemberName::Ends
);

/// One text, or several.
#[derive(Clone, Debug)]
pub enum OneOrMore {
    /// One text.
    One(String),
    /// Several texts.
    More(Vec<Text>),
}

written!(
    [] OneOrMore, "a text or a list of texts",
    word OneOrMore::One, list OneOrMore::More
);

/// One number, or a list.
#[derive(Clone, Debug)]
pub enum OneOr<T> {
    /// One number.
    One(f64),
    /// List of numbers.
    Many(Vec<T>),
}

/// One number, or a list of numbers.
pub type Numbers = OneOr<Number>;

/// A limit. It is one number for the whole motion, or a curve with pairs of drive value and limit.
pub type LimitText = OneOr<Spanned<Vec<Number>>>;

/// Types whose values a study may give as a list instead of a single number.
pub trait Listed {
    /// Description of the expected value, for messages, where a number or a list is allowed.
    const EXPECTED: &str;
}

impl Listed for Number {
    const EXPECTED: &str = "a number or a list of numbers";
}

impl Listed for Spanned<Vec<Number>> {
    const EXPECTED: &str = "a number or a curve [[drive value, limit], ...]";
}

written!(
    [T: Deserialize<'de> + Listed] OneOr<T>, T::EXPECTED,
    number OneOr::One, list OneOr::Many
);
