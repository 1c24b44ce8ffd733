//! INDX: how long every segment of every chunk is, from which follows where each begins.

use super::bytes::{Cursor, put_varint};
use super::chunk::stored_length;
use crate::codec::SEGMENTS;
use crate::error::{Error, Result};

/// Offsets are kept of every so many chunks; those between are added up when they are asked for.
const STEP: usize = 64;

/// Lengths of one segment in all chunks: the least of them, and what each has beyond it in `width` bits.
#[derive(Debug)]
struct Column {
    least: u32,
    width: u32,
    packed: Vec<u8>,
}

/// Lengths and offsets of a row of chunks that lie one after the other.
#[derive(Debug)]
pub(super) struct Index {
    chunks: u64,
    columns: [Column; SEGMENTS],
    offsets: Vec<u64>,
    total: u64,
}

/// Appends the index of a row of chunks.
pub(super) fn write(out: &mut Vec<u8>, lengths: &[[u32; SEGMENTS]]) {
    for segment in 0..SEGMENTS {
        let column = || lengths.iter().map(|lengths| lengths[segment]);
        let least = column().min().unwrap_or(0);
        let width = 32 - (column().max().unwrap_or(0) - least).leading_zeros();
        put_varint(out, u64::from(least));
        if lengths.len() > 1 {
            out.push(width as u8);
        }
        let (mut bits, mut waiting) = (0_u64, 0);
        for length in column() {
            bits |= u64::from(length - least) << waiting;
            waiting += width;
            while waiting >= 8 {
                out.push(bits as u8);
                bits >>= 8;
                waiting -= 8;
            }
        }
        if waiting > 0 {
            out.push(bits as u8);
        }
    }
}

impl Index {
    /// Reads the index of `chunks` chunks that take exactly `total` bytes.
    pub(super) fn read(cursor: &mut Cursor, chunks: u64, total: u64) -> Result<Self> {
        let mut columns = vec![];
        for _ in 0..SEGMENTS {
            let least = cursor.varint_in("a segment's length", 0, u64::from(u32::MAX))? as u32;
            let width = if chunks > 1 { u32::from(cursor.u8()?) } else { 0 };
            if width > 32 {
                return Err(cursor.corrupt(format!("lengths of {width} bits: expected at most 32")));
            }
            let bits = u128::from(chunks) * u128::from(width);
            let bytes = usize::try_from(bits.div_ceil(8)).map_err(|_| cursor.corrupt("its bytes end early"))?;
            let packed = cursor.take(bytes)?;
            // One index has one form: what pads the last byte is zero.
            if let Some(&last) = packed.last()
                && bits % 8 != 0
                && last >> (bits % 8) != 0
            {
                return Err(cursor.corrupt("bits are set after the last length"));
            }
            columns.push(Column { least, width, packed: packed.to_vec() });
        }
        let columns = columns.try_into().map_err(|_| cursor.corrupt("its bytes end early"))?;
        let mut index = Self { chunks, columns, offsets: vec![], total };
        index.add_up().map_err(|message| cursor.corrupt(message))?;
        Ok(index)
    }

    /// Checks all lengths and notes every [`STEP`]th offset.
    fn add_up(&mut self) -> std::result::Result<(), String> {
        let mut offset = 0;
        for chunk in 0..self.chunks {
            if chunk % STEP as u64 == 0 {
                self.offsets.push(offset);
            }
            for (segment, column) in self.columns.iter().enumerate() {
                if column.length(chunk) > u64::from(u32::MAX) {
                    return Err(format!("segment {segment} of chunk {chunk} has more than 32 bits of length"));
                }
            }
            let lengths = self.lengths(chunk);
            if lengths[0] == 0 {
                return Err(format!("chunk {chunk} begins with an empty segment"));
            }
            offset += stored_length(&lengths, SEGMENTS);
            if offset > self.total {
                break;
            }
        }
        if offset == self.total {
            return Ok(());
        }
        Err(format!("the lengths do not add up to the {} bytes that the chunks take", self.total))
    }

    /// Number of chunks.
    pub(super) fn chunks(&self) -> u64 {
        self.chunks
    }

