//! A specimen drawn before its job is submitted.
use std::io::{self, BufWriter, Write};

use loadframe_api::{JobSpec, Preview, PreviewFile};
use loadframe_physics::{
    Decorator, Halt, InterruptSource, Recorder, RunContext, Unrecorded, Wanted,
};

/// Bytes of all files together: pictures of any part that is drawn have far fewer.
const LARGEST: usize = 64_000_000;

/// Pictures of the specimen of `spec` before its test, made on this thread.
///
/// # Errors
/// When there is no such specimen, or its pictures are too large; an interrupt.
pub fn preview(spec: &JobSpec, interrupt: &dyn InterruptSource) -> Result<Preview, Halt> {
    let mut album = Album {
        files: Vec::new(),
        bytes: 0,
        interrupt,
        rest: Unrecorded,
    };
    let context = RunContext {
        threads: 1,
        interrupt,
        checkpoint: None,
    };
    let shows = loadframe_physics::preview(spec, context, &mut album)?;
    Ok(Preview {
        shows,
        files: album.files,
    })
}

/// Keeps pictures in memory, and nothing else.
struct Album<'a> {
    files: Vec<PreviewFile>,
    bytes: usize,
    interrupt: &'a dyn InterruptSource,
    rest: Unrecorded,
}

impl Decorator for Album<'_> {
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
        let mut out = BufWriter::new(Wanted::new(Vec::new(), self.interrupt));
        write(&mut out)?;
        let content = out.into_inner()?.into_inner();
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
