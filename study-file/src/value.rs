//! Values as written, with their place in the file.

use serde::de::value::{MapAccessDeserializer, SeqAccessDeserializer};
use serde::de::{Error, MapAccess, SeqAccess, Unexpected, Visitor};
use serde::{Deserialize, Deserializer};
use std::fmt;
use std::marker::PhantomData;
use std::ops::Range as Span;
use toml::Spanned;

/// A text.
pub type Text = Spanned<String>;

/// A whole number; the resolver checks its bounds.
pub type Whole = Spanned<i64>;

/// A finite number.
#[derive(Clone, Debug, PartialEq)]
pub struct Number {
    /// The number, within [`Number::MOST`] of zero.
    pub value: f64,
    /// Place in the file.
    pub span: Span<usize>,
}

impl Number {
    /// The largest magnitude: far beyond any dimension, far below where products overflow.
    pub const MOST: f64 = 1e12;

    /// Returns the value, or the expected kind of value.
    pub fn checked(value: f64) -> Result<f64, String> {
        let most = Number::MOST;
        if value.abs() <= most {
            Ok(value)
        } else if value.is_finite() {
            Err(format!("a number between -{most:e} and {most:e}"))
        } else {
            Err("a finite number".to_owned())
        }
    }

    /// Returns the value of a text, or the expected kind of value.
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

/// The visitor of a type that `written!` reads.
struct Written<T>(PhantomData<T>);

/// Defines the reading of a type from each kind of value in which it may be written.
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
    /// A list.
    List(Vec<Number>),
    /// Evenly spaced values.
    Range(Range),
}

/// Evenly spaced values, ends included.
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
    /// A word.
    Word(String),
    /// `[axle.right]`
    Own(Box<crate::file::OwnRight>),
}

written!(
    [] RightWheel, "\"mirrored\" or a table [axle.right]",
    word RightWheel::Word, table RightWheel::Own
);

/// All, none, or named ones.
#[derive(Clone, Debug)]
pub enum Selection {
    /// All if true, none if false.
    All(bool),
    /// Named ones.
    Named(Vec<Text>),
}

written!(
    [] Selection, "true, false or a list of hardpoint names",
    truth Selection::All, list Selection::Named
);

/// A member: by its name, or by its two ends.
#[derive(Clone, Debug)]
pub enum MemberName {
    /// Name of a load column.
    Name(String),
    /// The names of its ends.
    Ends(Vec<Text>),
}

written!(
    [] MemberName, "the name of a member or a list of its two ends",
    word MemberName::Name, list MemberName::Ends
);

/// One text, or several.
#[derive(Clone, Debug)]
pub enum OneOrMore {
    /// One.
    One(String),
    /// Several.
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
    /// A list.
    Many(Vec<T>),
}

/// One number, or a list of them.
pub type Numbers = OneOr<Number>;

/// A limit: one number, the same everywhere, or a curve of pairs, drive value and limit.
pub type LimitText = OneOr<Spanned<Vec<Number>>>;

/// Types of which a list may replace one number.
pub trait Listed {
    /// Expected value where either may stand.
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
