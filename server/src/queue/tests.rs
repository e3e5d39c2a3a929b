//! Every input in every state.
#![allow(clippy::unwrap_used, reason = "a refusal fails the test")]
use loadframe_api::{AttemptEnd, JobOutcome, ReasonCode};
use proptest::prelude::*;

use super::{
    Input, LOSSES_UNTIL_QUARANTINE, MACHINES_UNTIL_FAILED, Refusal, State, UserRequest, transition,
};

const INPUTS: [Input; 14] = [
    Input::Claim,
    Input::Cancel,
    Input::Pause,
    Input::Resume,
    Input::Retry,
    Input::Complete,
    Input::Fail,
    Input::Fault { machines: 1 },
    Input::Fault {
        machines: MACHINES_UNTIL_FAILED,
    },
    Input::Release,
    Input::Lose,
    Input::NeverUse,
    Input::ExceedTime,
    Input::ExceedEstimate,
];

const OUTCOMES: [JobOutcome; 5] = [
    JobOutcome::Succeeded,
    JobOutcome::Failed,
    JobOutcome::Cancelled,
    JobOutcome::TimedOut,
    JobOutcome::Quarantined,
];

/// The state an input leads to, or the refusal.
fn after(state: State, input: Input) -> Result<State, Refusal> {
    transition(state, input).map(|step| step.state)
}

#[test]
fn users_and_queue_in_every_state() {
    use State::{Finished, Paused, Queued, Running};
    let losses = 1;
    let queued = Queued { losses };
    let paused = Paused { losses };
    let running = |asked| Running { losses, asked };
    let cancelled = Finished(JobOutcome::Cancelled);

    let table = [
        (queued, Input::Claim, Ok(running(None))),
        (queued, Input::Cancel, Ok(cancelled)),
        (queued, Input::Pause, Ok(paused)),
        (queued, Input::Resume, Ok(queued)),
        (queued, Input::Retry, Ok(queued)),
        (paused, Input::Claim, Err(Refusal::NotQueued)),
        (paused, Input::Cancel, Ok(cancelled)),
        (paused, Input::Pause, Ok(paused)),
        (paused, Input::Resume, Ok(queued)),
        (paused, Input::Retry, Err(Refusal::StillPaused)),
        (running(None), Input::Claim, Err(Refusal::NotQueued)),
        (
            running(None),
            Input::Cancel,
            Ok(running(Some(UserRequest::Cancel))),
        ),
        (
            running(None),
            Input::Pause,
            Ok(running(Some(UserRequest::Pause))),
        ),
        (running(None), Input::Resume, Ok(running(None))),
        (running(None), Input::Retry, Err(Refusal::StillRunning)),
        (
            running(Some(UserRequest::Pause)),
            Input::Cancel,
            Ok(running(Some(UserRequest::Cancel))),
        ),
        (
            running(Some(UserRequest::Pause)),
            Input::Pause,
            Ok(running(Some(UserRequest::Pause))),
        ),
        (
            running(Some(UserRequest::Pause)),
            Input::Resume,
            Ok(running(None)),
        ),
        (
            running(Some(UserRequest::Cancel)),
            Input::Cancel,
            Ok(running(Some(UserRequest::Cancel))),
        ),
        (
            running(Some(UserRequest::Cancel)),
            Input::Pause,
            Err(Refusal::BeingCancelled),
        ),
        (
            running(Some(UserRequest::Cancel)),
            Input::Resume,
            Err(Refusal::BeingCancelled),
        ),
        (
            running(Some(UserRequest::Cancel)),
            Input::Retry,
            Err(Refusal::StillRunning),
        ),
        (cancelled, Input::Cancel, Ok(cancelled)),
    ];
    for (state, input, expected) in table {
        assert_eq!(after(state, input), expected, "{state:?} {input:?}");
    }
}

