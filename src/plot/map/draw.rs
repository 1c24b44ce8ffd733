//! Puts the map together: relief, overlay, frame, title, legend and source.

use super::canvas::{Canvas, Ink};
use super::classes::Classes;
use super::frame::Frame;
use super::graticule::draw_ticks;
use super::hillshade::{LEVEL, exaggeration, hillshade, slopes};
use super::legend::{Legend, QUIET, TEXT};
use super::overlay::Overlay;
use super::raster::{Averaged, Relief};
use super::scale_bar::ScaleBar;
use super::symbols::{Drawn, draw_overlay};
use super::text::{Align, Font, Lettering, grouped};
use super::tint::Ramp;
use crate::crs::Crs;
use crate::error::{Error, Result};
use crate::grid::GeoTransform;
use rayon::prelude::*;

/// How a map is to look.
#[derive(Clone, Debug, PartialEq)]
pub struct MapOptions {
    /// Width of the picture in pixels; its height follows from the relief.
    pub width_px: u32,
    /// Title above the map.
    pub title: Option<String>,
    /// Where the data is from, below the map.
    pub source: Option<String>,
    /// Elevation in metres up to which cells are sea; `None` where there is none, such as on the Moon.
    pub sea_level_m: Option<f64>,
    /// How many times heights are exaggerated in the shading; `None` to suit the relief.
    pub exaggeration: Option<f64>,
}

impl Default for MapOptions {
    fn default() -> Self {
        Self { width_px: 1600, title: None, source: None, sea_level_m: Some(0.0), exaggeration: None }
    }
}

/// Least and greatest width of a picture in pixels.
const WIDTHS: std::ops::RangeInclusive<u32> = 160..=16_384;
/// How many times as high as wide a map may be.
const TALLEST: f64 = 2.0;

impl MapOptions {
    /// Whether a map can be drawn so; drawing starts with this.
    ///
    /// # Errors
    /// A usage error for a width or an exaggeration out of range.
    pub fn check(&self) -> Result<()> {
        if !WIDTHS.contains(&self.width_px) {
            return Err(Error::usage(format!(
                "a picture cannot be {} pixels wide; ask for {} to {}",
                self.width_px,
                WIDTHS.start(),
                WIDTHS.end()
            )));
        }
        if self.exaggeration.is_some_and(|z| !(z > 0.0 && z.is_finite())) {
            return Err(Error::usage("the exaggeration of heights must be a positive number"));
        }
        Ok(())
    }

    /// Size of everything but the relief.
    fn sizes(&self) -> f32 {
        (self.width_px as f32 / 1600.0).clamp(0.75, 6.0)
    }

    fn margin(&self) -> f32 {
        (26.0 * self.sizes()).round()
    }

    /// Rows and columns of pixels that a raster would take on the map.
    ///
    /// # Errors
    /// See [`Relief::new`] and [`MapOptions::check`].
    pub fn relief_size(
        &self,
        rows: usize,
        cols: usize,
        transform: &GeoTransform,
        crs: Option<&Crs>,
    ) -> Result<(usize, usize)> {
        self.check()?;
        // Its shape is that of a much coarser one at the same place.
        let (few_rows, few_cols) = (rows.min(512), cols.min(512));
        let coarser = transform.scaled(rows as f64 / few_rows as f64, cols as f64 / few_cols as f64);
        let blank = Relief::new(few_rows, few_cols, vec![f32::NAN; few_rows * few_cols], coarser, crs)?;
        let frame = fitted_frame(&blank, self.width_px as f32 - 2.0 * self.margin());
        Ok((frame.height as usize, frame.width as usize))
    }
}

/// A finished map.
#[derive(Clone, Debug, PartialEq)]
pub struct Map {
    /// The picture as a PNG file.
    pub png: Vec<u8>,
    /// Its width and height in pixels.
    pub size: (u32, u32),
    /// How many of the peaks lie on the map.
    pub peaks_there: usize,
    /// How many of these are drawn.
    pub peaks_drawn: usize,
    /// Whether there is anything of the overlay on the map.
    pub has_overlay: bool,
}

