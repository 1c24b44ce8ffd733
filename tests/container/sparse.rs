//! Files of the sparse profile: what goes in as patches comes out as their blend.

use crate::case::{Counted, assert_same, cut, noise};
use orograph::codec::Cells;
use orograph::codec::sparse::{PatchTile, Steps, Term};
use orograph::error::ErrorKind;
use orograph::grid::SampleType;
use orograph::oro::{
    Band, Description, Dictionary, FaultPlace, Found, Place, Reader, Window, Writer, encode_patch_chunk,
};
use orograph::watch::Watch;

/// A raster of patches.
pub struct Patched {
    pub description: Description,
    pub dictionary: Dictionary,
    /// Mean and terms at each place of the whole raster, row by row.
    patches: Vec<Option<(i32, Vec<Term>)>>,
    voids: Vec<bool>,
}

impl Patched {
    pub fn new(
        (width, height): (usize, usize),
        (side, step): (usize, usize),
        (atoms, sparsity): (usize, usize),
        nodata: Option<f32>,
    ) -> Self {
        let mut band = Band::new(SampleType::F32);
        band.rule.nodata = nodata.map(|nodata| u64::from(nodata.to_bits()));
        let description = Description { tile_side: 64, ..Description::new(width, height, vec![band]) };
        let mut random = noise(7 + width as u64);
        let mut below = |limit: u64| (random.next().expect("endless") >> 20) % limit;
        let values = (0..atoms * side * side).map(|_| below(255) as i32 - 127).collect();
        let steps = Steps { mean: 0.25, part: 0.5, atom: 1.0 / 512.0 };
        let found = Found { least: 200.0, greatest: 900.0, rmse: 3.5 };
        let dictionary = Dictionary { side, step, sparsity, steps, atoms: values, found };
        let lattice = dictionary.lattice(&description);
        let patches = (0..lattice.across * lattice.down)
            .map(|place| {
                let count = below(sparsity as u64 + 1);
                let mut terms: Vec<Term> = vec![];
                while (terms.len() as u64) < count {
                    let atom = below(atoms as u64) as u32;
                    let part = below(200) as i32 - 100;
                    if part != 0 && terms.iter().all(|term| term.atom != atom) {
                        terms.push(Term { atom, part });
                    }
                }
                (nodata.is_none() || place % 17 > 0).then_some((2000 + below(500) as i32, terms))
            })
            .collect();
        let mut patched = Self { description, dictionary, patches, voids: vec![false; width * height] };
        // A lake without data, and every cell that no patch reaches.
        if nodata.is_some() {
            let sums = patched.sums();
            for (cell, void) in patched.voids.iter_mut().enumerate() {
                let (row, col) = (cell / width, cell % width);
                *void = sums[cell].1 == 0.0 || (10..20).contains(&row) && (5..70).contains(&col);
            }
        }
        patched
    }

    /// The file.
    pub fn write(&self) -> Vec<u8> {
        let Self { description, dictionary, .. } = self;
        let mut writer = Writer::sparse(vec![], description.clone(), dictionary.clone()).expect("fits");
        let (tiling, lattice) = (description.tiling(), dictionary.lattice(description));
        for chunk in 0..description.chunks() {
            let place = tiling.place(chunk, 1);
            let shape = tiling.shape(place.col, place.row);
            let (left, top) = (place.col * 64, place.row * 64);
            let (cols, rows) =
                (lattice.stored_with(left..left + shape.width), lattice.stored_with(top..top + shape.height));
            let mut tile = PatchTile::new(cols.len(), rows.len());
            for row in rows {
                for col in cols.clone() {
                    let patch = self.patches[row * lattice.across + col].as_ref();
                    tile.push(patch.map(|(mean, terms)| (*mean, terms.as_slice())));
                }
            }
            let voids = (0..shape.cells())
                .map(|cell| (top + cell / shape.width) * description.width + left + cell % shape.width)
                .map(|cell| self.voids[cell]);
            tile.voids = voids.collect();
            if !tile.voids.contains(&true) {
                tile.voids.clear();
            }
            writer.push(&encode_patch_chunk(description, dictionary, place, &tile).expect("fits")).expect("is written");
        }
        writer.finish().expect("is written").0
    }

