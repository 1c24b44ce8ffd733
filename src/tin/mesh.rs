//! A mesh of triangles.

/// Triangles over vertices, a surface that is nowhere vertical.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// x, y and z of the vertices. Of a raster these are column, row and metres, until coordinates are made of them.
    pub vertices: Vec<[f64; 3]>,
    /// Positions of the vertices of each triangle, counter-clockwise where x points right and y up.
    pub triangles: Vec<[u32; 3]>,
}

impl Mesh {
    /// Twice the signed area of a triangle in x and y; positive where it runs counter-clockwise.
    fn area2(&self, triangle: [u32; 3]) -> f64 {
        let [a, b, c] = triangle.map(|v| self.vertices[v as usize]);
        (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1])
    }

    /// Turns every triangle the other way round: what is due where y or x begins to count in the other direction.
    pub fn turn_over(&mut self) {
        self.triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
    }

    /// What is wrong with the mesh, if anything: a coordinate that is not finite, a triangle without a positive area,
    /// an edge that two triangles pass in the same direction, a vertex of no triangle.
    ///
    /// # Complexity
    /// O(n log n).
    pub fn check(&self) -> Result<(), String> {
        if let Some(i) = self.vertices.iter().position(|vertex| vertex.iter().any(|v| !v.is_finite())) {
            return Err(format!("vertex {i} is {:?}", self.vertices[i]));
        }
        let mut used = vec![false; self.vertices.len()];
        let mut edges: Vec<[u32; 2]> = Vec::with_capacity(self.triangles.len() * 3);
        for (i, &triangle) in self.triangles.iter().enumerate() {
            if triangle.iter().any(|&v| v as usize >= self.vertices.len()) {
                return Err(format!("triangle {i} is {triangle:?} of {} vertices", self.vertices.len()));
            }
            if self.area2(triangle) <= 0.0 || self.area2(triangle).is_nan() {
                return Err(format!("triangle {i}, {triangle:?}, does not run counter-clockwise"));
            }
            let [a, b, c] = triangle;
            edges.extend([[a, b], [b, c], [c, a]]);
            triangle.iter().for_each(|&v| used[v as usize] = true);
        }
        edges.sort_unstable();
        if let Some(pair) = edges.windows(2).find(|pair| pair[0] == pair[1]) {
            return Err(format!("two triangles pass the edge {:?}", pair[0]));
        }
        match used.iter().position(|used| !used) {
            Some(i) => Err(format!("vertex {i} belongs to no triangle")),
            None => Ok(()),
        }
    }

    /// Least and greatest x, y and z; `None` without vertices.
    pub fn bounds(&self) -> Option<([f64; 3], [f64; 3])> {
        let first = *self.vertices.first()?;
        Some(self.vertices.iter().fold((first, first), |(low, high), v| {
            (std::array::from_fn(|i| low[i].min(v[i])), std::array::from_fn(|i| high[i].max(v[i])))
        }))
    }

    /// Unit normals of the vertices, upwards: the mean of those of their triangles, weighted by area.
    pub fn normals(&self) -> Vec<[f64; 3]> {
        let mut sums = vec![[0.0; 3]; self.vertices.len()];
        for triangle in &self.triangles {
            let [a, b, c] = triangle.map(|v| self.vertices[v as usize]);
            let (p, q): ([f64; 3], [f64; 3]) =
                (std::array::from_fn(|i| b[i] - a[i]), std::array::from_fn(|i| c[i] - a[i]));
            // Its length is twice the triangle's area.
            let normal = [p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]];
            for &v in triangle {
                (0..3).for_each(|i| sums[v as usize][i] += normal[i]);
            }
        }
        for sum in &mut sums {
            let length = (sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]).sqrt();
            *sum = if length > 0.0 { sum.map(|v| v / length) } else { [0.0, 0.0, 1.0] };
        }
        sums
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn roof() -> Mesh {
        let vertices = vec![[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 2.0, 2.0], [0.0, 2.0, 2.0]];
        Mesh { vertices, triangles: vec![[0, 1, 2], [0, 2, 3]] }
    }

    #[test]
    fn normals_stand_on_the_surface() {
        let half = 0.5_f64.sqrt();
        for normal in roof().normals() {
            assert!((0..3).all(|i| (normal[i] - [0.0, -half, half][i]).abs() < 1e-15), "{normal:?}");
        }
        assert_eq!(roof().bounds(), Some(([0.0; 3], [2.0; 3])));
    }

    #[test]
    fn faults_are_found() {
        assert_eq!(roof().check(), Ok(()));
        let mut turned = roof();
        turned.turn_over();
        assert!(turned.check().unwrap_err().contains("counter-clockwise"));
        let spare = Mesh { vertices: [roof().vertices, vec![[5.0, 5.0, 5.0]]].concat(), ..roof() };
        assert!(spare.check().unwrap_err().contains("vertex 4 belongs to no triangle"));
        let twice = Mesh { triangles: vec![[0, 1, 2], [0, 1, 3], [0, 2, 3]], ..roof() };
        assert!(twice.check().unwrap_err().contains("two triangles pass the edge [0, 1]"));
        let beyond = Mesh { triangles: vec![[0, 1, 4]], ..roof() };
        assert!(beyond.check().unwrap_err().contains("of 4 vertices"));
        let mut infinite = roof();
        infinite.vertices[2][2] = f64::INFINITY;
        assert!(infinite.check().unwrap_err().contains("vertex 2"));
    }
}
