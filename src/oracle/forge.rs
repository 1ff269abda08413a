//! Saved scenes whose checksums hide what was done to them, to test what comes after the checksums.

use bytemuck::{bytes_of, pod_read_unaligned};

use crate::file::{Header, padding};

/// Makes the start, the version, all checksums and the zeros between sections right, of any bytes; too few
/// are filled up to a header.
///
/// ```
/// use octogrid::oracle::forge;
/// use octogrid::{LoadError, Scene, builtin};
/// let mut file = Vec::new();
/// Scene::build(&builtin::cube().mesh()?, &Default::default())?.save(&mut file)?;
/// file[196] ^= 1; // a coordinate of the second triangle
/// assert!(matches!(Scene::load(&file[..]), Err(LoadError::Damaged { section: "clusters", .. })));
/// forge::seal(&mut file);
/// assert!(Scene::load(&file[..]).is_ok());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn seal(file: &mut Vec<u8>) {
    const HEADER: usize = size_of::<Header>();
    file.resize(file.len().max(HEADER), 0);
    let (start, mut rest) = file.split_at_mut(HEADER);
    let mut header: Header = pod_read_unaligned(start);
    (header.magic, header.version) = (Header::MAGIC, Header::VERSION);
    for (section, item) in header.sections.iter_mut().zip(Header::ITEM_BYTES) {
        let claimed = usize::try_from(section.items).unwrap_or(usize::MAX).saturating_mul(item);
        let (items, after) = rest.split_at_mut(claimed.min(rest.len()));
        let (zeros, after) = after.split_at_mut(padding(items.len()).min(after.len()));
        section.checksum = crc32fast::hash(items);
        zeros.fill(0);
        rest = after;
    }
    header.seal();
    start.copy_from_slice(bytes_of(&header));
}
