//! Structs in Thrift's compact protocol, walked over before the Parquet decoder reads them: where a list says more
//! values than there are bytes, the decoder counts them all the same, for minutes.

/// Structs and lists within each other.
const DEPTH: usize = 64;

/// What a field of a struct holds.
pub(crate) enum Value<'a> {
    /// A whole number.
    Whole(i64),
    /// Bytes or a text.
    Bytes(&'a [u8]),
}

/// Walks over structs in bytes.
pub(crate) struct Walker<'a> {
    /// What follows the structs walked over so far.
    pub rest: &'a [u8],
    /// Values that lists may still say: none takes less than a byte.
    values: usize,
}

impl<'a> Walker<'a> {
    pub(crate) fn new(bytes: &'a [u8]) -> Self {
        Walker { rest: bytes, values: bytes.len() }
    }

    /// Walks over a struct; gives each whole number and text of its own with its field's identifier. Nothing where the
    /// struct is cut, too deep, of unknown types, or says more values than there are bytes.
    pub(crate) fn structure(&mut self, mut each: impl FnMut(i16, Value<'a>)) -> Option<()> {
        self.fields(DEPTH, &mut each)
    }

    fn fields(&mut self, depth: usize, each: &mut dyn FnMut(i16, Value<'a>)) -> Option<()> {
        let depth = depth.checked_sub(1)?;
        let mut field = 0_i16;
        loop {
            let head = self.byte()?;
            let kind = head & 0x0F;
            if kind == 0 {
                return Some(());
            }
            field = match head >> 4 {
                0 => i16::try_from(self.signed()?).ok()?,
                step => field.checked_add(i16::from(step))?,
            };
            match kind {
                4..=6 => each(field, Value::Whole(self.signed()?)),
                8 => each(field, Value::Bytes(self.bytes()?)),
                // A field's type is its value.
                1 | 2 => {}
                _ => self.value(kind, depth)?,
            }
        }
    }

    /// Walks over a value of a list. The decoder takes no byte for a yes or no in lists that it passes over.
    fn value(&mut self, kind: u8, depth: usize) -> Option<()> {
        match kind {
            1 | 2 => Some(()),
            3 => self.pass(1),
            4..=6 => self.signed().map(|_| ()),
            7 => self.pass(8),
            8 => self.bytes().map(|_| ()),
            9 | 10 => {
                let head = self.byte()?;
                let count = if head >> 4 == 15 { number(&mut self.rest)? } else { u64::from(head >> 4) };
                self.values(count, &[head & 0x0F], depth)
            }
            11 => {
                let count = number(&mut self.rest)?;
                let kinds = if count > 0 { self.byte()? } else { 0 };
                self.values(count, &[kinds >> 4, kinds & 0x0F], depth)
            }
            12 => self.fields(depth, &mut |_, _| {}),
            13 => self.pass(16),
            _ => None,
        }
    }

    fn values(&mut self, count: u64, kinds: &[u8], depth: usize) -> Option<()> {
        let depth = depth.checked_sub(1)?;
        let count = usize::try_from(count).ok()?;
        self.values = self.values.checked_sub(count)?;
        for _ in 0..count {
            for kind in kinds {
                self.value(*kind, depth)?;
            }
        }
        Some(())
    }

    /// Bytes with their number in front.
    fn bytes(&mut self) -> Option<&'a [u8]> {
        let length = usize::try_from(number(&mut self.rest)?).ok()?;
        let (bytes, rest) = self.rest.split_at_checked(length)?;
        self.rest = rest;
        Some(bytes)
    }

    /// Passes over bytes.
    pub(crate) fn pass(&mut self, count: u64) -> Option<()> {
        self.rest = self.rest.get(usize::try_from(count).ok()?..)?;
        Some(())
    }

    fn byte(&mut self) -> Option<u8> {
        let (byte, rest) = self.rest.split_first()?;
        self.rest = rest;
        Some(*byte)
    }

    /// A number with its sign in the lowest bit.
    fn signed(&mut self) -> Option<i64> {
        let value = number(&mut self.rest)?;
        Some((value >> 1) as i64 ^ -((value & 1) as i64))
    }
}

/// A number of seven bits a byte, the lowest first.
pub(crate) fn number(bytes: &mut &[u8]) -> Option<u64> {
    let mut value = 0;
    for shift in (0..64).step_by(7) {
        let (byte, rest) = bytes.split_first()?;
        *bytes = rest;
        value |= u64::from(byte & 0x7F) << shift;
        if byte & 0x80 == 0 {
            return Some(value);
        }
    }
    None
}
