//! What a finished job holds, by every door: single files, ranges, the archive, the curve.
use loadframe_api::{CurveView, FileEntry, JobStatus, Page, Problem, sha256_hex};
use loadframe_tests::{SMALL, Server, Worker, until, with_seed};
use serde_json::json;
use std::io::{Cursor, Read};
use uuid::Uuid;

fn finished_job(server: &Server) -> Uuid {
    let id = server.client.submit(&with_seed(SMALL, 1));
    let worker = Worker::start(server, "worker");
    until("the job is done", || {
        (server.client.job(id).status == JobStatus::Finished).then_some(())
    });
    worker.retire();
    id
}

#[test]
fn files_ranges_archive_and_curve_tell_the_same() {
    let server = Server::start();
    let id = finished_job(&server);
    let job = format!("/v1/jobs/{id}");
    let files: Page<FileEntry> = server.client.get(&format!("{job}/files")).json();
    let get = |name: &str, headers: &[(&str, &str)]| {
        server
            .client
            .send("GET", &format!("{job}/files/{name}"), headers, b"")
            .unwrap()
    };
    let curve = get("curve.csv", &[]);
    let whole = &curve.body;

    // a range, a resumed download, and what has not changed
    let part = get("curve.csv", &[("range", "bytes=10-19")]);
    assert_eq!((part.status, part.body.as_slice()), (206, &whole[10..20]));
    let entry = files
        .items
        .iter()
        .find(|entry| entry.name == "curve.csv")
        .unwrap();
    let etag = format!("\"{}\"", entry.sha256);
    let rest = get("curve.csv", &[("range", "bytes=10-"), ("if-range", &etag)]);
    assert_eq!((rest.status, rest.body.as_slice()), (206, &whole[10..]));
    let other = get(
        "curve.csv",
        &[("range", "bytes=10-"), ("if-range", "\"other\"")],
    );
    assert_eq!((other.status, &other.body), (200, whole));
    assert_eq!(get("curve.csv", &[("if-none-match", &etag)]).status, 304);
    let beyond = get("curve.csv", &[("range", "bytes=999999999-")]);
    assert_eq!(beyond.status, 416, "{beyond}");

    // the archive holds the same files
    let archive = server.client.get(&format!("{job}/archive.zip"));
    let mut archive = zip::ZipArchive::new(Cursor::new(archive.body)).unwrap();
    let mut archived = Vec::new();
    for index in 0..archive.len() {
        let mut file = archive.by_index(index).unwrap();
        let mut bytes = Vec::new();
        file.read_to_end(&mut bytes).unwrap();
        // all in one folder, so that unpacking litters nothing
        let name = file.name().unwrap();
        let (_, name) = name.split_once('/').unwrap();
        archived.push((name.to_owned(), sha256_hex(&bytes)));
    }
    archived.sort();
    let mut listed: Vec<(String, String)> = files
        .items
        .into_iter()
        .map(|entry| (entry.name, entry.sha256))
        .collect();
    listed.sort();
    assert_eq!(archived, listed);

    // the curve as JSON is the file, number for number
    let points: CurveView = server.client.get(&format!("{job}/curve")).json();
    let text = String::from_utf8(whole.clone()).unwrap();
    let mut lines = text.lines();
    assert_eq!(lines.next().unwrap(), points.columns.join(","));
    let rows: Vec<Vec<f64>> = lines
        .map(|line| {
            line.split(',')
                .map(|field| field.parse().unwrap())
                .collect()
        })
        .collect();
    assert_eq!(rows, points.points);
    let csv = server.client.send(
        "GET",
        &format!("{job}/curve"),
        &[("accept", "text/csv")],
        b"",
    );
    assert_eq!(csv.unwrap().body, *whole);
    // in pieces, and thinned out for a plot
    let half = points.points.len() / 2;
    let later: CurveView = server
        .client
        .get(&format!("{job}/curve?since={half}"))
        .json();
    assert_eq!(later.points, points.points[half..]);
    let thin: CurveView = server
        .client
        .get(&format!("{job}/curve?max_points=20"))
        .json();
    assert!(
        (2..=20).contains(&thin.points.len()),
        "{}",
        thin.points.len()
    );
    let peak = |points: &[Vec<f64>]| points.iter().map(|row| row[1]).fold(0.0, f64::max);
    assert_eq!(
        peak(&thin.points).to_bits(),
        peak(&points.points).to_bits(),
        "the peak stays in sight"
    );
}

