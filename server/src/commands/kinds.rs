//! `loadframe kinds`, `example`, `schema`: what can be run.
use clap::Args;
use loadframe_api::{Example, JobKind, kind_schema};
use serde_json::{Value, json};

use super::failure::{Code, Failure};
use super::terminal::{print_json, print_line};

#[derive(Debug, Args)]
pub(crate) struct KindsArguments {
    /// Print the kinds as JSON
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Args)]
pub(crate) struct ExampleArguments {
    /// Name of an example, or a kind for its first; `loadframe kinds` lists all
    name: String,
}

#[derive(Clone, Copy, Debug, Args)]
pub(crate) struct SchemaArguments {
    kind: JobKind,
}

pub(crate) fn list(arguments: KindsArguments) -> Result<(), Failure> {
    if arguments.json {
        let kinds = JobKind::ALL.iter().map(|kind| {
            json!({"kind": kind.name(), "title": kind.title(), "description": kind.description(),
                   "examples": names(*kind)})
        });
        return print_json(&kinds.collect::<Vec<Value>>());
    }
    for kind in JobKind::ALL {
        print_line(&format!("{}: {}", kind.name(), kind.title()));
        print_line(&format!("  {}", kind.description()));
        print_line(&format!("  examples: {}", names(*kind).join(", ")));
    }
    Ok(())
}

pub(crate) fn example(arguments: &ExampleArguments) -> Result<(), Failure> {
    let example = Example::named(&arguments.name)
        .map_err(|error| Failure::new(Code::Usage, error.to_string()))?;
    print_line(example.body.trim_end());
    Ok(())
}

pub(crate) fn schema(arguments: SchemaArguments) -> Result<(), Failure> {
    print_json(kind_schema(arguments.kind))
}

fn names(kind: JobKind) -> Vec<&'static str> {
    kind.examples().iter().map(|example| example.name).collect()
}
