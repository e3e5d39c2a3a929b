//! Searching the guide.
use crate::support::Lab;

#[tokio::test]
async fn search_finds_sections() {
    let lab = Lab::open().await;
    for (query, address) in [
        ("jaw_force_imbalance", "/guide/quality#jaw_force_imbalance"),
        ("quarantined", "/guide/operate#workers"),
        (
            "strain_step",
            "/guide/nonwoven_tensile/fields#test.strain_step",
        ),
        ("backup", "/guide/operate#data"),
        (
            "LAMMPS",
            "/guide/peers-and-speed#beside-lammps-and-yade-in-speed",
        ),
        ("token%20revoke", "/guide/operate#tokens"),
        ("which+command", "/guide/how-it-is-built#which-command-when"),
    ] {
        let page = lab.get(&format!("/guide/search?q={query}")).await.text();
        let link = format!("<a href=\"{address}\">");
        assert!(page.contains(&link), "{query}: {page}");
    }
    let first = lab.get("/guide/search?q=inertial_number").await.text();
    let found = first.split("class=\"found\"").nth(1).expect("results");
    assert!(found.contains("<mark>inertial_number</mark>"));
}

#[tokio::test]
async fn search_takes_whatever_is_asked() {
    let lab = Lab::open().await;
    let long = "very+long+".repeat(5_000);
    for query in [
        "",
        "?",
        "?q",
        "?q=",
        "?q=%20",
        "?other=1",
        "?q=a&q=b",
        "?q=%00%01",
        "?q=%ff%fe",
        "?q=%",
        "?q=%F0%9F%A6%80",
        "?q=..%2f..%2fetc",
        "?q=%3Cscript%3Ealert(1)%3C/script%3E",
        "?q=%22%3E%3Cimg+src=x+onerror=y%3E",
        &format!("?q={long}"),
    ] {
        let answer = lab.get(&format!("/guide/search{query}")).await;
        assert_eq!(answer.status, 200, "{query:.60}");
        let html = answer.text();
        assert!(
            !html.contains("<script") && !html.contains("<img"),
            "{query:.60}"
        );
        assert!(html.len() < 200_000, "{query:.60}");
        assert_eq!(html.matches("<h1").count(), 1);
    }
}
