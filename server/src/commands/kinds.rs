//! `loadframe kinds`, `example`, `schema`: what can be run.
use clap::Args;
use loadframe_api::{JobKind, kind_schema};
use serde_json::{Value, json};

use super::failure::{Code, Failure};
use super::terminal::{say, say_json};

#[derive(Debug, Args)]
pub(crate) struct KindsArguments {
    /// Print the kinds as JSON
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Args)]
pub(crate) struct ExampleArguments {
    kind: JobKind,
    /// Another example than the first; `loadframe kinds` lists them
    #[arg(long)]
    name: Option<String>,
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
        return say_json(&kinds.collect::<Vec<Value>>());
    }
    for kind in JobKind::ALL {
        say(&format!("{}: {}", kind.name(), kind.title()));
        say(&format!("  {}", kind.description()));
        say(&format!("  examples: {}", names(*kind).join(", ")));
    }
    Ok(())
}

pub(crate) fn example(arguments: &ExampleArguments) -> Result<(), Failure> {
    let examples = arguments.kind.examples();
    let wanted = arguments.name.as_deref();
    let found = examples
        .iter()
        .find(|example| wanted.is_none_or(|wanted| wanted == example.name));
    let Some(example) = found else {
        let message = format!(
            "there is no such example; there are: {}",
            names(arguments.kind).join(", ")
        );
        return Err(Failure::new(Code::Usage, message));
    };
    say(example.body.trim_end());
    Ok(())
}

pub(crate) fn schema(arguments: SchemaArguments) -> Result<(), Failure> {
    say_json(kind_schema(arguments.kind))
}

fn names(kind: JobKind) -> Vec<&'static str> {
    kind.examples().iter().map(|example| example.name).collect()
}
