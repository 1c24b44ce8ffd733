//! Makes the checksums of a damaged file right, so that a fuzzer gets past them.
//!
//! Written from `format-spec/oro.md`; what cannot be understood is left as it is.

use orograph::codec::SEGMENTS;
use orograph::oro::Reader;

const HEADER: usize = 12;
const FOOTER: usize = 38;

/// A varint at a place, and the place after it.
fn varint(bytes: &[u8], mut at: usize) -> Option<(u64, usize)> {
    let mut value = 0;
    for shift in (0..63).step_by(7) {
        let byte = *bytes.get(at)?;
        at += 1;
        value |= u64::from(byte & 127) << shift;
        if byte < 128 {
            return Some((value, at));
        }
    }
    None
}

fn put_checksum(file: &mut [u8], at: usize, checksum: u32) {
    file[at..at + 4].copy_from_slice(&checksum.to_le_bytes());
}

/// A section: its type, its bytes in the file, and where its checksum stands.
struct Section {
    number: u8,
    start: usize,
    end: usize,
    checksum_at: usize,
}

/// The sections that the directory names.
fn sections(file: &[u8], directory_start: usize) -> Option<Vec<Section>> {
    let end = file.len() - FOOTER;
    let mut found = vec![];
    let mut at = directory_start;
    while at < end {
        let number = file[at] & 127;
        let (length, after) = varint(file, at + 1)?;
        found.push(Section { number, start: 0, end: usize::try_from(length).ok()?, checksum_at: after });
        at = after + 4;
    }
    let mut end = directory_start;
    for section in found.iter_mut().rev() {
        section.start = end.checked_sub(section.end).filter(|&start| start >= HEADER)?;
        (section.end, end) = (end, section.start);
    }
    (at == file.len() - FOOTER).then_some(found)
}

/// Lengths of the segments of a row of chunks, from the index at a place; and the place after it.
fn lengths(index: &[u8], mut at: usize, chunks: usize) -> Option<(Vec<[usize; SEGMENTS]>, usize)> {
    let mut lengths = vec![[0; SEGMENTS]; chunks];
    for segment in 0..SEGMENTS {
        let (least, after) = varint(index, at)?;
        at = after;
        let mut width = 0;
        if chunks > 1 {
            width = usize::from(*index.get(at)?);
            at += 1;
        }
        for (chunk, lengths) in lengths.iter_mut().enumerate() {
            let bit = |k: usize| index.get(at + k / 8).map_or(0, |byte| usize::from(byte >> (k % 8) & 1));
            let more: usize = (0..width.min(32)).map(|k| bit(chunk * width + k) << k).sum();
            lengths[segment] = usize::try_from(least).ok()?.saturating_add(more);
        }
        at += (chunks * width).div_ceil(8);
    }
    Some((lengths, at))
}

/// Seals the segments that begin at a place of the file.
fn seal_chunks(file: &mut [u8], mut at: usize, end: usize, lengths: &[[usize; SEGMENTS]]) {
    for &length in lengths.iter().flatten().filter(|&&length| length > 0) {
        let Some(after) = at.checked_add(length).filter(|after| after + 4 <= end) else { return };
        let checksum = crc32c::crc32c(&file[at..after]);
        put_checksum(file, after, checksum);
        at = after + 4;
    }
}

/// Seals the footer over the directory.
fn seal_footer(file: &mut [u8], directory_start: usize) {
    let footer = file.len() - FOOTER;
    let checksum = crc32c::crc32c(&file[directory_start..footer + 30]);
    put_checksum(file, footer + 30, checksum);
}

/// Puts magic bytes, version, length and checksums where a reader looks for them.
pub fn seal(file: &mut [u8]) {
    if file.len() < HEADER + FOOTER {
        return;
    }
    let (length, footer) = (file.len() as u64, file.len() - FOOTER);
    file[..8].copy_from_slice(&[0x89, b'O', b'R', b'O', 1, 0, 0, 0]);
    let checksum = crc32c::crc32c(&file[..8]);
    put_checksum(file, 8, checksum);
    file[footer..footer + 8].copy_from_slice(&length.to_le_bytes());
    file[footer + 26..footer + 30].copy_from_slice(&[1, 0, 0, 0]);
    file[footer + 34..].copy_from_slice(b"ORO\x89");
    let directory = usize::from(u16::from_le_bytes([file[footer + 24], file[footer + 25]]));
    let Some(directory_start) = footer.checked_sub(directory) else { return };
    let Some(sections) = sections(file, directory_start) else { return seal_footer(file, directory_start) };
    for section in &sections {
        let checksum = crc32c::crc32c(&file[section.start..section.end]);
        put_checksum(file, section.checksum_at, checksum);
    }
    seal_footer(file, directory_start);
    // Chunks: how many there are is known as soon as the file opens, and it opens without their checksums.
    let Ok(reader) = Reader::open(&file[..]) else { return };
    let (chunks, bands) = (reader.description().chunks() as usize, reader.description().bands.len());
    let (width, height) = reader.description().level_size(6);
    let side = reader.description().tile_side;
    drop(reader);
    let find = |number: u8| sections.iter().find(|section| section.number == number);
    let Some(index) = find(2).map(|section| file[section.start..section.end].to_vec()) else { return };
    let Some((tiles, at)) = lengths(&index, 0, chunks) else { return };
    seal_chunks(file, HEADER, sections[0].start, &tiles);
    if let Some(overview) = find(3) {
        let chunks = width.div_ceil(side) * height.div_ceil(side) * bands;
        if let Some((tiles, _)) = lengths(&index, at, chunks) {
            seal_chunks(file, overview.start, overview.end, &tiles);
        }
        let checksum = crc32c::crc32c(&file[overview.start..overview.end]);
        put_checksum(file, overview.checksum_at, checksum);
        seal_footer(file, directory_start);
    }
}
