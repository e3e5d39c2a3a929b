//! What all answers have in common.
use serde_json::{Map, Value, json};

/// Answers every route may give, with when.
const EVERYWHERE: &[(&str, &str)] = &[
    ("400", "The request cannot be read; `detail` says where"),
    (
        "403",
        "This is not for the caller to do; or an open server was addressed by another name than its machine's, or by a page from elsewhere",
    ),
    (
        "503",
        "The server is stopping or busy; try again after `Retry-After`",
    ),
];

/// Answers of routes that demand a token where tokens are demanded.
const BY_TOKEN: &[(&str, &str)] = &[
    (
        "401",
        "A token or a session is needed, or this one is not in force",
    ),
    (
        "429",
        "Too many wrong tokens, or bodies at once, came from this client",
    ),
];

/// Headers that belong to an answer.
const HEADERS: &[(&str, &str, &str)] = &[
    ("401", "WWW-Authenticate", "How to authenticate"),
    ("429", "Retry-After", "Seconds to wait"),
    ("503", "Retry-After", "Seconds to wait"),
];

/// Says in the answer to a submission which routes go on from the job.
pub(super) fn link_jobs(document: &mut Value) {
    let mut links = Map::new();
    let paths = document["paths"].as_object().into_iter().flatten();
    for (_, item) in paths.filter(|(path, _)| path.starts_with("/v1/jobs/{id}")) {
        for operation in item.as_object().into_iter().flat_map(Map::values) {
            if let Some(id) = operation["operationId"].as_str() {
                let link =
                    json!({ "operationId": id, "parameters": { "id": "$response.body#/id" } });
                links.insert(id.to_owned(), link);
            }
        }
    }
    document["paths"]["/v1/jobs"]["post"]["responses"]["201"]["links"] = Value::Object(links);
}

/// Completes the answers and parameters of every operation.
pub(super) fn complete(document: &mut Value) {
    let Some(paths) = document["paths"].as_object_mut() else {
        return;
    };
    for (path, item) in paths {
        let is_guarded = path.starts_with("/v1/") || path == "/metrics";
        for operation in item.as_object_mut().into_iter().flat_map(Map::values_mut) {
            if operation.get("responses").is_none() {
                continue;
            }
            let by_token = if is_guarded { BY_TOKEN } else { &[] };
            for (status, description) in EVERYWHERE.iter().chain(by_token) {
                let answer = &mut operation["responses"][status];
                if answer.is_null() {
                    *answer = json!({ "description": description });
                }
            }
            if is_guarded {
                // an open server asks for none
                operation["security"] = json!([{}, { "token": [] }, { "session": [] }]);
            }
            if let Some(body) = operation.get_mut("requestBody") {
                body["required"] = json!(true);
            }
            complete_answers(&mut operation["responses"]);
            let parameters = operation
                .get_mut("parameters")
                .and_then(Value::as_array_mut);
            for parameter in parameters.into_iter().flatten() {
                without_null(&mut parameter["schema"]);
            }
        }
    }
}

/// Gives every error the one form of all errors.
fn complete_answers(answers: &mut Value) {
    let Some(answers) = answers.as_object_mut() else {
        return;
    };
    answers.sort_keys();
    for (status, answer) in answers {
        if status.starts_with(['4', '5']) {
            answer["content"] = json!({ "application/problem+json": {
                "schema": { "$ref": "#/components/schemas/Problem" },
            }});
        }
        for (_, name, description) in HEADERS.iter().filter(|(of, _, _)| of == status) {
            answer["headers"][name] = json!({
                "description": description,
                "schema": { "type": "string" },
            });
        }
    }
}

/// What is left out is never null.
pub(super) fn without_null(schema: &mut Value) {
    if let Some(types) = schema.get_mut("type")
        && let Some([only]) = types
            .as_array()
            .map(|types| {
                let kept = types.iter().filter(|kind| *kind != "null").cloned();
                kept.collect::<Vec<_>>()
            })
            .as_deref()
    {
        *types = only.clone();
    }
}
