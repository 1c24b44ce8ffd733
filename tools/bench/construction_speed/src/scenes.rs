//! Scenes with the numbers of primitives and operators, the sides and the kinds of features of table 1 of Génevaux et
//! al. 2015. The paper says nothing of radii, overlap and octaves; what is assumed stands at each function.

use orograph::construction::primitive::{
    Curve, Disc, FallOff, Image, Interpolation, Mapping, Profile, Samples, Skeleton,
};
use orograph::construction::{Affine, Area, Builder, Detail, NodeId, Tree, WeightRule};
use orograph::error::Result;
use orograph::grid::HeightRows;
use orograph::noise::{NoiseKind, NoiseSum, Spectrum};
use orograph::rng::Rng;

/// Share of the square's side over which the weight of a road or river falls, on either side. Assumed.
const VERGE: f64 = 1.0 / 80.0;

/// A row of the table.
pub struct Row {
    /// Which figure of the paper.
    pub figure: &'static str,
    /// Side of the square in metres.
    pub side_m: f64,
    /// Evaluations for the regular mesh.
    pub points: f64,
    /// Octaves of the noise of large discs: few (as a scene that is looked at as a whole), or as many as the mesh can
    /// show.
    pub octaves: [usize; 2],
    /// What the paper says: milliseconds on its graphics card, and kB.
    pub paper: (u32, u32),
    /// What the project promised, in milliseconds.
    pub goal_ms: u32,
    build: fn(&mut Scene) -> Result<NodeId>,
}

/// The rows that are timed.
pub const ROWS: [Row; 4] = [
    Row { figure: "1", side_m: 2e3, points: 5e6, octaves: [4, 6], paper: (14, 10), goal_ms: 60, build: valley },
    Row { figure: "20", side_m: 2e3, points: 20e6, octaves: [4, 7], paper: (80, 12), goal_ms: 250, build: coast },
    Row { figure: "19", side_m: 2e5, points: 20e6, octaves: [6, 8], paper: (25, 81), goal_ms: 250, build: range },
    Row { figure: "22", side_m: 6e2, points: 80e6, octaves: [3, 6], paper: (560, 19), goal_ms: 1200, build: road },
];

/// A disc of noise as the count of octaves needs it.
struct Known {
    centre: [f64; 2],
    radius_m: f64,
    octaves: usize,
}

/// A scene in the making.
struct Scene {
    builder: Builder,
    rng: Rng,
    side_m: f64,
    octaves: usize,
    known: Vec<Known>,
}

/// A tree, and where its noise lies.
pub struct Built {
    /// The scene.
    pub tree: Tree,
    known: Vec<Known>,
}

impl Built {
    /// Octaves of noise in reach of a point.
    pub fn octaves_at(&self, [x, y]: [f64; 2]) -> usize {
        let inside = |disc: &&Known| {
            let (dx, dy) = (x - disc.centre[0], y - disc.centre[1]);
            dx * dx + dy * dy < disc.radius_m * disc.radius_m
        };
        self.known.iter().filter(inside).map(|disc| disc.octaves).sum()
    }
}

impl Row {
    /// The scene; `fine` takes the greater number of octaves.
    pub fn scene(&self, fine: bool) -> Result<Built> {
        let octaves = self.octaves[usize::from(fine)];
        let mut scene =
            Scene { builder: Builder::new(), rng: Rng::new(1), side_m: self.side_m, octaves, known: vec![] };
        let root = (self.build)(&mut scene)?;
        Ok(Built { tree: scene.builder.finish(root, Detail::default())?, known: scene.known })
    }
}

impl Scene {
    /// A disc of noise, of the three kinds in turn.
    fn disc(&mut self, i: usize, centre: [f64; 2], radius_m: f64, octaves: usize) -> Result<NodeId> {
        let kind = match i % 3 {
            0 => NoiseKind::Fractal,
            1 => NoiseKind::Turbulence,
            _ => NoiseKind::Ridged { offset: 1.0, gain: 2.0 },
        };
        let spectrum = Spectrum {
            octaves,
            amplitude: radius_m / 12.0,
            wavelength: radius_m / 1.5,
            persistence: 0.5,
            lacunarity: 2.0,
            seed: self.rng.next_u64(),
        };
        self.known.push(Known { centre, radius_m, octaves });
        let noise = Some(NoiseSum::new(kind, spectrum.terms()));
        self.builder.leaf(Disc::new(centre, 0.0, noise, Some(FallOff::new(0.0, radius_m)?))?)
    }

    /// Discs of noise on a jittered grid over the square. Assumed: a radius of 1.5 times their distance, so that about
    /// seven overlap at a point (fewer would leave holes), and a first wavelength of once the distance.
    fn hills(&mut self, count: usize) -> Result<Vec<NodeId>> {
        let across = (count as f64).sqrt().ceil();
        let step = self.side_m / across;
        (0..count)
            .map(|i| {
                let (row, col) = ((i as f64 / across).floor(), i as f64 % across);
                let centre = [(col + self.rng.unit()) * step, (row + self.rng.unit()) * step];
                self.disc(i, centre, 1.5 * step, self.octaves)
            })
            .collect()
    }

    /// Small discs anywhere: rocks, mounds, craters; a twentieth of the side in radius, two octaves.
    fn mounds(&mut self, count: usize) -> Result<Vec<NodeId>> {
        (0..count)
            .map(|i| {
                let centre = [self.rng.unit() * self.side_m, self.rng.unit() * self.side_m];
                self.disc(i, centre, self.side_m / 20.0, 2)
            })
            .collect()
    }

