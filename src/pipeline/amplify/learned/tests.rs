//! The file: its header, its fixtures, and what is damaged.

use super::super::cell_size::CellSize;
use super::super::exemplar::Record;
use super::super::method::Method;
use super::super::mode::Mode;
use super::file::sealed;
use super::{Learned, Said};
use crate::amplify::keep::tests::{hills, plain};
use crate::amplify::{Paper, PatchModel};
use crate::error::ErrorKind;
use crate::rng::Rng;
use crate::watch::Watch;
use std::path::{Path, PathBuf};

const ROOM: u64 = 1 << 28;
const HEADER: usize = 20;

fn exemplars() -> Vec<Record> {
    let cell = CellSize { across_m: 9.5, down_m: 10.0 };
    vec![
        Record { name: "Écrins.tif".into(), size: [400, 300], cell, slope: Some(0.5) },
        Record { name: "sea.tif".into(), size: [7, 8], cell: cell.times(3.0), slope: None },
    ]
}

/// One file of each mode.
fn all() -> Vec<(&'static str, Learned)> {
    let model = PatchModel { side: 3, atoms: Some(9), seed: 4, ..PatchModel::default() };
    let paper = Paper::learn(vec![hills(24, 25, Some(3))], 4, &model, &Watch::default()).unwrap();
    [
        ("accurate", Mode::Accurate, Method::Cascade(plain(2, false))),
        ("realistic", Mode::Realistic, Method::Cascade(plain(2, true))),
        ("paper", Mode::Paper, Method::Paper(paper)),
    ]
    .into_iter()
    .map(|(name, mode, method)| {
        let cell = CellSize { across_m: 10.0, down_m: 10.0 };
        let seed = if mode == Mode::Realistic { 0 } else { 4 };
        (name, Learned { mode, cell, seed, exemplars: exemplars(), method })
    })
    .collect()
}

fn decoded(bytes: &[u8]) -> crate::error::Result<Learned> {
    Learned::decoded(bytes, ROOM, &Watch::default())
}

fn fixture(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("fixtures/learned/{name}.learned"))
}

/// Two are the same where they say the same and make the same.
fn assert_same(found: &Learned, known: &Learned) {
    assert_eq!((found.mode, found.cell, found.seed), (known.mode, known.cell, known.seed));
    assert_eq!(found.exemplars, known.exemplars);
    assert_eq!(found.method.model(), known.method.model());
    assert_eq!((found.method.factors(), found.method.atoms()), (known.method.factors(), known.method.atoms()));
    let fine = |learned: &Learned| {
        let side = 2 * learned.method.reach() + 4;
        let plane = hills(side, side, None);
        let fine = learned.method.amplified(plane, vec![true; side * side], [0, 0], 8);
        fine.heights_m().iter().map(|height| height.to_bits()).collect::<Vec<_>>()
    };
    assert_eq!(fine(found), fine(known));
}

#[test]
fn files_come_back() {
    for (_, learned) in all() {
        assert_same(&decoded(&learned.encoded().unwrap()).unwrap(), &learned);
    }
}

/// What was written once is read for ever. `cargo test --lib learned_fixtures -- --ignored` writes those that are not
/// there.
#[test]
fn fixtures_are_read() {
    for (name, learned) in all() {
        let (found, bytes) = Learned::read(&fixture(name), None, &Watch::default()).unwrap();
        assert_same(&found, &learned);
        assert!(bytes < 20_000, "{name}: {bytes} bytes");
    }
}

#[test]
#[ignore = "writes to the fixtures"]
fn write_learned_fixtures() {
    for (name, learned) in all() {
        if !fixture(name).exists() {
            std::fs::write(fixture(name), learned.encoded().unwrap()).unwrap();
        }
    }
}

#[test]
fn no_damage_goes_unseen() {
    for (_, learned) in all() {
        let bytes = learned.encoded().unwrap();
        let step = bytes.len() / 100 + 1;
        for at in (0..HEADER + 90).chain((HEADER..bytes.len()).step_by(step)) {
            let mut other = bytes.clone();
            other[at] ^= 1 << (at % 8);
            assert!(decoded(&other).is_err(), "byte {at}");
            let error = decoded(&bytes[..at]).unwrap_err();
            assert!(at < 4 || error.message().contains("was cut off"), "{at} bytes: {error}");
        }
        let error = decoded(&[&bytes[..], &[0]].concat()).unwrap_err();
        assert!(error.kind() == ErrorKind::Corrupt && error.message().contains("its header says"), "{error}");
    }
}

