//! The parsers of foreign bytes, one function each: whatever the bytes are, it returns.
use loadframe_api::spec::granular_scene::{Import, ImportFormat};
use loadframe_api::surface::{TriangleMesh, read_stl};
use loadframe_api::table::{self, Hints, Wanted};
use loadframe_api::worker::Lease;
use loadframe_api::{
    CurveView, JobKind, JobView, Outcome, Problem, Submission, Timestamp, check_file_name,
    messages_that_take,
};
use loadframe_harness::checkpoint;
use loadframe_run::{Engine, SavedRun};

/// The body of `POST /v1/jobs`. What is accepted can be priced and written down, and is accepted again
/// as written.
pub(crate) fn submission(bytes: &[u8]) {
    let Ok(submission) = Submission::from_slice(bytes) else {
        return;
    };
    let estimate = submission.spec.estimate(&Default::default());
    assert!(
        estimate.wall_s >= 0.0 && estimate.memory_mb >= 0.0,
        "{estimate:?}"
    );
    let written = format!(
        r#"{{"kind":{:?},"spec":{}}}"#,
        submission.spec.kind().name(),
        submission.spec.to_json()
    );
    let again = Submission::from_slice(written.as_bytes()).expect("what was accepted is");
    assert_eq!(again.spec.to_json(), submission.spec.to_json());
}

/// Bodies of workers, of people and of changes, and what the server answers.
pub(crate) fn message(bytes: &[u8]) {
    let _ = messages_that_take(bytes);
    // answers, which commands and workers read
    let _ = serde_json::from_slice::<Outcome>(bytes);
    let _ = serde_json::from_slice::<JobView>(bytes);
    let _ = serde_json::from_slice::<CurveView>(bytes);
    let _ = serde_json::from_slice::<Lease>(bytes);
    let _ = serde_json::from_slice::<Problem>(bytes);
    let text = String::from_utf8_lossy(bytes);
    let _ = check_file_name(&text);
    let _ = text.parse::<Timestamp>();
    let _ = text.parse::<JobKind>();
}

/// A bed of another program. What is understood is finite.
pub(crate) fn bed(bytes: &[u8]) {
    for format in [ImportFormat::Yade, ImportFormat::Lammps] {
        let import = Import {
            format,
            text: String::from_utf8_lossy(bytes).into_owned(),
            material: "stone".to_owned(),
            scale: 1.0,
            shift_m: [0.0; 3],
            breakable_clumps: false,
        };
        if let Ok(bodies) = import.bodies(2500.0) {
            let places = bodies.iter().flat_map(|body| body.position_m);
            assert!(places.into_iter().all(f64::is_finite));
        }
    }
}

/// A curve that a testing machine exported, in any of the forms in which it comes as text. What is
/// understood is finite.
pub(crate) fn table(bytes: &[u8]) {
    let text = String::from_utf8_lossy(bytes);
    let wanted = ["nominal_strain", "force_n"].map(|name| Wanted {
        name: name.to_owned(),
    });
    for gauge_length_mm in [None, Some(100.0)] {
        let hints = Hints {
            gauge_length_mm,
            ..Hints::default()
        };
        if let Ok(reading) = table::read(&text, &wanted, &hints) {
            assert!(
                reading
                    .points
                    .iter()
                    .flatten()
                    .all(|value| value.is_finite())
            );
        }
    }
}

/// A surface in STL, binary or text, and the mesh that is made of it.
pub(crate) fn surface(bytes: &[u8]) {
    let Ok(triangles) = read_stl(bytes) else {
        return;
    };
    let corners: Vec<_> = triangles
        .iter()
        .map(|triangle| triangle.map(|corner| corner.into()))
        .collect();
    let _ = TriangleMesh::weld(&corners).seams.is_closed();
}

/// A checkpoint, and the saved run around it.
pub(crate) fn checkpoint(bytes: &[u8]) {
    let engine = Engine {
        version: "1",
        commit: "1",
    };
    if let Ok(run) = SavedRun::from_bytes(bytes, engine, "a") {
        assert_eq!(run.to_bytes().last(), bytes.last());
    }
    let _ = checkpoint::unpack::<Vec<(u64, f64, String)>>(bytes);
}
