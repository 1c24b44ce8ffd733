//! From a raster to a triangulation within an error: greedy insertion.
//!
//! Of all cells the one that is furthest from the surface becomes a vertex, again and again. A queue holds for each
//! triangle its worst cell, and only the triangles around a new vertex are looked at anew (Garland and Heckbert 1995,
//! "Fast Polygonal Approximation of Terrains and Height Fields", CMU-CS-95-181, algorithm III; here the triangulation is
//! a Delaunay one of the cells' columns and rows).

use super::breaklines::Breaklines;
use super::heights::Heights;
use super::mesh::Mesh;
use super::plane::Plane;
use super::spans::each_span;
use super::triangulation::Triangulation;
use crate::error::{Error, ErrorKind, Result};
use crate::watch::Watch;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Vertices between two looks at the watch.
const BATCH: usize = 1024;

/// Steps in which progress is told.
const STEPS: u64 = 1000;

/// When to stop.
#[derive(Clone, Copy, Debug)]
pub struct RefineOptions {
    /// Greatest vertical distance in metres of a cell from the surface; not negative.
    pub max_error_m: f64,
    /// Greatest number of vertices, whatever the error.
    pub max_vertices: Option<usize>,
}

/// A triangulation of a raster.
#[derive(Clone, Debug, PartialEq)]
pub struct Refined {
    /// The surface; x is the column and y the row. Vertices are in the order of their cells.
    pub mesh: Mesh,
    /// Greatest vertical distance in metres of a cell from it; more than was asked for only where vertices ran out.
    pub error_m: f64,
    /// Cells with data that no triangle can cover: single ones, and lines of one cell's width.
    pub uncovered: u64,
}

/// Triangulates a raster so that each cell with data is at most so far from the surface, up to rounding of 1e-9.
///
/// The raster's corners and all cells beside voids are vertices, so that the triangles end exactly where the squares and
/// halves of squares between cells with data do; `lines` are edges. Among cells that are equally far off the one with
/// the lower index comes first.
///
/// # Errors
/// A raster without a square or half of one that has data; a limit below the number of vertices that are needed in any
/// case; an interrupt.
///
/// # Complexity
/// O((n + m) log m) on most terrain for n cells and m vertices; O(n m) where every vertex cuts a sliver off.
pub fn refine(heights: &Heights, lines: &Breaklines, options: RefineOptions, watch: &Watch) -> Result<Refined> {
    let limit = options.max_vertices.unwrap_or(usize::MAX);
    let mut refiner = Refiner::begin(heights, lines, limit)?;
    watch.begin("triangulating", STEPS);
    refiner.measure_all(options.max_error_m);
    let mut told = 0;
    while refiner.triangulation.vertices() < limit {
        let Some(worst) = refiner.next() else { break };
        refiner.insert(&worst, options.max_error_m)?;
        let vertices = refiner.triangulation.vertices();
        if vertices.is_multiple_of(BATCH) {
            // On most terrain the number of vertices goes with the inverse of the error.
            let share = (options.max_error_m / worst.error()).max(vertices as f64 / limit as f64);
            let done = ((share * STEPS as f64) as u64).clamp(told, STEPS);
            watch.advance(done - told)?;
            told = done;
        }
    }
    watch.check()?;
    Ok(Refined { error_m: refiner.error_m(), mesh: refiner.mesh(), uncovered: heights.uncovered() })
}

/// The worst cell of a triangle, in a queue: the worst first, among equals the lower cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Candidate {
    /// Bits of the error, which sort as errors do since none is negative.
    error_bits: u64,
    cell: Reverse<u32>,
    face: Reverse<u32>,
    /// How often the triangle had been measured.
    stamp: u32,
}

impl Candidate {
    fn error(&self) -> f64 {
        f64::from_bits(self.error_bits)
    }
}

/// What is known of a triangle.
#[derive(Clone, Copy, Debug, Default)]
struct Measured {
    triangle: [u32; 3],
    error_m: f64,
    stamp: u32,
    is_ground: bool,
}

struct Refiner<'a> {
    heights: &'a Heights,
    triangulation: Triangulation,
    measured: Vec<Measured>,
    queue: BinaryHeap<Candidate>,
    star: Vec<(usize, [u32; 3])>,
}

impl<'a> Refiner<'a> {
    /// The triangulation of the cells that are vertices in any case.
    fn begin(heights: &'a Heights, lines: &Breaklines, limit: usize) -> Result<Self> {
        let mut cells = heights.required();
        if cells.is_empty() {
            let message = "there is nothing to triangulate: no three cells with data that are neighbours of each other";
            return Err(Error::new(ErrorKind::Input, message));
        }
        let mut edges = lines.edges().to_vec();
        if !lines.is_empty() && heights.has_voids() {
            // They would be edges anyway, but a line that crossed them would go unnoticed.
            edges.extend(heights.shores());
        }
        cells.extend(edges.iter().flatten());
        cells.sort_unstable();
        cells.dedup();
        if cells.len() > limit {
            let message = format!(
                "{} vertices are needed for the corners, the cells beside voids and the lines alone: more than the {limit} that are allowed",
                cells.len()
            );
            return Err(Error::usage(message));
        }
        #[allow(clippy::cast_possible_truncation, reason = "there are fewer cells than 32 bits count")]
        let position = |cell: u32| cells.binary_search(&cell).unwrap_or_default() as u32;
        let pairs: Vec<[u32; 2]> = edges.iter().map(|edge| edge.map(position)).collect();
        let points: Vec<[f64; 2]> = cells.iter().map(|&cell| heights.place(cell).map(|v| v as f64)).collect();
        let triangulation = Triangulation::new(&points, &pairs)?;
        Ok(Self { heights, triangulation, measured: Vec::new(), queue: BinaryHeap::new(), star: Vec::new() })
    }

