//! Sections that a reader does not know, versions that it does not know.

use crate::case::{Case, assert_same};
use crate::parts::Parts;
use orograph::error::ErrorKind;
use orograph::grid::SampleType;
use orograph::oro::{Reader, Window};
use orograph::watch::Watch;
fn case() -> Case {
    Case::new(100, 70, 64, &[SampleType::I16])
}

fn kind_of(file: Vec<u8>) -> ErrorKind {
    Reader::open(file).expect_err("is refused").kind()
}

#[test]
fn the_parts_make_the_same_file() {
    for case in [case(), Case::talkative(), Case::new(64 * 5, 64 * 5, 64, &[SampleType::U8])] {
        let file = case.write().0;
        assert!(Parts::of(&file).file() == file, "what is written is what the specification says");
    }
}

#[test]
fn an_unknown_section_is_skipped() {
    let case = case();
    for place in 0..=2 {
        // 5 is reserved, 100 is anybody's.
        for number in [5, 100] {
            let mut parts = Parts::of(&case.write().0);
            parts.sections.insert(place, (number, b"not for old readers".to_vec()));
            let reader = Reader::open(parts.file()).expect("opens");
            let window = Window { col: 0, row: 0, width: 100, height: 70 };
            assert_same(&reader.window(0, 0, window).expect("is read"), &case.bands[0], "the cells");
            assert!(reader.check(&Watch::default()).expect("is read").is_sound());
            assert_eq!(reader.sections().len(), 3);
        }
    }
}

#[test]
fn a_section_that_must_be_understood_is_refused() {
    for number in [5, 100] {
        let mut parts = Parts::of(&case().write().0);
        parts.sections.insert(0, (number | 0x80, b"new".to_vec()));
        assert_eq!(kind_of(parts.file()), ErrorKind::Unsupported);
    }
}

#[test]
fn other_versions_are_refused() {
    let parts = Parts::of(&case().write().0);
    assert_eq!(kind_of(Parts { version: 2, ..parts.clone() }.file()), ErrorKind::Unsupported);
    assert_eq!(kind_of(Parts { flags: 1, ..parts.clone() }.file()), ErrorKind::Unsupported);
    assert_eq!(kind_of(Parts { version: 0, ..parts }.file()), ErrorKind::Corrupt);
}

#[test]
fn missing_and_repeated_sections_are_refused() {
    let parts = Parts::of(&case().write().0);
    for number in 0..2 {
        let mut without = parts.clone();
        without.sections.remove(number);
        assert_eq!(kind_of(without.file()), ErrorKind::Corrupt);
        let mut twice = parts.clone();
        twice.sections.push(parts.sections[number].clone());
        assert_eq!(kind_of(twice.file()), ErrorKind::Corrupt);
    }
}

/// Sections whose checksums are right and whose content is not: a reader believes nothing.
#[test]
fn sections_of_any_content_do_no_harm() {
    let case = Case::talkative();
    let parts = Parts::of(&case.write().0);
    for section in 0..2 {
        let length = parts.sections[section].1.len();
        for byte in 0..length {
            for bit in 0..8 {
                let mut other = parts.clone();
                other.sections[section].1[byte] ^= 1 << bit;
                read_all(other.file());
            }
            let mut short = parts.clone();
            short.sections[section].1.truncate(byte);
            assert_eq!(kind_of(short.file()), ErrorKind::Corrupt, "section {section} cut to {byte} bytes");
            let mut long = parts.clone();
            long.sections[section].1.insert(byte, 0xff);
            read_all(long.file());
        }
    }
}

/// Neither panics nor takes long, whatever it finds.
fn read_all(file: Vec<u8>) {
    let Ok(reader) = Reader::open(file) else { return };
    let description = reader.description().clone();
    for chunk in 0..description.chunks() {
        let place = description.tiling().place(chunk, description.bands.len());
        let _ = reader.tile(place, 0);
    }
    let _ = reader.check(&Watch::default());
}
