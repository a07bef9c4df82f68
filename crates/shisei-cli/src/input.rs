//! Reading files: which recordings the arguments name, and their bytes.

use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use shisei_core::Lang;
use shisei_record::{Input, Options, Problem, Recording, Stream};

use crate::args::Reading;
use crate::fail::{Exit, Failure, Outcome, say};
use crate::{ours, output};

/// A line longer than this is no recording's line; checked before a whole file is read.
const LONGEST_LINE: usize = 1 << 20;

/// File name endings that a directory is searched for.
const ENDINGS: [&str; 8] = ["csv", "txt", "tsv", "log", "dat", "parquet", "gz", "pq"];

/// One recording: one file, or an accelerometer and a gyroscope file that belong together.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Source {
    /// The files.
    pub paths: Vec<PathBuf>,
}

impl Source {
    fn one(path: PathBuf) -> Self {
        Source { paths: vec![path] }
    }

    /// As shown to the user.
    pub fn shown(&self) -> String {
        self.paths.iter().map(|path| path.display().to_string()).collect::<Vec<_>>().join(" + ")
    }

    /// What output names start with: the file's name without its ending; for a pair the folder's.
    pub fn stem(&self) -> String {
        let first = self.paths.first().map_or(Path::new("-"), PathBuf::as_path);
        if output::is_stdout(first) {
            return "stdin".to_owned();
        }
        if self.paths.len() > 1
            && let Some(folder) =
                first.canonicalize().ok().and_then(|p| p.parent()?.file_name().map(Into::into))
        {
            let folder: std::ffi::OsString = folder;
            return folder.to_string_lossy().into_owned();
        }
        let name = first.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        let name = name.strip_suffix(".gz").unwrap_or(&name).to_owned();
        match name.rsplit_once('.') {
            Some((stem, _)) if !stem.is_empty() => stem.to_owned(),
            _ => name,
        }
    }
}

/// What the arguments name: the sources, and whether they are a batch (a directory or several recordings).
#[derive(Debug)]
pub struct Sources {
    /// In the order of the arguments, directories sorted by name.
    pub list: Vec<Source>,
    /// True where results are many, whatever their number.
    pub batch: bool,
    /// True where each file was named, none found in a directory.
    named: bool,
}

impl Sources {
    /// Makes one recording of files that were named together and are its parts: an accelerometer's (or its two, without
    /// gravity and the gravity) and a gyroscope's.
    pub fn joined(mut self, options: &Options, lang: Lang) -> Sources {
        if self.named && matches!(self.list.len(), 2 | 3) && are_parts(&self.list, options, lang) {
            let paths = self.list.drain(..).flat_map(|source| source.paths).collect();
            self.list.push(Source { paths });
            self.batch = false;
        }
        self
    }
}

/// Whether files are the parts of one recording, by their first rows.
fn are_parts(list: &[Source], options: &Options, lang: Lang) -> bool {
    let mut files = Vec::new();
    for path in list.iter().flat_map(|source| &source.paths) {
        // A pipe can be read only once.
        let Some(bytes) = path.is_file().then(|| first_rows(path, lang).ok()).flatten() else { return false };
        files.push((path.display().to_string(), bytes));
    }
    let inputs: Vec<Input<'_>> = files.iter().map(|(name, bytes)| Input { name, bytes }).collect();
    let lacks = |input: &Input<'_>| shisei_record::open(&[*input], options).err().map(|error| error.problem);
    let part = |problem: &Problem| {
        matches!(problem, Problem::NoGyro { .. } | Problem::NoAcc { .. } | Problem::GravityRemoved { .. })
    };
    let alone: Vec<Problem> = inputs.iter().filter_map(lacks).filter(part).collect();
    let halves = matches!(
        alone.as_slice(),
        [Problem::NoGyro { .. }, Problem::NoAcc { .. }] | [Problem::NoAcc { .. }, Problem::NoGyro { .. }]
    );
    alone.len() == inputs.len() && (halves || shisei_record::open(&inputs, options).is_ok())
}

/// The rows at the beginning of a text; any other file whole.
fn first_rows(path: &Path, lang: Lang) -> Outcome<Vec<u8>> {
    let Opened { head: mut bytes, mut rest, .. } = start(path, lang)?;
    let long = bytes.len() > LONGEST_LINE;
    match bytes.iter().rposition(|&byte| byte == b'\n') {
        Some(end) if long && !is_packed(&bytes) => bytes.truncate(end + 1),
        _ => {
            rest.read_to_end(&mut bytes).map_err(|error| cannot_read(path, &error, lang))?;
        }
    }
    Ok(bytes)
}

