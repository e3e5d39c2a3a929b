// The shapes on the wire, by short names. They are made from the server's OpenAPI document: `npm run types`.
import type { components } from "./wire";

type Schemas = components["schemas"];

export type Allowance = Schemas["Allowance"];
export type Attempt = Schemas["AttemptView"];
export type AuditEntry = Schemas["AuditEntry"];
export type Caller = Schemas["CallerView"];
export type ComparedCurve = Schemas["ComparedCurve"];
export type ComparedJob = Schemas["ComparedJob"];
export type Comparison = Schemas["ComparisonView"];
export type Curve = Schemas["CurveView"];
export type DiskUse = Schemas["DiskUse"];
export type Curves = Schemas["Curves"];
export type Differences = Schemas["Differences"];
export type DryRun = Schemas["DryRun"];
export type ErrorPart = Schemas["ErrorPart"];
export type Example = Schemas["ExampleView"];
export type Field = Schemas["FieldView"];
export type FileEntry = Schemas["FileEntry"];
export type Group = Schemas["GroupView"];
export type Invitation = Schemas["InvitationView"];
export type InvitationMade = Schemas["InvitationMade"];
export type Job = Schemas["JobView"];
export type JobChanges = Schemas["JobChanges"];
/** What the server tells as it happens. */
export type JobEvent = Schemas["Event"];
export type JobLinks = Schemas["JobLinks"];
export type Kind = Schemas["KindView"];
export type LogLine = Schemas["LogLine"];
export type Mail = Schemas["MailView"];
export type MeasuredReading = Schemas["MeasuredReading"];
export type Outcome = Schemas["Outcome"];
export type Preview = Schemas["Preview"];
export type Person = Schemas["PersonView"];
export type PersonLimits = Schemas["PersonLimits"];
export type PointsReady = Schemas["PointsReady"];
export type Problem = Schemas["Problem"];
export type Project = Schemas["ProjectView"];
export type QualityCheck = Schemas["QualityCheck"];
export type Quantity = Schemas["Quantity"];
export type Retention = Schemas["RetentionView"];
export type Role = Schemas["Role"];
export type Session = Schemas["SessionView"];
export type Share = Schemas["ShareView"];
export type ShareMade = Schemas["ShareMade"];
export type SignInBegun = Schemas["SignInBegun"];
export type SignInWays = Schemas["SignInWays"];
export type Token = Schemas["TokenView"];
export type TokenMade = Schemas["TokenMade"];
export type TrashEntry = Schemas["TrashView"];
export type Version = Schemas["VersionView"];
export type Violation = Schemas["Violation"];
export type Visibility = Schemas["Visibility"];
export type WaitingView = Schemas["WaitingView"];
export type Warning = Schemas["Warning"];
export type ReportedAllocations = Schemas["ReportedAllocations"];
export type Webhook = Schemas["WebhookView"];
export type WebhookEvent = Schemas["WebhookEvent"];
export type WebhookMade = Schemas["WebhookMade"];
export type Worker = Schemas["WorkerView"];

/** A page of any list. */
export type Page<T> = Omit<Schemas["JobViewPage"], "items"> & { items: T[] };
