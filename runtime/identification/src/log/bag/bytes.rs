//! Reader of bytes from the beginning of a slice. Methods return `None` if the bytes end too early.

use std::borrow::Cow;

#[derive(Debug, Clone, Copy)]
pub(super) struct Bytes<'a>(pub(super) &'a [u8]);

impl<'a> Bytes<'a> {
    pub(super) fn take(&mut self, count: usize) -> Option<&'a [u8]> {
        let (head, rest) = self.0.split_at_checked(count)?;
        self.0 = rest;
        Some(head)
    }

    pub(super) fn array<const COUNT: usize>(&mut self) -> Option<[u8; COUNT]> {
        self.take(COUNT)?.try_into().ok()
    }

    /// Returns bytes that are preceded by their length, a little-endian integer of four bytes.
    pub(super) fn counted(&mut self) -> Option<&'a [u8]> {
        let count = u32::from_le_bytes(self.array()?);
        self.take(usize::try_from(count).ok()?)
    }

    pub(super) fn text(&mut self) -> Option<Cow<'a, str>> {
        self.counted().map(String::from_utf8_lossy)
    }
}
