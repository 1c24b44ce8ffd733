//! Writes inputs from which the fuzzers begin: `seeds FOLDER` makes `FOLDER/TARGET/NUMBER`.

use orograph::codec::{BandRule, Bound, TileShape, encode_tile};
use orograph::oro::{Band, Description, MetadataItem, Writer, encode_chunk};
use orograph_fuzz::ground::{GROUNDS, Ground, SAMPLES, bits, with_voids};
use orograph_fuzz::input::{TileInput, write_rule};
use std::error::Error;
use std::path::PathBuf;

type Result<T> = std::result::Result<T, Box<dyn Error>>;
type Inputs = Vec<Vec<u8>>;

fn rules(ground: Ground) -> impl Iterator<Item = BandRule> {
    SAMPLES.into_iter().enumerate().map(move |(number, sample)| BandRule {
        sample,
        nodata: [None, Some(0), Some(7)][(number + ground as usize) % 3],
        bound: [Bound::Lossless, Bound::MaxError(1.0), Bound::MaxError(0.3), Bound::MaxError(20.0)]
            [(number / 2 + ground as usize) % 4],
    })
}

const SHAPES: [TileShape; 4] = [
    TileShape { width: 5, height: 3 },
    TileShape { width: 20, height: 17 },
    TileShape { width: 1, height: 40 },
    TileShape { width: 70, height: 66 },
];

fn tiles() -> Result<(Inputs, Inputs)> {
    let (mut encoded, mut cells_of) = (vec![], vec![]);
    for ground in GROUNDS {
        for (number, rule) in rules(ground).enumerate() {
            let shape = SHAPES[(number + ground as usize) % 4];
            let mut cells = ground.cells(rule.sample, shape, number as u64);
            if let Some(nodata) = rule.nodata {
                cells = with_voids(&cells, nodata, |index| index % 7 < number % 5 && index > number * 5);
            }
            let segments = encode_tile(&cells, shape, &rule)?.segments;
            encoded.push(TileInput { rule, shape, level: number as u8 % 4, segments }.write());
            let mut input = write_rule(&rule, shape, number as u8 & 7);
            input.extend(cells.to_le_bytes().iter().take(2000));
            cells_of.push(input);
        }
    }
    Ok((encoded, cells_of))
}

fn container(width: usize, height: usize, rules: &[BandRule], ground: Ground) -> Result<Vec<u8>> {
    let bands = rules.iter().map(|&rule| Band { rule, unit: "m".into(), ..Band::new(rule.sample) }).collect();
    let mut description = Description { tile_side: 64, ..Description::new(width, height, bands) };
    description.georeference.crs = Some("LOCAL_CS[\"a\"]".into());
    description.metadata.push(MetadataItem { key: "AREA".into(), ..MetadataItem::default() });
    let mut writer = Writer::new(vec![], description.clone())?;
    for chunk in 0..description.chunks() {
        let place = description.tiling().place(chunk, rules.len());
        let shape = description.tiling().shape(place.col, place.row);
        let cells = ground.cells(rules[place.band].sample, shape, chunk);
        let void = rules[place.band].nodata.unwrap_or(bits(&cells, 0));
        let cells = with_voids(&cells, void, |index| index % 40 < chunk as usize % 5);
        writer.push(&encode_chunk(&description, place, &cells)?)?;
    }
    Ok(writer.finish()?.0)
}

fn containers() -> Result<Inputs> {
    let mut files = vec![];
    for (number, ground) in GROUNDS.into_iter().enumerate() {
        let rules: Vec<_> = rules(ground).skip(number % 7).take(1 + number % 2).collect();
        files.push(container(9 + number, 7, &rules, ground)?);
        // Small tiles, so many that there is an overview.
        files.push(container(64 * 17 + number, 1 + number % 2, &rules[..1], ground)?);
    }
    // What conformance vectors show: zones, copies, patches, dictionaries, and everything that must be refused.
    for kind in ["accept", "reject"] {
        let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../format-spec/vectors").join(kind);
        let mut paths = std::fs::read_dir(folder)?.map(|entry| Ok(entry?.path())).collect::<Result<Vec<_>>>()?;
        paths.retain(|path| path.extension().is_some_and(|extension| extension == "oro"));
        paths.sort();
        for path in paths {
            files.push(std::fs::read(path)?);
        }
    }
    Ok(files)
}

fn main() -> Result<()> {
    let folder = PathBuf::from(std::env::args().nth(1).ok_or("which folder?")?);
    let (encoded, cells) = tiles()?;
    for (target, inputs) in [("decode_tile", encoded), ("round_trip", cells), ("open_container", containers()?)] {
        std::fs::create_dir_all(folder.join(target))?;
        for (number, input) in inputs.iter().enumerate() {
            std::fs::write(folder.join(target).join(format!("seed-{number:03}")), input)?;
        }
    }
    Ok(())
}