/// True for the first bytes of a file in which lines cannot be seen.
fn is_packed(head: &[u8]) -> bool {
    head.starts_with(b"\x1f\x8b") || head.starts_with(b"PAR1")
}

/// Expands directories. Files that `orient` wrote are skipped in them.
pub fn expand(paths: &[PathBuf], lang: Lang) -> Outcome<Sources> {
    let mut list = Vec::new();
    let mut batch = paths.len() > 1;
    let mut named = true;
    for path in paths {
        if !path.is_dir() {
            list.push(Source::one(path.clone()));
            continue;
        }
        (batch, named) = (true, false);
        let before = list.len();
        list.extend(recordings_in(path, lang)?.into_iter().map(Source::one));
        if list.len() == before {
            let shown = path.display();
            let endings = ENDINGS.join(", ");
            return Err(Failure::input(say(
                lang,
                format!(
                    "{shown} has no recordings: no file directly in it ends in {endings}; name the files themselves"
                ),
                format!(
                    "{shown} の直下に記録がありません ({endings} のファイルがありません)。ファイルを直接指定してください"
                ),
            )));
        }
    }
    Ok(Sources { list, batch, named })
}

fn recordings_in(directory: &Path, lang: Lang) -> Outcome<Vec<PathBuf>> {
    let unreadable = |error: io::Error| cannot_read(directory, &error, lang);
    let mut found = Vec::new();
    for entry in std::fs::read_dir(directory).map_err(unreadable)? {
        let path = entry.map_err(unreadable)?.path();
        let ending = path.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
        if path.is_file() && ENDINGS.contains(&ending.as_str()) && !ours::is_orientation(&path) {
            found.push(path);
        }
    }
    found.sort();
    Ok(found)
}

/// The refusal for a path that cannot be read.
pub fn cannot_read(path: &Path, error: &io::Error, lang: Lang) -> Failure {
    let shown = path.display();
    let (en, ja) = match error.kind() {
        io::ErrorKind::NotFound => (
            "there is no such file; check the name".to_owned(),
            "ファイルがありません。名前を確認してください".to_owned(),
        ),
        io::ErrorKind::PermissionDenied => (
            "reading it is not permitted; check its permissions".to_owned(),
            "読み取りが許可されていません。アクセス権を確認してください".to_owned(),
        ),
        _ => (format!("it cannot be read ({error})"), format!("読み取れません ({error})")),
    };
    Failure::input(say(lang, format!("{shown}: {en}"), format!("{shown}：{ja}")))
}

/// A file whose start is read.
struct Opened {
    head: Vec<u8>,
    rest: Box<dyn Read>,
    /// Its length, bytes; 0 where that is not known.
    length: u64,
}

/// Opens a file and reads its start. A text whose first line does not end within 1 MiB is refused.
fn start(path: &Path, lang: Lang) -> Outcome<Opened> {
    let failed = |error: io::Error| cannot_read(path, &error, lang);
    let mut head = Vec::new();
    let mut length = 0;
    let mut rest: Box<dyn Read> = if output::is_stdout(path) {
        Box::new(io::stdin().lock())
    } else {
        let file = File::open(path).map_err(failed)?;
        length = file.metadata().map_err(failed)?.len();
        head.reserve(usize::try_from(length).unwrap_or(0).min(LONGEST_LINE) + 1);
        Box::new(file)
    };
    rest.by_ref().take(LONGEST_LINE as u64 + 1).read_to_end(&mut head).map_err(failed)?;
    if head.len() > LONGEST_LINE && !is_packed(&head) && !head.iter().any(|&b| b == b'\n' || b == b'\r') {
        let shown = path.display();
        return Err(Failure::input(say(
            lang,
            format!(
                "{shown}, line 1: the line is longer than 1 MiB, which no recording has; give a text file with one sample a line"
            ),
            format!(
                "{shown}, 1 行目：1 行が 1 MiB を超えています。1 行に 1 サンプルのテキストファイルを指定してください"
            ),
        )));
    }
    Ok(Opened { head, rest, length })
}

/// Reads a whole file. A text whose first line does not end within 1 MiB is refused before the rest is read.
pub fn read(path: &Path, lang: Lang) -> Outcome<Vec<u8>> {
    let Opened { head: mut bytes, mut rest, length } = start(path, lang)?;
    if bytes.len() > LONGEST_LINE {
        bytes.reserve(usize::try_from(length).unwrap_or(0).saturating_sub(bytes.len()).min(1 << 30) + 1);
    }
    rest.read_to_end(&mut bytes).map_err(|error| cannot_read(path, &error, lang))?;
    Ok(bytes)
}