    /// For each cell the sum of weighted heights and of weights, patch by patch, as the paper writes it.
    fn sums(&self) -> Vec<(f64, f64)> {
        let Dictionary { side, step, steps, atoms, .. } = &self.dictionary;
        let Description { width, height, .. } = self.description;
        let lattice = self.dictionary.lattice(&self.description);
        let radius = *side as f64 / 2.0;
        let mut sums = vec![(0.0, 0.0); width * height];
        for (place, patch) in self.patches.iter().enumerate() {
            let Some((mean, terms)) = patch else { continue };
            // The order in which terms are added: greater coefficients first.
            let mut terms = terms.clone();
            terms.sort_by_key(|term| (-term.part.abs(), term.atom));
            for k in 0..side * side {
                let y = lattice.top + (place / lattice.across * step + k / side) as i64;
                let x = lattice.left + (place % lattice.across * step + k % side) as i64;
                let (dx, dy) = ((k % side) as f64 + 0.5 - radius, (k / side) as f64 + 0.5 - radius);
                let left = 1.0 - (dx * dx + dy * dy) / (radius * radius);
                if left <= 0.0 || !(0..height as i64).contains(&y) || !(0..width as i64).contains(&x) {
                    continue;
                }
                let mut height = f64::from(*mean) * steps.mean;
                for term in terms.iter() {
                    let value = atoms[term.atom as usize * side * side + k];
                    height += f64::from(term.part) * steps.part * (f64::from(value) * steps.atom);
                }
                let sum = &mut sums[y as usize * width + x as usize];
                sum.0 += left * left * left * height;
                sum.1 += left * left * left;
            }
        }
        sums
    }

    fn cells(&self) -> Cells {
        let nodata = self.description.bands[0].rule.nodata.map_or(f32::NAN, |bits| f32::from_bits(bits as u32));
        let cells = self.sums().into_iter().zip(&self.voids);
        Cells::F32(cells.map(|((sum, weight), &void)| if void { nodata } else { (sum / weight) as f32 }).collect())
    }
}

fn cases() -> Vec<Patched> {
    vec![
        Patched::new((200, 130), (8, 4), (5, 3), None),
        Patched::new((200, 130), (8, 4), (5, 3), Some(-9999.0)),
        Patched::new((70, 3), (5, 3), (1, 1), Some(f32::NAN)),
        Patched::new((1, 1), (8, 4), (3, 0), None),
        // A place's tile is not that of its cells; tiles without places.
        Patched::new((300, 260), (40, 27), (4, 4), None),
        Patched::new((300, 140), (210, 148), (3, 2), None),
    ]
}

#[test]
fn windows_and_levels_are_those_of_the_sum_of_patches() {
    for (number, case) in cases().iter().enumerate() {
        let expected = case.cells();
        let file = case.write();
        let reader = Reader::open(file.as_slice()).expect("opens");
        assert_eq!(reader.dictionary(), Some(&case.dictionary));
        let Description { width, height, .. } = case.description;
        let window = |col, row, width, height| Window { col, row, width, height };
        let all = reader.window(0, 0, window(0, 0, width, height)).expect("is read");
        assert_same(&all, &expected, &format!("case {number}"));
        for level in 0..=case.description.last_level() {
            let (across, down) = case.description.level_size(level);
            let all = reader.window(0, level, window(0, 0, across, down)).expect("is read");
            assert_same(&all, &expected.decimated(width, level), &format!("case {number}, level {level}"));
        }
        let (col, row) = (width / 3, height / 2);
        let (across, down) = ((width - col).min(90), (height - row).min(40));
        let part = reader.window(0, 0, window(col, row, across, down)).expect("is read");
        assert_same(&part, &cut(&expected, width, col, row, across, down), &format!("case {number}, a window"));
        let last = Place { col: (width - 1) / 64, row: (height - 1) / 64, band: 0 };
        let (col, row) = (last.col * 64, last.row * 64);
        let tile = reader.tile(last, 0).expect("is read");
        assert_same(&tile, &cut(&expected, width, col, row, width - col, height - row), "the last tile");
        assert!(reader.check(&Watch::default()).expect("is read").is_sound());
    }
}

#[test]
fn cells_are_never_blended_onto_the_nodata_value() {
    let mut case = Patched::new((9, 9), (8, 4), (1, 0), Some(500.0));
    case.patches.iter_mut().for_each(|patch| *patch = Some((2000, vec![])));
    case.voids.fill(false);
    let file = case.write();
    let reader = Reader::open(file.as_slice()).expect("opens");
    let cells = reader.window(0, 0, Window { col: 0, row: 0, width: 9, height: 9 }).expect("is read");
    assert_same(&cells, &Cells::F32(vec![f32::from_bits(500.0_f32.to_bits() ^ 1); 81]), "all cells");
}

