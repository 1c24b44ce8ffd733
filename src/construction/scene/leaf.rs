//! Discs and contours of a scene, and what primitives share: noise, fall-offs, profiles.

use super::fields::{Object, Value};
use super::node::Reader;
use crate::construction::primitive::{Contour, Disc, FallOff, Profile};
use crate::construction::tree::{Builder, NodeId};
use crate::error::Result;
use crate::noise::{Filter, NoiseKind, NoiseSum, Spectrum};

/// Members of a spectrum of noise.
pub(super) const SPECTRUM: [&str; 6] = ["octaves", "amplitude_m", "wavelength_m", "persistence", "lacunarity", "seed"];

/// A spectrum of noise.
pub(super) fn spectrum(parts: &Object<'_>) -> Result<Spectrum> {
    let positive = f64::MIN_POSITIVE;
    let wavelength = parts.need("wavelength_m")?;
    let octaves = parts.get("octaves").map_or(Ok(1), |octaves| octaves.count(1, 32))?;
    Ok(Spectrum {
        octaves: octaves as usize,
        amplitude: parts.need("amplitude_m")?.number()?,
        wavelength: wavelength.number_within(positive, f64::MAX)?,
        persistence: parts.number_or("persistence", 0.5)?,
        lacunarity: parts.get("lacunarity").map_or(Ok(2.0), |value| value.number_within(positive, f64::MAX))?,
        seed: parts.get("seed").map_or(Ok(0), |seed| seed.count(0, u64::MAX))?,
    })
}

/// A sum of noise.
fn noise(value: &Value<'_>) -> Result<NoiseSum> {
    let known: Vec<&str> = ["kind", "offset", "gain", "detail"].into_iter().chain(SPECTRUM).collect();
    let parts = value.object(&known)?;
    let kind = match parts.get("kind") {
        None => NoiseKind::Fractal,
        Some(kind) => match kind.text()? {
            "fractal" => NoiseKind::Fractal,
            "turbulence" => NoiseKind::Turbulence,
            "ridged" => {
                NoiseKind::Ridged { offset: parts.number_or("offset", 1.0)?, gain: parts.number_or("gain", 2.0)? }
            }
            other => {
                return Err(
                    kind.fault(format!("noise is \"fractal\", \"turbulence\" or \"ridged\", found \"{other}\""))
                );
            }
        },
    };
    let spectrum = spectrum(&parts)?;
    let sum = NoiseSum::new(kind, spectrum.terms());
    let Some(detail) = parts.get("detail") else { return Ok(sum) };
    let mut filters = vec![];
    for item in detail.items()? {
        let [from, to] = item.numbers()?;
        if !(0.0 <= from && from < to && to <= 1.0) {
            return Err(item.fault("an octave sets in over [from, to] with 0 <= from < to <= 1"));
        }
        filters.push(Filter { from, to });
    }
    if filters.len() != spectrum.octaves {
        return Err(detail.fault(format!("{} octaves need as many ranges, found {}", spectrum.octaves, filters.len())));
    }
    Ok(sum.with_filters(filters))
}

/// A fall-off by the names of its members.
pub(super) fn fall_off(parts: &Object<'_>, radius: &str, plateau: &str, body: &Value<'_>) -> Result<FallOff> {
    let radius_m = parts.need(radius)?.number()?;
    FallOff::new(parts.number_or(plateau, 0.0)?, radius_m).map_err(|e| body.blame(&e))
}

/// A profile.
pub(super) fn profile(value: &Value<'_>) -> Result<Profile> {
    let mut knots = vec![];
    for item in value.items()? {
        let [at, z] = item.numbers()?;
        knots.push((at, z));
    }
    Profile::new(&knots).map_err(|e| value.blame(&e))
}

impl<'a> Reader<'a> {
    pub(super) fn disc(&mut self, builder: &mut Builder, body: &Value<'a>) -> Result<NodeId> {
        let parts = body.object(&["centre", "base_m", "noise", "radius_m", "plateau_m"])?;
        let centre = parts.get("centre").map_or(Ok([0.0; 2]), |centre| centre.numbers())?;
        let noise = parts.get("noise").map(|value| noise(&value)).transpose()?;
        let fall_off = match parts.get("radius_m") {
            None => None,
            Some(_) => Some(fall_off(&parts, "radius_m", "plateau_m", body)?),
        };
        let disc = Disc::new(centre, parts.number_or("base_m", 0.0)?, noise, fall_off);
        disc.and_then(|disc| builder.leaf(disc)).map_err(|e| body.blame(&e))
    }

    pub(super) fn contour(&mut self, builder: &mut Builder, body: &Value<'a>) -> Result<NodeId> {
        let parts = body.object(&["centre", "z_m", "points", "profile", "profiles", "radius", "plateau"])?;
        let mut points = vec![];
        for item in parts.need("points")?.items()? {
            points.push(item.numbers()?);
        }
        let profiles = match parts.get("profiles") {
            None => vec![profile(&parts.need("profile")?)?],
            Some(list) => list.items()?.iter().map(profile).collect::<Result<Vec<Profile>>>()?,
        };
        let fall_off = fall_off(&parts, "radius", "plateau", body)?;
        let z_m = parts.need("z_m")?.number()?;
        let contour = Contour::new(parts.need("centre")?.numbers()?, z_m, &points, profiles, fall_off);
        contour.and_then(|contour| builder.leaf(contour)).map_err(|e| body.blame(&e))
    }
}
