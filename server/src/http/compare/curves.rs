//! `GET /v1/curves`: one column over another, of many jobs.
use axum::body::Body;
use axum::extract::{Query, State};
use axum::http::{HeaderValue, header};
use axum::response::{IntoResponse, Response};
use futures_util::stream;
use loadframe_api::comparison::{ComparedCurve, Curves};
use loadframe_api::{JobStatus, Violation, csv_cell};
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

use super::super::AppState;
use super::super::bounded::{Number, Text};
use super::super::curve::push_number;
use super::super::decimate::Decimation;
use super::super::permit::{Permit, Read};
use super::super::problem::{ApiError, INVALID, Result};
use super::selection::comparing;
use crate::store::{Compared, CurvePart, Store, StoreError};
use crate::tasks::blocking;

/// Points of a curve unless asked otherwise: more than a screen has columns for a few hundred curves.
const POINTS: u64 = 1_000;
/// Points of all curves together in one answer, which is some tens of MB.
const MOST_POINTS: u64 = 1_000_000;
/// Fewest points that are left of a curve.
const FEWEST_POINTS: u64 = 100;
/// Points that are looked at for one answer, some seconds of work.
const MOST_LOOKED_AT: u64 = 50_000_000;

pub(super) fn router() -> OpenApiRouter<AppState> {
    OpenApiRouter::default()
        .routes(routes!(as_json))
        .routes(routes!(as_csv))
}

comparing! {
    struct CurvesQuery {
        /// Column that the curves are drawn over; the first of each curve when left out.
        #[param(value_type = String, required = false, min_length = 1, max_length = 200)]
        over: Option<Text<1, 200>>,
        /// Column that is drawn; the second of each curve when left out.
        #[param(value_type = String, required = false, min_length = 1, max_length = 200)]
        of: Option<Text<1, 200>>,
        /// Thins every curve out to at most so many points, 1000 when left out, keeping the first and the
        /// last point, the largest and the smallest value of both columns, and in every part between the
        /// largest and the smallest value drawn. Fewer where all together would be more than a million;
        /// the answer says how many.
        #[param(value_type = u64, required = false, minimum = 100, maximum = 10_000)]
        points: Option<Number<100, 10_000>>,
    }
}

comparing! {
    struct CurvesCsvQuery {
        /// Column that the curves are drawn over; the first of each curve when left out.
        #[param(value_type = String, required = false, min_length = 1, max_length = 200)]
        over: Option<Text<1, 200>>,
        /// Column that is drawn; the second of each curve when left out.
        #[param(value_type = String, required = false, min_length = 1, max_length = 200)]
        of: Option<Text<1, 200>>,
    }
}

/// Two columns by name; what is left out is the first or the second of the curve.
#[derive(Clone, Debug)]
struct Columns {
    over: Option<String>,
    of: Option<String>,
}

impl Columns {
    fn new(over: Option<Text<1, 200>>, of: Option<Text<1, 200>>) -> Self {
        let text = |name: Option<Text<1, 200>>| name.map(|Text(name)| name);
        Self {
            over: text(over),
            of: text(of),
        }
    }

    /// Their names in this job's curve, and where it begins; nothing where it has no such columns.
    fn of(&self, job: &Compared) -> Option<(String, String, CurvePart)> {
        let over = self.over.as_ref().or_else(|| job.columns.first())?;
        let of = self.of.as_ref().or_else(|| job.columns.get(1))?;
        let part = job.part(over, of)?;
        Some((over.clone(), of.clone(), part))
    }
}

/// Read many curves
///
/// One column over another of up to 1000 jobs, thinned out to what a plot shows. Jobs that you do not see
/// are `missing`, like those that do not exist.
#[utoipa::path(get, operation_id = "read_curves", path = "/v1/curves", tag = "Comparing",
    params(CurvesQuery),
    responses((status = 200, description = "The curves, in the order asked for", body = ref("#/components/schemas/Curves")),
              (status = 404, description = "There is no such comparison"),
              (status = 422, description = "The jobs are chosen in no way or in several, or their curves are too long"),
              (status = 503, description = "Too many jobs are being compared")))]