    fn measure_all(&mut self, max_error_m: f64) {
        self.measured.resize(self.triangulation.faces(), Measured::default());
        let faces: Vec<(usize, [u32; 3])> = self.triangulation.numbered().collect();
        for (face, triangle) in faces {
            self.measure(face, triangle, max_error_m);
        }
    }

    /// The worst cell of all.
    fn next(&mut self) -> Option<Candidate> {
        while let Some(candidate) = self.queue.pop() {
            if self.measured[candidate.face.0 as usize].stamp == candidate.stamp {
                return Some(candidate);
            }
        }
        None
    }

    fn insert(&mut self, worst: &Candidate, max_error_m: f64) -> Result<()> {
        let near = self.measured[worst.face.0 as usize].triangle[0];
        let place = self.heights.place(worst.cell.0).map(|v| v as f64);
        let vertex = self.triangulation.insert(place, near)?;
        self.measured.resize(self.triangulation.faces(), Measured::default());
        let mut star = std::mem::take(&mut self.star);
        self.triangulation.star(vertex, &mut star);
        for &(face, triangle) in &star {
            self.measure(face, triangle, max_error_m);
        }
        self.star = star;
        Ok(())
    }

    fn place(&self, vertex: u32) -> [i64; 2] {
        self.triangulation.point(vertex).map(|v| v as i64)
    }

    /// Finds the worst cell of a triangle, and queues it if it is further off than it may be.
    #[allow(clippy::cast_possible_truncation, reason = "there are fewer triangles than 32 bits count")]
    fn measure(&mut self, face: usize, triangle: [u32; 3], max_error_m: f64) {
        let corners = triangle.map(|vertex| self.place(vertex));
        let is_ground = self.heights.is_ground_triangle(corners);
        let (error_m, cell) = if is_ground { worst(self.heights, corners) } else { (0.0, 0) };
        let stamp = self.measured[face].stamp + 1;
        self.measured[face] = Measured { triangle, error_m, stamp, is_ground };
        if error_m > max_error_m {
            let error_bits = error_m.to_bits();
            self.queue.push(Candidate { error_bits, cell: Reverse(cell), face: Reverse(face as u32), stamp });
        }
    }

    fn error_m(&self) -> f64 {
        self.measured.iter().fold(0.0, |worst, face| worst.max(face.error_m))
    }

    /// The triangles on the ground, in an order that shows nothing of how they came about.
    #[allow(clippy::cast_possible_truncation, reason = "there are fewer vertices than 32 bits count")]
    fn mesh(&self) -> Mesh {
        let ground = self.measured.iter().filter(|face| face.is_ground);
        let cell = |vertex| self.heights.cell(self.place(vertex));
        let mut triangles: Vec<[u32; 3]> = ground.map(|face| face.triangle.map(cell)).collect();
        for triangle in &mut triangles {
            let least = (0..3).min_by_key(|&i| triangle[i]).unwrap_or_default();
            triangle.rotate_left(least);
        }
        triangles.sort_unstable();
        let mut cells: Vec<u32> = triangles.iter().flatten().copied().collect();
        cells.sort_unstable();
        cells.dedup();
        for corner in triangles.iter_mut().flatten() {
            *corner = cells.binary_search(corner).unwrap_or_default() as u32;
        }
        let vertex = |&cell: &u32| {
            let place = self.heights.place(cell);
            [place[0] as f64, place[1] as f64, self.heights.z(place)]
        };
        Mesh { vertices: cells.iter().map(vertex).collect(), triangles }
    }
}

/// Distance in metres and number of the cell of a triangle that is furthest from its plane.
fn worst(heights: &Heights, mut corners: [[i64; 2]; 3]) -> (f64, u32) {
    // Rounding must not depend on where a triangle is said to begin.
    corners.sort_unstable_by_key(|&[x, y]| (y, x));
    let plane = Plane::through(corners.map(|place| [place[0] as f64, place[1] as f64, heights.z(place)]));
    let mut found = (0.0, heights.cell(corners[0]));
    each_span::<0>(corners, (heights.cols() as i64, heights.rows() as i64), |row, first, last| {
        let begin = plane.at(first as f64, row as f64);
        let start = heights.cell([first, row]);
        let span = &heights.z_m()[start as usize..=start as usize + (last - first) as usize];
        let mut along = 0.0;
        for (cell, &z) in (start..).zip(span) {
            let error = (z - (begin + plane.slope_x * along)).abs();
            if error > found.0 {
                found = (error, cell);
            }
            along += 1.0;
        }
    });
    found
}
