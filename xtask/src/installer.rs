//! shisei-VERSION.msi: building it, and a round trip of it under Wine.

use std::path::{Path, PathBuf};

use crate::artefacts::{VERSION, WindowsFiles};
use crate::project::Project;
use crate::run::{must, output_of};
use crate::wine::{self, Wine};

/// Excel's list of add-ins.
const OPTIONS: &str = r"HKCU\Software\Microsoft\Office\16.0\Excel\Options";

/// The per-user installer.
pub fn build(project: &Project, files: &WindowsFiles, samples: &[PathBuf]) -> Result<PathBuf, String> {
    let folder = project.target().join("installer");
    std::fs::create_dir_all(&folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    let root = &project.root;
    let mut sources = vec![files.xll.clone(), files.dll.clone(), files.register.clone()];
    sources.extend(["LICENSE-MIT", "LICENSE-APACHE"].map(|name| root.join(name)));
    sources.push(root.join("crates/shisei-capi/vba/shisei.bas"));
    sources.push(root.join("crates/shisei-capi/include/shisei.h"));
    sources.extend(samples.iter().filter(|path| path.extension().is_some_and(|end| end == "xlsx")).cloned());
    for source in sources {
        let name = source.file_name().ok_or("a file without a name")?;
        std::fs::copy(&source, folder.join(name))
            .map_err(|error| format!("{}: {error}", source.display()))?;
    }
    let msi = project.target().join(format!("shisei-{VERSION}.msi"));
    // wixl takes files of its own folder only, and grumbles about parts of the language that it passes over
    let recipe = folder.join("shisei.wxs");
    std::fs::copy(root.join("apps/excel/shisei.wxs"), &recipe).map_err(|error| error.to_string())?;
    let mut wixl = project.command("wixl");
    wixl.current_dir(&folder).args(["-a", "x64", "-D", &format!("Version={VERSION}"), "-o"]);
    must(wixl.arg(&msi).arg("shisei.wxs").stderr(std::process::Stdio::null()))?;
    Ok(msi)
}

/// Installs and removes beside other add-ins, in an empty Windows; a check a line.
pub fn round_trip(project: &Project, msi: &Path) -> Vec<(String, Result<String, String>)> {
    match Trip::start(project) {
        Ok(trip) => vec![
            ("a list with other add-ins is restored".into(), trip.beside_others(msi)),
            ("an empty list is restored".into(), trip.alone(msi)),
        ],
        Err(reason) => vec![("Wine starts".into(), Err(reason))],
    }
}

struct Trip<'a> {
    project: &'a Project,
    wine: Wine,
}

impl<'a> Trip<'a> {
    fn start(project: &'a Project) -> Result<Self, String> {
        let wine = Wine::fresh(project, "installer")?;
        // the installer's helper runs from where it was installed; its stand-in must be found from there
        wine::stand_in(project, &wine.drive_c().join("windows/system32"))?;
        Ok(Trip { project, wine })
    }

    fn windows(&self, words: &[&str]) -> Result<String, String> {
        output_of(self.wine.command(self.project).args(words))
    }

    /// The list, an add-in a line, in its order.
    fn list(&self) -> Vec<String> {
        let text = self.windows(&["reg.exe", "query", OPTIONS]).unwrap_or_default();
        let mut found: Vec<(usize, String)> = text
            .lines()
            .filter_map(|line| {
                let (name, value) = line.trim().split_once("REG_SZ")?;
                let number = name.trim().strip_prefix("OPEN")?;
                let index = if number.is_empty() { 0 } else { number.parse().ok()? };
                Some((index, value.trim().to_owned()))
            })
            .collect();
        found.sort();
        found.into_iter().map(|(index, value)| format!("{index} {value}")).collect()
    }

    fn msiexec(&self, what: &str, msi: &Path) -> Result<(), String> {
        let path = format!("Z:{}", msi.display().to_string().replace('/', "\\"));
        self.windows(&["msiexec.exe", what, &path, "/qn"]).map(drop)
    }

    fn installed(&self) -> Vec<String> {
        let users = std::fs::read_dir(self.wine.drive_c().join("users"));
        let folders = users.into_iter().flatten().flatten();
        let mut names: Vec<String> = folders
            .map(|user| user.path().join("AppData/Local/Programs/shisei"))
            .filter_map(|folder| std::fs::read_dir(folder).ok())
            .flatten()
            .flatten()
            .map(|file| file.file_name().to_string_lossy().into_owned())
            .collect();
        names.sort();
        names
    }

    fn set(&self, name: &str, value: &str) -> Result<(), String> {
        self.windows(&["reg.exe", "add", OPTIONS, "/v", name, "/d", value, "/f"]).map(drop)
    }

    fn beside_others(&self, msi: &Path) -> Result<String, String> {
        self.set("OPEN", "/R \"C:\\other.xll\"")?;
        self.set("OPEN1", "\"C:\\more.xlam\"")?;
        self.set("Font", "Calibri,11")?;
        let before = self.list();
        self.msiexec("/i", msi)?;
        let during = self.list();
        let ours = during.last().cloned().unwrap_or_default();
        expect(during.len() == 3 && during[..2] == before[..], format!("the list became {during:?}"))?;
        expect(
            ours.starts_with("2 /R \"C:\\") && ours.ends_with("\\shisei.xll\""),
            format!("the entry {ours}"),
        )?;
        let files = self.installed();
        let needed =
            ["shisei.xll", "shisei.dll", "shisei.bas", "shisei.h", "shisei-tour.xlsx", "LICENSE-MIT.txt"];
        expect(
            needed.iter().all(|name| files.iter().any(|file| file == name)),
            format!("installed {files:?}"),
        )?;
        // another add-in comes after ours, then ours goes: the list stays dense
        self.set("OPEN3", "\"C:\\later.xll\"")?;
        self.msiexec("/x", msi)?;
        let after = self.list();
        let expected = [before.clone(), vec!["2 \"C:\\later.xll\"".into()]].concat();
        expect(after == expected, format!("the list is {after:?}, it was {before:?}"))?;
        expect(self.installed().is_empty(), format!("left behind: {:?}", self.installed()))?;
        let other = self.windows(&["reg.exe", "query", OPTIONS, "/v", "Font"])?;
        expect(other.contains("Calibri"), "another option is gone".into())?;
        Ok(format!("{} files", files.len()))
    }

    fn alone(&self, msi: &Path) -> Result<String, String> {
        self.windows(&["reg.exe", "delete", OPTIONS, "/f"])?;
        self.msiexec("/i", msi)?;
        let during = self.list();
        expect(during.len() == 1 && during[0].starts_with("0 "), format!("the list became {during:?}"))?;
        self.msiexec("/x", msi)?;
        expect(self.list().is_empty(), format!("the list is {:?}", self.list()))?;
        Ok(String::new())
    }
}

fn expect(right: bool, otherwise: String) -> Result<(), String> {
    if right { Ok(()) } else { Err(otherwise) }
}
