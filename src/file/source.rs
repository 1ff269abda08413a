//! Reading the parts of a file, with no more memory than there are bytes.

use std::io::{self, ErrorKind, Read};

use bytemuck::{Pod, Zeroable, bytes_of_mut, cast_slice_mut};
use crc32fast::Hasher;

use super::error::LoadError;
use super::header::{Header, Section};
use super::{ALIGN, padding};

/// Bytes at once: enough to make up for a call, few enough to be still in the cache for the checksum.
const PIECE: usize = 1 << 18;

/// Where a file comes from, and how far it was read.
pub(super) struct Source<R> {
    from: R,
    read: u64,
    section: &'static str,
}

impl<R: Read> Source<R> {
    pub(super) fn new(from: R) -> Self {
        Self { from, read: 0, section: "header" }
    }

    /// The header, as it was written.
    pub(super) fn header(&mut self) -> Result<Header, LoadError> {
        let mut header = Header::zeroed();
        // A foreign file may be shorter than a header, and another version have one of another size.
        let filled = self.fill(&mut header.magic);
        let read = self.read as usize;
        if header.magic[..read] != Header::MAGIC[..read] {
            return Err(LoadError::Foreign);
        }
        filled?;
        self.fill(bytes_of_mut(&mut header.version))?;
        if header.version != Header::VERSION {
            return Err(LoadError::Version { found: header.version });
        }
        let start = self.read as usize;
        self.fill(&mut bytes_of_mut(&mut header)[start..])?;
        if header.is_whole() { Ok(header) } else { Err(self.damaged(0)) }
    }

    /// An array, as it was written, and the zeros behind it.
    pub(super) fn section<T: Pod>(
        &mut self,
        name: &'static str,
        section: &Section,
    ) -> Result<Vec<T>, LoadError> {
        self.section = name;
        let start = self.read;
        let (items, checksum) = self.items(section.items)?;
        let mut zeros = [0; ALIGN];
        self.fill(&mut zeros[..padding(size_of_val(&*items))])?;
        let whole = checksum == section.checksum && zeros == [0; ALIGN];
        if whole { Ok(items) } else { Err(self.damaged(start)) }
    }

    /// That many items, and their checksum.
    fn items<T: Pod>(&mut self, count: u64) -> Result<(Vec<T>, u32), LoadError> {
        let too_many = || io::Error::from(ErrorKind::OutOfMemory);
        let count = usize::try_from(count).map_err(|_| too_many())?;
        let piece = PIECE / size_of::<T>();
        let (mut items, mut hasher) = (Vec::new(), Hasher::new());
        while items.len() < count {
            let (start, left) = (items.len(), count - items.len());
            if start == items.capacity() {
                // As much again as has arrived, whatever the file claims.
                let more = left.min(start.max(piece));
                items.try_reserve_exact(more).map_err(|_| too_many())?;
            }
            let next = left.min(piece).min(items.capacity() - start);
            items.resize(start + next, T::zeroed());
            let bytes = cast_slice_mut(&mut items[start..]);
            self.fill(bytes)?;
            hasher.update(bytes);
        }
        Ok((items, hasher.finalize()))
    }

    fn fill(&mut self, mut bytes: &mut [u8]) -> Result<(), LoadError> {
        while !bytes.is_empty() {
            match self.from.read(bytes) {
                Ok(0) => return Err(LoadError::Truncated { section: self.section, len: self.read }),
                Ok(n) => {
                    self.read += n as u64;
                    bytes = &mut bytes[n..];
                }
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) => return Err(error.into()),
            }
        }
        Ok(())
    }

    fn damaged(&self, start: u64) -> LoadError {
        LoadError::Damaged { section: self.section, start }
    }
}
