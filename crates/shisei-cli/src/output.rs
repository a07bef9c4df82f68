//! Writing results: to a temporary name beside the target, then renamed, so that no partial file is left.

use std::collections::HashSet;
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use shisei_core::Lang;

use crate::fail::{Failure, Outcome, say};
pub use crate::ours::Kind;
use crate::outgoing::Outgoing;

/// Where and how results may be written.
#[derive(Clone, Debug)]
pub struct Writer {
    /// Overwrite files that are not ours.
    pub force: bool,
    /// Language of refusals.
    pub lang: Lang,
    /// Files that are read in this run, by their whole paths; they are never overwritten.
    inputs: HashSet<PathBuf>,
}

impl Writer {
    /// `inputs` are the files that are read in this run.
    pub fn new<'a>(force: bool, lang: Lang, inputs: impl IntoIterator<Item = &'a PathBuf>) -> Self {
        // One that is not there cannot be overwritten.
        let inputs = inputs.into_iter().filter_map(|path| path.canonicalize().ok()).collect();
        Writer { force, lang, inputs }
    }

    /// Refuses early, before any work is done, what [`Writer::write`] would refuse, and two results in one place.
    pub fn check_all(&self, results: &[(&Path, Kind)]) -> Outcome<()> {
        for (k, (path, kind)) in results.iter().enumerate() {
            self.check(path, *kind)?;
            if !is_special(path) && results[..k].iter().any(|(before, _)| same_place(before, path)) {
                let shown = path.display();
                return Err(Failure::input(say(
                    self.lang,
                    format!(
                        "{shown} would hold two results, and the second would replace the first; name two files"
                    ),
                    format!(
                        "{shown} に 2 つの結果を書くことはできません。別々のファイル名を指定してください"
                    ),
                )));
            }
        }
        Ok(())
    }

    /// Refuses what [`Writer::write`] would refuse.
    fn check(&self, path: &Path, kind: Kind) -> Outcome<()> {
        if is_stdout(path) || is_special(path) {
            return Ok(());
        }
        let lang = self.lang;
        let shown = path.display();
        if !path.is_dir() && kind.is_promised_otherwise(path) {
            let endings = kind.endings().iter().map(|ending| format!(".{ending}")).collect::<Vec<_>>();
            return Err(Failure::input(say(
                lang,
                format!("{shown}: what is written there ends in {}; name such a file", endings.join(" or ")),
                format!("{shown}：ここに書き出せるのは {} のファイルです", endings.join(" または ")),
            )));
        }
        let names_a_directory = path.as_os_str().to_string_lossy().ends_with(std::path::is_separator);
        if path.is_dir() || names_a_directory {
            return Err(Failure::input(say(
                lang,
                format!("{shown} is a directory; name a file"),
                format!("{shown} はディレクトリです。ファイル名を指定してください"),
            )));
        }
        if !path.exists() {
            let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
            return match folder.filter(|folder| !folder.is_dir()) {
                Some(_) => Err(self.unwritable(path, &io::ErrorKind::NotFound.into())),
                None => Ok(()),
            };
        }
        if path.canonicalize().is_ok_and(|path| self.inputs.contains(&path)) {
            return Err(Failure::input(say(
                lang,
                format!("{shown} is an input of this run and is never overwritten; name another file"),
                format!("{shown} は入力ファイルのため上書きしません。別のファイル名を指定してください"),
            )));
        }
        if !self.force && !kind.is_ours(path) {
            return Err(Failure::input(say(
                lang,
                format!(
                    "{shown} exists and is not a result of shisei of this kind; name another file, or overwrite it with --force"
                ),
                format!(
                    "{shown} は既に存在し、shisei のこの種類の出力ではありません。別名にするか、--force で上書きしてください"
                ),
            )));
        }
        Ok(())
    }

    /// Writes a file whole or not at all; `-` is standard output.
    pub fn write(
        &self,
        path: &Path,
        kind: Kind,
        body: impl FnOnce(&mut dyn Write) -> io::Result<()>,
    ) -> Outcome<()> {
        self.finish(vec![self.stage(path, kind, body)?])
    }

    /// Writes a file under a temporary name; [`Writer::finish`] puts it in its place, dropping it leaves nothing.
    /// Standard output and devices are written at once.
    pub fn stage(
        &self,
        path: &Path,
        kind: Kind,
        body: impl FnOnce(&mut dyn Write) -> io::Result<()>,
    ) -> Outcome<Staged> {
        self.check(path, kind)?;
        let temporary = stage(path, body).map_err(|error| self.unwritable(path, &error))?;
        Ok(Staged { temporary, path: path.to_owned() })
    }

    /// Puts staged files in their places.
    pub fn finish(&self, files: Vec<Staged>) -> Outcome<()> {
        for file in files {
            if let Some(temporary) = file.temporary {
                temporary.persist(&file.path).map_err(|error| self.unwritable(&file.path, &error.error))?;
            }
        }
        Ok(())
    }

    fn unwritable(&self, path: &Path, error: &io::Error) -> Failure {
        Failure::input(unwritable(&path.display().to_string(), error, self.lang))
    }
}

