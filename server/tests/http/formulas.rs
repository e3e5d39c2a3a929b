//! Tables for spreadsheets: what a person or an engine has written is never a formula in one, and numbers stay
//! numbers.
use loadframe_api::worker::{CurveBlock, ProgressReport};
use serde_json::{Value, json};

use crate::people::group::id_of;
use crate::support::{Lab, example, key};

const ATTACKS: [&str; 6] = [
    "=HYPERLINK(\"http://evil.example\",\"click\")",
    "+1+cmd|' /C calc'!A0",
    "-2+3",
    "@SUM(1)",
    "\t=1+1",
    " =1+1",
];

/// Cells of a line of CSV, as a spreadsheet reads them.
fn cells(line: &str) -> Vec<String> {
    let mut cells = vec![String::new()];
    let mut quoted = false;
    let mut letters = line.chars().peekable();
    while let Some(letter) = letters.next() {
        let last = cells.len() - 1;
        match letter {
            '"' if quoted && letters.peek() == Some(&'"') => {
                letters.next();
                cells[last].push('"');
            }
            '"' => quoted = !quoted,
            ',' if !quoted => cells.push(String::new()),
            letter => cells[last].push(letter),
        }
    }
    assert!(!quoted, "{line}");
    cells
}

/// No cell of the table begins a formula; a number may begin with a sign.
fn holds_no_formula(table: &str) -> Vec<Vec<String>> {
    let rows: Vec<Vec<String>> = table.lines().map(cells).collect();
    let width = rows[0].len();
    for row in &rows {
        assert_eq!(row.len(), width, "{row:?}");
        for cell in row {
            let begins = cell.trim_start().starts_with(['=', '+', '-', '@']);
            assert!(!begins || cell.parse::<f64>().is_ok(), "{cell:?}");
        }
    }
    rows
}

#[tokio::test]
async fn tables_of_curves_hold_no_formula_of_a_name_or_a_column() {
    let lab = Lab::open().await;
    let mut ids = Vec::new();
    for attack in ATTACKS {
        let mut job: Value = serde_json::from_str(example()).expect("JSON");
        // a name may begin so only where it is taken at all
        for name in [attack.to_owned(), format!("x{attack}")] {
            job["name"] = json!(name);
            let answer = lab.post("/v1/jobs", &job.to_string()).await;
            if answer.status != 201 {
                answer.problem(422, "invalid-job");
                continue;
            }
            let id = id_of(&answer.json());
            let lease = lab.claim().await;
            assert_eq!(lease.job_id, id);
            let report = ProgressReport {
                progress: 0.5,
                phase: "pulling".to_owned(),
                eta_s: None,
                points: Some(CurveBlock {
                    columns: vec!["strain".to_owned(), "force_n".to_owned()],
                    first: 0,
                    rows: vec![vec![0.0, -1.5], vec![1.0, 2.5e-7]],
                }),
                log: Vec::new(),
                log_from: None,
            };
            let reported = lab.store.report(key(&lease), &report).await;
            reported.expect("the lease is held");
            let own = lab.get(&format!("/v1/jobs/{id}/curve.csv")).await;
            let rows = holds_no_formula(&own.text());
            assert_eq!(rows[1][1].parse(), Ok(-1.5), "numbers are untouched");
            ids.push(id.to_string());
        }
    }
    assert!(ids.len() >= ATTACKS.len(), "{ids:?}");
    let path = format!("/v1/curves.csv?jobs={}", ids.join(","));
    let answer = lab.get(&path).await;
    assert_eq!(answer.status, 200, "{answer:?}");
    let rows = holds_no_formula(&answer.text());
    assert_eq!(rows.len(), 1 + 2 * ids.len());
    assert_eq!(rows[1][3].parse(), Ok(-1.5), "{:?}", rows[1]);
    // the name is still there to be read
    assert!(answer.text().contains("SUM(1)"), "{}", answer.text());
}