/// The reader's options as given on the command line.
pub fn options(reading: &Reading, lang: Lang) -> Outcome<Options> {
    let refuse = |error: shisei_record::Error| Failure::input(error.sentence(lang));
    let mut options = Options { rate_hz: reading.rate, sensor: reading.sensor.clone(), ..Options::default() };
    options.skip_bad_rows = reading.skip_bad_rows;
    if let Some(rate_hz) = reading.rate.filter(|rate_hz| *rate_hz <= 0.0) {
        return Err(Failure::input(say(
            lang,
            format!("--rate {rate_hz}: a sampling rate is greater than 0 Hz, for example --rate 100"),
            format!(
                "--rate {rate_hz}：0 より大きいサンプリング周波数 [Hz] を指定してください (例 --rate 100)"
            ),
        )));
    }
    let said = [&reading.columns, &reading.units, &reading.axes, &reading.scale];
    for (name, text) in ["columns", "units", "axes", "scale"].into_iter().zip(said) {
        if let Some(text) = text {
            options.set(name, text).map_err(refuse)?;
        }
    }
    Ok(options)
}

/// Why a source could not be opened.
#[derive(Debug)]
pub enum Unopened {
    /// The file cannot be read.
    File(Failure),
    /// Its contents are refused.
    Contents(shisei_record::Error),
}

impl Unopened {
    /// The refusal as a sentence and an exit code.
    pub fn failure(self, lang: Lang) -> Failure {
        match self {
            Unopened::File(failure) => failure,
            Unopened::Contents(error) => {
                let exit = if error.exit_code() == 1 { Exit::Condition } else { Exit::Input };
                Failure { exit, sentence: error.sentence(lang) }
            }
        }
    }

    /// Accelerometer only, or gyroscope only: the half of a pair.
    fn half(&self) -> Option<Half> {
        match self {
            Unopened::Contents(error) => match error.problem {
                Problem::NoGyro { .. } => Some(Half::Accelerometer),
                Problem::NoAcc { .. } => Some(Half::Gyroscope),
                _ => None,
            },
            Unopened::File(_) => None,
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Half {
    Accelerometer,
    Gyroscope,
}

/// Opens a recording; a long text is read piece by piece.
pub fn open(source: &Source, options: &Options, lang: Lang) -> Result<Recording, Unopened> {
    let name = |path: &Path| {
        if output::is_stdout(path) { "stdin".to_owned() } else { path.display().to_string() }
    };
    if let [path] = source.paths.as_slice() {
        let Opened { head, mut rest, length } = start(path, lang).map_err(Unopened::File)?;
        let stream = Stream { name: &name(path), head, rest: &mut rest, length };
        return shisei_record::open_stream(stream, options).map_err(Unopened::Contents);
    }
    let mut files = Vec::new();
    for path in &source.paths {
        files.push((name(path), read(path, lang).map_err(Unopened::File)?));
    }
    let inputs: Vec<Input<'_>> = files.iter().map(|(name, bytes)| Input { name, bytes }).collect();
    shisei_record::open(&inputs, options).map_err(Unopened::Contents)
}

/// Makes one source of each accelerometer file and the gyroscope file that belongs to it: in the same folder,
/// named alike but for the words for the sensor, or the only ones there. `refused` are sources that could not be
/// opened alone, with the reasons.
pub fn pair(refused: &[(Source, Unopened)]) -> Vec<Source> {
    let of = |half: Half| -> Vec<&Source> {
        refused.iter().filter(|(_, why)| why.half() == Some(half)).map(|(source, _)| source).collect()
    };
    let (accelerometers, gyroscopes) = (of(Half::Accelerometer), of(Half::Gyroscope));
    let only = accelerometers.len() == 1 && gyroscopes.len() == 1;
    let mut pairs = Vec::new();
    for acc in &accelerometers {
        let mut partners = gyroscopes.iter().filter(|gyro| only || kin(gyro) == kin(acc));
        if let (Some(gyro), None) = (partners.next(), partners.next()) {
            pairs.push(Source { paths: acc.paths.iter().chain(&gyro.paths).cloned().collect() });
        }
    }
    pairs
}

/// Folder and name without the words that tell an accelerometer file from a gyroscope file.
fn kin(source: &Source) -> (PathBuf, String) {
    let path = source.paths.first().map_or(Path::new(""), PathBuf::as_path);
    let mut name = path.file_name().map(|name| name.to_string_lossy().to_lowercase()).unwrap_or_default();
    for word in ["accelerometer", "acceleration", "accel", "acc", "gyroscope", "gyro", "gyr"] {
        name = name.replace(word, "");
    }
    (path.parent().map(Path::to_path_buf).unwrap_or_default(), name)
}
