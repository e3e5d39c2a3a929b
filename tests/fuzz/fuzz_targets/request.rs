#![no_main]
#[allow(dead_code)]
#[path = "../../../server/tests/shared/database.rs"]
mod database;
#[allow(dead_code)]
#[path = "../../../server/tests/http/foreign.rs"]
mod foreign;
#[allow(dead_code)]
#[path = "../../../server/tests/shared/outcome.rs"]
mod outcome;
#[allow(dead_code)]
#[path = "../../../server/tests/http/support.rs"]
mod support;

use std::sync::OnceLock;

use foreign::Labs;
use tokio::runtime::Runtime;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    static SERVERS: OnceLock<(Runtime, Labs)> = OnceLock::new();
    let (runtime, labs) = SERVERS.get_or_init(|| {
        let runtime = Runtime::new().expect("a runtime");
        let labs = runtime.block_on(Labs::open());
        (runtime, labs)
    });
    runtime.block_on(labs.hold(bytes));
});