/// Draws a map as a PNG picture.
///
/// The relief may be larger or smaller than the picture: it is averaged down, or interpolated. Peaks, saddles and
/// labels that would overlap more prominent ones are left out; a note below the map says how many peaks are shown.
///
/// # Errors
/// See [`MapOptions::check`] and [`Relief::check`].
pub fn draw(relief: &Relief, overlay: &Overlay, options: &MapOptions) -> Result<Map> {
    relief.check()?;
    options.check()?;
    let (s, margin) = (options.sizes(), options.margin());
    let (regular, bold) = (Font::regular(), Font::bold());

    let frame = fitted_frame(relief, options.width_px as f32 - 2.0 * margin);
    let (mut map, tints) = drawn_relief(relief, &frame, options)?;
    let classes = Classes::fit(overlay.peaks.iter().map(|peak| peak.prominence_m));
    let drawn = draw_overlay(&mut map, &frame, overlay, &classes, &regular, s);

    let m_per_px = relief.drawn_cell_x_m() * relief.cols as f64 / f64::from(frame.width);
    let legend = Legend {
        classes: &classes,
        drawn: &drawn,
        ramp: tints.ramp,
        voids: tints.voids,
        bar: ScaleBar::fit(m_per_px, 190.0 * f64::from(s)),
        bar_note: varies(&relief.cell_x_m).then_some("at the middle latitude"),
        font: &regular,
        s,
    };
    let inner = options.width_px as f32 - 2.0 * margin;
    let title_height = if options.title.is_some() { (40.0 * s).round() } else { 0.0 };
    let map_top = margin + title_height;
    let legend_top = map_top + frame.height as f32 + (30.0 * s).round();
    let legend_height = legend.height(inner);
    let source_line = legend_top + legend_height + 12.0 * s;
    let note = peaks_note(&drawn);
    let has_source = options.source.is_some() || note.is_some();
    let height = source_line + if has_source { 16.0 * s } else { 0.0 };

    let mut page = Canvas::new(options.width_px, height.ceil() as u32, Ink::WHITE)?;
    let map_left = ((options.width_px as f32 - frame.width as f32) / 2.0).floor();
    if let Some(title) = &options.title {
        let lettering = Lettering { font: &bold, size: 25.0 * s, ink: TEXT, halo: None };
        let title = lettering.fitted(title, inner);
        lettering.write(&mut page, &title, (margin, margin + 21.0 * s), Align::Left);
    }
    let line = s.round().max(1.0);
    let (w, h) = (frame.width as f32, frame.height as f32);
    page.rectangle(map_left - line, map_top - line, w + 2.0 * line, h + 2.0 * line, TEXT);
    draw_ticks(&mut page, &frame, relief.degrees, (map_left, map_top), &regular, s);
    page.place(&map, map_left as i32, map_top as i32);
    legend.draw(&mut page, (margin, legend_top), inner);
    let small = Lettering { font: &regular, size: 10.5 * s, ink: QUIET, halo: None };
    let note = note.unwrap_or_default();
    small.write(&mut page, &note, (margin + inner, source_line), Align::Right);
    if let Some(source) = &options.source {
        let source = small.fitted(source, inner - small.width(&note) - 20.0 * s);
        small.write(&mut page, &source, (margin, source_line), Align::Left);
    }
    Ok(Map {
        png: page.png()?,
        size: page.size(),
        peaks_there: drawn.peaks_there,
        peaks_drawn: drawn.peaks.iter().sum(),
        has_overlay: drawn.peaks_there > 0 || drawn.ridges || drawn.saddles || drawn.isolation,
    })
}

/// The frame that shows the relief in its true shape, as wide as there is room unless it would be too tall.
fn fitted_frame(relief: &Relief, room: f32) -> Frame {
    let room = f64::from(room.floor());
    let shape = relief.rows as f64 * relief.cell_y_m / (relief.cols as f64 * relief.drawn_cell_x_m());
    let width = if shape > TALLEST { room * TALLEST / shape } else { room };
    // A raster of one row or column is still shown as a strip.
    let width = width.round().max(24.0);
    let height = (width * shape).round().clamp(24.0, room * TALLEST);
    Frame::new(relief, width as u32, height as u32)
}

/// What the legend has to know of the relief.
struct Tints {
    ramp: Option<Ramp>,
    voids: bool,
}

fn drawn_relief(relief: &Relief, frame: &Frame, options: &MapOptions) -> Result<(Canvas, Tints)> {
    let (height, width) = (frame.height as usize, frame.width as usize);
    let averaged = relief.averaged(height, width, options.sea_level_m);
    // A regular sample ranks as well as all cells do; an odd step meets every column sooner or later.
    let stride = (averaged.elevation_m.len() / 200_000).max(1) | 1;
    let sample = averaged.elevation_m.iter().copied().zip(averaged.sea.iter().copied()).step_by(stride);
    let ramp = Ramp::fit(sample, options.sea_level_m.unwrap_or(0.0) as f32);
    let known = averaged.valid.iter().map(|&v| f64::from(v)).sum::<f64>() / averaged.valid.len() as f64;
    let is_land = averaged.elevation_m.iter().zip(&averaged.sea).any(|(e, sea)| e.is_finite() && *sea < 0.5);
    // Enlarged first and shaded then: light that is enlarged looks out of focus.
    let relief = averaged.enlarged(height, width);
    let slopes = slopes(&relief);
    let times = options.exaggeration.map_or_else(|| exaggeration(&slopes), |z| z as f32);
    let shade = hillshade(&slopes, times);
    let Averaged { elevation_m, sea, valid, .. } = relief;
    let pixels: Vec<[u8; 3]> = (0..height * width)
        .into_par_iter()
        .map(|i| ramp.shaded(elevation_m[i], if shade[i].is_nan() { LEVEL } else { shade[i] }, sea[i], valid[i]))
        .collect();
    let map = Canvas::from_pixels(frame.width, frame.height, &pixels)?;
    Ok((map, Tints { ramp: is_land.then_some(ramp), voids: known < 0.9999 }))
}

