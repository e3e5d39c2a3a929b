//! One route, for people.
use serde_json::Value;

use crate::ServeConfig;
use crate::http::schema;
use crate::http::text::{line, prose, text};

/// A route and a method.
#[derive(Debug)]
pub(super) struct Operation<'a> {
    pub(super) tag: &'a str,
    method: &'a str,
    path: &'a str,
    content: &'a Value,
}

/// Every operation of the document, in its order.
pub(super) fn all(document: &Value) -> Vec<Operation<'_>> {
    let mut operations = Vec::new();
    for (path, item) in document["paths"].as_object().into_iter().flatten() {
        for (method, content) in item.as_object().into_iter().flatten() {
            let tag = content["tags"][0].as_str().unwrap_or("");
            operations.push(Operation {
                tag,
                method,
                path,
                content,
            });
        }
    }
    operations
}

impl Operation<'_> {
    pub(super) fn html(&self) -> String {
        let word = |name: &str| self.content[name].as_str().unwrap_or("");
        format!(
            "<details id=\"{id}\"><summary><b class=\"{method}\">{upper}</b> <code>{path}</code> <span>{summary}</span></summary>\
             {description}{parameters}{body}{answers}<pre>{curl}</pre></details>\n",
            id = text(word("operationId")),
            method = self.method,
            upper = self.method.to_uppercase(),
            path = text(self.path),
            summary = line(word("summary")),
            description = prose(word("description")),
            parameters = self.parameters(),
            body = self.body(),
            answers = self.answers(),
            curl = text(&self.curl()),
        )
    }

    fn parameters(&self) -> String {
        let Some(parameters) = self.content["parameters"].as_array() else {
            return String::new();
        };
        let row = |parameter: &Value| {
            let word = |name: &str| parameter[name].as_str().unwrap_or("");
            format!(
                "<tr><td><code>{}</code><td>{}<td>{}<td>{}</tr>",
                text(word("name")),
                text(word("in")),
                schema::describe(&parameter["schema"]),
                line(word("description")),
            )
        };
        let rows: String = parameters.iter().map(row).collect();
        format!(
            "<h3>Parameters</h3><div class=\"wide\" tabindex=\"0\"><table><tbody>{rows}</tbody></table></div>"
        )
    }

    fn body(&self) -> String {
        let body = &self.content["requestBody"];
        let contents = body["content"].as_object();
        let Some((media_type, content)) = contents.and_then(|contents| contents.iter().next())
        else {
            return String::new();
        };
        let examples = content["examples"].as_object().into_iter().flatten();
        let examples = examples.map(|(name, example)| {
            let json = serde_json::to_string_pretty(&example["value"]).unwrap_or_default();
            let summary = line(example["summary"].as_str().unwrap_or(name));
            format!(
                "<details><summary>Example: {summary}</summary><pre>{}</pre></details>",
                text(&json)
            )
        });
        format!(
            "<h3>Body</h3><p>{} <code>{}</code> {}</p>{}",
            line(body["description"].as_str().unwrap_or("")),
            text(media_type),
            schema::describe(&content["schema"]),
            examples.collect::<String>(),
        )
    }

    fn answers(&self) -> String {
        let answers = self.content["responses"].as_object().into_iter().flatten();
        let row = |(status, answer): (&String, &Value)| {
            let contents = answer["content"].as_object().into_iter().flatten();
            let contents = contents.map(|(media_type, content)| {
                let of = schema::describe(&content["schema"]);
                format!("<code>{}</code> {of} ", text(media_type))
            });
            let headers = answer["headers"].as_object().into_iter().flatten();
            let headers = headers.map(|(name, _)| format!("<code>{}</code> ", text(name)));
            format!(
                "<tr><td>{}<td>{}<td>{}<td>{}</tr>",
                text(status),
                line(answer["description"].as_str().unwrap_or("")),
                contents.collect::<String>(),
                headers.collect::<String>(),
            )
        };
        let rows: String = answers.map(row).collect();
        format!(
            "<h3>Answers</h3><div class=\"wide\" tabindex=\"0\"><table><tbody>{rows}</tbody></table></div>"
        )
    }

    /// The request as a line for a shell.
    fn curl(&self) -> String {
        let method = match self.method {
            "get" | "post" => String::new(),
            other => format!(" -X {}", other.to_uppercase()),
        };
        let has_json = self.content["requestBody"]["content"]
            .get("application/json")
            .is_some();
        let (kind, body) = match (self.method, has_json) {
            (_, true) => (" -H 'content-type: application/json'", " -d @body.json"),
            ("post", false) => (" -X POST", ""),
            ("put", false) => ("", " --data-binary @file"),
            _ => ("", ""),
        };
        let stream = match self.path.ends_with("/events") {
            true => " -N",
            false => "",
        };
        let host = ServeConfig::DEFAULT_LISTEN;
        let path = self.path.replace('{', "$").replace('}', "");
        format!("curl -sS{stream}{method}{kind}{body} \"http://{host}{path}\"")
    }
}
