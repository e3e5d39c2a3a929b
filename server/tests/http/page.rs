//! The lab page and the documentation.
use crate::support::Lab;

const HTML: (&str, &str) = ("accept", "text/html,application/xhtml+xml");

#[tokio::test]
async fn the_page_is_behind_each_of_its_addresses() {
    let lab = Lab::open().await;
    for path in ["/", "/submit", "/jobs/00000000-0000-4000-8000-000000000000"] {
        let page = lab.get_with(path, &[HTML]).await;
        assert_eq!(page.status, 200);
        assert_eq!(page.header("content-type"), "text/html; charset=utf-8");
        assert_eq!(page.header("cache-control"), "no-cache");
        assert!(
            page.header("content-security-policy")
                .contains("default-src 'self'")
        );
        let again = lab
            .get_with(path, &[HTML, ("if-none-match", page.header("etag"))])
            .await;
        assert_eq!(again.status, 304);
    }
    lab.get_with("/v1/submit", &[HTML])
        .await
        .problem(404, "not-found");
    lab.get("/submit").await.problem(404, "not-found");
}

#[tokio::test]
async fn assets_are_kept_for_ever_and_sent_compressed() {
    let lab = Lab::open().await;
    let page = lab.get_with("/", &[HTML]).await.text();
    let links: Vec<&str> = page
        .split('"')
        .filter(|part| part.starts_with("/assets/"))
        .collect();
    assert!(!links.is_empty(), "the page is built into the executable");
    for link in links {
        let asset = lab.get_with(link, &[("accept-encoding", "gzip")]).await;
        assert_eq!(asset.status, 200, "{link}");
        assert!(asset.header("cache-control").contains("immutable"));
        if link.ends_with(".js") {
            assert_eq!(asset.header("content-encoding"), "gzip");
            assert!(asset.header("content-type").starts_with("text/javascript"));
        }
    }
    let gone = lab.get_with("/assets/gone.js", &[("accept", "*/*")]).await;
    gone.problem(404, "not-found");
}

#[tokio::test]
async fn every_route_and_problem_is_documented_for_people() {
    let lab = Lab::open().await;
    let docs = lab.get("/docs").await;
    assert_eq!(docs.header("content-type"), "text/html; charset=utf-8");
    let docs = docs.text();
    let document = lab.get("/openapi.json").await.json();
    for path in document["paths"].as_object().expect("paths").keys() {
        assert!(docs.contains(&format!("<code>{path}</code>")), "{path}");
    }
    for name in document["components"]["schemas"]
        .as_object()
        .expect("schemas")
        .keys()
    {
        assert!(docs.contains(&format!("id=\"schema-{name}\"")), "{name}");
    }
    // every link within the page leads somewhere
    for link in docs.split("href=\"#").skip(1) {
        let target = link.split('"').next().expect("a target");
        assert!(docs.contains(&format!("id=\"{target}\"")), "{target}");
    }
    let problem = lab.get("/problems/not-found").await;
    assert_eq!(
        (problem.status, problem.header("location")),
        (303, "/docs#problem-not-found")
    );
    assert!(docs.contains("id=\"problem-not-found\""));
    assert!(!docs.contains("<script"));
}
