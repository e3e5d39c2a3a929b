//! Many pictures at once: of one person a few, whom the others and the submissions do not wait for.
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::time::Duration;

use futures_util::future::join_all;
use loadframe_api::people::Scope;
use loadframe_api::{JobSpec, Preview};
use tokio_util::sync::CancellationToken;

use crate::people::group::Group;
use crate::support::{Lab, example};

const PATH: &str = "/v1/jobs/preview";

static AT_WORK: AtomicU32 = AtomicU32::new(0);
static MAY_END: AtomicBool = AtomicBool::new(false);

/// A generator that takes its time for the seed 7.
fn draw(spec: &JobSpec, given_up: &CancellationToken) -> Result<Option<Preview>, String> {
    let JobSpec::NonwovenTensile(spec) = spec else {
        return Err("only nonwovens here".to_owned());
    };
    if spec.seed == 7 {
        AT_WORK.fetch_add(1, Ordering::SeqCst);
        while !given_up.is_cancelled() && !MAY_END.load(Ordering::SeqCst) {
            std::thread::sleep(Duration::from_millis(5));
        }
        AT_WORK.fetch_sub(1, Ordering::SeqCst);
    }
    Ok(Some(Preview {
        shows: "A specimen.".to_owned(),
        files: Vec::new(),
    }))
}

#[tokio::test(flavor = "multi_thread")]
async fn of_one_token_a_few_are_drawn_and_others_do_not_wait() {
    let lab = Lab::with(|config| {
        config.preview = Some(draw);
        config.preview_time = Duration::from_secs(120);
    })
    .await;
    let group = Group::of(lab).await;
    let (anna, _) = group.token(&group.anna, Scope::Submit).await;
    let (bert, _) = group.token(&group.bert, Scope::Submit).await;
    let mut slow: serde_json::Value = serde_json::from_str(example()).expect("JSON");
    slow["spec"]["seed"] = 7.into();
    let slow = slow.to_string();

    let many = join_all((0..12).map(|_| group.send(&anna, "POST", PATH, &slow)));
    let meanwhile = async {
        while AT_WORK.load(Ordering::SeqCst) == 0 {
            tokio::time::sleep(Duration::from_millis(5)).await;
        }
        // another person's picture, and submissions of both, while hers are being drawn
        let drawn = group.send(&bert, "POST", PATH, example()).await;
        assert_eq!(drawn.status, 200, "{drawn:?}");
        for by in [&anna, &bert] {
            let submitted = group.send(by, "POST", "/v1/jobs", example()).await;
            assert_eq!(submitted.status, 201, "{submitted:?}");
        }
        assert!(AT_WORK.load(Ordering::SeqCst) > 0, "hers still are");
        MAY_END.store(true, Ordering::SeqCst);
    };
    let (answers, ()) = tokio::join!(many, meanwhile);
    let (drawn, refused): (Vec<_>, Vec<_>) =
        answers.iter().partition(|answer| answer.status == 200);
    assert_eq!((drawn.len(), refused.len()), (4, 8));
    for answer in refused {
        let problem = answer.problem(429, "too-many-requests");
        assert_eq!(
            problem["detail"],
            "4 of your pictures are being drawn or wait for it"
        );
        assert!(answer.header("retry-after").parse::<u32>().is_ok());
    }
}