    /// A level disc: the water of a lake.
    fn level(&mut self, centre: [f64; 2], radius_m: f64) -> Result<NodeId> {
        let fall_off = FallOff::new(radius_m / 2.0, radius_m)?;
        self.builder.leaf(Disc::new(centre, 0.0, None, Some(fall_off))?)
    }

    /// A winding road or river through the square from west to east, of two parabolas an interval, on a bed of
    /// `width_m`.
    fn curve(&mut self, intervals: usize, width_m: f64) -> Result<NodeId> {
        let points: Vec<[f64; 3]> = (0..=intervals)
            .map(|i| {
                let along = i as f64 / intervals as f64;
                [along * self.side_m, self.side_m * (0.4 + 0.2 * self.rng.unit()), 0.0]
            })
            .collect();
        let fall_off = FallOff::new(width_m / 2.0, width_m / 2.0 + self.side_m * VERGE)?;
        let profile = Profile::new(&[(0.0, 0.0)])?;
        self.builder.leaf(Curve::new(Skeleton::through(&points, true)?, vec![(0.0, profile)], fall_off)?)
    }
}

/// Figure 1: 70 primitives, 9 operators. A blend of 60 discs, replaced by a river and two lakes, with seven mounds:
/// two are blended in, four added, and one replaces what is there.
fn valley(scene: &mut Scene) -> Result<NodeId> {
    let mut hills = scene.hills(60)?;
    let mounds = scene.mounds(7)?;
    hills.extend(&mounds[..2]);
    let mut root = scene.builder.blend(&hills)?;
    for &mound in &mounds[2..6] {
        root = scene.builder.add(root, mound, WeightRule::Keep)?;
    }
    root = scene.builder.replace(root, mounds[6], WeightRule::Keep)?;
    let river = scene.curve(8, 20.0)?;
    root = scene.builder.replace(root, river, WeightRule::Keep)?;
    let lake = scene.level([600.0, 1400.0], 150.0)?;
    let pond = scene.level([1500.0, 500.0], 60.0)?;
    // Both are level: one blend of them would do, but an operator each is what the table counts.
    root = scene.builder.replace(root, lake, WeightRule::Keep)?;
    scene.builder.replace(root, pond, WeightRule::Keep)
}

/// Figure 20: 78 primitives, 10 operators. A blend of 66 discs with a river, a road and a lake, and nine mounds turned
/// and added in two groups.
fn coast(scene: &mut Scene) -> Result<NodeId> {
    let hills = scene.hills(66)?;
    let mut root = scene.builder.blend(&hills)?;
    for (from, degrees) in [(4, 0.0), (5, 30.0)] {
        let mounds = scene.mounds(from)?;
        let group = scene.builder.blend(&mounds)?;
        // Turned about the middle of the square.
        let middle = scene.side_m / 2.0;
        let back = Affine::new([[1.0, 0.0], [0.0, 1.0]], [-middle, -middle], 1.0, 0.0)?;
        let turned = Affine::placed([1.0, 1.0], degrees, [middle, middle], 1.0, 0.0)?.after(&back)?;
        let group = scene.builder.place(group, turned)?;
        root = scene.builder.add(root, group, WeightRule::Keep)?;
    }
    for (intervals, width_m) in [(8, 20.0), (10, 6.0)] {
        let curve = scene.curve(intervals, width_m)?;
        root = scene.builder.replace(root, curve, WeightRule::Keep)?;
    }
    let lake = scene.level([600.0, 1400.0], 150.0)?;
    scene.builder.replace(root, lake, WeightRule::Keep)
}

/// Figure 19: 15 primitives, 3 operators. A blend of eleven discs and an image of 125 x 125 heights (the paper's takes
/// 61 kB), replaced by a lake of three blended discs.
fn range(scene: &mut Scene) -> Result<NodeId> {
    let mut parts = scene.hills(11)?;
    let heights = (0..125 * 125).map(|_| scene.rng.between(0.0, 2000.0)).collect();
    let samples = Samples::read(&HeightRows::new(125, heights, None), None)?;
    let place = Mapping::on_box(Area::of(&[[2e4, 2e4], [6e4, 6e4]]))?;
    parts.push(scene.builder.leaf(Image::new(samples, place, Interpolation::Bicubic, 8.0, (1.0, 0.0))?)?);
    let root = scene.builder.blend(&parts)?;
    let lake =
        [scene.level([1.2e5, 9e4], 8e3)?, scene.level([1.28e5, 9.4e4], 6e3)?, scene.level([1.14e5, 8.6e4], 5e3)?];
    let lake = scene.builder.blend(&lake)?;
    scene.builder.replace(root, lake, WeightRule::Keep)
}

/// Figure 22: 148 primitives, 9 operators. "A hundred disc primitives", a road of "about 20 quadric curves" by the
/// replacement operator, and 47 mounds in three groups, added, replaced and turned.
fn road(scene: &mut Scene) -> Result<NodeId> {
    let hills = scene.hills(100)?;
    let mut root = scene.builder.blend(&hills)?;
    for (i, count) in [16, 16, 15].into_iter().enumerate() {
        let mounds = scene.mounds(count)?;
        let mut group = scene.builder.blend(&mounds)?;
        if i == 2 {
            let (c, s) = (0.8, 0.6);
            group = scene.builder.place(group, Affine::new([[c, -s], [s, c]], [180.0, -60.0], 1.0, 0.0)?)?;
        }
        root = scene.builder.add(root, group, WeightRule::Keep)?;
    }
    let road = scene.curve(10, 6.0)?;
    scene.builder.replace(root, road, WeightRule::Keep)
}
