//! Trees as plain data, which can be built, and evaluated literally.

use orograph::construction::primitive::{
    Contour, Curve, Disc, FallOff, Image, Interpolation, Mapping, Profile, Samples, Skeleton,
};
use orograph::construction::{
    Affine, Area, Builder, Deformation, Detail, NodeId, Ramp, Rules, Thresholds, Tree, WeightRule,
};
use orograph::grid::{HeightRows, Heights};
use orograph::noise::{Filter, NoiseKind, NoiseSum, Spectrum};

/// A disc.
#[derive(Clone, Debug)]
pub struct DiscSpec {
    pub centre: [f64; 2],
    pub base_m: f64,
    pub noise: Option<(NoiseKind, Spectrum, bool)>,
    pub fall_off: Option<(f64, f64)>,
}

/// A curve.
#[derive(Clone, Debug)]
pub struct CurveSpec {
    pub points: Vec<[f64; 3]>,
    pub smooth: bool,
    /// Knots of the cross-sections at the beginning and, if there are two, at the end.
    pub sections: Vec<Vec<(f64, f64)>>,
    pub fall_off: (f64, f64),
}

/// A contour.
#[derive(Clone, Debug)]
pub struct ContourSpec {
    pub centre: [f64; 2],
    /// Distances from the centre in equal steps of the angle.
    pub radii_m: Vec<f64>,
    pub profiles: Vec<Vec<(f64, f64)>>,
    pub fall_off: (f64, f64),
}

impl ContourSpec {
    pub fn points(&self) -> Vec<[f64; 2]> {
        let step = std::f64::consts::TAU / self.radii_m.len() as f64;
        let point = |(i, r): (usize, &f64)| {
            let (s, c) = (i as f64 * step).sin_cos();
            [self.centre[0] + r * c, self.centre[1] + r * s]
        };
        self.radii_m.iter().enumerate().map(point).collect()
    }

    pub fn make(&self) -> Contour {
        let profiles = self.profiles.iter().map(|knots| Profile::new(knots).expect("sound")).collect();
        let fall_off = FallOff::new(self.fall_off.0, self.fall_off.1).expect("sound");
        Contour::new(self.centre, 3.0, &self.points(), profiles, fall_off).expect("sound")
    }
}

/// Where an image lies.
#[derive(Clone, Debug)]
pub enum MappingSpec {
    Box([f64; 2], [f64; 2]),
    Quadrangle([[f64; 2]; 4]),
    Along(Vec<[f64; 3]>, f64),
}

/// An image.
#[derive(Clone, Debug)]
pub struct ImageSpec {
    pub cols: usize,
    pub heights_m: Vec<f64>,
    pub weights: Option<Vec<f64>>,
    pub bicubic: bool,
    pub fade: f64,
    pub mapping: MappingSpec,
}

impl ImageSpec {
    pub fn make(&self) -> Image {
        let heights = HeightRows::new(self.cols, self.heights_m.clone(), None);
        let weights = self.weights.as_ref().map(|weights| HeightRows::new(self.cols, weights.clone(), None));
        let weights = weights.as_ref().map(|weights| weights as &dyn Heights);
        let samples = Samples::read(&heights, weights).expect("sound");
        let mapping = match &self.mapping {
            MappingSpec::Box(a, b) => Mapping::on_box(Area::of(&[*a, *b])),
            MappingSpec::Quadrangle(corners) => Mapping::on_quadrangle(*corners),
            MappingSpec::Along(points, half_width_m) => {
                Mapping::along(Skeleton::through(points, true).expect("sound"), *half_width_m)
            }
        };
        let interpolation = if self.bicubic { Interpolation::Bicubic } else { Interpolation::Bilinear };
        Image::new(samples, mapping.expect("sound"), interpolation, self.fade, (1.5, -2.0)).expect("sound")
    }
}

impl CurveSpec {
    pub fn make(&self) -> Curve {
        let skeleton = Skeleton::through(&self.points, self.smooth).expect("sound");
        let sections = self.sections.iter().enumerate();
        let sections = sections.map(|(i, knots)| (i as f64, Profile::new(knots).expect("sound"))).collect();
        let fall_off = FallOff::new(self.fall_off.0, self.fall_off.1).expect("sound");
        Curve::new(skeleton, sections, fall_off).expect("sound")
    }
}

/// A warp.
#[derive(Clone, Debug)]
pub enum WarpSpec {
    Affine { scale: [f64; 2], degrees: f64, shift: [f64; 2], z_scale: f64, z_shift_m: f64 },
    Noise(Spectrum),
    Drag { centre: [f64; 2], by: [f64; 2], radius_m: f64 },
    Twist { centre: [f64; 2], degrees: f64, radius_m: f64 },
}