fn varies(widths_m: &[f64]) -> bool {
    let least = widths_m.iter().copied().fold(f64::INFINITY, f64::min);
    let most = widths_m.iter().copied().fold(0.0, f64::max);
    most > 1.03 * least
}

fn peaks_note(drawn: &Drawn) -> Option<String> {
    let shown: usize = drawn.peaks.iter().sum();
    (shown < drawn.peaks_there).then(|| {
        let (shown, there) = (grouped(shown as f64), grouped(drawn.peaks_there as f64));
        format!("{shown} of {there} peaks shown: where they crowd, the most prominent")
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::ErrorKind;
    use crate::plot::map::{PeakMark, Ridge};

    fn hills(rows: usize, cols: usize) -> Relief {
        let elevation_m = (0..rows * cols)
            .map(|i| ((i / cols) as f32 * 0.3, (i % cols) as f32 * 0.2))
            .map(|(y, x)| 800.0 + 300.0 * x.sin() * y.cos())
            .collect();
        let t = GeoTransform([500_000.0, 100.0, 0.0, 5_200_000.0, 0.0, -100.0]);
        Relief::new(rows, cols, elevation_m, t, None).unwrap()
    }

    fn decoded(png: &[u8]) -> (u32, u32, Vec<u8>) {
        let mut reader = png::Decoder::new(std::io::Cursor::new(png)).read_info().unwrap();
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut pixels).unwrap();
        (info.width, info.height, pixels)
    }

    fn overlay() -> Overlay {
        let peak = |x: f64, y: f64, prominence_m: f64| PeakMark {
            x: 500_000.0 + x,
            y: 5_200_000.0 - y,
            prominence_m,
            elevation_m: 1100.0,
            name: Some("Piz".into()),
        };
        Overlay {
            peaks: vec![peak(700.0, 900.0, 300.0), peak(3000.0, 2000.0, f64::NAN), peak(-1e9, 0.0, 5.0)],
            saddles: vec![(501_500.0, 5_198_800.0), (f64::INFINITY, 0.0)],
            ridges: vec![Ridge {
                path: vec![(500_700.0, 5_199_100.0), (503_000.0, 5_198_000.0)],
                prominence_m: 90.0,
                carried_m: 90.0,
            }],
            isolation: vec![vec![(500_700.0, 5_199_100.0), (1e12, 5_198_000.0)]],
        }
    }

    #[test]
    fn draws_the_same_bytes_each_time_at_the_width_asked_for() {
        let relief = hills(60, 80);
        let options = MapOptions {
            width_px: 400,
            title: Some("Hills".into()),
            source: Some("made up".into()),
            ..MapOptions::default()
        };
        let map = draw(&relief, &overlay(), &options).unwrap();
        let (width, height, pixels) = decoded(&map.png);
        assert_eq!((width, (width, height)), (400, map.size));
        assert_eq!((map.peaks_there, map.peaks_drawn, map.has_overlay), (2, 2, true));
        assert!(height > 280 && height < 480, "{height}");
        assert!(pixels.iter().any(|&p| p < 60), "something dark was drawn");
        assert_eq!(draw(&relief, &overlay(), &options).unwrap(), map);
        let (rows, cols) = options.relief_size(60, 80, &relief.transform, None).unwrap();
        assert_eq!((rows, cols), (270, 360), "the width without its margins");
    }

    #[test]
    fn any_shape_of_relief_can_be_drawn() {
        let options = MapOptions { width_px: 200, ..MapOptions::default() };
        for (rows, cols) in [(1, 1), (1, 500), (500, 1), (3, 2), (700, 600)] {
            let map = draw(&hills(rows, cols), &Overlay::default(), &options).unwrap();
            assert_eq!(decoded(&map.png).0, 200, "{rows} x {cols}");
        }
        let mut nothing = hills(20, 20);
        nothing.elevation_m.fill(f32::NAN);
        let (_, _, pixels) = decoded(&draw(&nothing, &overlay(), &options).unwrap().png);
        assert!(!pixels.is_empty());
        nothing.elevation_m.fill(12.5);
        draw(&nothing, &overlay(), &options).unwrap();
    }

    #[test]
    fn wrong_options_are_refused() {
        let draw = |options: MapOptions| draw(&hills(5, 5), &Overlay::default(), &options).unwrap_err();
        let error = draw(MapOptions { width_px: 3, ..MapOptions::default() });
        assert_eq!(error.kind(), ErrorKind::Usage);
        assert!(error.to_string().contains("160 to 16384"), "{error}");
        assert!(
            draw(MapOptions { exaggeration: Some(-1.0), ..MapOptions::default() }).to_string().contains("positive")
        );
    }
}
