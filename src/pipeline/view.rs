//! Pictures of construction trees: rays traced, sights drawn.

use crate::construction::Tree;
use crate::construction::trace::{Camera, Counts, Seen, TraceOptions, trace};
use crate::error::Result;
use crate::plot::view::{Sight, Sun, ViewOptions, draw};
use crate::watch::Watch;

/// What is seen of the ground from the side, where the terrain ends.
const EARTH: [u8; 3] = [128, 112, 96];
/// How much of the sun such sides see.
const WALL_LIGHT: f32 = 0.4;

/// A tree to draw: the ground, or what lies upon it.
#[derive(Clone, Copy, Debug)]
pub struct Layer<'t> {
    /// The tree.
    pub tree: &'t Tree,
    /// Its colour; the tints of elevation without one.
    pub colour: Option<[u8; 3]>,
}

/// What to draw.
#[derive(Clone, Copy, Debug)]
pub struct RenderOptions {
    /// Pixels from left to right.
    pub width: usize,
    /// Pixels from top to bottom.
    pub height: usize,
    /// Rays each way through a pixel, against jagged edges; 1 for speed.
    pub samples: usize,
    /// From where.
    pub camera: Camera,
    /// Where the sun stands.
    pub sun: Sun,
    /// Whether the terrain throws shadows.
    pub shadows: bool,
    /// Elevations of the lowest and the highest tint in metres; the middle 98 % of what is seen unless given.
    pub tints_m: Option<[f32; 2]>,
    /// Distance in metres at which half of the light is haze; none without.
    pub haze_m: Option<f32>,
    /// How rays find the ground; its sun is set by the fields above.
    pub trace: TraceOptions,
}

impl RenderOptions {
    /// A picture of 1920 x 1080 pixels with shadows, one ray a pixel, no haze.
    pub fn new(camera: Camera) -> Self {
        Self {
            width: 1920,
            height: 1080,
            samples: 1,
            camera,
            sun: Sun::default(),
            shadows: true,
            tints_m: None,
            haze_m: None,
            trace: TraceOptions::default(),
        }
    }
}

/// A picture and what it took.
#[derive(Clone, Debug)]
pub struct Picture {
    /// The PNG file.
    pub png: Vec<u8>,
    /// What it took.
    pub counts: Counts,
}

/// What the camera sees of the layers, and the counts. `samples` x `samples` sights a pixel, as [`draw`] takes them.
///
/// # Errors
/// As [`render`].
pub fn sights(layers: &[Layer<'_>], options: &RenderOptions, watch: &Watch) -> Result<(Vec<Sight>, Counts)> {
    let lens = options.camera.lens(options.width, options.height)?;
    let trees: Vec<&Tree> = layers.iter().map(|layer| layer.tree).collect();
    let sun = options.shadows.then(|| options.sun.direction());
    let traced = trace(&trees, &lens, options.samples, &TraceOptions { sun, ..options.trace }, watch)?;
    let factor = options.camera.exaggeration;
    let sight = |seen: &Seen| match *seen {
        Seen::Sky(rise) => Sight::Sky(rise as f32),
        Seen::Ground { tree, elevation_m, slope, distance_m, sunlit, wall } => Sight::Ground {
            elevation_m: elevation_m as f32,
            slope: slope.map(|part| (part * factor) as f32),
            distance_m: if lens.eye().is_some() { distance_m as f32 } else { 0.0 },
            sunlit: if wall { WALL_LIGHT } else { f32::from(u8::from(sunlit)) },
            colour: layers[tree].colour.or(wall.then_some(EARTH)),
        },
    };
    Ok((traced.seen.iter().map(sight).collect(), traced.counts))
}

/// Draws the layers.
///
/// # Errors
/// A usage error for a camera, a size or options that make no picture, and for an eye below the ground; or when the
/// watch's job is cancelled.
pub fn render(layers: &[Layer<'_>], options: &RenderOptions, watch: &Watch) -> Result<Picture> {
    let (sights, counts) = sights(layers, options, watch)?;
    let view = ViewOptions { sun: options.sun, tints_m: options.tints_m, haze_m: options.haze_m };
    let png = draw(options.width, options.height, options.samples, &sights, &view)?;
    Ok(Picture { png, counts })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::construction::primitive::{Disc, FallOff};
    use crate::construction::{Builder, Detail};

    fn disc(base_m: f64, fall_off: Option<FallOff>) -> Tree {
        let mut builder = Builder::new();
        let root = builder.leaf(Disc::new([0.0, 0.0], base_m, None, fall_off).unwrap()).unwrap();
        builder.finish(root, Detail::default()).unwrap()
    }

    #[test]
    fn layers_keep_their_colours_and_sides_look_like_earth() {
        let table = disc(10.0, Some(FallOff::new(40.0, 41.0).unwrap()));
        let water = disc(4.0, None);
        let layers = [Layer { tree: &table, colour: None }, Layer { tree: &water, colour: Some([40, 90, 160]) }];
        let camera = Camera::towards([0.0, -100.0, 30.0], [0.0, 0.0, 5.0], 60.0);
        let options = RenderOptions { width: 40, height: 30, samples: 2, ..RenderOptions::new(camera) };
        let (sights, counts) = sights(&layers, &options, &Watch::default()).unwrap();
        assert_eq!((sights.len(), counts.rays), (4800, 4800));
        let has = |what: &dyn Fn(Option<[u8; 3]>, f32) -> bool| {
            sights
                .iter()
                .any(|sight| matches!(sight, Sight::Ground { colour, elevation_m, .. } if what(*colour, *elevation_m)))
        };
        assert!(has(&|colour, z| colour.is_none() && z == 10.0), "the table's top");
        assert!(has(&|colour, z| colour == Some(EARTH) && z > 4.0 && z < 10.0), "its side");
        assert!(has(&|colour, z| colour == Some([40, 90, 160]) && z == 4.0), "water");
        assert!(sights.iter().any(|sight| matches!(sight, Sight::Sky(rise) if *rise > 0.0)));
        let picture = render(&layers, &options, &Watch::default()).unwrap();
        assert_eq!(&picture.png[1..4], b"PNG");
        assert!(render(&layers, &RenderOptions { samples: 0, ..options }, &Watch::default()).is_err());
    }
}
