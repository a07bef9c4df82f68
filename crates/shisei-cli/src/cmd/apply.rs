//! `shisei apply`: a recording corrected by a calibration.

use shisei_core::Lang;
use shisei_record::write;

use crate::args::Apply;
use crate::calibration;
use crate::fail::{Outcome, say};
use crate::input::{self, Source};
use crate::output::{Kind, Writer, is_stdout};
use crate::summary;
use crate::tables::{self, Format};

/// Runs the command.
pub fn run(args: &Apply, lang: Lang) -> Outcome<()> {
    let mut options = input::options(&args.reading, lang)?;
    options.counts_ok = true;
    if args.keep {
        options.keep = vec!["*".to_owned()];
    }
    let writer = Writer::new(args.force, lang, args.files.iter().chain([&args.calibration]));
    let format = Format::of(&args.output);
    let kind = format.kind(Kind::Recording);
    writer.check_all(&[(&args.output, kind)])?;
    let file = calibration::read(&args.calibration, lang)?;
    let source = Source { paths: args.files.clone() };
    let mut recording = input::open(&source, &options, lang).map_err(|error| error.failure(lang))?;
    calibration::apply(&file, &mut recording, lang)?;
    let names = write::recording_names(&recording);
    tables::note_renamed(&mut recording, names);
    writer.write(&args.output, kind, |out| tables::recording(out, format, &recording))?;
    eprint!("{}", summary::of_notes(&recording, lang));
    if !is_stdout(&args.output) {
        eprintln!(
            "{}",
            say(
                lang,
                format!("{} samples corrected", recording.len()),
                format!("{} サンプルを補正しました", recording.len())
            )
        );
        eprintln!("→ {}", args.output.display());
    }
    Ok(())
}
