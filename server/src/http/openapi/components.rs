//! `#/components/schemas`: every type of the wire by name.
use loadframe_api::allocations::{AllocationReport, Backlog, ReportedAllocations};
use loadframe_api::comparison::{
    ComparisonChanges, ComparisonView, Curves, Differences, MeasuredReading, NewComparison,
};
use loadframe_api::people::{
    Acceptance, Allowance, AuditEntry, CallerView, DiskUse, GroupView, HandOver, InvitationMade,
    InvitationView, MailVerification, MailView, NewGroup, NewInvitation, NewMail, NewProject,
    NewShare, NewToken, NewWebhook, PasswordChange, PersonChanges, PersonLimits, PersonView,
    ProjectChanges, ProjectView, RetentionRule, RetentionView, SessionView, ShareMade, ShareView,
    SignIn, SignInBegun, SignInWays, TokenMade, TokenView, TrashView, WebhookMade, WebhookView,
};
use loadframe_api::spec::calibrate::MeasuredCurve;
use loadframe_api::worker::{
    ClaimRequest, CompleteRequest, FailRequest, FaultRequest, HeartbeatAnswer, Lease,
    ProgressReport, ReleaseRequest, UploadedPart,
};
use loadframe_api::{
    CurveView, Envelope, Event, FieldView, FileEntry, JobChanges, JobKind, JobView, LogLine,
    Outcome, Page, Preview, Problem, Timestamp, WaitingView, WorkerView, answer_schemas,
    body_schemas, kind_schema,
};
use loadframe_client::direct::{DirectEnd, DirectRequest, DirectUpload};
use schemars::SchemaGenerator;
use serde_json::{Map, Value, json};

use super::super::health::{Health, VersionView};
use super::super::jobs::DryRun;
use super::super::kinds::{ExampleView, KindView};
use super::answers::without_null;

macro_rules! add {
    ($generator:ident: $($type:ty),+ $(,)?) => { $($generator.subschema_for::<$type>();)+ };
}

/// All schemas. A type of the wire that a handler names must be listed here; a test follows every
/// reference.
pub(super) fn schemas() -> Map<String, Value> {
    let mut schemas = bodies();
    // what is both read and written, such as an outcome, is told as it is written
    schemas.extend(answers());
    let envelope = schemas.get("Envelope").cloned().unwrap_or_default();
    let mut variants = Vec::new();
    let mut mapping = Map::new();
    for kind in JobKind::ALL {
        let spec_name = type_name(*kind);
        let name = format!("{spec_name}Submission");
        variants.push(reference(&name));
        mapping.insert(kind.name().to_owned(), reference(&name)["$ref"].clone());
        schemas.insert(name, submission(*kind, &spec_name, &envelope));
        let mut spec = kind_schema(*kind).clone();
        if let Some(spec) = spec.as_object_mut() {
            spec.shift_remove("$schema");
            spec.shift_remove("x-results");
        }
        schemas.insert(spec_name, spec);
    }
    let submission = json!({
        "description": "A job to be done; `kind` decides what `spec` holds.",
        "oneOf": variants,
        "discriminator": { "propertyName": "kind", "mapping": mapping },
    });
    schemas.insert("Submission".to_owned(), submission);
    schemas
}

/// What the service reads.
fn bodies() -> Map<String, Value> {
    body_schemas(|generator: &mut SchemaGenerator| {
        add!(generator: JobChanges, Envelope, SignIn, PasswordChange, NewInvitation, Acceptance,
            HandOver, NewGroup, NewProject, NewShare, NewToken, NewWebhook, NewMail,
            MailVerification, PersonChanges, PersonLimits, ProjectChanges, RetentionRule, NewComparison, ComparisonChanges,
            MeasuredCurve, ClaimRequest, ProgressReport, CompleteRequest, FailRequest,
            FaultRequest, ReleaseRequest, AllocationReport, DirectRequest, DirectEnd);
    })
}

/// What the service writes.
fn answers() -> Map<String, Value> {
    let mut schemas = answer_schemas(|generator: &mut SchemaGenerator| {
        add!(generator: Problem, Timestamp, JobKind, JobView, Page<JobView>, DryRun, Preview,
            CurveView, Page<FileEntry>, Outcome, Page<LogLine>, Event,
            KindView, Page<KindView>, Page<ExampleView>, Page<WorkerView>, Health, VersionView,
            Lease, HeartbeatAnswer, UploadedPart, DirectUpload, CallerView, PersonView, Page<PersonView>,
            Page<SessionView>, InvitationMade, Page<InvitationView>, TokenMade, Page<TokenView>,
            GroupView, Page<GroupView>, ProjectView, Page<ProjectView>, ShareMade, Page<ShareView>,
            Page<AuditEntry>, Backlog, Page<ReportedAllocations>, WaitingView, Allowance,
            SignInWays, SignInBegun, RetentionView, Page<DiskUse>, Page<TrashView>, Page<FieldView>, WebhookMade, Page<WebhookView>,
            MailView, Page<MailView>,
            Differences, Curves, MeasuredReading, ComparisonView, Page<ComparisonView>);
    });
    for schema in schemas.values_mut() {
        let required = schema["required"].as_array().cloned().unwrap_or_default();
        let fields = schema.get_mut("properties").and_then(Value::as_object_mut);
        let fields = fields.into_iter().flatten();
        let optional = fields.filter(|(name, _)| !required.iter().any(|one| one == name.as_str()));
        optional.for_each(|(_, field)| without_null(field));
    }
    schemas
}

/// The envelope around one kind's spec.
fn submission(kind: JobKind, spec_name: &str, envelope: &Value) -> Value {
    let mut schema = envelope.clone();
    schema["description"] = json!(kind.description());
    schema["title"] = json!(kind.title());
    schema["properties"]["kind"] = json!({ "type": "string", "const": kind.name() });
    schema["properties"]["spec"] = reference(spec_name);
    let examples = kind.examples().iter();
    let examples = examples.filter_map(|example| serde_json::from_str::<Value>(example.body).ok());
    schema["examples"] = examples.collect();
    schema
}

/// The example jobs by name, as OpenAPI examples of a body.
pub(super) fn examples() -> Map<String, Value> {
    let examples = JobKind::ALL.iter().flat_map(|kind| kind.examples());
    let examples = examples.filter_map(|example| {
        let job: Value = serde_json::from_str(example.body).ok()?;
        let shown = json!({ "summary": job["name"], "value": job });
        Some((example.name.to_owned(), shown))
    });
    examples.collect()
}

/// `nonwoven_tensile` as `NonwovenTensile`.
fn type_name(kind: JobKind) -> String {
    let words = kind.name().split('_').map(|word| {
        let (first, rest) = word.split_at(word.len().min(1));
        first.to_ascii_uppercase() + rest
    });
    words.collect()
}

fn reference(name: &str) -> Value {
    json!({ "$ref": format!("#/components/schemas/{name}") })
}
