//! Values of query parameters that carry their limits in their type.
use std::fmt;

use loadframe_api::Timestamp;
use serde::de::{Deserialize, Deserializer, Error, Visitor};

/// A whole number from `LOW` to `HIGH`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Number<const LOW: u64, const HIGH: u64>(pub(super) u64);

/// A moment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Moment(pub(super) Timestamp);

/// A text of `SHORTEST` to `LONGEST` characters.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Text<const SHORTEST: usize, const LONGEST: usize>(pub(super) String);

impl<'de, const LOW: u64, const HIGH: u64> Deserialize<'de> for Number<LOW, HIGH> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let text = String::deserialize(deserializer)?;
        match text.parse() {
            Ok(number) if (LOW..=HIGH).contains(&number) => Ok(Self(number)),
            _ => Err(D::Error::custom(format_args!(
                "it must be a whole number, {LOW} … {HIGH}"
            ))),
        }
    }
}

impl<'de> Deserialize<'de> for Moment {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let text = String::deserialize(deserializer)?;
        let moment = text.parse().map(Self);
        moment.map_err(|error| {
            D::Error::custom(format_args!(
                "{error}; it must be a moment with its time and zone, as \"2026-11-29T09:00:00Z\" (RFC 3339)"
            ))
        })
    }
}

impl<'de, const SHORTEST: usize, const LONGEST: usize> Deserialize<'de>
    for Text<SHORTEST, LONGEST>
{
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let text = String::deserialize(deserializer)?;
        let length = text.chars().count();
        if (SHORTEST..=LONGEST).contains(&length) {
            Ok(Self(text))
        } else {
            Err(D::Error::custom(format_args!(
                "it has {length} characters; it must be a text of {SHORTEST} … {LONGEST}"
            )))
        }
    }
}

/// Several values, separated by commas.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Listed<T, const MOST: usize>(pub(super) Vec<T>);

impl<'de, T: std::str::FromStr<Err: fmt::Display>, const MOST: usize> Deserialize<'de>
    for Listed<T, MOST>
{
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Values<T, const MOST: usize>(std::marker::PhantomData<T>);
        impl<T: std::str::FromStr<Err: fmt::Display>, const MOST: usize> Visitor<'_> for Values<T, MOST> {
            type Value = Listed<T, MOST>;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                write!(f, "1 … {MOST} values separated by commas")
            }

            fn visit_str<E: Error>(self, text: &str) -> Result<Self::Value, E> {
                let values = text.split(',').map(|part| part.trim().parse::<T>());
                let values = values.collect::<Result<Vec<_>, _>>().map_err(E::custom)?;
                if values.len() > MOST {
                    return Err(E::invalid_length(values.len(), &self));
                }
                Ok(Listed(values))
            }
        }
        deserializer.deserialize_str(Values::<T, MOST>(std::marker::PhantomData))
    }
}
