//! Files put together from their parts, after the specification and without the library's own writing.

use sha2::{Digest, Sha256};

pub const FOOTER: usize = 38;

/// A file in parts: everything before the first section, and each section with its type.
#[derive(Clone)]
pub struct Parts {
    pub chunks: Vec<u8>,
    pub sections: Vec<(u8, Vec<u8>)>,
    pub version: u16,
    pub flags: u16,
}

impl Parts {
    pub fn of(bytes: &[u8]) -> Self {
        let footer = &bytes[bytes.len() - FOOTER..];
        let directory_length = usize::from(u16::from_le_bytes([footer[24], footer[25]]));
        let mut end = bytes.len() - FOOTER - directory_length;
        let mut directory = &bytes[end..bytes.len() - FOOTER];
        let mut entries = vec![];
        while let [number, rest @ ..] = directory {
            let last = rest.iter().position(|byte| byte & 0x80 == 0).expect("a varint ends");
            let length = rest[..=last].iter().rev().fold(0, |sum, byte| sum << 7 | usize::from(byte & 0x7f));
            entries.push((*number, length));
            directory = &rest[last + 5..];
        }
        let mut sections = vec![];
        for &(number, length) in entries.iter().rev() {
            sections.insert(0, (number, bytes[end - length..end].to_vec()));
            end -= length;
        }
        Self { chunks: bytes[12..end].to_vec(), sections, version: 1, flags: 0 }
    }

    pub fn file(&self) -> Vec<u8> {
        let profile = [self.version.to_le_bytes(), self.flags.to_le_bytes()].concat();
        let mut header = [b"\x89ORO", profile.as_slice()].concat();
        header.extend(crc32c::crc32c(&header).to_le_bytes());
        let mut directory = vec![];
        for (number, bytes) in &self.sections {
            directory.extend(entry(*number, bytes.len(), bytes));
        }
        self.file_with(&header, &directory)
    }

    /// The file with another header and another directory; all checksums after them are right.
    pub fn file_with(&self, header: &[u8], directory: &[u8]) -> Vec<u8> {
        let mut file = [header, &self.chunks].concat();
        self.sections.iter().for_each(|(_, bytes)| file.extend(bytes));
        file.extend(directory);
        let mut footer = ((file.len() + FOOTER) as u64).to_le_bytes().to_vec();
        footer.extend(&Sha256::digest(&file)[..16]);
        footer.extend((directory.len() as u16).to_le_bytes());
        footer.extend([self.version.to_le_bytes(), self.flags.to_le_bytes()].concat());
        footer.extend(crc32c::crc32c(&[directory, &footer].concat()).to_le_bytes());
        footer.extend(b"ORO\x89");
        file.extend(footer);
        file
    }
}

/// A directory's entry of a section that is said to have so many bytes.
pub fn entry(number: u8, length: usize, bytes: &[u8]) -> Vec<u8> {
    [&[number], varint(length).as_slice(), &crc32c::crc32c(bytes).to_le_bytes()].concat()
}

/// Seven bits a byte, low ones first.
pub fn varint(mut number: usize) -> Vec<u8> {
    let mut bytes = vec![];
    while number >= 0x80 {
        bytes.push(number as u8 | 0x80);
        number >>= 7;
    }
    bytes.push(number as u8);
    bytes
}
