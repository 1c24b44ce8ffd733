//! A mesh of all cells.

use super::ground::corners;
use super::heights::Heights;
use super::mesh::Mesh;

/// The mesh whose vertices are the cells: two triangles between any four neighbours, one where one of them is a void.
///
/// Squares are cut from the first row's first column to the second row's second, whatever the elevations. Cells that no
/// triangle touches are left out. x is the column and y the row.
#[allow(clippy::cast_possible_truncation, reason = "a raster of this kind has fewer cells than 32 bits count")]
pub fn regular(heights: &Heights) -> Mesh {
    const NONE: u32 = u32::MAX;
    let mut numbers = vec![NONE; heights.z_m().len()];
    let mut mesh = Mesh::default();
    for place in heights.places().filter(|&place| heights.is_ground(place)) {
        numbers[heights.cell(place) as usize] = mesh.vertices.len() as u32;
        mesh.vertices.push([place[0] as f64, place[1] as f64, heights.z(place)]);
    }
    for [x, y] in heights.places() {
        if x + 1 == heights.cols() as i64 || y + 1 == heights.rows() as i64 {
            continue;
        }
        let square = corners([x, y]).map(|corner| numbers[heights.cell(corner) as usize]);
        // Ground at a corner may be that of another square.
        let [a, b, c, d] = square;
        match corners([x, y]).map(|corner| heights.has(corner)) {
            [true, true, true, true] => mesh.triangles.extend([[a, b, c], [a, c, d]]),
            [true, true, true, false] => mesh.triangles.push([a, b, c]),
            [true, true, false, true] => mesh.triangles.push([a, b, d]),
            [true, false, true, true] => mesh.triangles.push([a, c, d]),
            [false, true, true, true] => mesh.triangles.push([b, c, d]),
            _ => {}
        }
    }
    mesh
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn voids_are_left_out() {
        let n = f64::NAN;
        #[rustfmt::skip]
        let z = vec![
            1.0, 2.0, 3.0, n,   9.0,
            4.0, 5.0, n,   n,   n,
            6.0, 7.0, n,   8.0, n,
        ];
        let mesh = regular(&Heights::new(3, 5, z).unwrap());
        assert_eq!(mesh.check(), Ok(()));
        let elevations: Vec<f64> = mesh.vertices.iter().map(|v| v[2]).collect();
        assert_eq!(elevations, [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0], "8 and 9 stand alone");
        assert_eq!(mesh.triangles, [[0, 1, 4], [0, 4, 3], [1, 2, 4], [3, 4, 6], [3, 6, 5]]);
        assert_eq!(regular(&Heights::new(1, 3, vec![1.0; 3]).unwrap()), Mesh::default(), "a line has no area");
    }
}
