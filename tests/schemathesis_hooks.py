"""What a fuzzer needs to know beyond the OpenAPI document."""

import schemathesis


@schemathesis.hook
def map_body(context, body):
    """Claims that wait are answered late on purpose: a fuzzer's do not wait."""
    if context.operation.path == "/v1/worker/claims" and isinstance(body, dict):
        wait = body.get("wait_s")
        if isinstance(wait, (int, float)) and not isinstance(wait, bool) and 0 <= wait <= 30:
            body["wait_s"] = 0
    return body


# A checkpoint is bytes without a schema.
schemathesis.deserializer("application/octet-stream")(lambda context, response: response.content)
