//! The list of add-ins in the registry.

use std::ffi::c_void;

type Key = *mut c_void;

const CURRENT_USER: Key = 0x8000_0001_usize as Key;
const ALL_ACCESS: u32 = 0xF003F;
const TEXT: u32 = 1;
/// Excel reads no more; beyond it the list would not be dense anyway.
const MOST: usize = 1024;

#[link(name = "advapi32")]
unsafe extern "system" {
    fn RegCreateKeyExW(
        key: Key,
        name: *const u16,
        reserved: u32,
        class: *const u16,
        options: u32,
        access: u32,
        security: *const c_void,
        result: *mut Key,
        disposition: *mut u32,
    ) -> i32;
    fn RegOpenKeyExW(key: Key, name: *const u16, options: u32, access: u32, result: *mut Key) -> i32;
    fn RegQueryValueExW(
        key: Key,
        name: *const u16,
        reserved: *mut u32,
        kind: *mut u32,
        data: *mut u8,
        size: *mut u32,
    ) -> i32;
    fn RegSetValueExW(
        key: Key,
        name: *const u16,
        reserved: u32,
        kind: u32,
        data: *const u8,
        size: u32,
    ) -> i32;
    fn RegDeleteValueW(key: Key, name: *const u16) -> i32;
    fn RegCloseKey(key: Key) -> i32;
}

/// One entry of the list as it stands in the registry.
#[derive(Clone)]
struct Entry {
    kind: u32,
    data: Vec<u8>,
}

impl Entry {
    fn of(text: &str) -> Self {
        let units = text.encode_utf16().chain([0]);
        Entry { kind: TEXT, data: units.flat_map(u16::to_le_bytes).collect() }
    }

    fn text(&self) -> String {
        let units: Vec<u16> = self.data.chunks_exact(2).map(|b| u16::from_le_bytes([b[0], b[1]])).collect();
        String::from_utf16_lossy(&units).trim_end_matches('\0').to_owned()
    }

    /// Ours, wherever an earlier version lay.
    fn is(&self, file_name: &str) -> bool {
        let text = self.text().to_lowercase();
        let path = text.trim_end_matches('"');
        path.ends_with(&format!("\\{}", file_name.to_lowercase()))
    }
}

/// Takes the add-in out of every version's list and, with `add`, puts it at the end of the first version's.
pub fn change(versions: &[&str], path: &str, add: bool) -> Result<(), String> {
    let file_name = path.rsplit(['\\', '/']).next().unwrap_or(path);
    for (i, version) in versions.iter().enumerate() {
        let adds = add && i == 0;
        let Some(key) = open(&format!(r"Software\Microsoft\Office\{version}\Excel\Options"), adds)? else {
            continue;
        };
        let before = read(key);
        let mut after: Vec<Entry> = before.iter().filter(|entry| !entry.is(file_name)).cloned().collect();
        if adds {
            after.push(Entry::of(&format!("/R \"{path}\"")));
        }
        let result = write(key, &before, &after);
        // SAFETY: opened above
        unsafe { RegCloseKey(key) };
        result?;
    }
    Ok(())
}

fn wide(text: &str) -> Vec<u16> {
    text.encode_utf16().chain([0]).collect()
}

fn name(index: usize) -> Vec<u16> {
    wide(&if index == 0 { "OPEN".into() } else { format!("OPEN{index}") })
}

fn open(path: &str, create: bool) -> Result<Option<Key>, String> {
    let (path_wide, mut key) = (wide(path), std::ptr::null_mut());
    // SAFETY: the names end with zero, `key` is a place to write to
    let code = unsafe {
        if create {
            let none = std::ptr::null();
            RegCreateKeyExW(
                CURRENT_USER,
                path_wide.as_ptr(),
                0,
                none,
                0,
                ALL_ACCESS,
                std::ptr::null(),
                &raw mut key,
                std::ptr::null_mut(),
            )
        } else {
            RegOpenKeyExW(CURRENT_USER, path_wide.as_ptr(), 0, ALL_ACCESS, &raw mut key)
        }
    };
    match (code, create) {
        (0, _) => Ok(Some(key)),
        (_, false) => Ok(None),
        (code, true) => Err(format!("the key {path} cannot be opened (error {code})")),
    }
}

fn read(key: Key) -> Vec<Entry> {
    let mut entries = Vec::new();
    while entries.len() < MOST {
        let (name, mut kind, mut size) = (name(entries.len()), 0, 0);
        // SAFETY: with no data the size is asked for
        let asked = unsafe {
            RegQueryValueExW(
                key,
                name.as_ptr(),
                std::ptr::null_mut(),
                &raw mut kind,
                std::ptr::null_mut(),
                &raw mut size,
            )
        };
        let mut data = vec![0; size as usize];
        // SAFETY: `data` has room for `size` bytes
        let got = unsafe {
            RegQueryValueExW(
                key,
                name.as_ptr(),
                std::ptr::null_mut(),
                &raw mut kind,
                data.as_mut_ptr(),
                &raw mut size,
            )
        };
        if asked != 0 || got != 0 {
            break;
        }
        data.truncate(size as usize);
        entries.push(Entry { kind, data });
    }
    entries
}

fn write(key: Key, before: &[Entry], after: &[Entry]) -> Result<(), String> {
    for (i, entry) in after.iter().enumerate() {
        let same = before.get(i).is_some_and(|old| old.kind == entry.kind && old.data == entry.data);
        // SAFETY: the data has that many bytes
        let code = if same {
            0
        } else {
            unsafe {
                let size = entry.data.len() as u32;
                RegSetValueExW(key, name(i).as_ptr(), 0, entry.kind, entry.data.as_ptr(), size)
            }
        };
        if code != 0 {
            return Err(format!("the list of add-ins cannot be written (error {code})"));
        }
    }
    for i in after.len()..before.len() {
        // SAFETY: the name ends with zero
        unsafe { RegDeleteValueW(key, name(i).as_ptr()) };
    }
    Ok(())
}
