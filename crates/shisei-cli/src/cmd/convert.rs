//! `shisei convert`: any recording in our own columns.

use shisei_core::Lang;
use shisei_record::write;

use crate::args::Convert;
use crate::fail::{Outcome, say};
use crate::input::{self, Source};
use crate::output::{Kind, Writer, is_stdout};
use crate::summary;
use crate::tables::{self, Format};

/// Runs the command.
pub fn run(args: &Convert, lang: Lang) -> Outcome<()> {
    let mut options = input::options(&args.reading, lang)?;
    if args.keep {
        options.keep = vec!["*".to_owned()];
    }
    let writer = Writer::new(args.force, lang, &args.files);
    let format = Format::of(&args.output);
    let kind = format.kind(Kind::Recording);
    writer.check_all(&[(&args.output, kind)])?;
    let source = Source { paths: args.files.clone() };
    let mut recording = input::open(&source, &options, lang).map_err(|error| error.failure(lang))?;
    let names = write::recording_names(&recording);
    tables::note_renamed(&mut recording, names);
    writer.write(&args.output, kind, |out| tables::recording(out, format, &recording))?;
    eprint!("{}", summary::of_notes(&recording, lang));
    if !is_stdout(&args.output) {
        let rows = recording.len();
        eprintln!("{}", say(lang, format!("{rows} samples"), format!("{rows} サンプル")));
        eprintln!("→ {}", args.output.display());
    }
    Ok(())
}
