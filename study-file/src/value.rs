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

/// A whole number; the resolver knows its bounds.
pub type Whole = Spanned<i64>;

/// A finite number.
#[derive(Clone, Debug, PartialEq)]
pub struct Number {
    /// The number, within [`Number::MOST`] of zero.
    pub value: f64,
    /// Its place.
    pub span: Span<usize>,
}

impl Number {
    /// The largest magnitude: far beyond any dimension, far below where products overflow.
    pub const MOST: f64 = 1e12;

    /// The value, or what it should have been.
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

    /// The value of a text, or what it should have been.
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

impl<'de> Deserialize<'de> for Finite {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(FiniteVisitor).map(Finite)
    }
}

struct FiniteVisitor;

impl Visitor<'_> for FiniteVisitor {
    type Value = f64;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a number")
    }

    fn visit_f64<E: Error>(self, value: f64) -> Result<f64, E> {
        Number::checked(value)
            .map_err(|wanted| E::invalid_value(Unexpected::Float(value), &&*wanted))
    }

    fn visit_i64<E: Error>(self, value: i64) -> Result<f64, E> {
        self.visit_f64(value as f64)
    }

    fn visit_u64<E: Error>(self, value: u64) -> Result<f64, E> {
        self.visit_f64(value as f64)
    }
}

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

impl<'de> Deserialize<'de> for Values {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(ValuesVisitor)
    }
}

struct ValuesVisitor;

impl<'de> Visitor<'de> for ValuesVisitor {
    type Value = Values;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a number, a list of numbers or { from, to, steps }")
    }

    fn visit_f64<E: Error>(self, value: f64) -> Result<Values, E> {
        FiniteVisitor.visit_f64(value).map(Values::One)
    }

    fn visit_i64<E: Error>(self, value: i64) -> Result<Values, E> {
        self.visit_f64(value as f64)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, seq: A) -> Result<Values, A::Error> {
        Vec::deserialize(SeqAccessDeserializer::new(seq)).map(Values::List)
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Values, A::Error> {
        Range::deserialize(MapAccessDeserializer::new(map)).map(Values::Range)
    }
}

/// What `right` of `[axle]` is.
#[derive(Debug)]
pub enum RightWheel {
    /// A word.
    Word(String),
    /// `[axle.right]`
    Own(Box<crate::file::OwnRight>),
}

impl<'de> Deserialize<'de> for RightWheel {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(RightWheelVisitor)
    }
}

struct RightWheelVisitor;

impl<'de> Visitor<'de> for RightWheelVisitor {
    type Value = RightWheel;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("\"mirrored\" or a table [axle.right]")
    }

    fn visit_str<E: Error>(self, word: &str) -> Result<RightWheel, E> {
        Ok(RightWheel::Word(word.to_owned()))
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<RightWheel, A::Error> {
        let own = crate::file::OwnRight::deserialize(MapAccessDeserializer::new(map))?;
        Ok(RightWheel::Own(Box::new(own)))
    }
}

/// All, none, or those named.
#[derive(Clone, Debug)]
pub enum Selection {
    /// All or none.
    All(bool),
    /// Those named.
    Named(Vec<Text>),
}

impl<'de> Deserialize<'de> for Selection {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(SelectionVisitor)
    }
}

struct SelectionVisitor;

impl<'de> Visitor<'de> for SelectionVisitor {
    type Value = Selection;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("true, false or a list of hardpoint names")
    }

    fn visit_bool<E: Error>(self, all: bool) -> Result<Selection, E> {
        Ok(Selection::All(all))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, seq: A) -> Result<Selection, A::Error> {
        Vec::deserialize(SeqAccessDeserializer::new(seq)).map(Selection::Named)
    }
}

/// A member: by its name, or by its two ends.
#[derive(Clone, Debug)]
pub enum MemberName {
    /// As in the columns of loads.
    Name(String),
    /// The names of its ends.
    Ends(Vec<Text>),
}

impl<'de> Deserialize<'de> for MemberName {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(MemberNameVisitor)
    }
}

struct MemberNameVisitor;

impl<'de> Visitor<'de> for MemberNameVisitor {
    type Value = MemberName;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("the name of a member or a list of its two ends")
    }

    fn visit_str<E: Error>(self, name: &str) -> Result<MemberName, E> {
        Ok(MemberName::Name(name.to_owned()))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, seq: A) -> Result<MemberName, A::Error> {
        Vec::deserialize(SeqAccessDeserializer::new(seq)).map(MemberName::Ends)
    }
}

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

/// What may stand in a list in place of one number.
pub trait Listed {
    /// What is expected where either may stand.
    const EXPECTED: &str;
}

impl Listed for Number {
    const EXPECTED: &str = "a number or a list of numbers";
}

impl Listed for Spanned<Vec<Number>> {
    const EXPECTED: &str = "a number or a curve [[drive value, limit], ...]";
}

impl<'de, T: Deserialize<'de> + Listed> Deserialize<'de> for OneOr<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(OneOrVisitor(PhantomData))
    }
}

struct OneOrVisitor<T>(PhantomData<T>);

impl<'de, T: Deserialize<'de> + Listed> Visitor<'de> for OneOrVisitor<T> {
    type Value = OneOr<T>;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(T::EXPECTED)
    }

    fn visit_f64<E: Error>(self, value: f64) -> Result<OneOr<T>, E> {
        FiniteVisitor.visit_f64(value).map(OneOr::One)
    }

    fn visit_i64<E: Error>(self, value: i64) -> Result<OneOr<T>, E> {
        self.visit_f64(value as f64)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, seq: A) -> Result<OneOr<T>, A::Error> {
        Vec::deserialize(SeqAccessDeserializer::new(seq)).map(OneOr::Many)
    }
}