#[test]
fn polling_is_cheap_and_tells_of_every_change() {
    let server = Server::start();
    let id = server.client.submit(&with_seed(SMALL, 1));
    for path in [format!("/v1/jobs/{id}"), "/v1/jobs".to_owned()] {
        let first = server.client.get(&path);
        let etag = first.etag.clone().unwrap();
        let ask = |etag: &str| {
            server
                .client
                .send("GET", &path, &[("if-none-match", etag)], b"")
                .unwrap()
        };
        let same = ask(&etag);
        assert_eq!((same.status, same.body.len()), (304, 0), "{same}");
        let name = serde_json::json!({"name": format!("renamed through {path}")});
        let headers = [("content-type", "application/json")];
        let edit = server.client.send(
            "PATCH",
            &format!("/v1/jobs/{id}"),
            &headers,
            name.to_string().as_bytes(),
        );
        assert_eq!(edit.unwrap().status, 200);
        let changed = ask(&etag);
        assert_eq!(changed.status, 200);
        assert!(String::from_utf8_lossy(&changed.body).contains("renamed through"));
    }
}

#[test]
fn a_key_submits_once() {
    let server = Server::start();
    let send = |key: &str, seed: u64| {
        let headers = [
            ("content-type", "application/json"),
            ("idempotency-key", key),
        ];
        let body = with_seed(SMALL, seed).to_string();
        server
            .client
            .send("POST", "/v1/jobs", &headers, body.as_bytes())
            .unwrap()
    };
    let first = send("once", 1);
    assert_eq!(first.status, 201, "{first}");
    let id = first.json::<loadframe_api::JobView>().id;
    assert_eq!(send("once", 1).json::<loadframe_api::JobView>().id, id);
    let other_body = send("once", 2);
    assert_eq!(other_body.status, 422, "{other_body}");
    assert_ne!(send("again", 1).json::<loadframe_api::JobView>().id, id);
    assert_eq!(server.client.jobs("").len(), 2);
}

#[test]
fn a_section_takes_its_constants_from_a_finished_cell_by_its_id() {
    let server = Server::start();
    let glass = json!({"isotropic": {"youngs_modulus_mpa": 74_000, "poisson_ratio": 0.2}});
    let epoxy = json!({"isotropic": {"youngs_modulus_mpa": 3_350, "poisson_ratio": 0.35}});
    let cell = json!({"kind": "composite_cell", "spec": {
        "version": 1, "materials": {"epoxy": epoxy, "glass": glass}, "matrix": "epoxy", "fibre": "glass",
        "arrangement": {"square": {"fibre_fraction": 0.5, "diameter_mm": 0.012}},
        "accuracy": {"cells_per_fibre": 12},
    }});
    let section = |id: Uuid| {
        json!({"kind": "composite_bending", "spec": {
            "version": 1,
            "section": {"length_mm": 10, "height_mm": 1, "thickness_mm": 1, "state": "plane_stress"},
            "materials": {"ply": {"from_job": id}}, "matrix": "ply", "grid": {"cells": [10, 4]},
            "test": {"tension": {"strain": 0.001}},
        }})
    };
    let refused = |id: Uuid| {
        let answer = server.client.post("/v1/jobs", &section(id));
        assert_eq!(answer.status, 422, "{answer}");
        let problem: Problem = serde_json::from_slice(&answer.body).unwrap();
        problem.violations[0].detail.clone()
    };
    let detail = refused(Uuid::from_u128(7));
    assert!(detail.contains("there is no job"), "{detail}");
    let id = server.client.submit(&cell);
    let detail = refused(id);
    assert!(detail.contains("has no results"), "{detail}");

    let worker = Worker::start(&server, "worker");
    let done = |id| {
        until("the job is done", || {
            let job = server.client.job(id);
            (job.status == JobStatus::Finished).then_some(job)
        })
    };
    let cell = done(id);
    let along = cell.summary.unwrap()["modulus_1"].value.unwrap();
    let section_id = server.client.submit(&section(id));
    let pulled = done(section_id);
    worker.retire();
    let constants = &pulled.spec.unwrap()["materials"]["ply"]["orthotropic"];
    assert_eq!(constants["modulus_1_mpa"].as_f64(), Some(along));
    let modulus = pulled.summary.unwrap()["effective_modulus"].value.unwrap();
    assert!((modulus / along - 1.0).abs() < 1e-6, "{modulus} {along}");
    // one of another kind has no such constants
    let detail = refused(section_id);
    assert!(detail.contains("composite_bending"), "{detail}");
}
