//! The firmware of the boards: built, held against what the board has, written as UF2 files.

use std::path::{Path, PathBuf};

use crate::cross::CORTEX_M4F;
use crate::elf::{self, Segment};
use crate::needs::{Apt, Needs};
use crate::project::Project;
use crate::run::must;

/// The firmware's folders, which are its names.
pub const BOARDS: [&str; 2] = ["xiao-node", "xiao-receiver"];
/// What is to be handed on with the UF2 files: the licence of Nordic's library in them.
pub const NOTICE: &str = "firmware/NOTICE";

/// What the bootloader leaves to an application: behind the SoftDevice, before the user data.
const APPLICATION: std::ops::Range<u32> = 0x0002_7000..0x000E_C000;
const RAM: std::ops::Range<u32> = 0x2000_0000..0x2004_0000;
/// Our limits, bytes: half of what the chip has.
const FLASH_MAX: u32 = 512 * 1024;
const RAM_MAX: u32 = 128 * 1024;
/// The nRF52840 with this bootloader, in UF2.
const FAMILY: u32 = 0xADA5_2840;

/// Debian's libclang reads the headers of Nordic's library for its bindings.
pub fn needs(project: &Project) -> Needs {
    let mut needs = CORTEX_M4F.needs(project);
    needs.apt.push(Apt::file("libclang-dev", "/usr/share/doc/libclang-dev"));
    needs
}

/// Builds a board's firmware.
pub fn build(project: &Project, board: &str) -> Result<PathBuf, String> {
    let mut cargo = CORTEX_M4F.cargo_build(project);
    cargo.arg("--locked").current_dir(project.root.join("firmware").join(board));
    if let Some(headers) = clang_headers() {
        cargo.env("BINDGEN_EXTRA_CLANG_ARGS", format!("-ffreestanding -I{}", headers.display()));
    }
    must(&mut cargo)?;
    Ok(CORTEX_M4F.products(project).join(board))
}

/// The headers of Debian's clang, which its library does not find by itself; nothing on other machines.
fn clang_headers() -> Option<PathBuf> {
    let versions = |folder: &Path| {
        let mut found: Vec<PathBuf> =
            std::fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path()).collect();
        found.sort();
        found
    };
    let clangs = versions(Path::new("/usr/lib"))
        .into_iter()
        .filter(|path| path.file_name().is_some_and(|name| name.to_string_lossy().starts_with("llvm-")));
    clangs
        .flat_map(|llvm| versions(&llvm.join("lib/clang")))
        .map(|version| version.join("include"))
        .rfind(|headers| headers.join("stdint.h").is_file())
}

/// What a board's firmware takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Size {
    pub flash: u32,
    pub ram: u32,
}

impl std::fmt::Display for Size {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} KiB of flash, {} KiB of RAM", self.flash.div_ceil(1024), self.ram.div_ceil(1024))
    }
}

/// Refused: a segment that would overwrite bootloader or SoftDevice, a start that is none, more than the limits.
pub fn check(segments: &[Segment<'_>]) -> Result<Size, String> {
    let (mut flash_end, mut ram_end) = (APPLICATION.start, RAM.start);
    for segment in segments {
        let (stored, length) = (segment.stored, segment.bytes.len() as u32);
        if length > 0 && !(APPLICATION.contains(&stored) && stored + length <= APPLICATION.end) {
            return Err(format!("a segment of {length} bytes at {stored:#x}, outside of {APPLICATION:#x?}"));
        }
        if length > 0 {
            flash_end = flash_end.max(stored + length);
        }
        if RAM.contains(&segment.address) {
            ram_end = ram_end.max(segment.address + segment.memory_bytes);
        }
    }
    let first = segments.iter().find(|segment| segment.stored == APPLICATION.start);
    let vectors = first.and_then(|segment| segment.bytes.first_chunk::<8>());
    let Some(&[s0, s1, s2, s3, r0, r1, r2, r3]) = vectors else {
        return Err(format!("no vectors at {:#x}", APPLICATION.start));
    };
    let (stack, reset) = (u32::from_le_bytes([s0, s1, s2, s3]), u32::from_le_bytes([r0, r1, r2, r3]));
    if stack <= RAM.start || stack > RAM.end || reset & 1 == 0 || !APPLICATION.contains(&reset) {
        return Err(format!("the vectors begin with stack {stack:#x} and reset {reset:#x}"));
    }
    let size = Size { flash: flash_end - APPLICATION.start, ram: ram_end - RAM.start };
    if size.flash > FLASH_MAX || size.ram > RAM_MAX {
        return Err(format!("{size}; the limits are {} KiB and {} KiB", FLASH_MAX / 1024, RAM_MAX / 1024));
    }
    Ok(size)
}

/// Checks a program and writes it beside itself as `shisei-BOARD.uf2`.
pub fn pack(program: &Path) -> Result<(PathBuf, Size), String> {
    let file = std::fs::read(program).map_err(|error| format!("{}: {error}", program.display()))?;
    let segments = elf::segments(&file)?;
    let size = check(&segments)?;
    let name = program.file_name().ok_or("a program without a name")?.to_string_lossy();
    let path = program.with_file_name(format!("shisei-{name}.uf2"));
    std::fs::write(&path, elf::uf2(&segments, FAMILY)).map_err(|error| error.to_string())?;
    Ok((path, size))
}

/// UF2 files of all boards, and the notice that belongs to them.
pub fn files(project: &Project) -> Result<Vec<PathBuf>, String> {
    let mut files = Vec::new();
    for board in BOARDS {
        let (path, size) = pack(&build(project, board)?)?;
        println!("{board}: {size}");
        files.push(path);
    }
    files.push(project.root.join(NOTICE));
    Ok(files)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn segment(stored: u32, address: u32, memory_bytes: u32, bytes: &[u8]) -> Segment<'_> {
        Segment { stored, address, memory_bytes, bytes }
    }

    const VECTORS: [u8; 8] = [0, 0, 4, 0x20, 1, 0x71, 2, 0];

    #[test]
    fn sizes_are_counted_and_limits_held() {
        let code = segment(0x27000, 0x27000, 8, &VECTORS);
        let zeros = segment(0x27008, 0x2000_0008, 1016, &[]);
        assert_eq!(check(&[code, zeros]), Ok(Size { flash: 8, ram: 1024 }));
        let much = segment(0x27008, 0x2000_0000, RAM_MAX + 1, &[]);
        assert!(check(&[code, much]).is_err());
    }

    #[test]
    fn what_would_overwrite_the_bootloader_is_refused() {
        let code = segment(0x27000, 0x27000, 8, &VECTORS);
        assert!(check(&[code, segment(0x26ffc, 0x26ffc, 4, &[0; 4])]).is_err());
        assert!(check(&[code, segment(0xebffe, 0xebffe, 4, &[0; 4])]).is_err());
        assert!(check(&[segment(0x27000, 0x27000, 8, &[0; 8])]).is_err());
        assert!(check(&[segment(0x27100, 0x27100, 8, &VECTORS)]).is_err());
    }
}
