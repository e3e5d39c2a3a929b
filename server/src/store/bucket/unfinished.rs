//! Uploads in parts that nobody finishes, and what they left: they cost room that no list shows.
use std::collections::BTreeSet;
use std::time::Duration;

use futures_util::TryStreamExt;
use loadframe_api::Timestamp;
use object_store::multipart::MultipartStore;
use object_store::path::Path;
use object_store::signer::{Method, SignedUrlOptions, Signer};
use object_store::{Error, ObjectStore, ObjectStoreExt};
use quick_xml::de::from_str;
use serde::Deserialize;

use super::super::clock::millis;
use super::super::error::{Result, StoreError};
use super::Bucket;

/// What no lease stands behind is abandoned after this time: longer than any upload takes.
const ABANDONED: Duration = Duration::from_secs(24 * 3600);
/// How long the address of the list is good for, which is used at once.
const GOOD_FOR: Duration = Duration::from_secs(60);

/// Answer of `ListMultipartUploads`
/// (docs.aws.amazon.com/AmazonS3/latest/API/API_ListMultipartUploads.html), as far as it is needed.
#[derive(Debug, Default, Deserialize)]
struct Uploads {
    #[serde(rename = "Upload", default)]
    uploads: Vec<Upload>,
}

#[derive(Debug, Deserialize)]
struct Upload {
    #[serde(rename = "Key")]
    key: String,
    #[serde(rename = "UploadId")]
    id: String,
    #[serde(rename = "Initiated")]
    begun: Timestamp,
}

/// An upload in parts that was begun, or an object that lies where things arrive.
#[derive(Debug)]
pub(in super::super) struct Unfinished {
    key: Path,
    /// `None` of an object.
    upload: Option<String>,
    /// [ms since 1970]
    since: i64,
}

impl Unfinished {
    /// Id of the lease under which a worker sends it, without dashes; `None` of what this server sends by
    /// itself, or wrote to try.
    fn lease(&self) -> Option<&str> {
        let (lease, _) = self.key.filename()?.split_once('-')?;
        (lease.len() == 32).then_some(lease)
    }

    /// Whether nobody can finish it, when `live` are the leases (without dashes) that were held after it
    /// was found.
    pub(in super::super) fn is_abandoned(&self, live: &BTreeSet<String>) -> bool {
        match self.lease() {
            Some(lease) => !live.contains(lease),
            None => self.since <= Timestamp::now().as_millis() - millis(ABANDONED),
        }
    }
}

impl Bucket {
    /// Everything that is on its way.
    pub(in super::super) async fn unfinished(&self) -> Result<Vec<Unfinished>> {
        let mut found = Vec::new();
        for Upload { key, id, begun } in self.uploads().await? {
            found.push(Unfinished {
                key: Path::parse(&key).map_err(StoreError::corrupt("key of the bucket"))?,
                upload: Some(id),
                since: begun.as_millis(),
            });
        }
        let incoming = self.key(&["incoming"]);
        let objects = self.listed(|| async {
            let objects = self.store.list(Some(&incoming));
            let objects = objects.map_ok(|object| Unfinished {
                key: object.location,
                upload: None,
                since: object.last_modified.timestamp_millis(),
            });
            objects.try_collect::<Vec<_>>().await
        });
        found.extend(objects.await?);
        Ok(found)
    }

    /// Aborts an upload, or removes an object.
    pub(in super::super) async fn abandon(&self, unfinished: Unfinished) -> Result<()> {
        let done = match unfinished.upload {
            Some(id) => self.store.abort_multipart(&unfinished.key, &id).await,
            None => self.store.delete(&unfinished.key).await,
        };
        match done {
            Ok(()) | Err(Error::NotFound { .. }) => Ok(()),
            Err(error) => Err(self.failed()(error)),
        }
    }

    /// Uploads in parts below the prefix of this store, at most a thousand; the rest comes next time.
    async fn uploads(&self) -> Result<Vec<Upload>> {
        let prefix = self.prefix.to_string();
        let below = if prefix.is_empty() {
            String::new()
        } else {
            format!("{prefix}/")
        };
        let options = SignedUrlOptions::default().with_query([("uploads", ""), ("prefix", &below)]);
        let address = self
            .store
            .signed_url_opts(Method::GET, &Path::default(), GOOD_FOR, &options)
            .await
            .map_err(self.failed())?;
        let unheard = |error: reqwest::Error| {
            self.failed()(object_store::Error::Generic {
                store: "S3",
                // the address is signed, and not for the log
                source: Box::new(error.without_url()),
            })
        };
        let answer = self.http.get(address).send().await.map_err(unheard)?;
        let answer = answer.error_for_status().map_err(unheard)?;
        let text = answer.text().await.map_err(unheard)?;
        let uploads: Uploads =
            from_str(&text).map_err(StoreError::corrupt("list of uploads in parts"))?;
        Ok(uploads.uploads)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_worker_sends_is_abandoned_with_its_lease_and_other_things_after_a_day() {
        let lease = "0123456789abcdef0123456789abcdef";
        let of = |name: &str, since| Unfinished {
            key: Path::from(format!("lab/incoming/{name}")),
            upload: None,
            since,
        };
        let sent = of(&format!("{lease}-{}", "a".repeat(64)), 0);
        assert!(sent.is_abandoned(&BTreeSet::new()));
        assert!(!sent.is_abandoned(&BTreeSet::from([lease.to_owned()])));
        let now = Timestamp::now().as_millis();
        assert!(!of("trial-1", now).is_abandoned(&BTreeSet::new()));
        assert!(of("trial-1", now - 86_400_000).is_abandoned(&BTreeSet::new()));
    }

    #[test]
    fn a_list_of_uploads_is_read() {
        let text = r#"<?xml version="1.0"?><ListMultipartUploadsResult xmlns="http://s3.amazonaws.com/doc/2006-03-01/">
            <Bucket>lab</Bucket><KeyMarker></KeyMarker>
            <Upload><Key>one/incoming/a</Key><UploadId>x1</UploadId><Initiator><ID>i</ID></Initiator>
              <Initiated>2026-11-26T14:00:00.000Z</Initiated></Upload>
            <Upload><Key>one/incoming/b</Key><UploadId>x2</UploadId><Initiated>2026-11-26T14:00:01Z</Initiated></Upload>
            </ListMultipartUploadsResult>"#;
        let found: Uploads = from_str(text).expect("a list");
        let ids: Vec<&str> = found
            .uploads
            .iter()
            .map(|upload| upload.id.as_str())
            .collect();
        assert_eq!(ids, ["x1", "x2"]);
        let none = "<ListMultipartUploadsResult></ListMultipartUploadsResult>";
        let none: Uploads = from_str(none).expect("a list of none");
        assert!(none.uploads.is_empty());
    }
}