/// A node with all below it.
#[derive(Clone, Debug)]
pub enum Spec {
    Disc(DiscSpec),
    Curve(CurveSpec),
    Image(ImageSpec),
    Contour(ContourSpec),
    Blend(Vec<Spec>),
    Replace(WeightRule, Box<Spec>, Box<Spec>),
    Add(WeightRule, Box<Spec>, Box<Spec>),
    Warp(WarpSpec, Box<Spec>),
    Level(f64, f64, Box<Spec>, Box<Spec>),
    /// Elevation ramp, slope ramp, child; the guide is the child's sibling.
    Weigh(Option<(f64, f64)>, Option<(f64, f64)>, Box<Spec>, Box<Spec>),
    /// The child weighed by itself in a replacement of itself: one node with two parents.
    Dunes(Box<Spec>, Box<Spec>),
}

impl DiscSpec {
    pub fn make(&self) -> Disc {
        let noise = self.noise.map(|(kind, spectrum, filtered)| {
            let sum = NoiseSum::new(kind, spectrum.terms());
            let filter = |i: usize| Filter { from: 0.2 * i as f64, to: 0.2 * i as f64 + 0.3 };
            if filtered { sum.with_filters((0..spectrum.octaves).map(filter).collect()) } else { sum }
        });
        let fall_off = self.fall_off.map(|(plateau, radius)| FallOff::new(plateau, radius).expect("sound"));
        Disc::new(self.centre, self.base_m, noise, fall_off).expect("sound")
    }
}

impl WarpSpec {
    pub fn affine(&self) -> Option<Affine> {
        match *self {
            Self::Affine { scale, degrees, shift, z_scale, z_shift_m } => {
                Some(Affine::placed(scale, degrees, shift, z_scale, z_shift_m).expect("sound"))
            }
            _ => None,
        }
    }

    pub fn deformation(&self) -> Option<Deformation> {
        match *self {
            Self::Affine { .. } => None,
            Self::Noise(spectrum) => Some(Deformation::noise(spectrum).expect("sound")),
            Self::Drag { centre, by, radius_m } => Some(Deformation::drag(centre, by, radius_m).expect("sound")),
            Self::Twist { centre, degrees, radius_m } => {
                Some(Deformation::twist(centre, degrees, radius_m).expect("sound"))
            }
        }
    }
}

/// Rules of a weight from the ends of the ramps.
pub fn rules(elevation: Option<(f64, f64)>, slope: Option<(f64, f64)>) -> Rules {
    let ramp = |ends: Option<(f64, f64)>| ends.map(|(from, to)| Ramp::new(from, to).expect("sound"));
    Rules { elevation: ramp(elevation), slope: ramp(slope) }
}

/// The ramp of dunes: below 20 m.
pub const DUNES: (f64, f64) = (20.0, 0.0);

impl Spec {
    /// Adds the node and all below it.
    pub fn add(&self, builder: &mut Builder) -> NodeId {
        match self {
            Self::Disc(disc) => builder.leaf(disc.make()),
            Self::Curve(curve) => builder.leaf(curve.make()),
            Self::Contour(contour) => builder.leaf(contour.make()),
            Self::Image(image) => builder.leaf(image.make()),
            Self::Blend(children) => {
                let children: Vec<NodeId> = children.iter().map(|child| child.add(builder)).collect();
                builder.blend(&children)
            }
            Self::Replace(rule, a, b) => {
                let (a, b) = (a.add(builder), b.add(builder));
                builder.replace(a, b, *rule)
            }
            Self::Add(rule, a, b) => {
                let (a, b) = (a.add(builder), b.add(builder));
                builder.add(a, b, *rule)
            }
            Self::Warp(warp, child) => {
                let child = child.add(builder);
                match (warp.affine(), warp.deformation()) {
                    (Some(affine), _) => builder.place(child, affine),
                    (None, Some(deformation)) => builder.bend(child, deformation),
                    (None, None) => unreachable!("a warp is one of the two"),
                }
            }
            Self::Level(from, to, a, b) => {
                let (a, b) = (a.add(builder), b.add(builder));
                builder.level(a, b, Thresholds::new(*from, *to).expect("sound"))
            }
            Self::Weigh(elevation, slope, child, guide) => {
                let (child, guide) = (child.add(builder), guide.add(builder));
                builder.weigh(child, guide, rules(*elevation, *slope))
            }
            Self::Dunes(mountain, dunes) => {
                let (mountain, dunes) = (mountain.add(builder), dunes.add(builder));
                let low = builder.weigh(dunes, mountain, rules(Some(DUNES), None)).expect("sound");
                builder.add(mountain, low, WeightRule::Keep)
            }
        }
        .expect("sound")
    }

    /// The tree of the node.
    pub fn tree(&self, detail: Detail) -> Tree {
        let mut builder = Builder::new();
        let root = self.add(&mut builder);
        builder.finish(root, detail).expect("sound")
    }
}