async fn as_json(
    State(state): State<AppState>,
    permit: Permit<Read>,
    Query(mut query): Query<CurvesQuery>,
) -> Result<Response> {
    let selected = query.selection().read(&state, &permit).await?;
    let looked_at: u64 = selected.jobs.iter().map(|job| job.points).sum();
    if looked_at > MOST_LOOKED_AT {
        let detail = "the curves are too long to be looked at in one answer";
        let violation = Violation::new("/jobs", "too_many_points", detail)
            .value(looked_at)
            .allowed(format!("curves of {MOST_LOOKED_AT} points together"));
        let refusal = ApiError::new(INVALID, "see what is wrong with it");
        return Err(refusal.violations(vec![violation]));
    }
    let asked = query.points.map_or(POINTS, |Number(points)| points);
    let share = MOST_POINTS / (selected.jobs.len() as u64).max(1);
    let points = asked.min(share).max(FEWEST_POINTS);
    let columns = Columns::new(query.over, query.of);
    let mut answer = Curves {
        points,
        missing: selected.missing.clone(),
        more: selected.more,
        ..Curves::default()
    };
    for job in &selected.jobs {
        match thinned(&permit.store, job, &columns, points).await? {
            Some(curve) => answer.curves.push(curve),
            None => answer.without.push(job.id),
        }
    }
    // as text while the turn lasts: of all that is done here, writing numbers takes longest
    let text = blocking(move || serde_json::to_vec(&answer)).await?;
    let text = text.map_err(|error| ApiError::internal(&error))?;
    drop(selected);
    let kind = HeaderValue::from_static("application/json");
    Ok(([(header::CONTENT_TYPE, kind)], text).into_response())
}

/// A job's curve in at most so many points; nothing where it has no such columns.
async fn thinned(
    store: &Store,
    job: &Compared,
    columns: &Columns,
    points: u64,
) -> Result<Option<ComparedCurve>> {
    let Some((over, of, mut part)) = columns.of(job) else {
        return Ok(None);
    };
    let mut decimation = Decimation::new(usize::try_from(points).unwrap_or(usize::MAX));
    let mut of_points = 0;
    loop {
        let (read, rest) = store.curve_part(part).await?;
        if read.is_empty() {
            break;
        }
        of_points += read.len() as u64;
        read.into_iter().for_each(|point| decimation.add(point));
        part = rest;
    }
    let (x, y) = decimation.finish().into_iter().map(|[x, y]| (x, y)).unzip();
    Ok(Some(ComparedCurve {
        job: job.id,
        over,
        of,
        x,
        y,
        of_points,
        complete: job.status == JobStatus::Finished,
    }))
}

/// Read many curves as CSV
///
/// All points with full digits: id and name of the job, and the two columns; one job after the other.
#[utoipa::path(get, operation_id = "read_curves_csv", path = "/v1/curves.csv", tag = "Comparing",
    params(CurvesCsvQuery),
    responses((status = 200, description = "The points", body = String, content_type = "text/csv"),
              (status = 404, description = "There is no such comparison"),
              (status = 422, description = "The jobs are chosen in no way or in several, or columns are left out where curves have others"),
              (status = 503, description = "Too many jobs are being compared")))]
async fn as_csv(
    State(state): State<AppState>,
    permit: Permit<Read>,
    Query(mut query): Query<CurvesCsvQuery>,
) -> Result<Response> {
    let selected = query.selection().read(&state, &permit).await?;
    let columns = Columns::new(query.over, query.of);
    let parts = selected.jobs.iter().filter_map(|job| {
        let (over, of, part) = columns.of(job)?;
        let cells = format!("{},{}", job.id, csv_cell(&job.name));
        Some(([over, of], (cells, part)))
    });
    let (mut names, parts): (Vec<_>, Vec<_>) = parts.unzip();
    names.dedup();
    let head = match names.as_slice() {
        [] => "job,name\n".to_owned(),
        [[over, of]] => format!("job,name,{},{}\n", csv_cell(over), csv_cell(of)),
        _ => {
            let detail = "these curves have different columns, which cannot stand under one name";
            let violation = Violation::new("/over", "columns_differ", detail);
            let refusal = ApiError::new(INVALID, "see what is wrong with it");
            return Err(refusal.violations(vec![violation.allowed("columns by name: over, of")]));
        }
    };
    let rows = stream::try_unfold(
        (permit.store.clone(), parts.into_iter(), None),
        async |(store, mut rest, current)| {
            let mut current: Option<(String, CurvePart)> = current;
            loop {
                let Some((cells, part)) = current.take().or_else(|| rest.next()) else {
                    return Ok::<_, StoreError>(None);
                };
                let (points, after) = store.curve_part(part).await?;
                if points.is_empty() {
                    continue;
                }
                let text = rows(&cells, &points);
                return Ok(Some((text, (store, rest, Some((cells, after))))));
            }
        },
    );
    let head = stream::once(async { Ok::<_, StoreError>(head) });
    let body = Body::from_stream(futures_util::StreamExt::chain(head, rows));
    let kind = HeaderValue::from_static("text/csv; charset=utf-8");
    let named = HeaderValue::from_static("attachment; filename=\"curves.csv\"");
    Ok((
        [
            (header::CONTENT_TYPE, kind),
            (header::CONTENT_DISPOSITION, named),
        ],
        body,
    )
        .into_response())
}

fn rows(cells: &str, points: &[[f64; 2]]) -> String {
    let mut text = String::with_capacity(points.len() * (cells.len() + 40));
    for [x, y] in points {
        text.push_str(cells);
        text.push(',');
        push_number(&mut text, *x);
        text.push(',');
        push_number(&mut text, *y);
        text.push('\n');
    }
    text
}
