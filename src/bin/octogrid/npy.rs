//! Rays from a NumPy file, hits and images to one.
//!
//! The header is read here rather than by `npyz`, which trusts the lengths and nesting that a file
//! claims; a damaged file must give an error, not exhaust memory or the stack.

use std::fmt::Write as _;
use std::io::{self, Read, Write};

use npyz::{AutoSerialize, WriterBuilder};
use octogrid::Ray;

/// The longest header that is read; that of an array of rays has 118 bytes.
const MAX_HEADER: usize = 1 << 16;
/// Bytes of a ray.
const ROW: usize = size_of::<Ray>();

/// Reads rays: float32, shape (n, 8), C order.
///
/// # Errors
/// Where the file can't be read or holds something else; says which.
pub(crate) fn read_rays(file: &mut impl Read) -> Result<Vec<Ray>, String> {
    let rows = ray_count(&read_header(file)?)?;
    read_rows(file, rows)
}

/// The text of the header.
fn read_header(file: &mut impl Read) -> Result<String, String> {
    let mut prefix = [0; 8];
    read_part(file, &mut prefix, "not an npy file: it ends before the header")?;
    if !prefix.starts_with(b"\x93NUMPY") {
        return Err("not an npy file: it doesn't begin with \\x93NUMPY".into());
    }
    let mut length = [0; 4];
    let bytes = match prefix[6] {
        1 => 2,
        2 | 3 => 4,
        version => return Err(format!("npy version {version} is not known")),
    };
    let truncated = "the npy header is truncated";
    read_part(file, &mut length[..bytes], truncated)?;
    let length = u32::from_le_bytes(length) as usize;
    if length > MAX_HEADER {
        return Err(format!("an npy header of {length} bytes is not one of rays"));
    }
    let mut header = vec![0; length];
    read_part(file, &mut header, truncated)?;
    Ok(String::from_utf8_lossy(&header).into_owned())
}

fn read_part(file: &mut impl Read, part: &mut [u8], truncated: &str) -> Result<(), String> {
    file.read_exact(part).map_err(|e| match e.kind() {
        io::ErrorKind::UnexpectedEof => truncated.to_owned(),
        _ => e.to_string(),
    })
}

/// The number of rays, where the header is that of rays.
fn ray_count(header: &str) -> Result<u64, String> {
    let damaged = |key| format!("the npy header has no valid '{key}'");
    let descr = value(header, "descr").ok_or_else(|| damaged("descr"))?;
    let descr = match descr.strip_prefix('\'') {
        Some(rest) => rest.split('\'').next().unwrap_or(rest),
        None => "a structured type",
    };
    let order = value(header, "fortran_order").ok_or_else(|| damaged("fortran_order"))?;
    let order = if order.starts_with("False") { "C" } else { "Fortran" };
    let shape = shape(header).ok_or_else(|| damaged("shape"))?;
    match shape[..] {
        [rows, 8] if descr == "<f4" && order == "C" && rows <= u64::from(u32::MAX) => Ok(rows),
        _ => {
            let mut text = String::new();
            for length in &shape {
                let _ = write!(text, "{length},");
            }
            Err(format!(
                "rays need dtype <f4, shape (n,8) with n < 2^32, C order; the file has {descr}, ({text}), {order} order"
            ))
        }
    }
}

/// What follows a key of the header's dictionary.
fn value<'a>(header: &'a str, key: &str) -> Option<&'a str> {
    let after = header.split_once(&format!("'{key}'"))?.1;
    Some(after.trim_start().strip_prefix(':')?.trim_start())
}

fn shape(header: &str) -> Option<Vec<u64>> {
    let list = value(header, "shape")?.strip_prefix('(')?.split_once(')')?.0;
    list.split(',').map(str::trim).filter(|n| !n.is_empty()).map(|n| n.parse().ok()).collect()
}

/// Reads `rows` rays. Grows with what is there, not with what the header claims.
fn read_rows(file: &mut impl Read, rows: u64) -> Result<Vec<Ray>, String> {
    let mut rays = Vec::new();
    let mut row = [0; ROW];
    for at in 0..rows {
        let truncated = || format!("the data is truncated: {at} rays of {rows}");
        file.read_exact(&mut row).map_err(|e| match e.kind() {
            io::ErrorKind::UnexpectedEof => truncated(),
            _ => e.to_string(),
        })?;
        let number = |i: usize| f32::from_le_bytes(std::array::from_fn(|byte| row[4 * i + byte]));
        rays.push(Ray {
            origin: std::array::from_fn::<f32, 3, _>(number).into(),
            t_min: number(3),
            dir: std::array::from_fn::<f32, 3, _>(|axis| number(4 + axis)).into(),
            t_max: number(7),
        });
    }
    Ok(rays)
}

/// The hit of one ray.
#[derive(AutoSerialize, npyz::Serialize)]
pub(crate) struct HitRow {
    pub(crate) t: f32,
    pub(crate) u: f32,
    pub(crate) v: f32,
    pub(crate) prim: u32,
}

/// One of several hits of a ray.
#[derive(AutoSerialize, npyz::Serialize)]
pub(crate) struct AllRow {
    pub(crate) ray: u32,
    pub(crate) t: f32,
    pub(crate) u: f32,
    pub(crate) v: f32,
    pub(crate) prim: u32,
}

/// Writes a one-dimensional array.
///
/// # Errors
/// Where `file` does.
pub(crate) fn write_rows<T: AutoSerialize>(
    file: &mut impl Write,
    len: usize,
    rows: impl Iterator<Item = T>,
) -> io::Result<()> {
    let mut writer =
        npyz::WriteOptions::new().default_dtype().shape(&[len as u64]).writer(file).begin_nd()?;
    for row in rows {
        writer.push(&row)?;
    }
    writer.finish()
}

/// Writes an image: float32, shape (height, width, 3), C order.
///
/// # Errors
/// Where `file` does.
pub(crate) fn write_image(
    file: &mut impl Write,
    [width, height]: [u32; 2],
    pixels: impl Iterator<Item = [f32; 3]>,
) -> io::Result<()> {
    let shape = [height.into(), width.into(), 3];
    let mut writer = npyz::WriteOptions::new().default_dtype().shape(&shape).writer(file).begin_nd()?;
    writer.extend(pixels.flatten())?;
    writer.finish()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn header_tells_the_number_of_rays() {
        let fine = "{'descr': '<f4', 'fortran_order': False, 'shape': (3, 8), }\n";
        assert_eq!(ray_count(fine), Ok(3));
        assert!(ray_count(&fine.replace("(3, 8)", "(24,)")).unwrap_err().ends_with("(24,), C order"));
        assert!(ray_count(&fine.replace("False", "True")).unwrap_err().ends_with("Fortran order"));
        assert!(ray_count(&fine.replace("'<f4'", "[('a', '<f4')]")).unwrap_err().contains("structured"));
        for broken in ["", "'shape'", &fine.replace("8)", "8"), &fine.replace('3', "99999999999999999999")] {
            assert!(ray_count(broken).is_err(), "{broken}");
        }
    }
}
