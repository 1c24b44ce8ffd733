//! Terrain for the vectors: the same on every machine, for it takes only sums and products.

use crate::case::noise;

/// Heights of about 0 to 2000 on a grid; `roughness` from 0 on says how much of it is in small things.
pub fn heights(width: usize, height: usize, seed: u64, roughness: f64) -> Vec<f64> {
    let mut heights = vec![0.0; width * height];
    let (mut cell, mut most) = (64, 1000.0);
    for octave in 0..7 {
        let across = width / cell + 2;
        let knots: Vec<f64> = noise(seed * 100 + octave)
            .take(across * (height / cell + 2))
            .map(|bits| (bits >> 11) as f64 / (1_u64 << 53) as f64)
            .collect();
        let ease = |t: f64| t * t * (3.0 - 2.0 * t);
        for (index, sum) in heights.iter_mut().enumerate() {
            let (row, col) = (index / width, index % width);
            let at = |row: usize, col: usize| knots[row * across + col];
            let (r, c) = (row / cell, col / cell);
            let down = ease((row % cell) as f64 / cell as f64);
            let right = ease((col % cell) as f64 / cell as f64);
            let upper = at(r, c) * (1.0 - right) + at(r, c + 1) * right;
            let lower = at(r + 1, c) * (1.0 - right) + at(r + 1, c + 1) * right;
            *sum += most * (upper * (1.0 - down) + lower * down);
        }
        cell = (cell / 2).max(1);
        most *= 0.25 + 0.25 * roughness;
    }
    heights
}

/// A lake with an island, a corner that is cut off, and single cells: what voids look like.
pub fn is_void(width: usize, height: usize, row: usize, col: usize) -> bool {
    let from = |y: usize, x: usize| {
        let (dy, dx) = (row as f64 - y as f64, col as f64 - x as f64);
        dy * dy + dx * dx
    };
    let lake = from(height / 3, width / 3);
    let r = (width.min(height) / 4) as f64;
    (lake < r * r && lake > r * r / 9.0) || row + col + 20 > width + height || (row * width + col) % 211 == 17
}
