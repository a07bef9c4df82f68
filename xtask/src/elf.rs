//! Reading a 32-bit ELF program and writing it as a UF2 file, as the bootloader of the XIAO takes it.
//!
//! UF2: <https://github.com/microsoft/uf2>, blocks of 512 bytes with 256 bytes of content.

/// A loaded part of a program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Segment<'a> {
    /// Where it is stored.
    pub stored: u32,
    /// Where it is in memory.
    pub address: u32,
    /// How long it is in memory; what the file does not have is zero.
    pub memory_bytes: u32,
    /// Its content.
    pub bytes: &'a [u8],
}

const LOADED: u32 = 1;
const PROGRAM_HEADER_BYTES: usize = 32;

/// The loaded segments of a little-endian 32-bit program.
pub fn segments(file: &[u8]) -> Result<Vec<Segment<'_>>, String> {
    if file.get(..6) != Some(&[0x7f, b'E', b'L', b'F', 1, 1]) {
        return Err("no little-endian 32-bit ELF program".into());
    }
    let table = word(file, 28)? as usize;
    let count = word(file, 44)? as usize & 0xffff;
    let mut segments = Vec::new();
    for k in 0..count {
        let at = table + k * PROGRAM_HEADER_BYTES;
        let field = |n: usize| word(file, at + 4 * n);
        let (kind, offset, address, stored) = (field(0)?, field(1)?, field(2)?, field(3)?);
        let (length, memory_bytes) = (field(4)?, field(5)?);
        if kind == LOADED && memory_bytes > 0 {
            let range = offset as usize..offset as usize + length as usize;
            let bytes = file.get(range).ok_or("a segment beyond the file's end")?;
            segments.push(Segment { stored, address, memory_bytes, bytes });
        }
    }
    Ok(segments)
}

fn word(file: &[u8], at: usize) -> Result<u32, String> {
    let bytes = file.get(at..).and_then(<[u8]>::first_chunk).ok_or("the file ends too early")?;
    Ok(u32::from_le_bytes(*bytes))
}

/// Content of a block.
const BLOCK: u32 = 256;
const MAGIC: [u32; 2] = [0x0A32_4655, 0x9E5D_5157];
const MAGIC_END: u32 = 0x0AB1_6F30;
/// The family is given.
const FLAGS: u32 = 0x2000;

/// The segments as a UF2 file for a family of boards; gaps in a block are 0xFF.
pub fn uf2(segments: &[Segment<'_>], family: u32) -> Vec<u8> {
    let mut blocks = std::collections::BTreeMap::<u32, [u8; BLOCK as usize]>::new();
    for segment in segments {
        for (address, byte) in (segment.stored..).zip(segment.bytes) {
            let block = blocks.entry(address & !(BLOCK - 1)).or_insert([0xff; BLOCK as usize]);
            block[(address & (BLOCK - 1)) as usize] = *byte;
        }
    }
    let mut file = Vec::with_capacity(blocks.len() * 512);
    let count = blocks.len() as u32;
    for (number, (address, content)) in (0..).zip(&blocks) {
        let start = file.len();
        for word in [MAGIC[0], MAGIC[1], FLAGS, *address, BLOCK, number, count, family] {
            file.extend_from_slice(&u32::to_le_bytes(word));
        }
        file.extend_from_slice(content);
        file.resize(start + 508, 0);
        file.extend_from_slice(&MAGIC_END.to_le_bytes());
    }
    file
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_block_is_as_the_specification_says() {
        let segments = [Segment { stored: 0x27010, address: 0x27010, memory_bytes: 2, bytes: &[1, 2] }];
        let file = uf2(&segments, 0xADA5_2840);
        assert_eq!(file.len(), 512);
        assert_eq!(file[..8], *b"UF2\nWQ]\x9e");
        assert_eq!(file[12..20], [0, 0x70, 2, 0, 0, 1, 0, 0]);
        assert_eq!(file[28..32], [0x40, 0x28, 0xa5, 0xad]);
        assert_eq!(file[32 + 0xf..32 + 0x13], [0xff, 1, 2, 0xff]);
        assert_eq!(file[508..], [0x30, 0x6f, 0xb1, 0x0a]);
    }

    #[test]
    fn what_is_no_program_is_refused() {
        assert!(segments(b"").is_err());
        assert!(segments(b"\x7fELF\x01\x01").is_err());
        let mut file = vec![0; 60];
        file[..6].copy_from_slice(b"\x7fELF\x01\x01");
        file[44] = 3;
        file[28] = 52;
        assert!(segments(&file).is_err());
    }
}
