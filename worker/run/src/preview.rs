//! A specimen drawn before its job is submitted.
use std::io::{self, Write};

use loadframe_api::{JobSpec, Preview, PreviewFile};
use loadframe_physics::{Decorator, Halt, InterruptSource, Recorder, RunContext, Unrecorded};

/// Bytes of all files together: pictures of any part that is drawn have far fewer.
const LARGEST: usize = 64_000_000;

/// Pictures of the specimen of `spec` before its test, made on this thread.
///
/// # Errors
/// When there is no such specimen, or its pictures are too large; an interrupt.
pub fn preview(spec: &JobSpec, interrupt: &dyn InterruptSource) -> Result<Preview, Halt> {
    let mut album = Album::default();
    let context = RunContext {
        threads: 1,
        interrupt,
        checkpoint: None,
    };
    let shows = loadframe_physics::preview(spec, context, &mut album)?;
    // of what looks for none while it is made
    interrupt.heed()?;
    Ok(Preview {
        shows,
        files: album.files,
    })
}

/// Keeps pictures in memory, and nothing else.
#[derive(Debug, Default)]
struct Album {
    files: Vec<PreviewFile>,
    bytes: usize,
    rest: Unrecorded,
}

impl Decorator for Album {
    fn inner(&self) -> &dyn Recorder {
        &self.rest
    }

    fn inner_mut(&mut self) -> &mut dyn Recorder {
        &mut self.rest
    }

    fn file(
        &mut self,
        name: &str,
        write: &mut dyn FnMut(&mut dyn Write) -> io::Result<()>,
    ) -> io::Result<()> {
        if !name.ends_with(".vtp") {
            return Ok(());
        }
        let mut content = Vec::new();
        write(&mut content)?;
        self.bytes += content.len();
        if self.bytes > LARGEST {
            let words = format!("its pictures take more than {LARGEST} bytes");
            return Err(io::Error::other(words));
        }
        self.files.push(PreviewFile {
            name: name.to_owned(),
            content,
        });
        Ok(())
    }
}