/// The sentence for a place that cannot be written.
pub fn unwritable(shown: &str, error: &io::Error, lang: Lang) -> String {
    let (why, why_ja) = match error.kind() {
        io::ErrorKind::NotFound => ("there is no such directory", "ディレクトリがありません"),
        io::ErrorKind::PermissionDenied => ("writing there is not permitted", "書き込みが許可されていません"),
        io::ErrorKind::ReadOnlyFilesystem => ("it can only be read", "読み取り専用です"),
        io::ErrorKind::StorageFull => ("the disk is full", "ディスクに空きがありません"),
        _ => {
            return say(
                lang,
                format!("{shown} could not be written ({error}); choose another place"),
                format!("{shown} に書き込めませんでした ({error})。別の場所を指定してください"),
            );
        }
    };
    say(
        lang,
        format!("{shown} could not be written: {why}; choose another place"),
        format!("{shown} に書き込めませんでした。{why_ja}。別の場所を指定してください"),
    )
}

/// A result under its temporary name.
#[derive(Debug)]
pub struct Staged {
    temporary: Option<tempfile::NamedTempFile>,
    path: PathBuf,
}

fn stage(
    path: &Path,
    body: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> io::Result<Option<tempfile::NamedTempFile>> {
    if is_stdout(path) {
        let mut out = BufWriter::new(io::stdout().lock());
        return match body(&mut out).and_then(|()| out.flush()) {
            // A reader that went away has read what it wanted: `| head`.
            Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(None),
            written => written.map(|()| None),
        };
    }
    if is_special(path) {
        // A device or pipe cannot be renamed over.
        let mut out = BufWriter::new(File::options().write(true).open(path)?);
        body(&mut out)?;
        out.flush()?;
        return Ok(None);
    }
    let directory = match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    };
    let mut builder = tempfile::Builder::new();
    builder.prefix(".shisei-").suffix(".tmp");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // As any other new file: the user's umask decides (a temporary file would be 0600).
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    let mut out = Outgoing::new(builder.tempfile_in(directory)?);
    body(&mut out)?;
    out.finish().map(Some)
}

/// True for `-`.
pub fn is_stdout(path: &Path) -> bool {
    path.as_os_str() == "-"
}

/// True where both names are of one file, there or not.
fn same_place(a: &Path, b: &Path) -> bool {
    let whole = |path: &Path| {
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        path.canonicalize().ok().or_else(|| Some(folder.canonicalize().ok()?.join(path.file_name()?)))
    };
    a == b || whole(a).is_some_and(|a| whole(b).is_some_and(|b| a == b))
}

fn is_special(path: &Path) -> bool {
    std::fs::metadata(path).is_ok_and(|meta| !meta.is_file() && !meta.is_dir())
}