    /// Lengths of a chunk's segments.
    pub(super) fn lengths(&self, chunk: u64) -> [u32; SEGMENTS] {
        self.columns.each_ref().map(|column| column.length(chunk) as u32)
    }

    /// Where a chunk begins, counted from the first.
    pub(super) fn offset(&self, chunk: u64) -> u64 {
        let step = STEP as u64;
        let Some(&before) = self.offsets.get((chunk / step) as usize) else { return self.total };
        before + (chunk / step * step..chunk).map(|other| stored_length(&self.lengths(other), SEGMENTS)).sum::<u64>()
    }

    /// What all chunks' segments take, without checksums.
    pub(super) fn segment_bytes(&self) -> [u64; SEGMENTS] {
        self.columns.each_ref().map(|column| (0..self.chunks).map(|chunk| column.length(chunk)).sum())
    }
}

impl Column {
    fn length(&self, chunk: u64) -> u64 {
        if self.width == 0 {
            return u64::from(self.least);
        }
        // Bits need more than 32 bits to count even where bytes do not.
        let bit = chunk * u64::from(self.width);
        let mut bytes = [0; 8];
        for (to, from) in bytes.iter_mut().zip(&self.packed[(bit / 8) as usize..]) {
            *to = *from;
        }
        let value = u64::from_le_bytes(bytes) >> (bit % 8) & ((1 << self.width) - 1);
        u64::from(self.least) + value
    }
}

/// Refuses more chunks than so many bytes can hold: each has at least a byte and its checksum.
pub(super) fn check_count(chunks: u64, bytes: u64) -> Result<()> {
    let least = 1 + super::chunk::CHECKSUM as u64;
    if chunks <= bytes / least {
        return Ok(());
    }
    let message = format!("{chunks} chunks cannot stand in {bytes} bytes");
    Err(Error::new(crate::error::ErrorKind::Corrupt, message).at_place("section META"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_come_back_with_their_offsets() {
        let mut lengths = vec![];
        let mut state = 1_u32;
        for _ in 0..1000 {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            lengths.push([1 + (state >> 28), 7, 0, if state & 1 == 0 { 0 } else { state }]);
        }
        for count in [1, 2, 63, 64, 65, 1000] {
            let lengths = &lengths[..count];
            let total = lengths.iter().map(|lengths| stored_length(lengths, SEGMENTS)).sum();
            let mut bytes = vec![];
            write(&mut bytes, lengths);
            let mut cursor = Cursor::new(&bytes, "section INDX");
            let index = Index::read(&mut cursor, count as u64, total).unwrap();
            cursor.end().unwrap();
            let mut offset = 0;
            for (chunk, lengths) in lengths.iter().enumerate() {
                assert_eq!(index.lengths(chunk as u64), *lengths, "lengths of chunk {chunk} of {count}");
                assert_eq!(index.offset(chunk as u64), offset, "offset of chunk {chunk} of {count}");
                offset += stored_length(lengths, SEGMENTS);
            }
            assert!(Index::read(&mut Cursor::new(&bytes, "section INDX"), count as u64, total + 1).is_err());
        }
    }

    /// The specification explains these bytes.
    #[test]
    fn the_worked_example_holds() {
        let mut bytes = vec![];
        write(&mut bytes, &[[5, 7, 0, 0], [6, 7, 0, 0], [12, 7, 0, 0]]);
        assert_eq!(bytes, [0x05, 0x03, 0xc8, 0x01, 0x07, 0, 0, 0, 0, 0]);
    }

    #[test]
    fn an_index_of_ten_thousand_large_tiles_takes_ten_bytes_each() {
        // Tiles of 1024 x 1024 floats, as unlike in their sizes as can be.
        let mut lengths = vec![[1, 1, 1, 1]; 10_000];
        lengths[5] = [1 << 16, 1 << 18, 1 << 20, 1 << 22];
        let mut bytes = vec![];
        write(&mut bytes, &lengths);
        assert!(bytes.len() <= 100_000, "{} bytes", bytes.len());
    }
}
