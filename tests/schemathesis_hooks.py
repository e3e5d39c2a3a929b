"""What a fuzzer needs to know beyond the OpenAPI document."""

from urllib.parse import urlencode

import schemathesis

# HTTP itself refuses longer targets (64 kB, hyper), with 414 and before any route is asked.
LONGEST_QUERY = 60_000


@schemathesis.hook
def map_body(context, body):
    """Claims that wait are answered late on purpose: a fuzzer's do not wait."""
    if context.operation.path == "/v1/worker/claims" and isinstance(body, dict):
        wait = body.get("wait_s")
        if isinstance(wait, (int, float)) and not isinstance(wait, bool) and 0 <= wait <= 30:
            body["wait_s"] = 0
    return body


@schemathesis.hook
def filter_query(context, query):
    """Lists of a thousand ids and more are beyond HTTP, not beyond a route."""
    return not isinstance(query, dict) or len(urlencode(query, doseq=True)) < LONGEST_QUERY


# A checkpoint is bytes without a schema.
schemathesis.deserializer("application/octet-stream")(lambda context, response: response.content)