#[test]
fn how_attempts_end() {
    let ended = |asked, input| {
        let step = transition(State::Running { losses: 0, asked }, input).unwrap();
        (step.state, step.attempt_end.unwrap(), step.reason.unwrap())
    };
    let finished = State::Finished;
    let pause = Some(UserRequest::Pause);
    let cancel = Some(UserRequest::Cancel);
    let queued = |losses| State::Queued { losses };
    let paused = |losses| State::Paused { losses };

    let table = [
        (
            None,
            Input::Complete,
            finished(JobOutcome::Succeeded),
            AttemptEnd::Completed,
            ReasonCode::Completed,
        ),
        (
            pause,
            Input::Complete,
            finished(JobOutcome::Succeeded),
            AttemptEnd::Completed,
            ReasonCode::Completed,
        ),
        (
            None,
            Input::Fail,
            finished(JobOutcome::Failed),
            AttemptEnd::Failed,
            ReasonCode::SimulationError,
        ),
        (
            None,
            Input::Fault { machines: 2 },
            queued(0),
            AttemptEnd::Faulted,
            ReasonCode::WorkerFault,
        ),
        (
            pause,
            Input::Fault { machines: 2 },
            paused(0),
            AttemptEnd::Faulted,
            ReasonCode::PausedByUser,
        ),
        (
            None,
            Input::Fault { machines: 3 },
            finished(JobOutcome::Failed),
            AttemptEnd::Faulted,
            ReasonCode::WorkerError,
        ),
        (
            None,
            Input::NeverUse,
            queued(0),
            AttemptEnd::Lost,
            ReasonCode::WorkerLost,
        ),
        (
            pause,
            Input::NeverUse,
            paused(0),
            AttemptEnd::Lost,
            ReasonCode::PausedByUser,
        ),
        (
            None,
            Input::ExceedTime,
            finished(JobOutcome::TimedOut),
            AttemptEnd::TimedOut,
            ReasonCode::TimeLimit,
        ),
        (
            None,
            Input::ExceedEstimate,
            paused(0),
            AttemptEnd::Paused,
            ReasonCode::BeyondEstimate,
        ),
        (
            None,
            Input::Release,
            queued(0),
            AttemptEnd::Released,
            ReasonCode::WorkerReleased,
        ),
        (
            pause,
            Input::Release,
            paused(0),
            AttemptEnd::Paused,
            ReasonCode::PausedByUser,
        ),
        (
            None,
            Input::Lose,
            queued(1),
            AttemptEnd::Lost,
            ReasonCode::WorkerLost,
        ),
        (
            pause,
            Input::Lose,
            paused(1),
            AttemptEnd::Lost,
            ReasonCode::PausedByUser,
        ),
    ];
    for (asked, input, state, end, reason) in table {
        assert_eq!(
            ended(asked, input),
            (state, end, reason),
            "{asked:?} {input:?}"
        );
    }
    // once a cancel is accepted, every ending is that
    for input in &INPUTS[5..] {
        let (state, end, reason) = ended(cancel, *input);
        assert_eq!(state, finished(JobOutcome::Cancelled), "{input:?}");
        assert_eq!(reason, ReasonCode::CancelledByUser);
        let lost = matches!(input, Input::Lose | Input::NeverUse);
        assert_eq!(
            end,
            if lost {
                AttemptEnd::Lost
            } else {
                AttemptEnd::Cancelled
            }
        );
    }
}

#[test]
fn workers_can_only_end_what_runs() {
    let idle = [State::Queued { losses: 0 }, State::Paused { losses: 0 }];
    for state in idle.into_iter().chain(OUTCOMES.map(State::Finished)) {
        for input in &INPUTS[5..] {
            assert_eq!(
                after(state, *input),
                Err(Refusal::NotRunning),
                "{state:?} {input:?}"
            );
        }
    }
}

#[test]
fn the_third_loss_quarantines() {
    let mut state = State::Queued { losses: 0 };
    for loss in 1..=LOSSES_UNTIL_QUARANTINE {
        state = after(state, Input::Claim).unwrap();
        state = after(state, Input::Lose).unwrap();
        assert_eq!(
            loss == LOSSES_UNTIL_QUARANTINE,
            state == State::Finished(JobOutcome::Quarantined)
        );
    }
    assert_eq!(after(state, Input::Retry), Ok(State::Queued { losses: 0 }));
}

fn any_state() -> impl Strategy<Value = State> {
    let asked = prop_oneof![
        Just(None),
        Just(Some(UserRequest::Cancel)),
        Just(Some(UserRequest::Pause))
    ];
    prop_oneof![
        (0u32..5).prop_map(|losses| State::Queued { losses }),
        (0u32..5).prop_map(|losses| State::Paused { losses }),
        (0u32..5, asked).prop_map(|(losses, asked)| State::Running { losses, asked }),
        prop::sample::select(&OUTCOMES[..]).prop_map(State::Finished),
    ]
}

proptest! {
    #[test]
    fn finished_jobs_change_only_by_retry(state in any_state(), inputs in prop::collection::vec(prop::sample::select(&INPUTS[..]), 0..60)) {
        let mut state = state;
        for input in inputs {
            let Ok(step) = transition(state, input) else { continue };
            if let State::Finished(outcome) = state
                && step.state != state
            {
                prop_assert_eq!(input, Input::Retry);
                prop_assert_ne!(outcome, JobOutcome::Succeeded);
            }
            // an attempt ends exactly when the job stops running
            let was_running = matches!(state, State::Running { .. });
            let is_running = matches!(step.state, State::Running { .. });
            prop_assert_eq!(step.attempt_end.is_some(), was_running && !is_running);
            // only a claim starts one
            prop_assert_eq!(!was_running && is_running, input == Input::Claim);
            state = step.state;
        }
    }
}