/// A checksum can be forged.
#[test]
fn any_numbers_are_checked() {
    let mut rng = Rng::new(5);
    for (_, learned) in all() {
        let body = learned.encoded().unwrap()[HEADER..].to_vec();
        // Large tables take a while.
        for _ in 0..if body.len() > 10_000 { 25 } else { 250 } {
            let mut other = body.clone();
            for _ in 0..1 + rng.below(2) {
                let at = rng.below(110.min(other.len() as u64)) as usize;
                other[at] = [0, 255, other[at] ^ (1 << rng.below(8))][rng.below(3) as usize];
            }
            if let Err(error) = decoded(&sealed(&other)) {
                assert!(matches!(error.kind(), ErrorKind::Corrupt | ErrorKind::Unsupported), "{error}");
            }
        }
        for length in (0..body.len().min(150)).step_by(if body.len() > 10_000 { 7 } else { 1 }) {
            assert!(decoded(&sealed(&body[..length])).is_err(), "{length} bytes");
        }
        assert!(decoded(&sealed(&[&body[..], &[0]].concat())).is_err());
        // Each number at the head that cannot be: mode, kind, factor, a cell.
        for (at, bytes, words) in [
            (0, vec![9], "mode 9, which this program does not know"),
            (1, vec![9], "kind of what was learned 9"),
            (2, vec![1, 0], "factor 1"),
            (2, vec![11, 1], "factor 267"),
            (12, f64::NAN.to_le_bytes().to_vec(), "the cells is NaN"),
            (20, (-1.0f64).to_le_bytes().to_vec(), "the cells is -1"),
        ] {
            let mut other = body.clone();
            other[at..at + bytes.len()].copy_from_slice(&bytes);
            let error = decoded(&sealed(&other)).unwrap_err();
            assert!(error.message().contains(words), "{error}");
        }
        let mut other = body.clone();
        other[0] = other[0] % 3 + 1;
        assert!(decoded(&sealed(&other)).unwrap_err().message().contains("of another kind than mode"));
    }
}

#[test]
fn other_files_are_told() {
    let words = |bytes: &[u8]| decoded(bytes).unwrap_err().message().to_string();
    assert!(words(b"").contains("begin otherwise"));
    assert!(words(b"II*\0anything at all").contains("begin otherwise"));
    assert!(words(&[&crate::oro::MAGIC[..], &[0; 40]].concat()).contains("an .oro container"));
    let mut newer = all()[0].1.encoded().unwrap();
    newer[4] = 2;
    assert!(words(&newer).contains("version 2 of the format"), "{}", words(&newer));
}

#[test]
fn what_is_said_beside_it_has_to_agree() {
    let path = Path::new("folder/x.learned");
    let said = |option, value: &str| Said { option, value: (!value.is_empty()).then(|| value.to_string()) };
    let all = all();
    let agree =
        |number: usize, said: Said| all[number].1.agree(path, &[said]).map_err(|error| error.message().to_string());
    for (number, option, value, wrong) in [
        (0, "--mode", "accurate", ""),
        (0, "--mode", "paper", "--mode paper: x.learned was learned with --mode accurate"),
        (0, "--factor", "2", ""),
        (0, "--factor", "4", "--factor 4: x.learned was learned with --factor 2"),
        (0, "--seed", "4", ""),
        (0, "--seed", "1", "--seed 1: x.learned was learned with --seed 4"),
        (1, "--seed", "1", ""),
        (1, "--patch", "3", "--patch 3: x.learned was learned with --mode realistic, and it is for --mode paper only"),
        (2, "--patch", "3", ""),
        (2, "--patch", "8", "--patch 8: x.learned was learned with --patch 3"),
        (2, "--atoms", "9", ""),
        (2, "--patches", "9", "--patches 9: x.learned was learned without --patches"),
        (2, "--unsigned", "", "--unsigned: x.learned was learned without --unsigned"),
        (2, "--by", "4", ""),
        (2, "--by", "2", "--by 2: x.learned was learned with --by 4"),
        (2, "--sparsity", "1", ""),
        (2, "--step", "1", ""),
    ] {
        let found = agree(number, said(option, value));
        match wrong {
            "" => assert_eq!(found, Ok(())),
            wrong => assert!(found.clone().unwrap_err().starts_with(wrong), "{found:?}"),
        }
    }
}

#[test]
fn other_cells_and_slopes_are_told() {
    let learned = &all()[0].1;
    let path = Path::new("folder/x.learned");
    let cell = |across_m: f64, down_m: f64| CellSize { across_m, down_m };
    assert_eq!(learned.remarks(path, cell(10.5, 9.6), Some(0.4)), Vec::<String>::new());
    let far = learned.remarks(path, cell(12.0, 12.0), None);
    assert!(far[0].starts_with("x.learned was learned for cells of 10.00 m, and those that are made are of 12.00 m"));
    assert!(far[0].ends_with("--cell 12m"), "{far:?}");
    let long = learned.remarks(path, cell(7.25, 10.0), None);
    assert!(long[0].contains("10.00 m, as wide as high, and") && long[0].ends_with("--cell 7.25m,10m"), "{long:?}");
    let steep = learned.remarks(path, cell(10.0, 10.0), Some(2.0));
    assert!(steep[0].starts_with("x.learned, exemplar Écrins.tif: its terrain is of another kind"), "{steep:?}");
    assert_eq!(steep.len(), 1, "the other has no slope");
}
