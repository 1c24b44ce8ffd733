//! Any bytes as the segments of a tile: decoded or refused.
#![no_main]

use libfuzzer_sys::fuzz_target;
use orograph::codec::decode_tile;
use orograph_fuzz::input::TileInput;

fuzz_target!(|bytes: &[u8]| {
    let TileInput { rule, shape, level, segments } = TileInput::read(bytes);
    let segments = segments.each_ref().map(Vec::as_slice);
    if let Ok(cells) = decode_tile(&segments, shape, &rule, level) {
        assert_eq!((cells.sample(), cells.len()), (rule.sample, shape.at_level(level).cells()));
        // What the cells decode to, their levels decode to.
        if level == 0 {
            let coarse = decode_tile(&segments[..2], shape, &rule, 2).expect("a part of what is sound");
            let expected = cells.decimated(shape.width, 2);
            assert!(coarse.to_le_bytes() == expected.to_le_bytes(), "level 2 is not the cells decimated");
        }
    }
});