#[test]
fn damaged_tiles_leave_what_they_do_not_reach() {
    let case = Patched::new((200, 130), (8, 4), (5, 3), Some(-9999.0));
    let (mut file, expected) = (case.write(), case.cells());
    let reader = Reader::open(file.as_slice()).expect("opens");
    let bad = Place { col: 1, row: 1, band: 0 };
    let bytes = reader.chunk(bad, 0).expect("is read").bytes;
    let at = file.windows(bytes.len()).position(|found| found == bytes).expect("stands in the file");
    file[at + bytes.len() / 2] ^= 4;
    let reader = Reader::open(file.as_slice()).expect("opens");
    let all = Window { col: 0, row: 0, width: 200, height: 130 };
    assert_eq!(reader.window(0, 0, all).expect_err("is damaged").kind(), ErrorKind::Corrupt);
    let mut damage = 0;
    let saved = reader.window_or(0, 0, all, &mut |_| {
        damage += 1;
        Ok(())
    });
    assert_eq!(damage, 1);
    let (Cells::F32(saved), Cells::F32(expected)) = (saved.expect("is read"), expected) else { panic!("floats") };
    for (cell, (saved, expected)) in saved.iter().zip(&expected).enumerate() {
        let (row, col) = (cell / 200, cell % 200);
        let reached = (64 - 8..128 + 8).contains(&col) && (64 - 8..130).contains(&row);
        let inside = (64..128).contains(&col) && (64..128).contains(&row);
        let is_void = *saved == -9999.0;
        assert!(saved.to_bits() == expected.to_bits() || reached && is_void, "cell {row}, {col}");
        assert!(!inside || is_void, "cell {row}, {col} is not known");
    }
    let report = reader.check(&Watch::default()).expect("is read");
    assert!(matches!(report.faults[0].place, FaultPlace::Tile(place, Some(_)) if place == bad));
}

#[test]
fn windows_that_share_a_shelf_are_the_same_and_read_less() {
    let case = Patched::new((200, 330), (8, 4), (5, 3), Some(-9999.0));
    let file = case.write();
    let windows: Vec<Window> = (0..330_usize.div_ceil(64) * 4)
        .map(|i| (i / 4 * 64, i % 4 * 64))
        .map(|(row, col)| Window { col, row, width: (200 - col).min(64), height: (330 - row).min(64) })
        .collect();
    let counted = Counted::new(file);
    let reader = Reader::open(&counted).expect("opens");
    let read = || counted.take().iter().map(|(_, length)| length).sum::<usize>();
    let _ = read();
    let shelf = reader.shelf(0, 0, &windows);
    for &window in &windows {
        let cells = reader.window_with(&shelf, 0, 0, window, &mut Err).expect("is read");
        let expected = cut(&case.cells(), 200, window.col, window.row, window.width, window.height);
        assert_same(&cells, &expected, "a window of several");
    }
    let shared = read();
    for &window in &windows {
        reader.window(0, 0, window).expect("is read");
    }
    let apart = read();
    assert!(2 * shared < apart, "{shared} bytes shared, {apart} one by one");
    // What nobody else needs is not kept.
    assert!(format!("{shelf:?}").len() < 200, "{shelf:?}");
}

#[test]
fn every_bit_and_every_length_matters() {
    let case = Patched::new((70, 3), (5, 3), (2, 2), Some(-1.0));
    let file = case.write();
    for length in 0..file.len() {
        assert!(Reader::open(&file[..length]).is_err());
    }
    for bit in 0..file.len() * 8 {
        let mut damaged = file.clone();
        damaged[bit / 8] ^= 1 << (bit % 8);
        if let Ok(reader) = Reader::open(damaged.as_slice()) {
            assert!(!reader.check(&Watch::default()).expect("is read").is_sound(), "bit {bit}");
            let _ = reader.window(0, 0, Window { col: 0, row: 0, width: 70, height: 3 });
        }
    }
}

#[test]
fn what_does_not_fit_is_refused() {
    let case = Patched::new((70, 3), (5, 3), (2, 2), None);
    let Patched { description, dictionary, .. } = &case;
    let refuses = |description: &Description, dictionary: &Dictionary| {
        Writer::sparse(vec![], description.clone(), dictionary.clone()).expect_err("is refused").kind()
            == ErrorKind::Usage
    };
    let integers = Description { bands: vec![Band::new(SampleType::I16)], ..description.clone() };
    assert!(refuses(&integers, dictionary));
    let two =
        Description { bands: vec![Band::new(SampleType::F32), Band::new(SampleType::F32)], ..description.clone() };
    assert!(refuses(&two, dictionary));
    assert!(refuses(description, &Dictionary { step: 4, ..dictionary.clone() }), "gaps");
    assert!(refuses(description, &Dictionary { atoms: vec![], ..dictionary.clone() }));
    assert!(refuses(description, &Dictionary { atoms: vec![1; 26], ..dictionary.clone() }));
    let steps = Steps { mean: f64::NAN, ..dictionary.steps };
    assert!(refuses(description, &Dictionary { steps, ..dictionary.clone() }));
    let place = Place { col: 0, row: 0, band: 0 };
    assert!(encode_patch_chunk(description, dictionary, place, &PatchTile::new(1, 1)).is_err(), "other places");
    let place = Place { col: 9, row: 0, band: 0 };
    assert!(encode_patch_chunk(description, dictionary, place, &PatchTile::new(0, 0)).is_err(), "no such tile");
}
