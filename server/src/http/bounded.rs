//! Values of query parameters that carry their limits in their type.
use std::fmt;

use serde::de::{Deserialize, Deserializer, Error, Visitor};

/// A whole number from `LOW` to `HIGH`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Number<const LOW: u64, const HIGH: u64>(pub(super) u64);

/// A text of `SHORTEST` to `LONGEST` characters.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Text<const SHORTEST: usize, const LONGEST: usize>(pub(super) String);

impl<'de, const LOW: u64, const HIGH: u64> Deserialize<'de> for Number<LOW, HIGH> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let number = u64::deserialize(deserializer)?;
        if (LOW..=HIGH).contains(&number) {
            Ok(Self(number))
        } else {
            Err(D::Error::custom(format_args!(
                "{number} is not in {LOW} … {HIGH}"
            )))
        }
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
                "{length} characters are not {SHORTEST} … {LONGEST}"
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
