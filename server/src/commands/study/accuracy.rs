//! `loadframe study accuracy`: what exactness costs.
use clap::Args;
use loadframe_study::accuracy::{Design, Request};

use super::carry_out::{Options, carry_out};
use crate::commands::failure::{Code, Failure};
use crate::commands::source::SpecArgument;

#[derive(Debug, Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    spec: SpecArgument,
    /// Vary this knob only, over these values or its own; may be given several times. Without it,
    /// all knobs of the kind are varied, one at a time
    #[arg(long = "knob", value_name = "NAME[=V,V,...]", value_parser = request)]
    knobs: Vec<Request>,
    /// Specimens at each setting: the same seeds everywhere, from the spec's own on
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..=1000))]
    seeds: u32,
    #[command(flatten)]
    options: Options,
}

/// `force_accuracy=5,100` or `force_accuracy`.
fn request(text: &str) -> Result<Request, String> {
    let (knob, values) = text.split_once('=').unwrap_or((text, ""));
    let values: Vec<String> = values
        .split(',')
        .map(|value| value.trim().to_owned())
        .filter(|value| !value.is_empty())
        .collect();
    if text.contains('=') && values.is_empty() {
        return Err("there is no value after the =".to_owned());
    }
    Ok(Request {
        knob: knob.trim().to_owned(),
        values,
    })
}

pub(crate) fn perform(arguments: Arguments) -> Result<(), Failure> {
    let submission = arguments.spec.read()?.submission()?;
    let design = Design::new(&submission.spec, &arguments.knobs, arguments.seeds)
        .map_err(|error| Failure::new(Code::Usage, error.to_string()))?;
    let title = format!("Accuracy of {}", submission.name);
    carry_out(design, &title, arguments.options)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn knobs_are_given_with_values_or_without() {
        let values = |text| request(text).map(|request| (request.knob, request.values.join("|")));
        let parsed = |knob: &str, values: &str| Ok((knob.to_owned(), values.to_owned()));
        assert_eq!(values("solver"), parsed("solver", ""));
        assert_eq!(values("a=5, 1e3,"), parsed("a", "5|1e3"));
        assert!(request("a=").is_err());
    }
}
