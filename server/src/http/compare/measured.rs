//! `POST /v1/curves/measured`: a measured curve, read as calibrations read it.
use axum::Json;
use axum::extract::State;
use loadframe_api::Violation;
use loadframe_api::comparison::MeasuredReading;
use loadframe_api::spec::calibrate::MeasuredCurve;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

use super::super::AppState;
use super::super::body::{JsonBody, message};
use super::super::permit::{Permit, Read};
use super::super::problem::{ApiError, INVALID, Result};

pub(super) fn router() -> OpenApiRouter<AppState> {
    OpenApiRouter::default().routes(routes!(read))
}

/// Read a measured curve
///
/// The text of a testing machine's file (`csv`), read as two `columns` of jobs' curves, in their units;
/// what it leaves open stands in `reading`. The same reader as in calibrations. Nothing is kept.
#[utoipa::path(post, operation_id = "read_measured_curve", path = "/v1/curves/measured", tag = "Comparing",
    request_body(content = ref("#/components/schemas/MeasuredCurve"), description = "The text, and the columns it is read as"),
    responses((status = 200, description = "The points, and how they were understood", body = ref("#/components/schemas/MeasuredReading")),
              (status = 408, description = "The body did not arrive in time"),
              (status = 413, description = "The body is too large"),
              (status = 415, description = "The body is not declared as JSON"),
              (status = 422, description = "It cannot be understood, or in two ways; see `violations`")))]
async fn read(
    State(state): State<AppState>,
    _: Permit<Read>,
    body: JsonBody,
) -> Result<Json<MeasuredReading>> {
    let client = body.client;
    let curve: MeasuredCurve = message(&state, body).await?;
    let reading = move || reading(&curve);
    let read = state.checks.run(client, reading).await?;
    read.map(Json).map_err(|violation| {
        let refusal = ApiError::new(INVALID, "the curve cannot be read");
        refusal.violations(vec![violation])
    })
}

fn reading(curve: &MeasuredCurve) -> Result<MeasuredReading, Violation> {
    let missing = |pointer: &str, detail: &str, allowed: &str| {
        Violation::new(pointer, "required", detail).allowed(allowed)
    };
    let Some(text) = &curve.csv else {
        let detail = "there is no text to read";
        return Err(missing(
            "/csv",
            detail,
            "the text of the file, or the file in base64",
        ));
    };
    let Some(columns) = &curve.columns else {
        let detail = "it is not said which columns of the jobs were measured";
        return Err(missing(
            "/columns",
            detail,
            "names of two columns of curves",
        ));
    };
    let read = curve.read_columns(text, columns.clone(), None)?;
    let (x, y) = read.points.into_iter().map(|[x, y]| (x, y)).unzip();
    Ok(MeasuredReading {
        columns: columns.clone(),
        x,
        y,
        read_as: read.words,
    })
}
