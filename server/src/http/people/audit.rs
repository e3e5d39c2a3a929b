//! `/v1/audit`: what was done, by whom.
use axum::Json;
use axum::body::Body;
use axum::extract::Query;
use axum::http::{HeaderValue, header};
use axum::response::{IntoResponse, Response};
use futures_util::stream;
use loadframe_api::people::AuditEntry;
use loadframe_api::{Page, csv_cell};
use serde::Deserialize;
use utoipa::IntoParams;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;
use uuid::Uuid;

use super::super::AppState;
use super::super::bounded::{Number, Text};
use super::super::permit::{Administer, Permit};
use super::super::problem::Result;
use crate::store::people::AuditFilter;
use crate::store::{Store, StoreError};

/// Lines on a page unless asked otherwise.
const PAGE: u32 = 100;
/// Lines read at once for CSV.
const BLOCK: u32 = 1000;

pub(super) fn router() -> OpenApiRouter<AppState> {
    OpenApiRouter::default()
        .routes(routes!(read))
        .routes(routes!(as_csv))
}

#[derive(Debug, Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
struct AuditQuery {
    /// Most lines on a page; 100 when left out.
    #[param(value_type = u32, required = false, minimum = 1, maximum = 1000)]
    limit: Option<Number<1, 1000>>,
    /// `next` of the page before.
    #[param(value_type = String, required = false, min_length = 1, max_length = 20)]
    cursor: Option<Text<1, 20>>,
    /// Only what this person did.
    #[param(value_type = Uuid, required = false)]
    person: Option<Uuid>,
    /// Only what was done to this job, project, person, token or link.
    #[param(value_type = Uuid, required = false)]
    object: Option<Uuid>,
}

#[derive(Debug, Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
struct ExportQuery {
    /// Only what this person did.
    #[param(value_type = Uuid, required = false)]
    person: Option<Uuid>,
    /// Only what was done to this job, project, person, token or link.
    #[param(value_type = Uuid, required = false)]
    object: Option<Uuid>,
}

/// Read the audit log
///
/// The newest line first. Nothing in it is ever changed or removed.
#[utoipa::path(get, operation_id = "read_audit", path = "/v1/audit", tag = "People",
    params(AuditQuery),
    responses((status = 200, description = "A page of lines", body = ref("#/components/schemas/AuditEntryPage")),
              (status = 422, description = "The cursor is not one of this server")))]
async fn read(
    permit: Permit<Administer>,
    Query(query): Query<AuditQuery>,
) -> Result<Json<Page<AuditEntry>>> {
    let before = query.cursor.map(|Text(cursor)| cursor.parse::<u64>());
    let before = before.transpose().map_err(|_| {
        StoreError::Invalid("the cursor is not one that a page gave as `next`".to_owned())
    })?;
    let filter = AuditFilter {
        person: query.person,
        object: query.object,
        before,
        limit: query.limit.map_or(PAGE, |Number(limit)| limit as u32),
    };
    Ok(Json(permit.store.audit(&filter).await?))
}

/// Export the audit log as CSV
///
/// All lines, the newest first. A cell that a spreadsheet would take for a formula begins with `'`.
#[utoipa::path(get, operation_id = "export_audit", path = "/v1/audit.csv", tag = "People",
    params(ExportQuery),
    responses((status = 200, description = "All lines", body = String, content_type = "text/csv")))]
async fn as_csv(permit: Permit<Administer>, Query(query): Query<ExportQuery>) -> Result<Response> {
    let filter = AuditFilter {
        person: query.person,
        object: query.object,
        before: None,
        limit: BLOCK,
    };
    let heading = "number,at,who,person,credential,action,object,detail,request,address\n";
    let store = permit.store.clone();
    // the first block at once: an error after the head could not be told
    let first = store.audit(&filter).await?;
    let state = Some((Some(first), filter, store));
    let blocks = stream::unfold(state, |state| async {
        let (page, filter, store) = state?;
        let page = match page {
            Some(page) => page,
            None => match store.audit(&filter).await {
                Ok(page) => page,
                Err(error) => return Some((Err(error), None)),
            },
        };
        Some((Ok(rows(&page)), following(&page, filter, store)))
    });
    let kind = HeaderValue::from_static("text/csv; charset=utf-8");
    let name = HeaderValue::from_static("attachment; filename=\"audit.csv\"");
    let headers = [
        (header::CONTENT_TYPE, kind),
        (header::CONTENT_DISPOSITION, name),
    ];
    let head = stream::once(async move { Ok::<_, StoreError>(heading.to_owned()) });
    let body = futures_util::StreamExt::chain(head, blocks);
    Ok((headers, Body::from_stream(body)).into_response())
}

type Export = (Option<Page<AuditEntry>>, AuditFilter, Store);

fn following(page: &Page<AuditEntry>, filter: AuditFilter, store: Store) -> Option<Export> {
    let before = page.next.as_ref()?.parse().ok();
    Some((None, AuditFilter { before, ..filter }, store))
}

fn rows(page: &Page<AuditEntry>) -> String {
    let id = |id: Option<Uuid>| id.map_or_else(String::new, |id| id.to_string());
    let row = |entry: &AuditEntry| {
        let cells = [
            entry.number.to_string(),
            entry.at.to_string(),
            csv_cell(&entry.who).into_owned(),
            id(entry.person),
            id(entry.credential),
            csv_cell(&entry.action).into_owned(),
            id(entry.object),
            csv_cell(&entry.detail).into_owned(),
            id(entry.request),
            csv_cell(&entry.address).into_owned(),
        ];
        cells.join(",") + "\n"
    };
    page.items.iter().map(row).collect()
}
